#include "drivers/lcm/messages.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "dsp/numbers.hpp"
#include "tests/drivers/lcm/random_messages.hpp"

namespace stillcut {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Two messages are equal, bit for bit, when they encode to the same bytes; padding in the structs has no say.
template <class T>
void expect_same(const T& a, const T& b) {
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  EXPECT_EQ(encode(a), encode(b));
}

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

// A receiver built from other .lcm files would not understand us: a field renamed, moved or retyped changes these. The
// numbers come from the contract's text through lcm-gen's Python output.
TEST(Messages, KeepTheFingerprintsOfTheContract) {
  const auto fingerprint = [](const MessageBytes& bytes) { return big_endian(std::span(bytes).first(8)); };
  EXPECT_EQ(fingerprint(encode(RobotState{})), 0xFB5F69E97E4E11B1ULL);
  EXPECT_EQ(fingerprint(encode(Correction{})), 0x7E9201F32145B052ULL);
  EXPECT_EQ(fingerprint(encode(CorrectionAck{})), 0x2FEE73E5E3891E5EULL);
  EXPECT_EQ(fingerprint(encode(Event{})), 0x85F9F85B45B5FCA7ULL);
  EXPECT_EQ(fingerprint(encode(Status{})), 0x4D95E8BB0BDB9130ULL);
  EXPECT_EQ(fingerprint(encode(RobotPath{})), 0x74DFAE90E046EA02ULL);
}

TEST(Messages, ComeBackBitForBit) {
  RandomMessages random(1);
  for (int i = 0; i < 500; ++i) {
    const RobotState state = random.state();
    const auto state_back = decode_robot_state(encode(state), state.stamp_ns);
    ASSERT_TRUE(state_back.ok()) << state_back.why_not;
    expect_same(state, state_back.value);

    const RobotPath path = random.path();
    const auto path_back = decode_robot_path(encode(path), path.stamp_ns);
    ASSERT_TRUE(path_back.ok()) << path_back.why_not;
    expect_same(path, path_back.value);

    const CorrectionAck ack = random.ack();
    const auto ack_back = decode_correction_ack(encode(ack, "why"), ack.stamp_ns);
    ASSERT_TRUE(ack_back.ok()) << ack_back.why_not;
    expect_same(ack, ack_back.value);

    const Correction correction = random.correction();
    const auto correction_back = decode_correction(encode(correction));
    ASSERT_TRUE(correction_back.ok()) << correction_back.why_not;
    expect_same(correction, correction_back.value);
    EXPECT_EQ(correction.reason, correction_back.value.reason);

    const Event event = random.event();
    const auto event_back = decode_event(encode(event));
    ASSERT_TRUE(event_back.ok()) << event_back.why_not;
    expect_same(event, event_back.value);
    EXPECT_EQ(event.note, event_back.value.note);

    const Status status = random.status();
    const auto status_back = decode_status(encode(status));
    ASSERT_TRUE(status_back.ok()) << status_back.why_not;
    expect_same(status, status_back.value);
    EXPECT_EQ(status.lobes_stamp_ns, status_back.value.lobes_stamp_ns);
  }
}

TEST(Messages, PutFieldsWhereTheContractHasThem) {
  RobotState state;
  state.stamp_ns = 5'000'007'000;
  state.joint_position[5] = 0.25;
  state.radial_depth = 0.125;
  state.milling = Milling::slot;
  state.block = 77;
  const MessageBytes bytes = encode(state);
  const std::span<const std::uint8_t> all(bytes);
  const auto number_at = [&](std::size_t at) { return std::bit_cast<double>(big_endian(all.subspan(at, 8))); };
  ASSERT_EQ(bytes.size(), 8U + 8 + 18 * 8 + 1 + 4);
  EXPECT_EQ(big_endian(all.subspan(8, 8)), 5'000'007U);
  EXPECT_EQ(number_at(16 + 5 * 8), 0.25);
  EXPECT_EQ(number_at(16 + 17 * 8), 0.125);
  EXPECT_EQ(bytes[16 + 18 * 8], 3);
  EXPECT_EQ(big_endian(all.last(4)), 77U);
}

TEST(Messages, DateTheEndOfACorrection) {
  Correction correction;
  correction.stamp_ns = 2'000'000'000;
  correction.valid_for_ms = 500;
  const MessageBytes bytes = encode(correction);
  // Behind fingerprint, utime, sequence and valid_for_ms.
  EXPECT_EQ(big_endian(std::span<const std::uint8_t>(bytes).subspan(8 + 8 + 8 + 4, 8)), 2'500'000U);
}

TEST(Messages, TakeTheStampOfReceiptForRobotMessages) {
  RobotState state;
  state.stamp_ns = 1'000;
  EXPECT_EQ(decode_robot_state(encode(state), 42'000).value.stamp_ns, 42'000);
  EXPECT_EQ(decode_correction_ack(encode(CorrectionAck{}), 43'000).value.stamp_ns, 43'000);
}

TEST(Messages, NormaliseTheToolOrientation) {
  RobotState state;
  state.tool_orientation = {2, 0, 0, -2};
  const auto decoded = decode_robot_state(encode(state), 0);
  ASSERT_TRUE(decoded.ok());
  EXPECT_NEAR(decoded.value.tool_orientation[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(decoded.value.tool_orientation[3], -std::sqrt(0.5), 1e-15);
}

TEST(Messages, RefuseRobotStatesThatNoMachineSends) {
  const auto why_not = [](auto change) {
    RobotState state;
    change(state);
    const auto decoded = decode_robot_state(encode(state), 0);
    return std::string(decoded.ok() ? "" : decoded.why_not);
  };
  EXPECT_EQ(why_not([](RobotState&) {}), "");
  EXPECT_EQ(why_not([](RobotState& s) { s.axial_depth = s.radial_depth = kNaN; }), "");
  for (const double bad : {kNaN, kInf, -kInf, 1e30}) {
    EXPECT_TRUE(why_not([&](RobotState& s) { s.joint_position[3] = bad; }).starts_with("joint_position_rad"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.tcp_position[1] = bad; }).starts_with("tcp_position_m"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.tool_orientation[2] = bad; }).starts_with("tool_orientation_wxyz"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.feed_direction = bad; }).starts_with("feed_direction_rad"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.feed_rate = bad; }).starts_with("feed_rate_m_per_s"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.spindle_speed_rpm = bad; }).starts_with("spindle_speed_rpm"));
  }
  for (const double bad : {kInf, -0.001, 2.0}) {
    EXPECT_TRUE(why_not([&](RobotState& s) { s.axial_depth = bad; }).starts_with("axial_depth_m"));
    EXPECT_TRUE(why_not([&](RobotState& s) { s.radial_depth = bad; }).starts_with("radial_depth_m"));
  }
  EXPECT_EQ(why_not([](RobotState& s) { s.tool_orientation = {0, 0, 0, 0}; }), "tool_orientation_wxyz has no length");
  EXPECT_TRUE(why_not([](RobotState& s) { s.feed_rate = -0.01; }).starts_with("feed_rate_m_per_s"));
  EXPECT_TRUE(why_not([](RobotState& s) { s.spindle_speed_rpm = -1; }).starts_with("spindle_speed_rpm"));
  EXPECT_TRUE(why_not([](RobotState& s) { s.milling = static_cast<Milling>(4); }).starts_with("milling"));
  EXPECT_TRUE(why_not([](RobotState& s) { s.milling = static_cast<Milling>(-1); }).starts_with("milling"));
}

