// `stillcut tune` as a user runs it, on short simulated cuts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "drivers/files/csv.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/pipeline.hpp"
#include "tools/predictor.hpp"
#include "tools/tuning_replay.hpp"
#include "tools/tuning_report.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

const char* const kLabelHeader = "log,from_s,to_s,kind\n";
// Crosses the depth limit of the demo cell, 2.96 mm, at 1.2 s.
const char* const kTunedLabels = "deep.log,1.2,2,regenerative\nsound.log,,,\nthin.log,,,\n";

// The demo cell and a folder of three logs: one turns to chatter, two stay sound.
class TunedLogs : public DemoCell {
 public:
  TunedLogs() {
    std::filesystem::create_directory(path() / "logs");
    mill("deep", "0:0,0.2:0,0.3:1.5,0.8:1.5,1.5:3.6", "2", "1");
    mill("sound", "0:0,0.2:0,0.3:1.5,0.9:1.5,1:2,1.5:2,1.55:0", "1.8", "2");
    mill("thin", "0:0,0.2:0,0.3:0.8", "1.2", "3");
    label(kTunedLabels);
  }

  void mill(const std::string& name, const std::string& depth, const std::string& duration_s,
            const std::string& seed) const {
    const Finished done = run({"stillcut", "simulate", "cell.toml", "--duration", duration_s, "--depth", depth,
                               "--seed", seed, "--can", "logs/" + name + ".log", "--json"},
                              path());
    if (done.exit_code != 0) throw std::runtime_error("simulate: " + done.err);
  }
  void label(const std::string& rows) const { (void)write("logs/labels.csv", kLabelHeader + rows); }

  [[nodiscard]] Finished tune(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"stillcut", "tune", "cell.toml", "--logs", "logs"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path());
  }
};

TEST(TuneCommand, FindsALimitTellsItInEveryFormAndTheSameWhateverTheJobs) {
  const TunedLogs logs;
  const std::vector<std::string> files{"--json", "--csv", "curve.csv", "--out", "monitor.toml", "--plot", "roc.svg"};
  auto with_jobs = [&](const char* jobs) {
    std::vector<std::string> arguments = files;
    arguments.insert(arguments.end(), {"--jobs", jobs});
    const Finished done = logs.tune(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return done.out + content_of(logs.path() / "curve.csv") + content_of(logs.path() / "monitor.toml") +
           content_of(logs.path() / "roc.svg");
  };
  const std::string one = with_jobs("1"), three = with_jobs("3");
  EXPECT_TRUE(one == three);

  const auto result = nlohmann::json::parse(three.substr(0, three.find('\n')));
  EXPECT_EQ(result["logs"], 3);
  EXPECT_GT(result["hours"], 1.0 / 3600);
  EXPECT_LT(result["hours"], 4.0 / 3600);  // in the cut only, outside the chatter
  ASSERT_EQ(result["roc"].size(), 16U);
  EXPECT_EQ(result["roc"][0]["limit"], 5.0);
  EXPECT_EQ(result["roc"][15]["limit"], 200.0);
  const auto& chosen = result["chosen"];
  EXPECT_EQ(chosen["stretches"], 1);
  EXPECT_EQ(chosen["detected"], 1);
  EXPECT_GT(chosen["delay_median_s"], -0.1);
  EXPECT_LT(chosen["delay_median_s"], 0.8);
  const auto& validated = result["cross_validated"];
  EXPECT_NEAR(validated["proved_below_per_hour"], proved_rate_per_hour(validated["false_alarms"], validated["hours"]),
              1e-9);
  EXPECT_EQ(validated["stretches"], 1);
  ASSERT_EQ(validated["left_out"].size(), 3U);
  EXPECT_EQ(validated["left_out"][0]["log"], "deep.log");

  const CsvTable curve = read_csv(logs.path() / "curve.csv");
  ASSERT_EQ(curve.rows().size(), 16U);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(curve.number(curve.rows()[i], curve.require_column("limit")), result["roc"][i]["limit"]);
    EXPECT_EQ(curve.number(curve.rows()[i], curve.require_column("false_alarms")), result["roc"][i]["false_alarms"]);
  }

  // What is written is a section that the cell takes, and the monitor then has the limit.
  const auto tuned = read_cell(logs.path() / "monitor.toml");
  ASSERT_TRUE(tuned.detection.limit.has_value());
  EXPECT_EQ(*tuned.detection.limit, chosen["limit"]);
  EXPECT_THAT(content_of(logs.path() / "monitor.toml"), HasSubstr("3 logs"));
  const CoreSettings before = core_settings(read_cell(logs.path() / "cell.toml", {.bus = false}));
  (void)logs.write("cell.toml",
                   content_of(logs.path() / "cell.toml") + "\n" + content_of(logs.path() / "monitor.toml"));
  const CoreSettings after = core_settings(read_cell(logs.path() / "cell.toml", {.bus = false}));
  EXPECT_EQ(before.monitor.watch.limit, LineWatchSettings{}.limit);
  EXPECT_EQ(after.monitor.watch.limit, chosen["limit"]);
  EXPECT_EQ(after.monitor.release_ratio, before.monitor.release_ratio);
}

