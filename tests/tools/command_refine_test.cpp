// `stillcut refine` as a user runs it, on cuts of a machine whose tool mode lies elsewhere than its map says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "drivers/files/csv.hpp"
#include "drivers/files/map_proposals_file.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/heard_chatter.hpp"
#include "tools/map_refinement_study.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

// Of the demo cell at 4.5 mm, where 752 Hz, mode 5 of `home`, chatters.
const std::vector<std::string> kChatteringRpm{"8200", "8400", "8600", "9000", "12900", "13300", "13600"};

// The machine's own cell in machine/, where its logs are, and the monitor's in the folder itself.
class OffCell : public DemoCell {
 public:
  OffCell() {
    change("axial_depth_mm = 3.6", "axial_depth_mm = 4.5");
    for (const std::string& rpm : kChatteringRpm) {
      const Finished done =
          run({"stillcut", "simulate", "cell.toml", "--duration", "1.7", "--seed", rpm, "--can", rpm + ".log", "--json",
               "--depth", "0:0,0.3:0,0.4:1.5,0.8:1.5,1.1:4.5", "--speed", "0:" + rpm + ",2:" + rpm},
              path());
      if (done.exit_code != 0) throw std::runtime_error("simulate: " + done.err);
    }
    std::filesystem::copy(path() / "map", path() / "true-map");
  }

  // Mode 5 of `home` elsewhere, as the map has it.
  void set_mode(const std::string& hz) const {
    std::filesystem::copy(path() / "true-map", path() / "map",
                          std::filesystem::copy_options::overwrite_existing | std::filesystem::copy_options::recursive);
    change("home,5,752.0,", "home,5," + hz + ",", "map/modes.csv");
  }

  [[nodiscard]] Finished refine(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"stillcut", "refine", "cell.toml", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path());
  }
  [[nodiscard]] nlohmann::json refine_from_logs() const {
    std::vector<std::string> arguments{"--can"};
    for (const std::string& rpm : kChatteringRpm) arguments.push_back(rpm + ".log");
    const Finished done = refine(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  }

  // Root mean square over the speeds of ln of the limits, the map's over the machine's.
  [[nodiscard]] double lobes_off() const {
    const auto limits = [&](const char* map) {
      change("map = \"map\"", std::string("map = \"") + map + "\"");
      const Finished done =
          run({"stillcut", "lobes", "cell.toml", "--speed", "8000:9500:21", "--csv", "lobes.csv"}, path());
      EXPECT_EQ(done.exit_code, 0) << done.err;
      change(std::string("map = \"") + map + "\"", "map = \"map\"");
      const CsvTable table = read_csv(path() / "lobes.csv");
      std::vector<double> depths;
      for (const CsvRow& row : table.rows()) depths.push_back(table.number(row, table.require_column("a_lim_mm")));
      return depths;
    };
    const std::vector<double> ours = limits("map"), true_ones = limits("true-map");
    double sum = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i) sum += std::pow(std::log(ours[i] / true_ones[i]), 2);
    return std::sqrt(sum / static_cast<double>(ours.size()));
  }
};

