// Slot tests for the tests of `stillcut coefficients`: a cell with the surface paper's tool, tables and recordings of
// forces that its coefficients make.
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "drivers/files/cell.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/slot_tests.hpp"

namespace stillcut {

// The demo cell with the tool of the surface paper and its coefficients.
class SlotCell : public DemoCell {
 public:
  SlotCell() {
    change("shape = \"end\"", "shape = \"ball\"\nhelix_deg = 45.0");
    change("diameter_mm = 20.0", "diameter_mm = 8.0");
    change("runout_mm = 0.004", "");
    change("radial_depth_mm = 10.0", "radial_depth_mm = 8.0");
    change("milling = \"down\"", "milling = \"slot\"");
    for (const auto& [from, to] : {std::pair{"ktc_mpa = 800.0", "ktc_mpa = 1661.8"},
                                   {"krc_mpa = 300.0", "krc_mpa = 1240.8"},
                                   {"kac_mpa = 100.0", "kac_mpa = 19.1"},
                                   {"kte_n_per_mm = 8.0", "kte_n_per_mm = 7.1"},
                                   {"kre_n_per_mm = 6.0", "kre_n_per_mm = 15.9\nkae_n_per_mm = 2.3"}})
      change(from, to);
  }
  [[nodiscard]] Cell cell() const { return read_cell(path() / "cell.toml", {.dbc = false, .bus = false}); }

  // Mean force in the feed frame.
  [[nodiscard]] Eigen::Vector3d mean(double feed_mm, double depth_mm) const {
    return slot_influence(*cell().tool, feed_mm * 1e-3, depth_mm * 1e-3) * six_coefficients(*cell().material);
  }

  [[nodiscard]] std::string table(double scale = 1.0) const {
    std::vector<SlotTest> tests;
    for (const double depth : {0.5, 1.0})
      for (const double feed : {0.02, 0.04, 0.06, 0.08, 0.1})
        tests.push_back({feed * 1e-3, depth * 1e-3, scale * mean(feed, depth)});
    std::ostringstream text;
    write_slot_tests(text, tests);
    return text.str();
  }
};

inline Finished coefficients(const DemoCell& cell, std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "coefficients", "cell.toml"};
  arguments.insert(arguments.end(), more);
  return run(arguments, cell.path());
}

struct Instrument {
  double offset = 0.0, drift = 0.0;  // N, N/s
  double entry_s = 1.0, cut_s = 3.7, end_s = 4.0;
};

// What a dynamometer shows of a slot: air, the force growing as the tool enters, tooth passing and runout in the cut,
// air; at a rate that fits no turn.
inline std::string dynamometer_recording(const Eigen::Vector3d& mean, double direction, double turn_s,
                                         const Instrument& instrument) {
  std::ostringstream text;
  text.precision(12);
  text << "time_s,fx_n,fy_n,fz_n\n";
  const double c = std::cos(direction), s = std::sin(direction);
  const Eigen::Vector3d workpiece(c * mean.x() - s * mean.y(), s * mean.x() + c * mean.y(), mean.z());
  constexpr double kRate = 5321.0, kEntryTakes = 0.4;
  for (int i = 0; i < static_cast<int>(instrument.end_s * kRate); ++i) {
    const double t = i / kRate;
    double cutting = std::clamp((t - instrument.entry_s) / kEntryTakes, 0.0, 1.0);
    if (t > instrument.cut_s) cutting = 0.0;
    const double turn = kTwoPi * t / turn_s;
    const double wave = 1.0 + 0.7 * std::cos(2.0 * turn) + 0.3 * std::cos(turn + 1.0);
    text << t;
    for (int axis = 0; axis < 3; ++axis)
      text << ',' << cutting * wave * workpiece[axis] + instrument.offset + instrument.drift * t;
    text << '\n';
  }
  return text.str();
}

inline std::string write_recordings(const SlotCell& cell, double direction, const Instrument& instrument) {
  std::string list = "file,feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm\n";
  for (const std::string feed : {"0.04", "0.07", "0.1"}) {
    (void)cell.write("slots/" + feed + ".csv",
                     dynamometer_recording(cell.mean(std::stod(feed), 1.0), direction, 0.012, instrument));
    list += feed + ".csv," + feed + ",1,5000\n";
  }
  (void)cell.write("slots/tests.csv", list);
  return list;
}

}  // namespace stillcut
