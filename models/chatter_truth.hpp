// Whether a simulated cut chatters, from what the simulation itself knows: the motion of the tool point. A sound cut
// repeats every revolution, runout included; chatter does not. What does not repeat is the displacement less its mean
// at the same spindle angle in the revolutions before. It is chatter when it exceeds a few micrometres and does not
// decay over 0.4 s in which nothing disturbs the machine: the ringing after an entry, a knock or a step of depth
// decays. No monitor has a say in it.
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
  double frequency_hz = 0.0;      // of its strongest line about the peak, to 1 Hz
};

class ChatterTruth {
 public:
  static constexpr double kLimit = 3e-6;  // m: what a surface shows

  // One sample of the run: spindle angle in rad, rising, displacement of the tool point in m; time in s, rising.
  // `disturbed`: entry, exit, a blow, an abrupt change of the cut, a force from outside.
  void add(double time, double spindle_angle, const Eigen::Vector3d& displacement, bool disturbed);

  struct Millisecond {
    double peak = 0.0, fast_peak = 0.0;      // m, of what does not repeat, and of what of it is faster than 80 Hz
    double square = 0.0, fast_square = 0.0;  // m^2, sums over the samples
    int samples = 0;
    bool disturbed = false;
    bool unsettled = false;  // disturbed, or its mean still holds what was before the disturbance
  };
  [[nodiscard]] const std::vector<Millisecond>& milliseconds() const { return milliseconds_; }

  // The spells of chatter, in time; to be asked when the run is over.
  [[nodiscard]] std::vector<ChatterSpell> spells() const;

 private:
  static constexpr std::size_t kRevolutions = 4;
  struct Sample {
    double angle;
    Eigen::Vector3d displacement;
  };
  struct Unrepeated {  // one of every few samples
    double time;
    float x, y;
  };
  [[nodiscard]] Eigen::Vector3d without_repetition(double angle, const Eigen::Vector3d& displacement);
  [[nodiscard]] Eigen::Vector3d fast_part(const Eigen::Vector3d& motion, double step);
  [[nodiscard]] double strongest_line_hz(double time) const;

  std::vector<Sample> past_;                        // a ring would save memory; a run is minutes at most
  std::array<std::size_t, kRevolutions> before_{};  // sample at or before this angle, one revolution ago, two, ...
  std::vector<Millisecond> milliseconds_;
  std::array<Eigen::Vector3d, 4> slow_{
      Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
      Eigen::Vector3d::Zero()};              // what each of the high-pass filters in a row takes away
  double time_ = 0.0, settled_from_ = -1.0;  // s; spindle angle in rad
  std::vector<Unrepeated> motion_;
};

}  // namespace stillcut
