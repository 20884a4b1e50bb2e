// Feed rate and direction from the positions that a controller sends: no protocol tells them. The mean over the last
// twentieth of a second, so that the rounding of positions does not show as speed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stillcut {

class FeedMotion {
 public:
  // A position (m) at a time of the controller's clock; times that do not move on start anew.
  void add(std::int64_t clock_us, const std::array<double, 3>& position);
  void forget() { count_ = 0; }

  [[nodiscard]] double rate_m_per_s() const { return rate_; }    // in space
  [[nodiscard]] double direction() const { return direction_; }  // rad in XY; while the tool stands, the last one
  void assume(double direction) { direction_ = direction; }      // before anything has moved

 private:
  struct Place {
    std::int64_t clock_us = 0;
    std::array<double, 3> position{};
  };
  static constexpr std::size_t kPlaces = 64;
  std::array<Place, kPlaces> places_{};  // a ring; the newest is at (next_ - 1)
  std::size_t next_ = 0, count_ = 0;
  double rate_ = 0.0, direction_ = 0.0;
};

}  // namespace stillcut
