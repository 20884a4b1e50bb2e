#include "adapters/controller_report.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

template <class Range>
bool all_up_to(const Range& values, double most) {  // false for NaN
  return std::all_of(values.begin(), values.end(), [&](double value) { return std::abs(value) <= most; });
}

}  // namespace

const char* reason_to_doubt(const ControllerReport& report) {
  if (report.counter < 0) return "its counter is negative";
  if (!all_up_to(report.joints, kMaxReportedJoint)) return "a joint's position is no number, or beyond any machine";
  if (!all_up_to(report.position, kMaxReportedPosition)) return "the position is no number, or beyond any machine";
  double squared = 0.0;
  for (const double q : report.orientation) squared += q * q;
  if (!(std::abs(squared - 1.0) < 0.1)) return "the orientation is no rotation";
  const double speed = report.spindle_speed_rpm;
  if (!std::isnan(speed) && !(speed >= 0.0 && speed <= kMaxReportedSpeed_rpm))
    return "the spindle speed is beyond any machine";
  return nullptr;
}

std::array<double, 4> quaternion_of_zyx(double about_z, double about_y, double about_x) {
  const double cz = std::cos(0.5 * about_z), sz = std::sin(0.5 * about_z);
  const double cy = std::cos(0.5 * about_y), sy = std::sin(0.5 * about_y);
  const double cx = std::cos(0.5 * about_x), sx = std::sin(0.5 * about_x);
  return {cz * cy * cx + sz * sy * sx, cz * cy * sx - sz * sy * cx, cz * sy * cx + sz * cy * sx,
          sz * cy * cx - cz * sy * sx};
}

}  // namespace stillcut
