#include "models/posture.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <string>

#include "models/machining.hpp"

namespace stillcut {
namespace {

// Numbers separated by commas; empty when anything else stands there.
std::vector<double> numbers(std::string_view text) {
  std::vector<double> values;
  while (true) {
    const std::size_t comma = text.find(',');
    std::string_view field = text.substr(0, comma);
    while (!field.empty() && field.front() == ' ') field.remove_prefix(1);
    while (!field.empty() && field.back() == ' ') field.remove_suffix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) return {};
    values.push_back(value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

double posture_distance(const Posture& a, const Posture& b, bool has_joints, const JointScale& scale) {
  double sum = 0.0;
  if (has_joints) {
    for (std::size_t i = 0; i < a.joints.size(); ++i) {
      const double difference = scale[i] * std::remainder(a.joints[i] - b.joints[i], kTwoPi);
      sum += difference * difference;
    }
  } else {
    for (std::size_t i = 0; i < a.position.size(); ++i) {
      const double difference = a.position[i] - b.position[i];
      sum += difference * difference;
    }
  }
  return std::sqrt(sum);
}

std::string posture_distance_text(double distance, bool has_joints) {
  std::ostringstream text;
  text << std::setprecision(3) << (has_joints ? rad_to_deg(distance) : distance * 1e3) << (has_joints ? " deg" : " mm");
  return text.str();
}

std::vector<double> inverse_distance_weights(const DynamicsMap& map, const Posture& query, double power,
                                             const JointScale& scale) {
  if (map.postures.empty()) throw std::invalid_argument("dynamics map: it holds no posture");
  if (!(power > 0.0) || !std::isfinite(power)) throw std::invalid_argument("power: must be positive");
  std::vector<double> weights;
  for (const Posture& posture : map.postures) {
    weights.push_back(posture_distance(posture, query, map.has_joints, scale));
    if (!std::isfinite(weights.back())) throw std::invalid_argument("posture: its coordinates must be finite");
  }
  const auto nearest = std::min_element(weights.begin(), weights.end());
  const double smallest = *nearest;
  if (smallest == 0.0) {
    const auto measured = nearest - weights.begin();
    std::fill(weights.begin(), weights.end(), 0.0);
    weights[static_cast<std::size_t>(measured)] = 1.0;
    return weights;
  }
  double sum = 0.0;
  for (double& weight : weights)
    sum += weight = std::pow(smallest / weight, power);  // in units of the nearest's weight
  for (double& weight : weights) weight /= sum;
  return weights;
}

Posture find_posture(const DynamicsMap& map, std::string_view text) {
  for (const Posture& posture : map.postures) {
    if (posture.id == text) return posture;
  }
  const std::vector<double> values = numbers(text);
  Posture posture;
  posture.id = text;
  if (map.has_joints && values.size() == posture.joints.size()) {
    std::transform(values.begin(), values.end(), posture.joints.begin(), deg_to_rad);
    return posture;
  }
  if (!map.has_joints && values.size() == posture.position.size()) {
    std::transform(values.begin(), values.end(), posture.position.begin(), [](double mm) { return mm * 1e-3; });
    return posture;
  }
  throw std::invalid_argument("posture \"" + std::string(text) +
                              "\": not in the map; give the id of a measured posture or " +
                              (map.has_joints ? "six joint angles j1,...,j6 in degrees" : "x,y,z in mm"));
}

}  // namespace stillcut
