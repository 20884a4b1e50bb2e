#include "rt/correction_memory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kSamePostureRad = 0.1, kSamePostureM = 0.05;  // within it the modes are the same to a few per cent
constexpr double kSameProgrammedSpeed = 0.02, kSameDirectionRad = 0.1;
constexpr double kNotMuchDeeper = 1.1;
constexpr double kSameSpeed = 0.005;  // relative, of the speed that worked

double angle_between(double a, double b) noexcept { return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi)); }

bool same_place(const CutPlace& a, const CutPlace& b) noexcept {
  bool same = std::abs(a.programmed_speed - b.programmed_speed) < kSameProgrammedSpeed * b.programmed_speed &&
              angle_between(a.feed_direction, b.feed_direction) < kSameDirectionRad;
  for (std::size_t j = 0; j < a.joints.size(); ++j)
    same = same && angle_between(a.joints[j], b.joints[j]) < kSamePostureRad;
  for (std::size_t i = 0; i < a.tcp.size(); ++i) same = same && std::abs(a.tcp[i] - b.tcp[i]) < kSamePostureM;
  return same;
}

}  // namespace

std::size_t CorrectionMemory::find(const CutPlace& place) const noexcept {
  std::size_t i = 0;
  while (i < count_ && !same_place(places_[i].place, place)) ++i;
  return i;
}

void CorrectionMemory::keep(const Remembered& worked) noexcept {
  std::size_t i = find(worked.place);
  if (i == count_) {
    i = next_;
    next_ = (next_ + 1) % kPlaces;
    count_ = std::min(count_ + 1, kPlaces);
  }
  places_[i] = worked;
}

void CorrectionMemory::forget(const CutPlace& place, double speed) noexcept {
  // Places run into one another, so several may be near; one without a programmed speed is found no more.
  for (std::size_t i = 0; i < count_; ++i) {
    Remembered& known = places_[i];
    if (same_place(known.place, place) && std::abs(known.setting.speed - speed) < kSameSpeed * speed)
      known.place.programmed_speed = 0.0;
  }
}

const Remembered* CorrectionMemory::recall(const CutPlace& place) const noexcept {
  const std::size_t i = find(place);
  if (i == count_) return nullptr;
  const bool deeper = place.axial_depth > kNotMuchDeeper * places_[i].place.axial_depth;
  return deeper ? nullptr : &places_[i];
}

}  // namespace stillcut
