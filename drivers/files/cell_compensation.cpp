#include "drivers/files/cell_sections.hpp"
#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

constexpr double kSecondsAMinute = 60.0;
constexpr Bounds kFeedPerToothMm = from(0, 100), kCuttingSpeed = from(0, 1e5), kRpm = above(0, 1e6);

// Two keys that bound one quantity; the upper must be above the lower.
std::pair<double, double> read_window(TomlSection& section, const char* low_key, const char* high_key,
                                      const Bounds& bounds, double low_fallback, double high_fallback) {
  const double low = section.number(low_key, bounds, low_fallback);
  const double high = section.number(high_key, bounds, high_fallback);
  if (!(high > low))
    section.fail(section.has(high_key) ? high_key : low_key, std::string(low_key) + " and " + high_key +
                                                                 " leave nothing between them; give " + high_key +
                                                                 " above " + low_key);
  return {low, high};
}

void read_avoided(TomlSection& section, CompensationLimits& limits) {
  for (const auto& [low, high] : section.pairs("avoid_rpm", kRpm, kRpm)) {
    if (!(high > low))
      section.fail("avoid_rpm",
                   "a pair goes from " + csv_number(low) + " to " + csv_number(high) + "; give the lower speed first");
    if (limits.avoided_count == CompensationLimits::kMaxBands)
      section.fail("avoid_rpm", "has more than " + std::to_string(CompensationLimits::kMaxBands) +
                                    " pairs; join those that lie close together");
    limits.avoided[limits.avoided_count++] = {rpm_to_rad_s(low), rpm_to_rad_s(high)};
  }
}

}  // namespace

CompensationSettings read_compensation(TomlSection section, const std::filesystem::path& folder) {
  CompensationSettings settings;
  CompensationLimits& limits = settings.limits;
  limits.spindle_time_constant_s =
      section.number("spindle_time_constant_s", above(0, 10), limits.spindle_time_constant_s);
  read_avoided(section, limits);
  const auto [slow, fast] =
      read_window(section, "min_cutting_speed_m_per_min", "max_cutting_speed_m_per_min", kCuttingSpeed, 0.0, kInfinity);
  settings.min_cutting_speed = slow / kSecondsAMinute;
  settings.max_cutting_speed = fast / kSecondsAMinute;
  const auto [thin, thick] =
      read_window(section, "min_feed_per_tooth_mm", "max_feed_per_tooth_mm", kFeedPerToothMm, 0.0, kInfinity);
  limits.min_feed_per_tooth = thin * 1e-3;
  limits.max_feed_per_tooth = thick * 1e-3;
  limits.min_feed_override = section.number("min_feed_override", above(0, 1), limits.min_feed_override);
  limits.max_feed_override = section.number("max_feed_override", from(1, 10), limits.max_feed_override);
  limits.feed_override_rate = section.number("feed_override_per_s", above(0, 100), limits.feed_override_rate);
  limits.free_turn = deg_to_rad(section.number("free_feed_turn_deg", from(0, 180), 0.0));
  limits.turn_rate = deg_to_rad(section.number("turn_rate_deg_per_s", above(0, 3600), rad_to_deg(limits.turn_rate)));
  limits.max_variation = section.number("max_speed_variation", from(0, 0.5), limits.max_variation);
  limits.max_variation_hz = section.number("max_speed_variation_hz", above(0, 100), limits.max_variation_hz);
  limits.may_stop = section.truth("stop_request", limits.may_stop);
  if (section.has("feed_map")) {
    settings.feed_map = absolute_path(folder, section.text("feed_map"));
    check_file(section, "feed_map", settings.feed_map);
    if (limits.free_turn == 0.0)
      section.fail("feed_map",
                   "has no use while the path leaves the feed direction no freedom; set free_feed_turn_deg "
                   "above 0, or leave it out");
  }
  section.finish();
  return settings;
}

}  // namespace stillcut
