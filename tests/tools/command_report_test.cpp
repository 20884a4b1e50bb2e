// `stillcut report`: the page is well-formed and holds all it needs; its figures are those of playback; what was asked
// and answered, and what is broken in a recording, stand in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/files/csv.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "dsp/numbers.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTwoCuts = "0:0,0.2:0,0.25:1.5,0.9:1.5,0.95:0,1.5:0,1.55:1.5,2:3.8,3:3.8,3.1:0";

struct Reported {
  nlohmann::json json;
  std::string page;
};

Reported report_of(const DemoCell& files, const std::vector<std::string>& more = {"--pictures", "0"}) {
  std::vector<std::string> arguments{"stillcut", "report", "cell.toml", "--can",
                                     "cut.log",  "--out",  "page.html", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished done = run(arguments, files.path());
  if (done.exit_code != 0) throw std::runtime_error("report: " + done.err);
  return {nlohmann::json::parse(done.out), content_of(files.path() / "page.html")};
}

CsvTable events_of(const DemoCell& files) {
  const Finished done =
      run({"stillcut", "replay", "cell.toml", "--can", "cut.log", "--events", "events.csv", "--json"}, files.path());
  if (done.exit_code != 0) throw std::runtime_error("replay: " + done.err);
  return read_csv(files.path() / "events.csv");
}

std::vector<double> times_of(const CsvTable& events, const std::string& event) {
  std::vector<double> times;
  for (const CsvRow& row : events.rows())
    if (row.fields[1] == event) times.push_back(events.number(row, 0));
  return times;
}

// Calls `visit` with every element of a document.
void visit_all(const tinyxml2::XMLElement* element, const std::function<void(const tinyxml2::XMLElement&)>& visit) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    visit(*element);
    visit_all(element->FirstChildElement(), visit);
  }
}

std::string text_of(const tinyxml2::XMLNode& node) {
  std::string text;
  for (const tinyxml2::XMLNode* child = node.FirstChild(); child != nullptr; child = child->NextSibling())
    text += child->ToText() != nullptr ? child->Value() : text_of(*child);
  return text;
}

