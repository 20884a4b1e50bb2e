// The roughness of a simulated cut as `simulate` and `hil` tell it, on machines so stiff that only feed marks are left.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

// R_a of arcs of 10 mm, 0.2 mm apart: f²/(18 √3 R), and their height f²/(8 R), um.
const double kMarksRa = 0.2 * 0.2 / (18.0 * std::sqrt(3.0) * 10.0) * 1e3, kMarksRt = 0.2 * 0.2 / (8.0 * 10.0) * 1e3;

class StiffCell : public DemoCell {
 public:
  StiffCell() {
    change("runout_mm = 0.004\n", "");
    change("feed_per_tooth_mm = 0.05", "feed_per_tooth_mm = 0.2");
    (void)write("map/postures.csv", "posture,x_mm,y_mm,z_mm\nhome,1100,0,600\n");
    (void)write("map/modes.csv",
                "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                "home,1,500,0.05,1e13,1,0,0\nhome,2,500,0.05,1e13,0,1,0\nhome,3,500,0.05,1e13,0,0,1\n");
  }
  void give_ball_end() const {
    change("shape = \"end\"", "shape = \"ball\"");
    change("radial_depth_mm = 10.0", "radial_depth_mm = 0.5");
    change("axial_depth_mm = 3.6", "axial_depth_mm = 0.5\nlead_deg = 20");
  }
  [[nodiscard]] nlohmann::json simulated(std::vector<std::string> more) const {
    more.insert(more.begin(), {"stillcut", "simulate", "cell.toml", "--duration", "0.4", "--json"});
    const Finished done = run(more, path());
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  }
  [[nodiscard]] nlohmann::json in_loop() const {
    (void)write("scenario.toml", "cell = \"cell.toml\"\nduration_s = 0.6\nforce_noise = 0\n");
    const Finished done =
        run({"stillcut", "hil", "cell.toml", "--scenario", "scenario.toml", "--data-time", "--json"}, path());
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  }
};

void expect_marks(const nlohmann::json& summary, const char* surface) {
  EXPECT_EQ(summary["surface"], surface);
  EXPECT_NEAR(summary["ra_um"].get<double>(), kMarksRa, 0.03 * kMarksRa);
  EXPECT_NEAR(summary["rq_um"].get<double>(), 2.0 / (3.0 * std::sqrt(5.0)) * kMarksRt, 0.03 * kMarksRt);
  EXPECT_NEAR(summary["rt_um"].get<double>(), kMarksRt, 0.1 * kMarksRt);
}

// Fails with a wall on the wrong side, marks of another radius, a ball end measured as an end mill, other sums.
TEST(SimulatedRoughness, OfAStiffMachineIsItsFeedMarks) {
  const StiffCell cell;
  expect_marks(cell.simulated({"--force-noise", "0"}), "wall");
  expect_marks(cell.in_loop(), "wall");
  cell.change("milling = \"down\"", "milling = \"up\"");
  expect_marks(cell.simulated({"--force-noise", "0"}), "wall");
}

TEST(SimulatedRoughness, OfABallEndIsThatOfItsFloor) {
  const StiffCell cell;
  cell.give_ball_end();
  expect_marks(cell.simulated({"--force-noise", "0"}), "floor");
  expect_marks(cell.in_loop(), "floor");
}

// A softer tool is seen on the floor, and so is what one of its teeth is too long by.
TEST(SimulatedRoughness, OfAFloorShowsVibrationAndRunout) {
  const StiffCell stiff, soft, runout;
  for (const StiffCell* cell : {&stiff, &soft, &runout}) cell->give_ball_end();
  soft.change("home,3,500,0.05,1e13", "home,3,500,0.05,1e6", "map/modes.csv");
  runout.change("teeth = 2", "teeth = 2\nrunout_mm = 0.02");
  const double ra = stiff.simulated({})["ra_um"];
  EXPECT_GT(soft.simulated({})["ra_um"], 1.5 * ra);
  EXPECT_GT(runout.simulated({})["ra_um"], 1.5 * ra);
}

TEST(SimulatedRoughness, IsUnknownWhereNothingWasCut) {
  const StiffCell cell;
  const auto known = [&] {
    const nlohmann::json summary = cell.simulated({"--depth", "0:0"});
    return !summary.at("ra_um").is_null() || !summary.at("rq_um").is_null() || !summary.at("rt_um").is_null();
  };
  EXPECT_FALSE(known());
  cell.give_ball_end();
  EXPECT_FALSE(known());
  const Finished told = run({"stillcut", "simulate", "cell.toml", "--duration", "0.1", "--depth", "0:0"}, cell.path());
  EXPECT_NE(told.out.find("no 0.8 mm of floor to measure"), std::string::npos) << told.out;
}

}  // namespace
}  // namespace stillcut