TEST(Messages, RefuseAcknowledgementsOutOfRange) {
  const auto accepted = [](CorrectionAck ack) { return decode_correction_ack(encode(ack), 0).ok(); };
  EXPECT_TRUE(accepted({0, 0, true, 3000, 1}));
  EXPECT_FALSE(accepted({0, -1, true, 3000, 1}));
  EXPECT_FALSE(accepted({0, 1, true, kNaN, 1}));
  EXPECT_FALSE(accepted({0, 1, true, -1, 1}));
  EXPECT_FALSE(accepted({0, 1, true, 3000, kInf}));
  EXPECT_FALSE(accepted({0, 1, true, 3000, -0.1}));
  MessageBytes bytes = encode(CorrectionAck{});
  bytes[8 + 8 + 8] = 2;  // accepted
  EXPECT_FALSE(decode_correction_ack(bytes, 0).ok());
}

TEST(Messages, TellWhyTheControllerRefusesInWhatCanBePrinted) {
  const auto told = [](std::string_view reason) {
    return std::string{decode_correction_ack(encode(CorrectionAck{}, reason), 0).value.reason.data()};
  };
  EXPECT_EQ(told("EGM path correction carries no speeds"), "EGM path correction carries no speeds");
  EXPECT_EQ(told("two\nlines, \x1b[31m"), "two?lines, ?[31m");
  EXPECT_EQ(told(std::string(500, 'x')), std::string(ShortText{}.size() - 1, 'x'));
}

