// Bad input, as a user meets it: one line that names file, line and key and says what to do, and the exit code of
// docs/replay.md. Runs the real programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kShortCut = "0:3";

struct Refusal {
  const char* name;
  std::function<void(const DemoCell&)> spoil;
  std::vector<std::string> arguments;
  int exit_code;
  std::string line_starts, line_names;  // the message's beginning, and what it must name
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.name; }

const std::vector<std::string> kReplay{"stillcut", "replay", "cell.toml", "--can", "cut.log"};
const std::vector<std::string> kDaemon{"stillcutd", "cell.toml"};

std::vector<std::string> with(std::vector<std::string> arguments, std::initializer_list<std::string> more) {
  arguments.insert(arguments.end(), more);
  return arguments;
}

std::function<void(const DemoCell&)> change(std::string from, std::string to, std::string file = "cell.toml") {
  return [=](const DemoCell& cell) { cell.change(from, to, file); };
}
std::function<void(const DemoCell&)> put(std::string file, std::string text) {
  return [=](const DemoCell& cell) { (void)cell.write(file, text); };
}
void nothing(const DemoCell& /*cell*/) {}

class BadInput : public ::testing::TestWithParam<Refusal> {};

TEST_P(BadInput, IsRefusedWithOneLineThatNamesIt) {
  const Refusal& refusal = GetParam();
  const DemoCell cell;
  cell.simulate("0.05", kShortCut);
  refusal.spoil(cell);
  const Finished done = run(refusal.arguments, cell.path());
  EXPECT_EQ(done.exit_code, refusal.exit_code) << done.err;
  EXPECT_EQ(done.out, "");
  // LCM's own library may have its say first.
  std::string line = done.err.substr(0, done.err.size() - 1);
  line = line.substr(line.rfind('\n') + 1);
  const std::string program = refusal.arguments[0] + ": ";
  EXPECT_THAT(line, StartsWith(program + refusal.line_starts));
  EXPECT_THAT(line, HasSubstr(refusal.line_names));
  EXPECT_EQ(done.err.find(program), done.err.rfind(program)) << "more than one line: " << done.err;
}

