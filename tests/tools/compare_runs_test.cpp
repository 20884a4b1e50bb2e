// The same cut not corrected, corrected, and at a sound depth.
#include "tools/compare_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "models/lobes.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

struct Compared {
  explicit Compared(const std::string& scenario_name)
      : scenario{read_scenario(EXAMPLES "/scenarios/" + scenario_name + ".toml")},
        cell{read_cell(scenario.cell, {.bus = false})},
        runs{compare_runs(cell, scenario, 1'700'000'000'000'000'000, [](double) {})} {}
  Scenario scenario;
  Cell cell;
  std::vector<ComparedRun> runs;
};

TEST(CompareRuns, ShowWhatACorrectionIsWorth) {
  const Compared compared{"pocket-above"};
  ASSERT_EQ(compared.runs.size(), 3U);
  const HilScore& plain = compared.runs[0].score;
  const HilScore& corrected = compared.runs[1].score;
  const HilScore& shallow = compared.runs[2].score;
  EXPECT_LT(corrected.chatter_s, 0.5 * plain.chatter_s);
  EXPECT_LT(compared.runs[1].ra_at_end, compared.runs[0].ra_at_end);
  EXPECT_GT(corrected.removed_mm3_per_min.value_or(0.0), plain.removed_mm3_per_min.value_or(1e9));  // a faster spindle
  EXPECT_LT(shallow.removed_mm3_per_min.value_or(1e9), plain.removed_mm3_per_min.value_or(0.0));
  EXPECT_TRUE(shallow.spells.empty());
}

TEST(CompareRuns, MillAtNineTenthsOfTheLimitAndKeepShallowerPartsOfTheProgram) {
  const Compared compared{"depth-step"};
  const auto modes = stability_posture(compared.cell, read_cell_dynamics(compared.cell)).posture.modes;
  const std::vector<double> speed{compared.cell.cut->spindle_speed};
  const double limit =
      depth_limits(*compared.cell.tool, *compared.cell.material, *compared.cell.cut, modes, speed, {})[0].depth;
  EXPECT_NEAR(sound_depth(compared.cell, compared.scenario), 0.9 * limit, 1e-9);
  double deepest = 0.0;
  for (const MachineMoment& moment : compared.runs[2].machine->moments()) {
    deepest = std::max(deepest, moment.axial_depth);
    const bool sound_part = moment.time > 0.6 && moment.time < 1.4;
    EXPECT_NEAR(sound_part ? moment.axial_depth : 1.5e-3, 1.5e-3, 1e-12);
  }
  EXPECT_NEAR(deepest, 0.9 * limit, 1e-9);
}

TEST(CompareRuns, LeaveOutTheShallowCutWhereTheProgramIsSound) {
  const Compared compared{"stable-cut"};
  ASSERT_EQ(compared.runs.size(), 2U);
  const auto &plain = compared.runs[0].score.roughness, &corrected = compared.runs[1].score.roughness;
  ASSERT_TRUE(plain && corrected);
  EXPECT_EQ(plain->ra, corrected->ra);  // nothing was corrected
}

TEST(CompareRuns, FollowTheWallAsItWasCut) {
  const Compared compared{"stable-cut"};
  const ComparedRun& run = compared.runs[0];
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < run.surface_time.size(); ++i) {
    EXPECT_GE(run.surface_time[i], i > 0 ? run.surface_time[i - 1] : 0.0);
    if (!run.score.lengths[i].roughness) continue;
    sum += run.score.lengths[i].roughness->ra;
    ++count;
  }
  ASSERT_TRUE(run.score.roughness);
  EXPECT_NEAR(sum / count, run.score.roughness->ra, 0.02 * run.score.roughness->ra);
}

TEST(CompareRuns, AreToldAsAListAndDrawn) {
  const TempFolder folder;
  const Finished done = run({"stillcut", "hil", EXAMPLES "/demo-cell/cell.toml", "--scenario",
                             EXAMPLES "/scenarios/knock.toml", "--compare", "--json", "--plot", "compared.svg"},
                            folder.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  ASSERT_GE(json.at("runs").size(), 2U);
  EXPECT_EQ(json["runs"][0]["name"], "not corrected");
  EXPECT_GT(json["runs"][1]["removed_mm3_per_min"], 0.0);
  EXPECT_GT(json["runs"][1]["ra_at_end_um"], 0.0);
  EXPECT_GT(std::filesystem::file_size(folder.path() / "compared.svg"), 5000U);
}

}  // namespace
}  // namespace stillcut
