#include <gtest/gtest.h>

#include <cmath>

#include "adapters/linuxcnc_adapter.hpp"
#include "adapters/linuxcnc_lines.hpp"
#include "adapters/linuxcnc_server.hpp"
#include "tests/adapters/adapter_loop.hpp"
#include "tests/adapters/exchange_replay.hpp"

namespace stillcut {
namespace {

SessionSettings linuxcnc_session() {
  SessionSettings settings = demo_session(linuxcnc_refusals());
  settings.cycle_ns = 50'000'000;
  return settings;
}

// Adapter and simulated LinuxCNC without a socket: a line takes a millisecond.
class CncLoop {
 public:
  explicit CncLoop(const SimulatedProgramSettings& program = {}) : server{program} {}

  void run(double seconds) {
    for (const std::int64_t end = now_ns + static_cast<std::int64_t>(seconds * 1e9); now_ns < end;) step();
  }
  void step() {
    now_ns += 1'000'000;
    server.step(1e-3);
    std::string text;
    if (!inbox.empty()) {
      text = inbox.front();
      inbox.pop_front();
    }
    const CncOutput output = adapter.line(text, now_ns);
    if (output.state) states.push_back(*output.state);
    if (output.warning != nullptr) warnings.emplace_back(output.warning);
    if (output.hang_up != nullptr) hang_ups.emplace_back(output.hang_up);
    if (output.send.empty()) return;
    sent.push_back(output.send.substr(0, output.send.find('\r')));
    std::string reply = silent ? "" : server.line(sent.back());
    if (!reply.empty()) inbox.push_back(reply.substr(0, reply.find_first_of("\r\n")));
  }
  std::optional<Answer> say(Correction correction) {
    correction.sequence = ++sequence;
    correction.stamp_ns = now_ns;
    return adapter.receive(correction, now_ns);
  }
  std::string refused(const Correction& correction) {
    const auto answer = say(correction);
    return answer->ack.accepted ? "accepted" : answer->reason.data();
  }
  void hold(const Correction& correction, double seconds) {
    for (double t = 0.0; t < seconds; t += 0.1) {
      say(correction);
      run(0.1);
    }
  }
  [[nodiscard]] std::size_t sent_count(const std::string& start) const {
    return static_cast<std::size_t>(
        std::count_if(sent.begin(), sent.end(), [&](const std::string& line) { return line.starts_with(start); }));
  }

  std::int64_t now_ns = 7'000'000'000, sequence = 0;
  LinuxCncServer server;
  LinuxCncAdapter adapter{linuxcnc_session(), {}};
  std::deque<std::string> inbox;
  std::vector<std::string> sent, warnings, hang_ups;
  std::vector<RobotState> states;
  bool silent = false;
};

TEST(LinuxCncLines, KnowsRepliesFromEchoesAndMessages) {
  EXPECT_EQ(reply_to("HELLO EMC stillcut 1.0", "HELLO ACK EMCNETSVR 1.1"), CncReply::done);
  EXPECT_EQ(reply_to("HELLO EMC stillcut 1.0", "HELLO NAK"), CncReply::refused);
  EXPECT_EQ(reply_to("HELLO EMC stillcut 1.0", "HELLO EMC stillcut 1.0"), CncReply::none);  // its echo
  EXPECT_EQ(reply_to("SET ECHO OFF", "SET ECHO OFF"), CncReply::none);
  EXPECT_EQ(reply_to("SET ECHO OFF", "SET ECHO ACK"), CncReply::done);
  EXPECT_EQ(reply_to("SET FEED_OVERRIDE 90", "SET FEED_OVERRIDE NAK"), CncReply::refused);
  EXPECT_EQ(reply_to("SET FEED_OVERRIDE 90", "SET SPINDLE_OVERRIDE ACK"), CncReply::none);
  EXPECT_EQ(reply_to("SET SPINDLE_OVERRIDE 120", "error: invalid: 120 (valid: 0-100)"), CncReply::refused);
  EXPECT_EQ(reply_to("GET FEED_OVERRIDE", "FEED_OVERRIDE 100"), CncReply::done);
  EXPECT_EQ(reply_to("GET FEED_OVERRIDE", "GET FEED_OVERRIDE NAK"), CncReply::refused);
  EXPECT_EQ(reply_to("GET FEED_OVERRIDE", "GET FEED_OVERRIDE"), CncReply::none);
  EXPECT_EQ(reply_to("GET FEED_OVERRIDE", "FEED_OVERRIDE"), CncReply::none);
  EXPECT_EQ(reply_to("GET FEED_OVERRIDE", ""), CncReply::none);
}

TEST(LinuxCncLines, ReadsPlacesAndTheProgrammedSpeed) {
  EXPECT_EQ(cnc_places("REL_ACT_POS 1.5 -2 3 4 5 6 7"), (std::array<double, 6>{1.5, -2, 3, 4, 5, 6}));
  EXPECT_EQ(cnc_places("JOINT_POS 1 2 3"), (std::array<double, 6>{1, 2, 3, 0, 0, 0}));
  EXPECT_EQ(cnc_places("REL_ACT_POS"), std::nullopt);
  EXPECT_EQ(cnc_places("REL_ACT_POS 1 nan 3"), std::nullopt);
  EXPECT_EQ(programmed_speed_rpm("PROGRAM_CODES G1 G61.1 F1500 S8500"), 8500.0);
  EXPECT_EQ(programmed_speed_rpm("PROGRAM_CODES G1 F1500"), std::nullopt);
}

TEST(LinuxCncLoop, BringsOverridesToTheControllerAndTheOperatorsOwnBack) {
  CncLoop loop;
  loop.server.set_feed_override(80);  // the operator's
  loop.run(0.5);
  EXPECT_NEAR(loop.states.back().feed_rate, 0.020, 1e-4);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)), "accepted");
  loop.hold(speed_correction(7395.0, 0.87), 2.0);
  EXPECT_EQ(loop.server.spindle_percent(), 87);
  EXPECT_EQ(loop.server.feed_percent(), 70);  // 0.87 of 80
  EXPECT_NEAR(loop.server.program().spindle_speed_rpm(), 7395.0, 10.0);
  EXPECT_EQ(loop.states.back().spindle_speed_rpm, 8500.0);
  loop.run(5.0);
  EXPECT_EQ(loop.server.spindle_percent(), 100);
  EXPECT_EQ(loop.server.feed_percent(), 80);
  EXPECT_EQ(loop.warnings, std::vector<std::string>{});
}

