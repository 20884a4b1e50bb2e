// A cell that mills a small pocket, its map nine places of a machine without joints whose soft direction turns along X.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {

class PocketCell {
 public:
  explicit PocketCell(const std::string& region = "polygon_mm = [[0, 0], [100, 0], [100, 100], [0, 100]]") {
    std::filesystem::create_directory(path() / "map");
    std::ofstream postures{path() / "map" / "postures.csv"}, modes{path() / "map" / "modes.csv"};
    postures << "posture,x_mm,y_mm,z_mm\n";
    modes << "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n";
    for (int i = 0; i < 9; ++i) {
      const int column = i % 3, row = i / 3;
      postures << i + 1 << ',' << 50 * column << ',' << 50 * row << ",0\n";
      const double angle = (20.0 + 25.0 * column) * std::numbers::pi / 180.0;
      modes << i + 1 << ",1," << 490 + 4 * row << ",0.03,2.2e6," << std::cos(angle) << ',' << std::sin(angle) << ",0\n";
      modes << i + 1 << ",2,530,0.03,6e6," << -std::sin(angle) << ',' << std::cos(angle) << ",0\n";
    }
    std::ofstream{path() / "cell.toml"} << R"([tool]
shape = "end"
diameter_mm = 20.0
teeth = 2
[material]
name = "AL7075"
ktc_mpa = 800.0
krc_mpa = 300.0
[cut]
milling = "down"
radial_depth_mm = 8.0
axial_depth_mm = 0.5
feed_per_tooth_mm = 0.1
spindle_speed_rpm = 3300
feed_direction_deg = 0.0
[spindle]
min_rpm = 2800
max_rpm = 3800
acceleration_rpm_per_s = 2000
jerk_rpm_per_s2 = 20000
[dynamics]
map = "map"
posture = "5"
)" << (region.empty() ? "" : "[region]\n" + region + "\n");
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

}  // namespace stillcut
