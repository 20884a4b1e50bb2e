#include "drivers/can/decode_plan.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "drivers/can/decoder.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/can/temporary_file.hpp"
#include "tests/drivers/can/triaxial_cell.hpp"

namespace stillcut {
namespace {

class DecodePlanRefuses : public testing::Test {
 protected:
  std::string error() {
    return message_of<InputError>([this] { compile_decode_plan(dbc_, can_, "cell.toml"); });
  }
  AccelerometerSettings& sensor() { return can_.accelerometers[0]; }
  Dbc dbc_ = parse_dbc(
      "BO_ 1 Vibration: 64 N\n"
      " SG_ Counter : 0|16@1+ (1,0) [0|0] \"\" N\n"
      " SG_ X0 : 16|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ X1 : 32|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ Y0 : 48|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ Page M : 64|8@1+ (1,0) [0|0] \"\" N\n"
      " SG_ A m0 : 72|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ B m1 : 72|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ F : 96|32@1- (1,0) [0|0] \"\" N\n"
      "BO_ 2 Other: 8 N\n"
      " SG_ Z : 0|16@1- (1,0) [0|0] \"\" N\n"
      " SG_ C m0 : 16|16@1- (1,0) [0|0] \"\" N\n"
      "SIG_VALTYPE_ 1 F : 1;\n",
      "cell.dbc");
  CanSettings can_ = [] {
    CanSettings can = triaxial_cell();
    can.accelerometers[0].axis = {"Vibration.X{0..1}", "", ""};
    can.spindle_speed = "Other.Z";
    return can;
  }();
};

TEST_F(DecodePlanRefuses, NothingInAGoodCell) { EXPECT_EQ(error(), ""); }

TEST_F(DecodePlanRefuses, SignalsThatTheDbcLacks) {
  sensor().axis[0] = "Vibraton.X{0..1}";
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer.x: cell.dbc has no message 'Vibraton'; there is Vibration, Other");
  sensor().axis[0] = "Vibration.X{0..2}";
  EXPECT_EQ(
      error(),
      "cell.toml:40: can.accelerometer.x: message 'Vibration' of cell.dbc has no signal 'X2'; nearest are X0, X1, Y0");
  sensor().axis[0] = "Vibration.X{0..1}";
  sensor().counter = "Vibration.counter";
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer.counter: message 'Vibration' of cell.dbc has no signal 'counter'; "
            "nearest are Counter, Page, X0");
  sensor().counter = "";
  can_.spindle_speed = "Other.Speed";
  EXPECT_EQ(error(),
            "cell.toml:37: can.spindle.speed_rpm: message 'Other' of cell.dbc has no signal 'Speed'; there is Z, C");
}

TEST_F(DecodePlanRefuses, MalformedReferences) {
  const auto with_x = [this](const char* reference) {
    sensor().axis[0] = reference;
    return error();
  };
  const std::string start = "cell.toml:40: can.accelerometer.x: ";
  for (const char* reference : {"Vibration", ".X0", "Vibration."}) {
    EXPECT_EQ(with_x(reference), start + "'" + reference + "' is not of the form Message.Signal");
  }
  for (const char* reference : {"Vibration.X{0..", "Vibration.X{0-1}", "Vibration.X{a..b}", "Vibration.X{..1}",
                                "Vibration.X{-1..1}", "Vibration.X{0..99999999999}"}) {
    EXPECT_EQ(with_x(reference), start + "'" + reference + "' is not of the form Message.Signal{first..last}");
  }
  EXPECT_EQ(with_x("Vibration.X{1..0}"),
            start + "'Vibration.X{1..0}' counts down; write the oldest sample first, {a..b} with a <= b");
  EXPECT_EQ(with_x("Vibration.X{0..64}"),
            start + "'Vibration.X{0..64}' names 65 samples; a CAN FD frame holds at most 64");
}

TEST_F(DecodePlanRefuses, AxesThatDoNotBelongTogether) {
  sensor().axis[1] = "Other.Z";
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer.y: message 'Other' is not the one of x, 'Vibration'; axes and counter "
            "of one accelerometer come in one message: use a second [[can.accelerometer]]");
  sensor().axis[1] = "Vibration.Y0";
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer.y: 1 samples a frame, but 2 for x; all axes of an accelerometer have "
            "the same number");
  sensor().axis = {"Vibration.A", "Vibration.B", ""};
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer: signals of message 'Vibration' that are sent by turns (multiplexed m0 "
            "and m1) cannot be read together; they must share one multiplexer value");
  sensor().axis = {"Other.C", "", ""};
  sensor().counter = "";
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer: message 'Other' needs exactly one multiplexer (M) to read multiplexed "
            "signals");
}

TEST_F(DecodePlanRefuses, SettingsWithoutSense) {
  sensor().axis[0] = "";
  EXPECT_EQ(error(), "cell.toml:40: can.accelerometer: no axis is measured; give x, y or z");
  sensor().axis[0] = "Vibration.X0";
  sensor().counter = "Vibration.X{0..1}";
  EXPECT_EQ(error(), "cell.toml:40: can.accelerometer.counter: a counter is one whole number");
  sensor().counter = "Vibration.F";
  EXPECT_EQ(error(), "cell.toml:40: can.accelerometer.counter: a counter is one whole number");
  sensor().counter = "";
  sensor().rotation = {0.0, 0.0, 0.1};
  EXPECT_EQ(error(),
            "cell.toml:40: can.accelerometer: rotation_deg mixes measured with unmeasured axes into tool x; measure "
            "all three axes, or turn by quarter turns only");
  sensor().axis[1] = "Vibration.Y0";  // a turn about the axis that is not measured needs nothing of it
  EXPECT_EQ(error(), "");
  can_.spindle_speed = "Vibration.X{0..1}";
  EXPECT_EQ(error(), "cell.toml:37: can.spindle.speed_rpm: the spindle speed is one signal");
  can_.spindle_speed = "";
  can_.accelerometers.resize(5, sensor());
  EXPECT_EQ(error(), "cell.toml:40: can.accelerometer: 5 accelerometers; at most 4");
}

