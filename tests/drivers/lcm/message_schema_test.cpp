#include "drivers/lcm/message_schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

#include "drivers/lcm/recording_messages.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "tests/drivers/lcm/random_messages.hpp"

namespace stillcut {
namespace {

const FieldReading& field(const MessageReading& message, std::string_view name) {
  for (const FieldReading& reading : message.fields)
    if (reading.field->name == name) return reading;
  throw std::out_of_range(std::string(name));
}
double number(const MessageReading& message, std::string_view name, std::size_t at = 0) {
  return std::visit(
      [](const auto& value) -> double {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) return static_cast<double>(value);
        return kNaN;
      },
      field(message, name).values.at(at));
}
// Equal, or both not a number.
void expect_same(double read, double sent) { EXPECT_TRUE(read == sent || (std::isnan(read) && std::isnan(sent))); }

// One message of every type, made by the code that lcm-gen generates: its fingerprints are the oracle.
std::vector<std::pair<std::string, MessageBytes>> one_of_every_type() {
  RandomMessages random{3};
  SpectrumReport spectrum;
  spectrum.levels.assign(300, 7);
  VibrationReport vibration;
  vibration.samples.assign(10, {1.0F, 2.0F, 3.0F});
  DiagramReport diagram;
  diagram.mode_hz = diagram.mode_damping = {1.5F, 2.5F};
  diagram.depth_limit_mm.assign(201, 0.25F);
  HealthReport health;
  health.sensors.resize(3);
  LatencyReport latency;
  latency.stages = {{"wake-up", 5, 1.0, 2.0, 3.0, 4.0}, {"", 0, 0.0, 0.0, 0.0, 0.0}};
  const MessageBytes question = encode(random.state());
  return {{"robot_state_t", encode(random.state())},
          {"robot_path_t", encode(random.path())},
          {"correction_ack_t", encode(random.ack(), "too fast")},
          {"correction_t", encode(random.correction())},
          {"event_t", encode(random.event())},
          {"status_t", encode(random.status())},
          {"monitor_t", encode(MonitorReport{})},
          {"spectrum_t", encode(spectrum)},
          {"vibration_t", encode(vibration)},
          {"diagram_t", encode(diagram)},
          {"health_t", encode(health)},
          {"loop_times_t", encode(latency)},
          {"histogram_t", encode(HistogramReport{})},
          {"lobes_used_t", encode(LobesUsed{}, question)},
          {"silence_t", encode(Silence{})},
          {"timing_t", encode(LoopTiming{})}};
}

TEST(MessageSchema, KnowsEveryTypeByTheFingerprintThatLcmGenGives) {
  std::set<std::string> seen;
  for (const auto& [type, bytes] : one_of_every_type()) {
    const MessageReading message = read_message(bytes);
    ASSERT_NE(message.schema, nullptr) << type;
    EXPECT_EQ(message.schema->name, type);
    EXPECT_EQ(message.why_not, "") << type;
    EXPECT_EQ(message.fields.size(), message.schema->fields.size()) << type;
    seen.insert(type);
  }
  EXPECT_EQ(seen.size(), our_schemas().size()) << "a type is not tried here";
}

TEST(MessageSchema, ReadsWhatWasSent) {
  RandomMessages random{11};
  for (int round = 0; round < 200; ++round) {
    const RobotState state = random.state();
    const MessageReading read = read_message(encode(state));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(number(read, "joint_position_rad", i), state.joint_position[i]);
    expect_same(number(read, "axial_depth_m"), state.axial_depth);
    EXPECT_EQ(number(read, "milling"), static_cast<double>(state.milling));
    EXPECT_EQ(number(read, "block"), state.block);

    const Correction correction = random.correction();
    const MessageReading asked = read_message(encode(correction));
    EXPECT_EQ(number(asked, "sequence"), static_cast<double>(correction.sequence));
    expect_same(number(asked, "predicted_margin_after"), correction.predicted_margin_after);
    EXPECT_EQ(std::get<std::string>(field(asked, "reason").values.front()), text_of(correction.reason));

    const RobotPath path = random.path();
    const MessageReading ahead = read_message(encode(path));
    const FieldReading& joints = field(ahead, "joint_position_rad");
    EXPECT_EQ(joints.sizes, (std::vector<std::size_t>{path.count, 6}));
    for (std::size_t i = 0; i < path.count; ++i)
      EXPECT_EQ(std::get<double>(joints.values.at(6 * i + 5)), path.points[i].joint_position[5]);
  }
}

TEST(MessageSchema, KeepsUnitsAndMeaningsOfTheFiles) {
  const MessageSchema* correction = find_schema(std::string_view{"correction_t"});
  ASSERT_NE(correction, nullptr);
  EXPECT_THAT(correction->comment, ::testing::StartsWith("What the compensator asks of the controller"));
  for (const SchemaField& f : correction->fields) {
    if (f.name == "kind") {
      EXPECT_THAT(f.comment, ::testing::EndsWith("4 feed override, 5 stop request")) << "goes on below";
    }
  }
}

TEST(MessageSchema, EveryChannelHasAType) {
  for (const KnownChannel& channel : known_channels())
    EXPECT_NE(find_schema(std::string_view{channel.type}), nullptr) << channel.name;
  for (const char* name : telemetry_channels())
    EXPECT_TRUE(std::any_of(known_channels().begin(), known_channels().end(), [&](const KnownChannel& c) {
      return c.name == std::string_view{name};
    })) << name;
}

TEST(MessageSchema, SpoiltBytesAreReadAsFarAsTheyGoAndSaidWhy) {
  std::mt19937 random{5};
  for (const auto& [type, bytes] : one_of_every_type()) {
    for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 8)
      EXPECT_NE(read_message(std::span{bytes}.first(length)).why_not, "") << type << ' ' << length;
    MessageBytes longer = bytes;
    longer.push_back(0);
    EXPECT_EQ(read_message(longer).why_not, "1 bytes too many");
    for (int round = 0; round < 300; ++round) {
      MessageBytes spoilt = bytes;
      for (unsigned hits = 1 + random() % 4; hits > 0; --hits)
        spoilt[8 + random() % (spoilt.size() - 8)] = static_cast<std::uint8_t>(random());
      const MessageReading message = read_message(spoilt);
      std::size_t values = 0;
      for (const FieldReading& reading : message.fields) values += reading.values.size();
      EXPECT_LE(values, spoilt.size());
    }
  }
  EXPECT_EQ(read_message(MessageBytes(20, 9)).schema, nullptr);
}

TEST(MessageSchema, RefusesWhatIsNoStructOfPrimitives) {
  EXPECT_EQ(parse_schema("package p;\nstruct a_t {\n int8_t x; // m\n}\n").fields.at(0).comment, "m");
  for (const char* text : {"", "struct a_t {", "package p; struct a_t { int8_t x; }", "struct a_t {\n other_t x;\n}",
                           "struct a_t {\n int8_t x[3;\n}", "enum e_t { A=1 }", "struct a_t {\n const int8_t X=1;\n}"})
    EXPECT_THROW((void)parse_schema(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace stillcut
