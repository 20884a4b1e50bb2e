// From a file of cutter locations to the surface that it leaves.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "drivers/files/cl_file.hpp"
#include "models/path_surface.hpp"
#include "models/surface_sweep.hpp"

namespace stillcut::test {
namespace {

Tool ball_of_file(double diameter) {
  return {.shape = ToolShape::ball, .diameter = diameter, .teeth = 2, .pitch = {kTwoPi / 2, kTwoPi / 2}};
}

// A flat zig-zag, inclined, as a CAM system would write it. Fails where the tip is taken for the centre, feeds or
// spindle speeds are misread, or the time that rapids take is lost: the marks then lie elsewhere.
TEST(PathSurfaceFile, AFlatZigZagLeavesWhatParallelPassesDo) {
  const Cut cut{.radial_depth = 0.4e-3,
                .axial_depth = 0.5e-3,
                .feed_per_tooth = 0.1e-3,
                .spindle_speed = rpm_to_rad_s(6000),
                .tilt = deg_to_rad(-5),
                .lead = deg_to_rad(15),
                .path = PathKind::zigzag};
  const CutterMotion motion = cutter_motion(ball_of_file(8e-3), cut);
  const double rapid_rate = 0.1;
  const auto passes = passes_over(motion, cut, 0.5e-3, 0.5e-3, cut.radial_depth / rapid_rate);
  std::string text = "TOOL PATH/ZIG\nSPINDL/RPM,6000,CLW\nFEDRAT/MMPM,1200\n";
  const Eigen::Vector3d axis = motion.orientation.col(2);
  const auto go = [&](double x, double y) {
    const Eigen::Vector3d tip = 1e3 * (Eigen::Vector3d(x, y, 4e-3) - 4e-3 * axis);
    char line[160];
    (void)std::snprintf(line, sizeof line, "GOTO/%.6f,%.6f,%.6f,%.9f,%.9f,%.9f\n", tip.x(), tip.y(), tip.z(), axis.x(),
                        axis.y(), axis.z());
    text += line;
  };
  for (const CutterPass& pass : passes) {
    text += "RAPID\n";
    go(pass.begin, pass.across);
    go(pass.begin + (pass.reversed ? -1.0 : 1.0) * pass.length, pass.across);
  }
  const ToolPath path = parse_cutter_locations(text + "END-OF-PATH\nFINI\n", "zig.cls");
  const CutterPath cutter = cutter_path(ball_of_file(8e-3), path, {.rapid_rate = rapid_rate});
  const PathSurface surface = path_surface(cutter, {0.0, 0.0, 0.5e-3, 0.5e-3}, {.spacing = 4e-6});
  HeightMap flat = uncut_map(0.5e-3, 0.5e-3, 4e-6);
  const SurfaceSweep sweep(motion, cut, flat.spacing_along, flat.spacing_across);
  for (const MapTile& tile : map_tiles(flat)) sweep.sweep(flat, tile, passes);
  ASSERT_EQ(surface.map.heights.size(), flat.heights.size());
  const double chords = 2.0 * 4e-6 * 4e-6 / (8.0 * 4e-3), rounded = 1e-9;
  for (std::size_t i = 0; i < flat.heights.size(); ++i)
    ASSERT_NEAR(surface.map.heights[i], flat.heights[i], chords + rounded) << i;
}

// The example's tool stands upright on its wave. Where two chords of 2.5 mm meet on the crest, the ball comes c^2 R / 8
// rho^2 below the point that both name: half a micrometre.
TEST(PathSurfaceFile, TheExampleLeavesItsWave) {
  const CutterPath cutter = cutter_path(ball_of_file(12e-3), read_cutter_locations(TEST_DATA "/paths/wave.cls"));
  const Eigen::Vector3d tip = cutter.pieces[12].from;
  const PathSurface surface =
      path_surface(cutter, {tip.x() - 0.02e-3, tip.y() - 0.02e-3, 0.04e-3, 0.04e-3}, {.spacing = 4e-6});
  EXPECT_EQ(surface.uncovered, 0U);
  EXPECT_LT(surface.map.at(5, 5), tip.z() + 0.1e-6);
  EXPECT_GT(surface.map.at(5, 5), tip.z() - 1e-6);
}

}  // namespace
}  // namespace stillcut::test
