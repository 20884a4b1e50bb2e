// What worked where: the spindle speeds that ended chatter, kept by posture, programmed speed and feed direction, so
// that the same corner of the next part is answered at once with what helped before. Fixed size, the oldest goes first;
// noexcept, for the loop.
#pragma once

#include <array>
#include <cstddef>

#include "rt/cut_setting.hpp"

namespace stillcut {

struct CutPlace {
  std::array<double, 6> joints{};  // rad
  std::array<double, 3> tcp{};     // m
  double programmed_speed = 0.0;   // rad/s
  double feed_direction = 0.0;     // rad, programmed
  double axial_depth = 0.0;        // m; NaN unknown
};

struct Remembered {
  CutPlace place;
  CutSetting setting;
};

class CorrectionMemory {
 public:
  static constexpr std::size_t kPlaces = 32;

  // Replaces what was known of the same place.
  void keep(const Remembered& worked) noexcept;
  // A speed (rad/s) that did not help this time; what else worked there stays.
  void forget(const CutPlace& place, double speed) noexcept;
  // Nothing where no place is near; depths deeper than the remembered one are another question.
  [[nodiscard]] const Remembered* recall(const CutPlace& place) const noexcept;

 private:
  [[nodiscard]] std::size_t find(const CutPlace& place) const noexcept;  // count_: nowhere

  std::array<Remembered, kPlaces> places_{};
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace stillcut
