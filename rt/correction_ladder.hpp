// What to try next against this chatter, from the best founded to the last resort: a constant speed, a varying speed,
// another feed direction, less feed, a stop. Each is judged by its predicted margin and by what was tried; nothing
// predicted worse than the present setting is ever proposed. Pure function, fit for the loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/compensation_limits.hpp"
#include "rt/correction_memory.hpp"
#include "rt/cut_setting.hpp"
#include "rt/predicted_margin.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct Candidate {
  CorrectionKind kind = CorrectionKind::release;  // release: nothing is left to try
  CutSetting setting;
  int lobe = 0;                // k of n = 60 f_c / (N k); 0: from the lobes, or no speed
  bool remembered = false;     // it worked here before
  double settle_s = 0.0;       // expected decay once the setting is reached
  double margin_before = 0.0;  // a_lim/a - 1; NaN unknown
  double margin_after = 0.0;
  std::int32_t limited_by = 0;
  int confidence_percent = 0;
};

// Settings that were given time and did not help, with the depth at which: shallower they may yet.
class Attempts {
 public:
  void add(const Candidate& candidate, double axial_depth) noexcept;
  // The controller takes this kind, or does not.
  void accept(CorrectionKind kind) noexcept { accepted_ |= bit_of(kind); }
  void refuse(CorrectionKind kind) noexcept { refused_ |= bit_of(kind); }
  // The next cut is another question. But a kind that the controller has never taken while it takes others it cannot
  // do; a stop is asked for whatever it said.
  void end_cut() noexcept {
    count_ = 0;
    refused_ = accepted_ == 0 ? 0 : refused_ & ~accepted_ & ~bit_of(CorrectionKind::stop_request);
  }
  void forget_refusals() noexcept { refused_ = accepted_ = 0; }

  [[nodiscard]] bool refused(CorrectionKind kind) const noexcept { return (refused_ & bit_of(kind)) != 0; }
  [[nodiscard]] int count(CorrectionKind kind, double axial_depth) const noexcept;

  static constexpr std::size_t kMost = 16;
  struct Speeds {
    std::array<double, kMost> speed{};
    std::size_t count = 0;
  };
  [[nodiscard]] Speeds speeds(double axial_depth) const noexcept;

 private:
  struct Attempt {
    CorrectionKind kind = CorrectionKind::release;
    double speed = 0.0, axial_depth = 0.0;
  };
  std::array<Attempt, kMost> attempts_{};
  static constexpr unsigned bit_of(CorrectionKind kind) noexcept { return 1U << static_cast<unsigned>(kind); }

  std::size_t count_ = 0;
  unsigned refused_ = 0, accepted_ = 0;
};

struct ChatterSituation {
  bool structural = false;            // of the robot's structure alone: the tool's recipe n_k does not apply
  double chatter_frequency_hz = 0.0;  // NaN: no single line
  double vibration_hz = 0.0;          // the same, or of the structure; NaN: not known
  bool doubtful = false;              // faint, and predicted not to be: no reason to slow down or to stop
  bool deafened = false;              // the sensor is beyond its range: what is only better than now is not enough
  bool patience_is_out = false;       // it has chattered on for so long that only the last resort is left
  int teeth = 0;
  CutSetting present;      // as it is now: measured speed, the feed and direction that are set
  double set_speed = 0.0;  // rad/s, the setpoint that the present speed follows; the mean of a swing
  CutSetting programmed;
  Prediction prediction;
  const Remembered* remembered = nullptr;  // that worked here before
};

[[nodiscard]] Candidate next_candidate(const ChatterSituation& situation, const Attempts& attempts,
                                       const CompensationLimits& limits) noexcept;

}  // namespace stillcut