TEST(LinuxCncLoop, SetsNothingWithoutACorrection) {
  CncLoop loop;
  loop.run(1.0);
  loop.server.set_feed_override(50);
  loop.server.set_spindle_override(110);
  loop.run(1.0);
  EXPECT_EQ(loop.sent_count("SET FEED_OVERRIDE"), 0U);
  EXPECT_EQ(loop.sent_count("SET SPINDLE_OVERRIDE"), 0U);
  EXPECT_EQ(loop.server.feed_percent(), 50);
  EXPECT_DOUBLE_EQ(loop.states.back().spindle_speed_rpm, 8500.0 * 1.1);  // what the operator made of the program
  EXPECT_EQ(loop.sent_count("HELLO"), 1U);
}

TEST(LinuxCncLoop, LeavesAnOverrideThatTheOperatorMovesAlone) {
  CncLoop loop;
  loop.run(0.5);
  loop.hold(speed_correction(7395.0, 0.87), 2.0);
  loop.server.set_feed_override(40);
  loop.run(0.2);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)),
            "the operator, or a limit of LinuxCNC, has changed an override");
  EXPECT_EQ(loop.warnings.size(), 1U);
  loop.run(5.0);
  EXPECT_EQ(loop.server.feed_percent(), 40);
  EXPECT_EQ(loop.server.spindle_percent(), 100);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)), "accepted");  // from there, anew
}

TEST(LinuxCncLoop, PausesOnAStopRequestAndWaitsForAPerson) {
  CncLoop loop;
  loop.run(0.5);
  Correction stop = speed_correction(0.0, 1.0);
  stop.kind = CorrectionKind::stop_request;
  EXPECT_EQ(loop.refused(stop), "accepted");
  loop.run(2.0);
  EXPECT_TRUE(loop.server.program().stopped());
  EXPECT_EQ(loop.sent_count("SET PAUSE"), 1U);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)), "stopped; start the program again at the controller");
  loop.server.resume();
  loop.run(5.0);
  EXPECT_FALSE(loop.server.program().stopped());
  EXPECT_EQ(loop.sent_count("SET PAUSE"), 1U);
  EXPECT_EQ(loop.server.feed_percent(), 100);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)), "accepted");
}

TEST(LinuxCncLoop, RefusesWhileTheProgramDoesNotRun) {
  CncLoop loop;
  loop.run(0.5);
  (void)loop.server.line("SET PAUSE");  // the operator
  loop.run(0.5);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)), "the program does not run");
}

TEST(LinuxCncLoop, SaysThatTheMachineTakesNoOverridesAndTriesUntilTheOwnIsBack) {
  CncLoop loop;
  loop.run(0.5);
  loop.hold(speed_correction(7395.0, 0.87), 2.0);
  loop.server.switch_machine(false);
  loop.run(0.6);  // it lapses, and the way back is refused
  loop.run(0.5);
  EXPECT_EQ(loop.refused(speed_correction(7395.0, 0.87)),
            "LinuxCNC does not take overrides; is the machine on, and no other client enabled?");
  EXPECT_LT(loop.server.feed_percent(), 90);
  loop.server.switch_machine(true);
  loop.run(5.0);
  EXPECT_EQ(loop.server.feed_percent(), 100);
  EXPECT_EQ(loop.server.spindle_percent(), 100);
}