TEST(Messages, RefuseEnumerationsOutOfRange) {
  constexpr std::size_t kAfterTime = 8 + 8;
  MessageBytes event = encode(Event{});
  event[kAfterTime] = 0;
  EXPECT_FALSE(decode_event(event).ok());
  MessageBytes status = encode(Status{});
  status[kAfterTime] = 8;
  EXPECT_FALSE(decode_status(status).ok());
  MessageBytes correction = encode(Correction{});
  correction[kAfterTime + 8 + 4 + 8] = 3;  // mode
  EXPECT_FALSE(decode_correction(correction).ok());
}

// Returns how many of the decoders accept the bytes.
int accepted_by(std::span<const std::uint8_t> bytes) {
  return int{decode_robot_state(bytes, 0).ok()} + int{decode_robot_path(bytes, 0).ok()} +
         int{decode_correction_ack(bytes, 0).ok()} + int{decode_correction(bytes).ok()} +
         int{decode_event(bytes).ok()} + int{decode_status(bytes).ok()};
}

TEST(Messages, RefuseBytesOfAnotherTypeOrLength) {
  RandomMessages random(2);
  const MessageBytes messages[] = {encode(random.state()),      encode(random.path()),  encode(random.ack(), "late"),
                                   encode(random.correction()), encode(random.event()), encode(random.status())};
  for (const MessageBytes& message : messages) {
    EXPECT_EQ(accepted_by(message), 1);
    for (std::size_t length = 0; length < message.size(); ++length) {
      EXPECT_EQ(accepted_by(std::span(message).first(length)), 0) << length;
    }
    MessageBytes longer = message;
    longer.push_back(0);
    EXPECT_EQ(accepted_by(longer), 0);
    MessageBytes other_type = message;
    other_type[7] ^= 1;
    EXPECT_EQ(accepted_by(other_type), 0);
  }
}

TEST(Messages, RefuseTextsWhoseLengthIsWrong) {
  const MessageBytes good = encode(CorrectionAck{}, "late");
  const std::size_t length_at = good.size() - 5 - 4;
  for (const std::uint32_t length : {0U, 1U, 4U, 6U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    MessageBytes bytes = good;
    for (std::size_t i = 0; i < 4; ++i) bytes[length_at + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
    EXPECT_FALSE(decode_correction_ack(bytes, 0).ok()) << length;
  }
}

TEST(Messages, SurviveAnyDamage) {
  RandomMessages random(3);
  std::mt19937 damage(4);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    MessageBytes bytes[] = {encode(random.state()),      encode(random.path()),  encode(random.ack(), "late"),
                            encode(random.correction()), encode(random.event()), encode(random.status())};
    for (MessageBytes& message : bytes) {
      for (int change = 0; change < 3; ++change) {
        message[damage() % message.size()] = static_cast<std::uint8_t>(damage());
      }
      refused += accepted_by(message) == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Messages, CutATextThatIsTooLong) {
  // A longer note than a ShortText holds, from another sender: built by hand from an event with an empty note.
  const MessageBytes empty_note = encode(Event{});
  MessageBytes bytes(empty_note.begin(), empty_note.end() - 5);
  for (const std::uint8_t byte : {0, 0, 0, 201}) bytes.push_back(byte);
  bytes.insert(bytes.end(), 200, 'n');
  bytes.push_back(0);
  const auto decoded = decode_event(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.why_not;
  EXPECT_EQ(std::string(decoded.value.note.data()), std::string(decoded.value.note.size() - 1, 'n'));
}

}  // namespace
}  // namespace stillcut
