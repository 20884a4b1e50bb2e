// Whether a simulated cut chatters, from what the simulation itself knows: the motion of the tool point. A sound cut
// repeats every revolution, runout included; chatter does not. What does not repeat is the displacement less its mean
// at the same spindle angle in the revolutions before. It is chatter when its envelope exceeds a few micrometres and
// has not decayed 0.3 s later: the ringing after an entry, a knock or a step of depth decays. No monitor has a say in
// it.
//
// One case is out of its reach: chatter that itself repeats every revolution (period doubling of a two-tooth tool)
// looks like runout.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace stillcut {

struct ChatterSpell {
  double start = 0.0, end = 0.0;  // s; end: where it has died down, or where the run ends
  bool died_down = false;         // before the end of the run
  double peak = 0.0;              // m, of the motion that does not repeat
  double frequency_hz = 0.0;      // of that motion, by its zero crossings
};

class ChatterTruth {
 public:
  static constexpr double kLimit = 3e-6;  // m: what a surface shows

  // One sample of the run: spindle angle in rad, rising, displacement of the tool point in m; time in s, rising.
  void add(double time, double spindle_angle, const Eigen::Vector3d& displacement);

  // The largest motion that does not repeat, of each millisecond so far, m.
  [[nodiscard]] const std::vector<double>& unrepeated() const { return peaks_; }

  // The spells of chatter, in time; to be asked when the run is over.
  [[nodiscard]] std::vector<ChatterSpell> spells() const;

 private:
  static constexpr std::size_t kRevolutions = 4;
  struct Sample {
    double angle;
    Eigen::Vector3d displacement;
  };
  [[nodiscard]] std::vector<double> envelope() const;
  [[nodiscard]] double frequency_hz(std::size_t from, std::size_t to) const;

  std::vector<Sample> past_;                        // a ring would save memory; a run is minutes at most
  std::array<std::size_t, kRevolutions> before_{};  // sample at or before this angle, one revolution ago, two, ...
  std::vector<double> peaks_;
  std::vector<std::array<int, 2>> crossings_;  // of zero, x and y, up to the end of each millisecond
  std::array<int, 2> crossed_{};
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
};

}  // namespace stillcut