// At the default limit it hears what `stillcut replay` hears with the cell as it is.
TEST(TuneCommand, HearsWhatReplayHears) {
  const TunedLogs logs;
  const Cell cell = read_cell(logs.path() / "cell.toml", {.bus = false});
  const std::vector<std::filesystem::path> files{logs.path() / "logs/deep.log"};
  const std::vector<double> limits{LineWatchSettings{}.limit};
  const std::vector<HeardLog> heard =
      hear_logs(cell, Predictor{cell}.nominal().diagram, files, limits, 1, [](double) {});
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_NEAR(heard[0].duration_s, 2.0, 0.01);
  const Finished replay =
      run({"stillcut", "replay", "cell.toml", "--can", "logs/deep.log", "--events", "-"}, logs.path());
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  std::vector<double> onsets_s;
  const CsvTable events = parse_csv(replay.out, "events");
  for (const CsvRow& row : events.rows())
    if (row.fields[1] == "chatter_onset") onsets_s.push_back(events.number(row, 0));
  const std::vector<HeardOnset>& onsets = heard[0].at_limit.front().onsets;
  ASSERT_FALSE(onsets.empty() || onsets_s.empty());
  EXPECT_NEAR(onsets[0].time_s, onsets_s[0], 1e-6);
  for (const HeardOnset& onset : onsets)  // all but those that only tell the kind of one before
    EXPECT_TRUE(std::any_of(onsets_s.begin(), onsets_s.end(),
                            [&](double time_s) { return std::abs(onset.time_s - time_s) < 1e-6; }));
  for (const LogSpan& span : heard[0].at_limit.front().in_cut) {
    EXPECT_GE(span.from_s, 0.19);
    EXPECT_LE(span.to_s, 2.0);
    EXPECT_GT(span.to_s, span.from_s);
  }
}

