#include "models/linear_cut.hpp"

#include <cmath>
#include <stdexcept>

namespace stillcut {
namespace {

// Integrals of sin^2, sin cos, cos^2, sin and cos over [from, to].
struct TrigonometricIntegrals {
  double ss, sc, cc, s, c;
};

TrigonometricIntegrals integrate(double from, double to) {
  const double half = 0.5 * (to - from);
  const double quarter_sin = 0.25 * (std::sin(2.0 * to) - std::sin(2.0 * from));
  return {half - quarter_sin, 0.25 * (std::cos(2.0 * from) - std::cos(2.0 * to)), half + quarter_sin,
          std::cos(from) - std::cos(to), std::sin(to) - std::sin(from)};
}

void require(bool holds, const char* message) {
  if (!holds) throw std::invalid_argument(message);
}

}  // namespace

LinearCut linear_cut(const Tool& tool, const Material& material, const Cut& cut) {
  require(tool.teeth >= 1, "teeth: must be at least 1");
  require(tool.pitch.empty() || tool.pitch.size() == static_cast<std::size_t>(tool.teeth),
          "pitch_deg: needs one angle a tooth");
  double turn = tool.pitch.empty() ? kTwoPi : 0.0;
  bool equal = true;
  for (const double pitch : tool.pitch) {
    require(pitch > 0.0 && std::isfinite(pitch), "pitch_deg: angles must be positive");
    turn += pitch;
    equal = equal && std::abs(pitch - kTwoPi / tool.teeth) < 1e-9;
  }
  require(std::abs(turn - kTwoPi) < 1e-6, "pitch_deg: the angles must add up to 360");
  require(std::isfinite(material.ktc) && material.ktc > 0.0, "ktc: must be positive");
  require(std::isfinite(material.krc) && std::isfinite(material.kac), "krc, kac: must be numbers");
  require(std::isfinite(material.process_damping) && material.process_damping >= 0.0,
          "process damping: must not be negative");
  require(tool.helix >= 0.0 && tool.helix < 0.5 * std::numbers::pi, "helix: must lie in [0, 90) degrees");
  LinearCut result;
  result.shape = tool.shape;
  result.teeth = tool.teeth;
  if (!equal) result.pitch = tool.pitch;
  result.immersion = immersion(cut.milling, cut.radial_depth, tool.diameter);
  result.ktc = material.ktc;
  result.krc = material.krc;
  result.kac = material.kac;
  result.process_damping = material.process_damping;
  result.radius = 0.5 * tool.diameter;
  result.lag_per_depth = std::tan(tool.helix) / result.radius;
  return result;
}

std::vector<std::string> linear_cut_warnings(const Tool& tool, const Cut& cut) {
  std::vector<std::string> lines;
  if (tool.runout > 0.0 || tool.axial_runout > 0.0) {
    lines.emplace_back("runout_mm: lobes assume that every tooth cuts; they leave runout out");
  }
  if (cut.tilt != 0.0 || cut.lead != 0.0) {
    lines.emplace_back("tilt_deg, lead_deg: lobes assume a tool axis normal to the surface; they leave the tilt out");
  }
  return lines;
}

DirectionMatrix cutting_stiffness_integral(const LinearCut& cut, double from, double to) {
  const auto [ss, sc, cc, s, c] = integrate(from, to);
  DirectionMatrix w;
  w << cut.ktc * sc + cut.krc * ss, cut.ktc * cc + cut.krc * sc,   //
      -cut.ktc * ss + cut.krc * sc, -cut.ktc * sc + cut.krc * cc,  //
      cut.kac * s, cut.kac * c;
  return w;
}

DirectionMatrix radial_projection_integral(double from, double to) {
  const auto [ss, sc, cc, s, c] = integrate(from, to);
  DirectionMatrix r;
  r << ss, sc, sc, cc, 0.0, 0.0;
  return r;
}

Eigen::Vector3d cutting_force_direction(const LinearCut& cut, double angle) {
  const double s = std::sin(angle), c = std::cos(angle);
  return {cut.ktc * c + cut.krc * s, -cut.ktc * s + cut.krc * c, cut.kac};
}

Eigen::Vector2d chip_normal(double angle) { return {std::sin(angle), std::cos(angle)}; }

}  // namespace stillcut