TEST(Report, PageIsWellFormedAndNeedsNothingBesideItself) {
  const DemoCell files;
  files.simulate("3.3", kTwoCuts);
  const Reported report = report_of(files, {});
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(report.page.c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  int pictures = 0;
  std::vector<std::string> headings;
  visit_all(document.RootElement(), [&](const tinyxml2::XMLElement& element) {
    const std::string name = element.Name();
    EXPECT_NE(name, "script");
    EXPECT_NE(name, "link");
    if (name == "h2") headings.push_back(text_of(element));
    for (const char* reference : {"src", "href"}) {
      const char* const to = element.Attribute(reference);
      EXPECT_TRUE(to == nullptr || std::string(to).starts_with("data:")) << to;
    }
    if (name != "img") return;
    ++pictures;
    EXPECT_GT(std::string(element.Attribute("alt")).size(), 10U);
  });
  EXPECT_EQ(headings, (std::vector<std::string>{"Timeline", "Cuts", "Chatter", "Lobes and cuts", "Health", "Latency"}));
  EXPECT_EQ(pictures, 3);  // timeline, one episode, lobes of one posture
  EXPECT_THAT(report.page, HasSubstr(report.json["verdict"].get<std::string>()));
}

TEST(Report, FiguresAreThoseOfPlayback) {
  const DemoCell files;
  files.simulate("3.3", kTwoCuts);
  const Reported report = report_of(files);
  const CsvTable events = events_of(files);
  const auto onsets = times_of(events, "chatter_onset"), ends = times_of(events, "chatter_end"),
             entries = times_of(events, "cut_entry"), exits = times_of(events, "cut_exit"),
             corrections = times_of(events, "correction");
  ASSERT_EQ(onsets.size(), 1U);
  ASSERT_EQ(report.json["episodes"].size(), onsets.size());
  const auto& episode = report.json["episodes"][0];
  EXPECT_NEAR(episode["onset_s"], onsets[0], 1e-6);
  EXPECT_NEAR(episode["end_s"], ends.at(0), 1e-6);
  EXPECT_EQ(episode["kind"], "regenerative");
  ASSERT_EQ(episode["corrections"].size(), corrections.size());
  EXPECT_NEAR(episode["corrections"][0]["time_s"], corrections.at(0), 1e-6);
  EXPECT_EQ(episode["corrections"][0]["answer"], "shown only (shadow)");
  for (const CsvRow& row : events.rows()) {
    if (row.fields[1] == "correction") {
      EXPECT_NEAR(episode["corrections"][0]["target_rpm"], events.number(row, 5), 1e-5);
    }
    if (row.fields[1] == "chatter_onset") {
      EXPECT_NEAR(episode["frequency_hz"], events.number(row, 3), 1e-5);
    }
  }
  ASSERT_EQ(report.json["cuts"].size(), entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto& cut = report.json["cuts"][i];
    EXPECT_NEAR(cut["begin_s"], entries[i], 1e-6);
    EXPECT_NEAR(cut["end_s"], exits.at(i), 1e-6);
    EXPECT_NEAR(cut["spindle_speed_rpm"], 8500.0, 5.0);
    const bool holds_the_chatter = onsets[0] > entries[i] && onsets[0] < exits[i];
    EXPECT_EQ(cut["episodes"], holds_the_chatter ? 1 : 0);
    EXPECT_NEAR(cut["chatter_s"], holds_the_chatter ? ends[0] - onsets[0] : 0.0, 0.02);
  }
  double told_s = 0.0;
  for (const auto& [state, time_s] : report.json["time_s"].items()) told_s += time_s.get<double>();
  EXPECT_NEAR(told_s, report.json["played_s"], 0.11);  // status comes ten times a second
  EXPECT_NEAR(report.json["time_s"]["chatter"], ends[0] - onsets[0], 0.2);
  EXPECT_TRUE(report.json["latency_us"].is_null());
  EXPECT_THAT(report.page, HasSubstr("holds none"));
}

TEST(Report, TellsWhatWasAnsweredAndWhereTheLoopsTimeWent) {
  const DemoCell files;
  files.change("mode = \"shadow\"", "mode = \"active\"");
  files.simulate("3.3", kTwoCuts);
  const double onset_s = report_of(files).json["episodes"].at(0)["onset_s"];
  const std::int64_t start_ns = report_of(files).json["start_utime"].get<std::int64_t>() * 1000;
  for (const bool accepts : {true, false}) {
    std::string log;
    const auto at = [&](double time_s) { return start_ns + std::llround(time_s * 1e6) * 1000; };
    std::int64_t number = 0;
    for (double time_s = 0.0; time_s < 3.2; time_s += 0.02) {
      RobotState state;
      state.stamp_ns = at(time_s);
      state.spindle_speed_rpm = 8500.0;
      state.axial_depth = 3.3e-3;
      state.radial_depth = kNaN;
      append_lcm_event(log, number++, state.stamp_ns, kRobotStateChannel, encode(state));
      if (time_s < onset_s + 0.05 || time_s >= onset_s + 0.07) continue;
      CorrectionAck ack;
      ack.stamp_ns = at(time_s);
      ack.sequence = 1;
      ack.accepted = accepts;
      append_lcm_event(log, number++, ack.stamp_ns, kRobotAckChannel, encode(ack, accepts ? "" : "drive <busy>"));
    }
    const auto times = std::make_unique<LoopTimes>();
    for (int i = 0; i < 77; ++i) times->loop.execution.record(1000 * i);
    append_lcm_event(log, number++, at(3.2), kLatencyChannel, encode(latency_report(*times, at(3.2))));
    (void)files.write("robot.lcm", log);
    const Reported report = report_of(files, {"--lcm", "robot.lcm", "--pictures", "0"});
    const auto& first = report.json["episodes"].at(0)["corrections"].at(0);
    EXPECT_EQ(first["answer"], accepts ? "followed" : "refused: drive <busy>");
    EXPECT_NEAR(report.json["episodes"][0]["axial_depth_mm"], 3.3, 1e-9);
    EXPECT_EQ(report.json["latency_us"]["tick"]["count"], 77);
    EXPECT_EQ(report.json["latency_us"]["tick"]["max"], 76.0);
    EXPECT_THAT(report.page, HasSubstr("the deepest that the robot told"));
    tinyxml2::XMLDocument document;
    EXPECT_EQ(document.Parse(report.page.c_str()), tinyxml2::XML_SUCCESS) << "names of others' making are escaped";
  }
}

TEST(Report, ASoundCutIsGood) {
  const DemoCell files;
  files.simulate("1.5", "0:0,0.2:0,0.25:1.5,1.2:1.5,1.25:0");
  const Reported report = report_of(files);
  EXPECT_EQ(report.json["gravity"], "good") << report.json["verdict"];
  EXPECT_EQ(report.json["episodes"].size(), 0U);
  EXPECT_EQ(report.json["cuts"].size(), 1U);
  EXPECT_THAT(report.json["verdict"].get<std::string>(), HasSubstr("No chatter in 1 cut"));
  EXPECT_LT(report.json["cuts"][0]["indicator_max"], 1.01);
}

TEST(Report, TellsWhatIsMissing) {
  const DemoCell files;
  files.simulate("1.5", "0:0,0.2:0,0.25:1.5,1.2:1.5,1.25:0");
  std::istringstream lines{content_of(files.path() / "cut.log")};
  std::string log, line;
  for (int i = 0; std::getline(lines, line); ++i)
    if (i % 500 < 497 && !(i > 1600 && i < 2300)) log.append(line).append("\n");
  (void)files.write("cut.log", log);
  const Reported report = report_of(files);
  const auto& sensor = report.json["sensors"].at(0);
  const double rate = sensor["sample_rate_hz"];
  EXPECT_GT(sensor["gaps"], 5);
  EXPECT_GT(sensor["samples_missing"], 6500);
  EXPECT_NEAR(sensor["samples"].get<double>() + sensor["samples_missing"].get<double>(), 1.5 * rate, 0.01 * rate);
  EXPECT_NEAR(sensor["longest_gap_s"], 700.0 / 2610.0, 0.02);
  EXPECT_FALSE(report.json["faults"].empty());
  EXPECT_THAT(report.json["verdict"].get<std::string>(), HasSubstr("could not be trusted"));
  EXPECT_THAT(report.page, HasSubstr("samples lost"));
}

TEST(Report, PicturesAreOfTheWorstEpisodesOnly) {
  const DemoCell files;
  files.simulate("4.2", "0:0,0.2:0,0.3:3.8,1.1:3.8,1.2:0,2:0,2.1:3.8,3.2:3.8,3.3:0");
  const auto pictures_in = [](const std::string& page) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = page.find("data:image/png", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  const Reported all = report_of(files, {}), one = report_of(files, {"--pictures", "1"});
  ASSERT_GE(all.json["episodes"].size(), 2U);
  EXPECT_EQ(pictures_in(all.page), all.json["episodes"].size());
  EXPECT_EQ(pictures_in(one.page), 1U);
  EXPECT_EQ(one.json, all.json);
  EXPECT_THAT(one.page, HasSubstr("Pictures are of the 1 episodes"));
}

TEST(Report, WhatCannotBeReportedIsRefusedInOneLine) {
  struct Refused {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const DemoCell files;
  files.simulate("0.1", "0:3");
  for (const Refused& refused :
       std::vector<Refused>{{{"--can", "cut.log"}, 2, "--out"},
                            {{"--can", "no.log", "--json"}, 3, "no.log: "},
                            {{"--can", "map", "--json"}, 3, "map: "},
                            {{"--can", "cut.log", "--out", "none/p.html"}, 3, "none/p.html: "},
                            {{"--can", "cut.log", "--out", "/dev/full"}, 3, "is the disk full?"},
                            {{"--can", "cut.log", "--out", "-", "--json"}, 2, "standard output"}}) {
    std::vector<std::string> arguments{"stillcut", "report", "cell.toml"};
    arguments.insert(arguments.end(), refused.arguments.begin(), refused.arguments.end());
    const Finished ended = run(arguments, files.path());
    EXPECT_EQ(ended.exit_code, refused.exit_code) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(refused.says));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  }
}

}  // namespace
}  // namespace stillcut
