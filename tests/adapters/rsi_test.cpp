#include <gtest/gtest.h>

#include <cmath>

#include "adapters/rsi_controller.hpp"
#include "adapters/rsi_xml.hpp"
#include "tests/adapters/adapter_loop.hpp"
#include "tests/adapters/exchange_replay.hpp"

namespace stillcut {
namespace {

// As a controller with more in its configuration than we ask for sends it.
constexpr const char* kPacket =
    R"(<Rob Type="KUKA"><RIst X="1620.5" Y="-12.25" Z="1000.0" A="90.0" B="0.0" C="180.0"/>)"
    R"(<RSol X="1620.5" Y="-12.25" Z="1000.0" A="90.0" B="0.0" C="180.0"/>)"
    R"(<AIPos A1="10.0" A2="-90.0" A3="90.0" A4="0.0" A5="45.0" A6="180.0"/>)"
    R"(<ELPos E1="0.0" E2="0.0"/><Delay D="3"/><Stillcut Speed="8500.0" Block="42"/><IPOC>4208163634</IPOC></Rob>)";

PacketProtocol rsi_protocol() {
  return {parse_rsi, [](const ControllerReport& report, const Setpoint& setpoint, const AnswerHead&) {
            return build_rsi(report.counter, setpoint);
          }};
}

SessionSettings rsi_session() {
  SessionSettings settings = demo_session(rsi_refusals());
  settings.counter_step = 4;
  return settings;
}

std::string why_not(std::string packet) {
  const ParsedReport parsed = parse_rsi(bytes_of(packet));
  return parsed.why_not == nullptr ? "good" : parsed.why_not;
}

std::string with(const std::string& from, const std::string& to) {
  std::string packet = kPacket;
  packet.replace(packet.find(from), from.size(), to);
  return packet;
}

TEST(Rsi, ReadsPoseJointsProgramAndStamp) {
  const ParsedReport parsed = parse_rsi(bytes_of(kPacket));
  ASSERT_EQ(parsed.why_not, nullptr);
  const ControllerReport& report = parsed.report;
  EXPECT_EQ(report.counter, 4208163634);
  EXPECT_EQ(report.clock_us, 4208163634000);
  EXPECT_DOUBLE_EQ(report.position[0], 1.6205);
  EXPECT_DOUBLE_EQ(report.position[1], -0.01225);
  EXPECT_DOUBLE_EQ(report.position[2], 1.0);
  EXPECT_NEAR(report.joints[1], -std::acos(0.0), 1e-12);
  EXPECT_NEAR(report.joints[5], 2.0 * std::acos(0.0), 1e-12);
  EXPECT_EQ(report.spindle_speed_rpm, 8500.0);
  EXPECT_EQ(report.block, 42);
  EXPECT_EQ(report.late_answers, 3);
  // About z by 90 degrees, then about the new x by 180: the tool's y axis, (0, 1, 0), shows along the base's x.
  const auto& q = report.orientation;
  EXPECT_NEAR(2.0 * (q[1] * q[2] - q[0] * q[3]), 1.0, 1e-12);
  EXPECT_EQ(reason_to_doubt(report), nullptr);
}

TEST(Rsi, NeedsNeitherJointsNorOurOwnTags) {
  const ParsedReport parsed =
      parse_rsi(bytes_of(R"(<Rob Type="KUKA"><RIst X="0" Y="0" Z="0" A="0" B="0" C="0"/><IPOC>7</IPOC></Rob>)"));
  ASSERT_EQ(parsed.why_not, nullptr);
  EXPECT_TRUE(std::isnan(parsed.report.spindle_speed_rpm));
  EXPECT_EQ(parsed.report.block, 0);
}

TEST(Rsi, SaysWhatIsWrongWithAPacket) {
  EXPECT_EQ(why_not(kPacket), "good");
  EXPECT_EQ(why_not(""), "not of a size that RSI sends");
  EXPECT_EQ(why_not(std::string(5000, ' ')), "not of a size that RSI sends");
  EXPECT_EQ(why_not("hello"), "not XML");
  EXPECT_EQ(why_not("<Sen><IPOC>1</IPOC></Sen>"), "its root is not Rob");
  EXPECT_EQ(why_not(with("<IPOC>4208163634</IPOC>", "")), "IPOC is missing, or no whole number");
  EXPECT_EQ(why_not(with("4208163634", "42x")), "IPOC is missing, or no whole number");
  EXPECT_EQ(why_not(with("4208163634", "-4")), "IPOC is missing, or no whole number");
  EXPECT_EQ(why_not(with("4208163634", "9000000000001")), "IPOC is missing, or no whole number");
  EXPECT_EQ(why_not(with("RIst", "Rist")), "RIst is missing; send it in the RSI configuration");
  EXPECT_EQ(why_not(with("\"1620.5\"", "\"nan\"")), "RIst does not hold six numbers X, Y, Z, A, B, C");
  EXPECT_EQ(why_not(with("\"1620.5\"", "\"1620.5mm\"")), "RIst does not hold six numbers X, Y, Z, A, B, C");
  EXPECT_EQ(why_not(with("A6=\"180.0\"", "")), "AIPos does not hold six numbers A1 to A6");
  EXPECT_EQ(why_not(with("\"8500.0\"", "\"fast\"")), "Stillcut.Speed is no number");
  EXPECT_EQ(why_not(with("\"42\"", "\"4.2\"")), "Stillcut.Block is no whole number");
}

TEST(Rsi, AsksForNothingWithZeros) {
  EXPECT_EQ(build_rsi(123, {8500.0, 0.0, 1.0, 0.0, false}),
            R"(<Sen Type="Stillcut"><RKorr X="0.0" Y="0.0" Z="0.0" A="0.0" B="0.0" C="0.0"/>)"
            R"(<Stillcut Feed="0.00" Speed="0.0" Stop="0"/><IPOC>123</IPOC></Sen>)");
  const auto request = parse_rsi_answer(build_rsi(123, {7380.0, -1120.0, 0.868, 0.0, true}));
  ASSERT_TRUE(request);
  EXPECT_DOUBLE_EQ(request->feed_percent, -13.2);
  EXPECT_DOUBLE_EQ(request->spindle_rpm, -1120.0);
  EXPECT_TRUE(request->stop);
  EXPECT_EQ(request->ipoc, 123);
}

TEST(RsiLoop, BringsACorrectionToTheControllerAndLetsItLapse) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(100);
  const auto answer = loop.say(speed_correction(7380.0, 0.868));
  ASSERT_TRUE(answer && answer->ack.accepted);
  loop.hold(speed_correction(7380.0, 0.868), 500);
  EXPECT_NEAR(controller.program().spindle_speed_rpm(), 7380.0, 1.0);
  EXPECT_NEAR(controller.inputs().feed_override, 0.868, 1e-9);
  EXPECT_NEAR(loop.states.back().feed_rate, 0.025 * 0.868, 1e-5);
  EXPECT_EQ(loop.states.back().spindle_speed_rpm, 8500.0);  // as programmed
  EXPECT_TRUE(std::isnan(loop.states.back().axial_depth));
  loop.run(1000);
  EXPECT_EQ(controller.inputs().spindle_change_rpm, 0.0);
  EXPECT_EQ(controller.inputs().feed_override, 1.0);
  EXPECT_EQ(controller.late(), 0);
}

TEST(RsiLoop, RefusesWhileTheControllerIsSilent) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  EXPECT_STREQ(loop.say(speed_correction(7380.0, 0.868))->reason.data(), "the controller is silent");
  loop.run(10);
  EXPECT_TRUE(loop.say(speed_correction(7380.0, 0.868))->ack.accepted);
  loop.now_ns += 1'100'000'000;
  EXPECT_STREQ(loop.say(speed_correction(7380.0, 0.868))->reason.data(), "the controller is silent");
}

