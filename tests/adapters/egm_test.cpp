#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "adapters/egm_controller.hpp"
#include "adapters/egm_packets.hpp"
#include "tests/adapters/adapter_loop.hpp"
#include "tests/adapters/exchange_replay.hpp"

namespace stillcut {
namespace {

// The wire format by hand, from the published field numbers: other code than that which protoc makes of egm.proto.
std::string number_field(int field, unsigned value) {
  return {static_cast<char>(field << 3), static_cast<char>(value)};  // both below 128
}
std::string double_field(int field, double value) {
  std::string bytes(9, static_cast<char>(field << 3 | 1));
  std::memcpy(&bytes[1], &value, 8);
  return bytes;
}
std::string part_field(int field, const std::string& part) {
  return std::string{static_cast<char>(field << 3 | 2), static_cast<char>(part.size())} + part;
}
std::string header(unsigned number, unsigned time_ms, unsigned type) {
  return part_field(1, number_field(1, number) + number_field(2, time_ms) + number_field(3, type));
}
std::string place(double x, double y, double z) { return double_field(1, x) + double_field(2, y) + double_field(3, z); }
std::string robot_packet() {
  std::string joints;
  for (const double joint : {10.0, -90.0, 90.0, 0.0, 45.0, 180.0}) joints += double_field(1, joint);
  const std::string pose =
      part_field(1, place(1620.5, -12.25, 1000.0)) + part_field(2, place(0.0, 1.0, 0.0) + double_field(4, 0.0));
  const std::string time = number_field(1, 100) + number_field(2, 77);
  const std::string feedback = part_field(1, joints) + part_field(2, pose) + part_field(4, time);
  std::string packet = header(17, 99, 2);
  packet +=
      std::string{0x12, static_cast<char>(0x80 | (feedback.size() & 0x7F)), static_cast<char>(feedback.size() >> 7)};
  packet += feedback;
  packet += part_field(3, "") + part_field(4, number_field(1, 1));  // planned, motor state: passed over
  packet += part_field(8, number_field(1, 2)) + number_field(11, 5);
  return packet;
}

SessionSettings egm_session(EgmAnswer answer) { return demo_session(egm_refusals(answer)); }

TEST(Egm, ReadsAPacketWrittenByHand) {
  const ParsedReport parsed = parse_egm(bytes_of(robot_packet()));
  ASSERT_STREQ(parsed.why_not, nullptr);
  const ControllerReport& report = parsed.report;
  EXPECT_EQ(report.counter, 17);
  EXPECT_EQ(report.clock_us, 100'000'077);
  EXPECT_DOUBLE_EQ(report.position[0], 1.6205);
  EXPECT_DOUBLE_EQ(report.position[1], -0.01225);
  EXPECT_DOUBLE_EQ(report.position[2], 1.0);
  EXPECT_EQ(report.orientation, (std::array<double, 4>{0.0, 1.0, 0.0, 0.0}));
  EXPECT_NEAR(report.joints[1], -std::acos(0.0), 1e-12);
  EXPECT_EQ(report.block, 5);
  EXPECT_TRUE(std::isnan(report.spindle_speed_rpm));
  const std::string with_rapid = robot_packet() + part_field(13, double_field(2, 8500.0) + double_field(2, 42.0));
  EXPECT_EQ(parse_egm(bytes_of(with_rapid)).report.spindle_speed_rpm, 8500.0);
  EXPECT_EQ(parse_egm(bytes_of(with_rapid)).report.block, 42);
}

TEST(Egm, WritesTheAnswersThatTheFieldNumbersSay) {
  const Setpoint setpoint{7380.0, -1120.0, 0.875, 0.5e-3, true};
  EXPECT_EQ(build_egm(EgmAnswer::path, setpoint, {3, 99}),
            header(3, 99, 4) + part_field(2, part_field(1, place(0.0, 0.5, 0.0)) + number_field(2, 0)));
  EXPECT_EQ(build_egm(EgmAnswer::data, setpoint, {3, 99}),
            header(3, 99, 3) + part_field(4, number_field(1, 1) + double_field(2, -12.5) + double_field(2, -1120.0)));
}

TEST(Egm, SaysWhatIsWrongWithAPacket) {
  const auto why_not = [](const std::string& packet) {
    const ParsedReport parsed = parse_egm(bytes_of(packet));
    return std::string{parsed.why_not == nullptr ? "good" : parsed.why_not};
  };
  EXPECT_EQ(why_not(""), "not of a size that EGM sends");
  EXPECT_EQ(why_not(std::string(5000, '\0')), "not of a size that EGM sends");
  EXPECT_EQ(why_not("hello"), "no EGM packet of a robot");
  EXPECT_EQ(why_not(part_field(1, number_field(3, 2))), "it has no header with a sequence number");
  EXPECT_EQ(why_not(header(1, 1, 3)), "its header says that it comes from no robot");
  EXPECT_EQ(why_not(header(1, 1, 2)), "it has no feedback");
  EXPECT_EQ(why_not(header(1, 1, 2) + part_field(2, "")), "it tells no position");
  EXPECT_EQ(why_not(header(1, 1, 2) + part_field(2, part_field(2, part_field(1, double_field(1, 1.0))))),
            "no EGM packet of a robot");  // y and z are missing
  EXPECT_EQ(why_not(robot_packet() + part_field(13, double_field(2, std::nan("")))),
            "the spindle speed from RAPID is no number");
}

TEST(EgmLoop, BringsSpeedAndFeedAsDataToTheControllerAndLetsThemLapse) {
  SimulatedController controller{egm_controller_protocol(EgmAnswer::data), {}, 0.004, 1};
  AdapterLoop loop{egm_protocol(EgmAnswer::data), egm_session(EgmAnswer::data), controller};
  loop.run(100);
  const auto answer = loop.say(speed_correction(7380.0, 0.868));
  ASSERT_TRUE(answer && answer->ack.accepted);
  loop.hold(speed_correction(7380.0, 0.868), 500);
  EXPECT_NEAR(controller.program().spindle_speed_rpm(), 7380.0, 1.0);
  EXPECT_NEAR(controller.inputs().feed_override, 0.868, 1e-12);
  EXPECT_NEAR(loop.states.back().feed_rate, 0.025 * 0.868, 1e-9);
  EXPECT_EQ(loop.states.back().spindle_speed_rpm, 8500.0);
  loop.run(1000);
  EXPECT_EQ(controller.inputs().spindle_change_rpm, 0.0);
  EXPECT_EQ(controller.inputs().feed_override, 1.0);
}

TEST(EgmLoop, MovesThePathAsideForAFeedDirectionAndBack) {
  SessionSettings settings = egm_session(EgmAnswer::path);
  settings.follower.max_path_offset = 0.5e-3;
  SimulatedController controller{egm_controller_protocol(EgmAnswer::path), {}, 0.004, 1};
  AdapterLoop loop{egm_protocol(EgmAnswer::path), settings, controller};
  loop.run(100);
  Correction turn = speed_correction(8500.0, 1.0);
  turn.kind = CorrectionKind::feed_direction;
  turn.feed_direction = 0.05;
  EXPECT_TRUE(loop.say(turn)->ack.accepted);
  loop.hold(turn, 50);
  EXPECT_NEAR(loop.states.back().feed_direction, 0.05, 0.002);  // the tool really goes there
  loop.hold(turn, 500);
  EXPECT_NEAR(controller.inputs().path_offset, 0.5e-3, 1e-12);
  loop.run(500);
  EXPECT_EQ(controller.inputs().path_offset, 0.0);
}

TEST(EgmLoop, GivesEveryKindADefinedAnswer) {
  const auto answers = [](EgmAnswer kind) {
    SessionSettings settings = egm_session(kind);
    settings.follower.max_path_offset = 1e-3;
    SimulatedController controller{egm_controller_protocol(kind), {}, 0.004, 1};
    AdapterLoop loop{egm_protocol(kind), settings, controller};
    loop.run(50);
    std::vector<std::string> said;
    for (int i = 0; i < 6; ++i) {
      Correction correction = speed_correction(8000.0, 0.9);
      correction.kind = static_cast<CorrectionKind>(i);
      correction.speed_variation_ratio = 0.01;
      correction.speed_variation_hz = 1.0;
      const auto answer = loop.say(correction);
      said.emplace_back(answer->ack.accepted ? "yes" : answer->reason.data());
    }
    return said;
  };
  EXPECT_EQ(answers(EgmAnswer::data),
            (std::vector<std::string>{"yes", "yes", "yes",
                                      "EGM data: the feed direction stays with the program; use --answer path", "yes",
                                      "yes"}));
  const std::string no_speeds = "EGM path correction carries no speeds; use --answer data";
  EXPECT_EQ(answers(EgmAnswer::path), (std::vector<std::string>{"yes", no_speeds, no_speeds, "yes", no_speeds,
                                                                "EGM path correction cannot stop; use --answer data"}));
}

TEST(EgmLoop, DropsAndCountsBrokenPackets) {
  SimulatedController controller{egm_controller_protocol(EgmAnswer::data), {}, 0.004, 1};
  AdapterLoop loop{egm_protocol(EgmAnswer::data), egm_session(EgmAnswer::data), controller};
  loop.run(10);
  std::mt19937 random{4};
  std::int64_t answered = 0;
  const int packets = 20'000;
  for (int i = 0; i < packets; ++i) {
    std::string packet = mutated(i % 2 == 0 ? robot_packet() : loop.last_packet, random);
    if (i % 10 == 0)
      for (char& c : packet) c = static_cast<char>(random());
    const PacketOutput output = loop.adapter.packet(bytes_of(packet), loop.now_ns += 4'000'000);
    if (!output.answer.empty()) {
      ++answered;
      EXPECT_TRUE(parse_egm_answer(EgmAnswer::data, output.answer));
    }
    if (output.state) {
      EXPECT_TRUE(decode_robot_state(encode(*output.state), 0).ok());
    }
  }
  EXPECT_GT(loop.adapter.bad(), packets / 2);
  EXPECT_EQ(answered + loop.adapter.bad() + loop.adapter.session().counters().old, packets);
  loop.now_ns += 2'000'000'000;
  loop.run(300);
  EXPECT_EQ(controller.inputs().spindle_change_rpm, 0.0);
  EXPECT_EQ(controller.late(), 0);
}

TEST(EgmRecording, GivesTheSameBytesAgain) {
  const auto recorded = read_exchange(TEST_DATA "/adapters/egm.txt");
  SessionSettings settings = egm_session(EgmAnswer::data);
  settings.cycle_ns = 12'000'000;
  PacketAdapter adapter{egm_protocol(EgmAnswer::data), settings};
  EXPECT_EQ(replay(recorded, adapter), outgoing(recorded));
  EXPECT_GE(adapter.session().counters().cycles, 50);
  EXPECT_EQ(adapter.session().follower_counters().lapsed, 1);
  EXPECT_GE(adapter.session().follower_counters().refused, 1);
}

}  // namespace
}  // namespace stillcut