TEST(TuneCommand, PrintsATableWithTheChosenRowAndWhatItProves) {
  const TunedLogs logs;
  const Finished done = logs.tune({"--false-alarms-per-hour", "1000000"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.err, "");
  EXPECT_THAT(done.out, HasSubstr("3 logs, "));
  EXPECT_THAT(done.out, HasSubstr("\n->      5 "));  // with such a wish the smallest
  EXPECT_THAT(done.out, HasSubstr("rule of three"));
  EXPECT_THAT(done.out, HasSubstr("cross-validated: "));
}

Event tuning_event(EventType type, ChatterKind kind) {
  Event event;
  event.type = type;
  event.kind = kind;
  return event;
}

TEST(OnsetCollector, CountsAnEpisodeOnceHoweverItsKindIsTold) {
  using enum ChatterKind;
  OnsetCollector collector;
  collector.add(tuning_event(EventType::cut_entry, unknown), 0.5);
  collector.add(tuning_event(EventType::chatter_onset, unknown), 1.0);
  collector.add(tuning_event(EventType::chatter_onset, structural), 1.1);  // beside the tool's
  collector.add(tuning_event(EventType::chatter_end, structural), 1.2);
  collector.add(tuning_event(EventType::chatter_onset, regenerative), 1.3);  // the first one's kind
  collector.add(tuning_event(EventType::chatter_end, regenerative), 2.0);
  collector.add(tuning_event(EventType::chatter_onset, unknown), 3.0);
  collector.add(tuning_event(EventType::cut_exit, unknown), 3.5);
  collector.add(tuning_event(EventType::chatter_onset, regenerative), 4.0);
  std::vector<double> times;
  for (const HeardOnset& onset : collector.onsets()) times.push_back(onset.time_s);
  EXPECT_EQ(times, (std::vector<double>{1.0, 1.1, 3.0, 4.0}));
}

TEST(TuningReport, WarnsWhereTheWishIsNotMet) {
  TuningResult result;
  result.limits = limit_grid(5.0, 20.0, 3);
  EXPECT_EQ(result.limits, (std::vector<double>{5.0, 10.0, 20.0}));
  auto warning = [&](const std::vector<int>& false_alarms) {
    result.curve.clear();
    for (const int count : false_alarms) result.curve.push_back({.false_alarms = count, .sound_s = 3600.0});
    result.choice = choose_limit(result.curve, 1.0);
    return wish_warning(result);
  };
  EXPECT_EQ(warning({5, 1, 0}), "");
  EXPECT_THAT(warning({5, 4, 6}), HasSubstr("the best limit, 10, has 4 false alarms an hour and not 1"));
  EXPECT_THAT(warning({5, 0, 6}), HasSubstr("limit 10 keeps to 1 an hour, but a larger one, 20, has 6"));
}

TEST(TuneCommand, RefusesBadInputWithOneLineThatNamesIt) {
  const TunedLogs logs;
  struct Spoilt {
    std::string labels;
    std::vector<std::string> arguments;
    int exit_code;
    std::string names;
  };
  const std::string good = kTunedLabels;
  const std::vector<Spoilt> cases{
      {good, {"--logs"}, 2, "--logs"},
      {good, {"--false-alarms-per-hour", "-1"}, 2, "--false-alarms-per-hour"},
      {good, {"--jobs", "0"}, 2, "--jobs"},
      {good, {"--json", "--csv", "-"}, 2, "standard output"},
      {good, {"--plot", "roc.pdf"}, 3, "roc.pdf: "},
      {good, {"--out", "./cell.toml"}, 3, "./cell.toml: is the cell file itself"},
      {"", {}, 3, "logs/labels.csv:1: no label"},
      {good + "gone.log,1,2,\n", {}, 3, "logs/labels.csv:5: log: \"gone.log\""},
      {"deep.log,1.2,9,\nsound.log,,,\nthin.log,,,\n", {}, 3, "logs/labels.csv:2: to_s: 9 is beyond the end"},
      {"deep.log,0,2,\nsound.log,0,1.79,\nthin.log,0,1.19,\n", {}, 3, "logs: holds no cutting outside"},
  };
  for (const Spoilt& spoilt : cases) {
    logs.label(spoilt.labels);
    const Finished done = logs.tune(spoilt.arguments);
    EXPECT_EQ(done.exit_code, spoilt.exit_code) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, testing::StartsWith("stillcut: "));
    EXPECT_THAT(done.err, HasSubstr(spoilt.names));
  }
  logs.label(good);
  (void)logs.write("logs/thin.log", "(1500000000.000000) can0 7FF#00\n(1500000001.000000) can0 7FF#00\n");
  EXPECT_THAT(logs.tune({}).err, HasSubstr("logs/thin.log: holds no frame of the cell's accelerometers"));
  (void)logs.write("logs/sound.log", "no log\n");  // of two bad logs the first is told, whichever thread meets it
  EXPECT_EQ(logs.tune({"--jobs", "4"}).err,
            "stillcut: logs/sound.log: not one valid frame; a CAN log is what `candump -L` writes\n");
  EXPECT_EQ(logs.tune({}).exit_code, 3);
}

}  // namespace
}  // namespace stillcut