TEST(RsiLoop, EndsWithTheProgramsSetting) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(10);
  loop.hold(speed_correction(7380.0, 0.868), 300);
  loop.adapter.end();
  EXPECT_STREQ(loop.say(speed_correction(7380.0, 0.868))->reason.data(), "the adapter ends");
  loop.run(1);
  EXPECT_LT(controller.inputs().spindle_change_rpm, -1000.0);  // not at one blow
  loop.run(1000);
  EXPECT_EQ(controller.inputs().spindle_change_rpm, 0.0);
  EXPECT_EQ(controller.inputs().feed_override, 1.0);
}

TEST(RsiLoop, TellsFeedDirectionRateAndBlockAsTheToolMoves) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(1000);  // 4 s: half of the first lane
  EXPECT_NEAR(loop.states.back().feed_rate, 0.025, 1e-6);
  EXPECT_NEAR(loop.states.back().feed_direction, 0.0, 1e-9);
  EXPECT_EQ(loop.states.back().block, 1);
  loop.run(1500);  // on the way back
  EXPECT_NEAR(std::abs(loop.states.back().feed_direction), std::acos(-1.0), 1e-9);
  EXPECT_EQ(loop.states.back().block, 2);
}

TEST(RsiLoop, RefusesTheFeedDirectionInPlainWords) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(10);
  Correction turn = speed_correction(8500.0, 1.0);
  turn.kind = CorrectionKind::feed_direction;
  const auto answer = loop.say(turn);
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->ack.accepted);
  EXPECT_STREQ(answer->reason.data(), "RSI: the feed direction stays with the program");
}