TEST(DecodePlan, ExpandsNumbersWithinAName) {
  const Dbc dbc = parse_dbc(
      "BO_ 1 M: 4 N\n SG_ S9_x : 0|16@1- (1,0) [0|0] \"\" N\n SG_ S10_x : 16|16@1- (1,0) [0|0] \"\" N\n", "cell.dbc");
  CanSettings can;
  can.accelerometers.resize(1);
  can.accelerometers[0].axis[2] = "M.S{9..10}_x";
  const DecodePlan plan = compile_decode_plan(dbc, can, "cell.toml");
  EXPECT_EQ(plan.sensors[0].samples, 2);
  EXPECT_EQ(plan.sensors[0].axes_present, 4);
  EXPECT_FALSE(plan.spindle.has_value());
}

// Any layout (both orders, any width, sign and kind) decodes to what a bit-by-bit reading of the frame gives; regular
// ones take the plain loop, the others the general way.
TEST(DecodePlan, DecodesRandomLayoutsAsBitByBit) {
  std::mt19937_64 random(8);
  int regular = 0;
  for (int n = 0; n < 3'000; ++n) {
    const bool usual = n % 4 == 0;
    const int samples = 1 + static_cast<int>(random() % 7);
    const int kind = usual ? 1 : static_cast<int>(random() % 4);  // unsigned, signed, float, double
    const int length = usual ? 16 : kind == 2 ? 32 : kind == 3 ? 64 : 1 + static_cast<int>(random() % 64);
    const bool little = usual || random() % 2 == 0;
    const int first = usual ? 8 * static_cast<int>(random() % 8) : static_cast<int>(random() % 60);
    std::string text = "BO_ 7 M: 64 N\n", types;
    std::vector<int> begin;  // of each sample: bits in transmission order
    for (int i = 0; i < samples; ++i) {
      begin.push_back(first + i * length);
      const int bit = little ? begin.back() : begin.back() / 8 * 8 + 7 - begin.back() % 8;
      text += " SG_ S" + std::to_string(i) + " : " + std::to_string(bit) + "|" + std::to_string(length) +
              (little ? "@1" : "@0") + (kind == 1 ? "-" : "+") + " (0.5,-3) [0|0] \"\" N\n";
      if (kind >= 2) types += "SIG_VALTYPE_ 7 S" + std::to_string(i) + " : " + std::to_string(kind - 1) + ";\n";
    }
    CanSettings can;
    can.accelerometers.resize(1);
    can.accelerometers[0].axis[0] = "M.S{0.." + std::to_string(samples - 1) + "}";
    Decoder decoder(parse_dbc(text + types, "cell.dbc"), can, "cell.toml");
    regular += decoder.plan().sensors[0].axis[0].regular ? 1 : 0;

    CanFrame frame;
    frame.id = 7;
    frame.fd = true;
    frame.length = 64;
    for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    Decoded out;
    ASSERT_TRUE(decoder.decode(frame, out));
    for (int i = 0; i < samples; ++i) {
      std::uint64_t raw = 0;
      for (int k = 0; k < length; ++k) {
        const int bit = begin[static_cast<std::size_t>(i)] + k;
        const std::uint8_t byte = frame.data[static_cast<std::size_t>(bit / 8)];
        if (little) {
          raw |= static_cast<std::uint64_t>(byte >> (bit % 8) & 1) << k;
        } else {
          raw = raw << 1 | static_cast<std::uint64_t>(byte >> (7 - bit % 8) & 1);
        }
      }
      double value = static_cast<double>(raw);
      if (kind == 1) {
        const bool negative = (raw >> (length - 1) & 1) != 0;
        value = negative ? -static_cast<double>((~raw & bit_mask(length)) + 1) : value;
        if (negative && length == 64 && raw == 1ULL << 63) value = -0x1p63;
      }
      if (kind == 2) value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
      if (kind == 3) value = std::bit_cast<double>(raw);
      const float wanted = static_cast<float>(value * 0.5 - 3.0);
      const float got = out.block[0].acceleration[0][static_cast<std::size_t>(i)];
      if (std::abs(value * 0.5 - 3.0) < 1e30) {
        ASSERT_EQ(got, wanted) << text;
      } else {
        ASSERT_TRUE(std::isnan(got)) << text;
      }
      if (kind == 1) {  // a signed sample at either end of its range, and no other, has its bit
        const std::uint64_t top = 1ULL << (length - 1);
        if (length <= 52) {
          ASSERT_EQ(out.block[0].full_scale[0] >> i & 1, raw == top || raw == top - 1 ? 1U : 0U) << text;
        }
      }
    }
  }
  EXPECT_GE(regular, 750);
}

}  // namespace
}  // namespace stillcut