TEST(RefineCommand, FindsByHowMuchAModeIsOffAndAcceptedItBringsTheLobesNearer) {
  const OffCell cell;
  const std::string sound_modes = content_of(cell.path() / "map/modes.csv");
  const auto sound = cell.refine_from_logs();
  EXPECT_TRUE(sound["proposals"].empty()) << sound;
  EXPECT_GE(sound["evidence"][0]["observations"], 5);
  EXPECT_FALSE(std::filesystem::exists(cell.path() / "map/proposals.csv"));

  for (const double hz : {744.5, 767.0}) {  // 1 and -2 % off
    cell.set_mode(csv_number(hz));
    const std::string off_modes = content_of(cell.path() / "map/modes.csv");
    const auto result = cell.refine_from_logs();
    ASSERT_EQ(result["proposals"].size(), 1U) << hz << result;
    const auto& proposal = result["proposals"][0];
    EXPECT_EQ(proposal["id"], "home/5");
    EXPECT_NEAR(proposal["frequency_hz"].get<double>(), hz, 1e-6);
    EXPECT_NEAR(proposal["proposed_frequency_hz"].get<double>(), 752.0, 0.004 * 752.0);
    EXPECT_EQ(content_of(cell.path() / "map/modes.csv"), off_modes);  // not touched yet

    const double before = cell.lobes_off();
    const Finished accepted = cell.refine({"--accept", "home/5"});
    ASSERT_EQ(accepted.exit_code, 0) << accepted.err;
    EXPECT_LT(cell.lobes_off(), 0.4 * before);
    EXPECT_EQ(nlohmann::json::parse(accepted.out)["proposals"][0]["status"], "accepted");
    const std::string kept = nlohmann::json::parse(accepted.out)["kept"];
    EXPECT_EQ(content_of(kept), off_modes);
    std::filesystem::remove(cell.path() / "map/proposals.csv");
  }
}

TEST(RefineCommand, DoesNotProposeAgainWhatWasRejectedAndTakesOpenOnesBackOnNewEvidence) {
  const OffCell cell;
  cell.set_mode("737");
  (void)cell.refine_from_logs();
  EXPECT_EQ(cell.refine({"--reject"}).exit_code, 0);
  EXPECT_EQ(cell.refine_from_logs()["proposals"][0]["status"], "rejected");
  EXPECT_THAT(cell.refine({"--accept", "home/5"}).err, HasSubstr("home/5: is no open proposal"));
  EXPECT_THAT(cell.refine({"--accept"}).err, HasSubstr("has no open proposal"));

  std::filesystem::remove(cell.path() / "map/proposals.csv");
  (void)cell.refine_from_logs();
  cell.set_mode("752.0");  // somebody has tapped again
  const Finished late = cell.refine({"--accept"});
  EXPECT_EQ(late.exit_code, 3);
  EXPECT_THAT(late.err, HasSubstr("has 752 Hz in the map, not 737 as when it was proposed"));
  EXPECT_TRUE(cell.refine_from_logs()["proposals"].empty());
}

TEST(RefineCommand, ReadsEventsAndNamesWhatIsWrongInThem) {
  const DemoCell cell;
  const auto events = [&](const std::string& rows) {
    (void)cell.write("events.csv", "time_s,event,kind,frequency_hz,indicator,spindle_speed_rpm,note\n" + rows);
    return run({"stillcut", "refine", "cell.toml", "--json", "--events", "events.csv"}, cell.path());
  };
  std::string rows;
  for (const char* hz : {"763.0", "763.2", "762.8", "763.1", "763.0"})  // 747.5 Hz by the lobes at 3.6 mm
    rows += std::string("1.5,chatter_onset,regenerative,") + hz +
            ",1.2,8200,\n2,chatter_end,regenerative,740,,8200,\n" + "3,chatter_onset,structural,12.9,1,8200,\n";
  const auto result = nlohmann::json::parse(events(rows).out);
  EXPECT_EQ(result["heard"], 5);
  EXPECT_GT(result["evidence"][0]["shift"], 0.01);
  EXPECT_LT(result["evidence"][0]["shift"], 0.04);
  EXPECT_EQ(result["proposals"].size(), 1U);
  const Finished wrong = events("1.5,chatter_onset,regenerative,-5,1.2,8200,\n");
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("events.csv:2: frequency_hz: must be above 0"));
  EXPECT_EQ(run({"stillcut", "refine", "cell.toml", "--accept", "--reject"}, cell.path()).exit_code, 2);
}