TEST(RsiLoop, StopsTheProgramAndLeavesTheRestartToAPerson) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(10);
  Correction stop = speed_correction(0.0, 1.0);
  stop.kind = CorrectionKind::stop_request;
  EXPECT_TRUE(loop.say(stop)->ack.accepted);
  loop.run(500);
  EXPECT_TRUE(controller.program().stopped());
  EXPECT_EQ(loop.states.back().feed_rate, 0.0);
  SimulatedController started_again{rsi_controller_protocol(), {}, 0.004, 4};  // its IPOC starts from nothing
  AdapterLoop again{rsi_protocol(), rsi_session(), started_again};
  again.adapter = loop.adapter;
  again.now_ns = loop.now_ns + 5'000'000'000;
  again.run(10);
  EXPECT_FALSE(started_again.program().stopped());
  EXPECT_EQ(again.adapter.session().counters().sessions, 2);
}

TEST(RsiLoop, CountsWhatIsLostAndDoesNotAnswerWhatIsOld) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(10);
  const std::string before = loop.last_packet;
  controller.cycle();  // three packets get lost on their way
  controller.cycle();
  controller.cycle();
  loop.run(1);
  EXPECT_EQ(loop.adapter.session().counters().lost, 3);
  EXPECT_EQ(loop.adapter.late_answers(), 3);  // as the controller tells
  EXPECT_EQ(loop.adapter.packet(bytes_of(before), loop.now_ns).answer, "");
  EXPECT_EQ(loop.adapter.packet(bytes_of(loop.last_packet), loop.now_ns).answer, "");
  EXPECT_EQ(loop.adapter.session().counters().old, 2);
}

TEST(RsiLoop, DropsAndCountsBrokenPackets) {
  SimulatedController controller{rsi_controller_protocol(), {}, 0.004, 4};
  AdapterLoop loop{rsi_protocol(), rsi_session(), controller};
  loop.run(10);
  std::mt19937 random{3};
  std::int64_t answered = 0;
  const int packets = 20'000;
  for (int i = 0; i < packets; ++i) {
    std::string packet = mutated(i % 2 == 0 ? kPacket : loop.last_packet, random);
    if (i % 10 == 0)
      for (char& c : packet) c = static_cast<char>(random());
    const PacketOutput output = loop.adapter.packet(bytes_of(packet), loop.now_ns += 4'000'000);
    if (!output.answer.empty()) {
      ++answered;
      EXPECT_TRUE(parse_rsi_answer(output.answer)) << output.answer;
    }
    if (output.state) {
      EXPECT_TRUE(decode_robot_state(encode(*output.state), 0).ok());
    }
  }
  EXPECT_GT(loop.adapter.bad(), packets / 2);
  EXPECT_EQ(answered + loop.adapter.bad() + loop.adapter.session().counters().old, packets);
  loop.now_ns += 2'000'000'000;
  loop.run(300);  // and then the controller is there again
  EXPECT_EQ(controller.inputs().spindle_change_rpm, 0.0);
  EXPECT_EQ(controller.late(), 0);
}

TEST(RsiRecording, GivesTheSameBytesAgain) {
  const auto recorded = read_exchange(TEST_DATA "/adapters/rsi.txt");
  SessionSettings settings = rsi_session();
  settings.counter_step = 12;
  settings.cycle_ns = 12'000'000;
  PacketAdapter adapter{rsi_protocol(), settings};
  EXPECT_EQ(replay(recorded, adapter), outgoing(recorded));
  EXPECT_GE(adapter.session().counters().cycles, 50);
  EXPECT_EQ(adapter.session().follower_counters().lapsed, 1);
  EXPECT_GE(adapter.session().follower_counters().refused, 1);
}

}  // namespace
}  // namespace stillcut