INSTANTIATE_TEST_SUITE_P(
    Cell, BadInput,
    ::testing::Values(
        Refusal{
            "missing", nothing, {"stillcut", "replay", "no.toml", "--can", "cut.log"}, 3, "no.toml: ", "no such file"},
        Refusal{"folder", nothing, {"stillcut", "replay", "map", "--can", "cut.log"}, 3, "map: ", "folder"},
        Refusal{"not_toml", put("cell.toml", "[tool\n"), kReplay, 3, "cell.toml:1: ", "]"},
        Refusal{"unknown_key", change("shape", "shap"), kReplay, 3, "cell.toml:4: tool.shap: ", "did you mean shape"},
        Refusal{"wrong_type", change("teeth = 2", "teeth = \"two\""), kReplay, 3, "cell.toml:6: tool.teeth: ", ""},
        Refusal{"out_of_range", change("teeth = 2", "teeth = 0"), kReplay, 3, "cell.toml:6: tool.teeth: ", ""},
        Refusal{"no_section", change("[spindle]", "[region]"), kReplay, 3, "cell.toml:", ""},
        Refusal{"rate_too_low", change("sample_rate_hz = 25600", "sample_rate_hz = 100"), kReplay, 3,
                "cell.toml:40: can.accelerometer.sample_rate_hz: ", "500"},
        Refusal{"unknown_bus", change("socketcan:can0", "canx:0"), kDaemon, 3, "cell.toml:38: can.bus: ", "canx:0"},
        Refusal{"unknown_posture", change("\"home\"", "\"away\""), kReplay, 3, "cell.toml: dynamics.posture: ", "away"},
        Refusal{"no_posture", change("posture = \"home\"", ""), kReplay, 3,
                "cell.toml: dynamics.posture: ", "missing"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Map, BadInput,
    ::testing::Values(Refusal{"missing", change("map = \"map\"", "map = \"none\""), kReplay, 3,
                              "cell.toml:32: dynamics.map: ", "none"},
                      Refusal{"header", change("stiffness_n_per_m", "stiff", "map/modes.csv"), kReplay, 3, "",
                              "map/modes.csv:1: "},
                      Refusal{"not_a_number",
                              put("map/modes.csv",
                                  "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                                  "home,1,abc,0.03,1e7,1,0,0\n"),
                              kReplay, 3, "", "map/modes.csv:2: "},
                      Refusal{"empty", put("map/postures.csv", ""), kReplay, 3, "", "map/postures.csv"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(Dbc, BadInput,
                         ::testing::Values(Refusal{"missing", change("cell.dbc", "none.dbc"), kReplay, 3,
                                                   "cell.toml:39: can.dbc: ", "none.dbc"},
                                           Refusal{"malformed", change("BO_ 288", "BO_ x", "cell.dbc"), kReplay, 3, "",
                                                   "cell.dbc:9: "},
                                           Refusal{"no_such_signal", change("Spindle.Speed", "Spindle.Sped"), kReplay,
                                                   3, "cell.toml:", "'Sped'; there is Speed"},
                                           Refusal{"no_such_message", change("Spindle.Speed", "Drive.Speed"), kReplay,
                                                   3, "cell.toml:", "Drive"},
                                           Refusal{"no_such_samples", change("Vibration.X{0..9}", "Vibration.X{0..19}"),
                                                   kReplay, 3, "cell.toml:40: can.accelerometer.x: ", "X10"}),
                         [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Logs, BadInput,
    ::testing::Values(
        Refusal{"missing", nothing, {"stillcut", "replay", "cell.toml", "--can", "no.log"}, 3, "no.log: ", ""},
        Refusal{"folder", nothing, {"stillcut", "replay", "cell.toml", "--can", "map"}, 3, "map: ", ""},
        Refusal{"empty", put("cut.log", ""), kReplay, 3, "cut.log: ", "candump -L"},
        Refusal{"no_log", put("cut.log", "this is\nno log\n"), kReplay, 3, "cut.log: ", "candump -L"},
        Refusal{"lcm_missing", nothing, with(kReplay, {"--lcm", "no.lcm"}), 3, "no.lcm: ", ""},
        Refusal{"lcm_no_log", nothing, with(kReplay, {"--lcm", "cell.toml"}), 3, "cell.toml: ", "lcm-logger"},
        Refusal{"bus_log_missing", change("socketcan:can0", "log:no.log"), kDaemon, 3,
                "cell.toml:38: can.bus: ", "no.log"},
        Refusal{"events_folder", nothing, with(kReplay, {"--events", "none/e.csv", "--json"}), 3,
                "none/e.csv: ", "written"},
        Refusal{"events_disk_full", nothing, with(kReplay, {"--events", "/dev/full", "--json"}), 3,
                "/dev/full: ", "full"},
        Refusal{"picture_kind", nothing, with(kReplay, {"--plot", "p.txt", "--json"}), 3, "p.txt: ", ".svg"}),
    [](const auto& test) { return std::string(test.param.name); });

const std::string kScenario = "cell = \"cell.toml\"\nduration_s = 1\n";
const std::vector<std::string> kHil{"stillcut", "hil", "cell.toml", "--scenario", "run.toml", "--data-time", "--json"};
const std::vector<std::string> kPlant{"stillcut", "plant", "cell.toml", "--scenario", "run.toml", "--json"};

std::function<void(const DemoCell&)> scenario(std::string more) {
  return [=](const DemoCell& cell) { (void)cell.write("run.toml", kScenario + more); };
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, BadInput,
    ::testing::Values(Refusal{"missing", nothing, kHil, 3, "run.toml: ", "no such file"},
                      Refusal{"unknown_key", scenario("[program]\ndepth_mm = [[0, 1]]\n"), kHil, 3,
                              "run.toml:4: program.depth_mm: ", ""},
                      Refusal{"after_the_end", scenario("[program]\naxial_depth_mm = [[0, 1], [2, 3]]\n"), kHil, 3,
                              "run.toml:4: program.axial_depth_mm: ", "after the end"},
                      Refusal{"unknown_posture", scenario("[program]\nposture = \"away\"\n"), kPlant, 3,
                              "run.toml:4: program.posture: ", "away"},
                      Refusal{"no_number_from_integers", scenario("[[sensor_fault]]\nstart_s = 0\nkind = \"nan\"\n"),
                              kHil, 3, "run.toml:3: sensor_fault.kind: ", "whole numbers"},
                      Refusal{"bus_missing", scenario(""), kPlant, 4, "", "can0"},
                      Refusal{"bus_is_a_log",
                              [](const DemoCell& cell) {
                                scenario("")(cell);
                                cell.change("socketcan:can0", "log:cut.log");
                              },
                              kPlant, 3, "cell.toml:37: can.bus: ", "log"},
                      Refusal{"live_without_time", scenario(""), with(kHil, {"--live"}), 2, "", "--live"},
                      Refusal{"compared_in_shadow", scenario(""), with(kHil, {"--compare", "--shadow"}), 2, "",
                              "--compare"},
                      Refusal{"two_for_stdout", scenario(""), with(kHil, {"--events", "-"}), 2, "", "--events"},
                      Refusal{"picture_kind", scenario(""), with(kHil, {"--plot", "p.txt"}), 3, "p.txt: ", ".svg"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Usage, BadInput,
    ::testing::Values(Refusal{"unknown_option", nothing, with(kReplay, {"--nonsense"}), 2, "", "--nonsense"},
                      Refusal{"daemon_unknown_option", nothing, with(kDaemon, {"--nonsense"}), 2, "", "--nonsense"},
                      Refusal{"no_can", nothing, {"stillcut", "replay", "cell.toml"}, 2, "", "--can"},
                      Refusal{"no_command", nothing, {"stillcut"}, 2, "", "subcommand"},
                      Refusal{"no_number", nothing, with(kReplay, {"--lcm-offset", "soon"}), 2, "", "--lcm-offset"},
                      Refusal{"two_for_stdout", nothing, with(kReplay, {"--json", "--events", "-"}), 2, "", "--events"},
                      Refusal{"priority", nothing, with(kDaemon, {"--priority", "200"}), 2, "", "--priority"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Components, BadInput,
    ::testing::Values(
        Refusal{"interface", change("socketcan:can0", "socketcan:nocan99"), kDaemon, 4, "socketcan:nocan99: ", ""},
        Refusal{"lcm_address", nothing, with(kReplay, {"--publish", "udpm://nonsense"}), 4, "", "udpm://nonsense"},
        Refusal{"lcm_kind", nothing, with(kReplay, {"--publish", "post://x"}), 4, "", "post://x"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Replay, JsonIsOneObjectWithThePinnedKeysAndNothingElse) {
  const DemoCell cell;
  cell.simulate("0.2", kShortCut);
  const Finished done = run(with(kReplay, {"--json"}), cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(std::count(done.out.begin(), done.out.end(), '\n'), 1);
  const nlohmann::json summary = nlohmann::json::parse(done.out);
  for (const char* key :
       {"signal_s", "wall_s", "frames", "frames_lost", "frames_bad", "chatter_onsets", "corrections"}) {
    ASSERT_TRUE(summary.contains(key)) << key;
    EXPECT_TRUE(summary[key].is_number()) << key;
  }
  const std::string log = content_of(cell.path() / "cut.log");
  EXPECT_EQ(summary["frames"], std::count(log.begin(), log.end(), '\n'));
  EXPECT_NEAR(summary["signal_s"], 0.2, 0.01);
  EXPECT_EQ(summary["frames_lost"], 0);
  EXPECT_EQ(summary["frames_bad"], 0);
}

TEST(Replay, EventsOnStandardOutputAreCsvAndNothingElse) {
  const DemoCell cell;
  cell.simulate("0.6", "0:0,0.2:0,0.25:3");
  const Finished done = run(with(kReplay, {"--events", "-"}), cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  std::istringstream lines{done.out};
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "time_s,event,kind,frequency_hz,indicator,spindle_speed_rpm,note");
  int rows = 0;
  for (; std::getline(lines, line); ++rows) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 6) << line;
  EXPECT_GE(rows, 1);
  EXPECT_EQ(done.err, "");
}

TEST(Replay, BadLinesAreCountedWarnedOfAndPassedOver) {
  const DemoCell cell;
  cell.simulate("0.2", kShortCut);
  const std::string log = content_of(cell.path() / "cut.log");
  const std::size_t second_line = log.find('\n') + 1;
  (void)cell.write(
      "cut.log", log.substr(0, second_line) + "what is this\n" + log.substr(second_line, log.size() - second_line - 9));
  const Finished done = run(with(kReplay, {"--json"}), cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(nlohmann::json::parse(done.out)["frames_bad"], 2);
  EXPECT_THAT(done.err, StartsWith("stillcut: cut.log:2: "));
}

TEST(Replay, StampsThatGoBackAreAFaultEvent) {
  const DemoCell cell;
  cell.simulate("0.2", kShortCut);
  const std::string log = content_of(cell.path() / "cut.log");
  (void)cell.write("cut.log", log + log.substr(0, log.find('\n') + 1));
  const Finished done = run(with(kReplay, {"--events", "-"}), cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr(",fault,"));
  EXPECT_THAT(done.out, HasSubstr("stamp goes back"));
}

}  // namespace
}  // namespace stillcut
