// The example cell of `stillcut surface` for tests, to be changed, and the command run on it.
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/tools/run_program.hpp"

namespace stillcut {

class SurfaceCell : public TempFolder {
 public:
  SurfaceCell() { std::filesystem::copy(EXAMPLES "/surface-cell", path(), std::filesystem::copy_options::recursive); }

  // Writes cell.toml with `from`, which must be there, replaced.
  void change(const std::string& from, const std::string& to) const {
    std::string text = content_of(path() / "cell.toml");
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("cell.toml has no '" + from + "'");
    (void)write("cell.toml", text.replace(at, from.size(), to));
  }

  // So that the tool's vibration is simulated in no time: modes that settle soon, and a shallow cut with a fast feed.
  void make_quick() const {
    (void)write("map/postures.csv", "posture,x_mm,y_mm,z_mm\nA,25,40,0\nB,50,40,0\nC,75,40,0\n");
    (void)write("map/modes.csv",
                "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
                "A,1,620,0.03,1.4e6,0.90,0.10,0.42\nA,2,840,0.03,1.6e6,0.05,0.97,0.24\n"
                "B,1,600,0.03,1.2e6,0.90,0.10,0.42\nB,2,815,0.03,1.4e6,0.05,0.97,0.24\n"
                "C,1,580,0.03,1.0e6,0.90,0.10,0.42\nC,2,790,0.03,1.2e6,0.05,0.97,0.24\n");
    change("radial_depth_mm = 0.1", "radial_depth_mm = 0.2");
    change("axial_depth_mm = 0.5", "axial_depth_mm = 0.1");
    change("feed_per_tooth_mm = 0.025", "feed_per_tooth_mm = 0.1");
  }

  // Arcs of 4 mm, 0.4 mm apart across the feed and 0.1 mm along it, their marks straight.
  void make_simple() const {
    change("runout_mm = 0.02\naxial_runout_mm = 0.005\n", "");
    change("radial_depth_mm = 0.1", "radial_depth_mm = 0.4");
    change("feed_per_tooth_mm = 0.025", "feed_per_tooth_mm = 0.1");
    change("tilt_deg = 5.0\n", "");
  }

  [[nodiscard]] Finished surface(std::initializer_list<std::string> more) const {
    std::vector<std::string> arguments{"stillcut", "surface", "cell.toml"};
    arguments.insert(arguments.end(), more);
    return run(arguments, path());
  }
};

}  // namespace stillcut