TEST(LinuxCncLoop, GivesTheOverridesBackAtItsEnd) {
  CncLoop loop;
  loop.server.set_feed_override(90);
  loop.run(0.5);
  EXPECT_EQ(loop.adapter.farewell(), "");
  loop.hold(speed_correction(7395.0, 0.87), 2.0);
  EXPECT_EQ(loop.adapter.farewell(), "SET FEED_OVERRIDE 90\r\nSET SPINDLE_OVERRIDE 100\r\n");
}

TEST(LinuxCncLoop, FindsItsOwnOverrideAgainAfterABrokenConnection) {
  CncLoop loop;
  loop.run(0.5);
  loop.hold(speed_correction(7395.0, 0.87), 2.0);
  loop.inbox.clear();
  loop.server.disconnected();
  loop.adapter.disconnected();
  loop.now_ns += 3'000'000'000;
  loop.run(6.0);
  EXPECT_EQ(loop.sent_count("HELLO"), 2U);
  EXPECT_EQ(loop.server.feed_percent(), 100);
  EXPECT_EQ(loop.server.spindle_percent(), 100);
}

TEST(LinuxCncLoop, HangsUpOnWrongPasswordsAndSilence) {
  CncLoop loop;
  loop.adapter = LinuxCncAdapter{linuxcnc_session(), {.connect_password = "wrong", .enable_password = "EMCTOO"}};
  loop.run(0.01);
  EXPECT_EQ(loop.hang_ups.at(0), "LinuxCNC refuses the connection password");
  loop.adapter = LinuxCncAdapter{linuxcnc_session(), {.connect_password = "EMC", .enable_password = "wrong"}};
  loop.run(0.01);
  EXPECT_EQ(loop.hang_ups.at(1), "LinuxCNC refuses to be controlled; check the enable password");
  loop.adapter = LinuxCncAdapter{linuxcnc_session(), {}};
  loop.run(0.5);
  loop.silent = true;
  loop.run(1.5);
  EXPECT_EQ(loop.hang_ups.at(2), "LinuxCNC does not answer");
}

TEST(LinuxCncLoop, GivesEveryKindADefinedAnswer) {
  std::vector<std::string> said;
  for (int kind = 0; kind < 6; ++kind) {
    CncLoop loop;
    loop.run(0.5);
    Correction correction = speed_correction(8000.0, 0.9);
    correction.kind = static_cast<CorrectionKind>(kind);
    correction.speed_variation_ratio = 0.01;
    correction.speed_variation_hz = 1.0;
    said.push_back(loop.refused(correction));
  }
  EXPECT_EQ(said,
            (std::vector<std::string>{"accepted", "accepted", "accepted",
                                      "LinuxCNC: the feed direction stays with the program", "accepted", "accepted"}));
}

TEST(LinuxCncLoop, SurvivesBrokenReplies) {
  std::mt19937 random{9};
  CncLoop loop;
  loop.run(0.3);
  for (int i = 0; i < 500'000; ++i) {
    loop.step();
    if (!loop.inbox.empty() && i % 7 == 0) {
      std::string& reply = loop.inbox.front();
      const auto values = std::min(reply.find(' '), reply.size());  // what they belong to stays, mostly
      reply =
          i % 5 == 0 ? mutated(reply, random) : reply.substr(0, values) + " " + mutated(reply.substr(values), random);
    }
    if (i % 50 == 0) loop.inbox.push_front(mutated("FEED_OVERRIDE 100", random));
    if (!loop.hang_ups.empty()) {  // a reply that was lost: the connection is made anew
      loop.hang_ups.clear();
      loop.inbox.clear();
      loop.adapter.disconnected();
    }
    if (i % 100 == 0) loop.say(speed_correction(7395.0, 0.87));
  }
  for (const RobotState& state : loop.states) ASSERT_TRUE(decode_robot_state(encode(state), 0).ok());
  EXPECT_GT(loop.adapter.bad(), 100);
  loop.inbox.clear();
  loop.adapter.disconnected();
  const auto before = loop.states.size();
  loop.run(10.0);
  EXPECT_GT(loop.states.size(), before + 100);
}

TEST(LinuxCncRecording, GivesTheSameBytesAgain) {
  const auto recorded = read_exchange(TEST_DATA "/adapters/linuxcnc.txt");
  LinuxCncAdapter adapter{linuxcnc_session(), {}};
  std::vector<ExchangeEntry> out;
  for (const ExchangeEntry& entry : recorded) {
    if (entry.kind == ExchangeKind::correction)
      put_ack(out, entry.time_ns, adapter.receive(decode_correction(bytes_of(entry.bytes)).value, entry.time_ns));
    if (entry.kind != ExchangeKind::packet) continue;
    const CncOutput output = adapter.line(entry.bytes, entry.time_ns);
    if (!output.send.empty()) out.push_back({entry.time_ns, ExchangeKind::answer, output.send});
    put_state(out, entry.time_ns, output.state);
  }
  EXPECT_EQ(out, outgoing(recorded));
  EXPECT_GE(adapter.session().counters().cycles, 20);
  EXPECT_EQ(adapter.session().follower_counters().lapsed, 1);
  EXPECT_GE(adapter.session().follower_counters().refused, 1);
}

}  // namespace
}  // namespace stillcut