// What the collector is told, hop by hop.
class Hops {
 public:
  explicit Hops(const Cell& cell) : collector_{cell, Posture{}} {}
  void chatter(double seconds, double hz, double rpm = 8000, ChatterKind kind = ChatterKind::regenerative,
               const RobotState* robot = nullptr) {
    for (const std::int64_t end = stamp_ns_ + static_cast<std::int64_t>(seconds * 1e9); stamp_ns_ < end;) {
      MonitorView view;
      view.stamp_ns = stamp_ns_ += 3'000'000;
      view.speed = rpm_to_rad_s(rpm);
      view.chatter = hz > 0.0;
      view.kind = kind;
      view.chatter_frequency_hz = hz;
      collector_.look(view, robot, 0);
      collector_.look(view, robot, 0);  // a frame without a new view
    }
  }
  std::vector<ChatteredCut> finish() { return collector_.finish(); }

 private:
  ChatterCollector collector_;
  std::int64_t stamp_ns_ = 1'000'000'000;
};

TEST(ChatterCollector, TakesOneFrequencyAnEpisodeWhileTheSpeedStands) {
  const DemoCell folder;
  const Cell cell = read_cell(folder.path() / "cell.toml", {.bus = false});
  Hops hops{cell};
  hops.chatter(0.2, 750);
  hops.chatter(0.5, 0);
  hops.chatter(0.3, 760);  // an episode of one second, of which only the beginning counts
  hops.chatter(0.7, 700);
  hops.chatter(0.1, 0);
  hops.chatter(0.01, 770);  // too short
  hops.chatter(0.1, 0);
  for (int i = 0; i < 30; ++i) hops.chatter(0.01, 750 - 2 * i);  // wanders
  hops.chatter(0.1, 0);
  hops.chatter(0.3, 780, 8000, ChatterKind::unknown);  // on a spindle order
  hops.chatter(0.1, 0);
  hops.chatter(0.1, 790, 9000);  // then its speed is corrected
  hops.chatter(0.2, 700, 9500);
  RobotState robot;
  robot.axial_depth = 0.002;
  robot.radial_depth = 0.004;
  robot.feed_direction = 1.5;
  robot.milling = Milling::up;
  hops.chatter(0.1, 0);
  hops.chatter(0.2, 800, 8000, ChatterKind::regenerative, &robot);
  const std::vector<ChatteredCut> cuts = hops.finish();
  ASSERT_EQ(cuts.size(), 4U);
  const double hz[] = {750, 760, 790, 800};
  for (std::size_t i = 0; i < cuts.size(); ++i) EXPECT_DOUBLE_EQ(cuts[i].heard.frequency, kTwoPi * hz[i]);
  EXPECT_DOUBLE_EQ(cuts[2].heard.spindle_speed, rpm_to_rad_s(9000));
  EXPECT_DOUBLE_EQ(cuts[0].heard.axial_depth, 0.0036);
  EXPECT_DOUBLE_EQ(cuts[3].heard.axial_depth, 0.002);
  EXPECT_EQ(cuts[3].cut.milling, Milling::up);
  EXPECT_DOUBLE_EQ(cuts[3].cut.feed_direction, 1.5);
  EXPECT_DOUBLE_EQ(cuts[3].cut.radial_depth, 0.004);
}

TEST(RefinementStudy, CountsChatterForTheNearestPostureIfItHasHalfOfTheWeight) {
  const DemoCell folder;
  const Cell cell = read_cell(folder.path() / "cell.toml", {.bus = false});
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const auto study_at = [&](const std::string& posture) {
    ChatteredCut one{1.0,
                     {rpm_to_rad_s(8200), cell.cut->axial_depth, kTwoPi * 748.0},
                     *cell.cut,
                     find_posture(dynamics.map, posture)};
    return study_refinement(cell, dynamics, std::vector{one}, {}, [](double) {});
  };
  const RefinementStudy at_home = study_at("home"), near_left = study_at("24,-80,85,0,80,25");
  ASSERT_EQ(at_home.evidence.size(), 1U);
  EXPECT_EQ(dynamics.map.postures[at_home.evidence[0].posture].id, "home");
  ASSERT_EQ(near_left.evidence.size(), 1U);
  EXPECT_EQ(dynamics.map.postures[near_left.evidence[0].posture].id, "left");
  EXPECT_EQ(study_at("12,-85,87,0,85,12").between, 1U);
}

}  // namespace
}  // namespace stillcut
