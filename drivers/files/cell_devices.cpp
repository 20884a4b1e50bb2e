#include <string_view>

#include "drivers/files/cell_sections.hpp"
#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s^2
// Of [monitor]. At 4 (6 dB) noise alone gets there now and then; what stands 400 times (26 dB) above its past needs no
// monitor.
constexpr Bounds kDetectionLimit = from(4.0, 400.0), kReleaseRatio = from(0.05, 0.9);
constexpr std::size_t kLongestInterfaceName = 15;  // IFNAMSIZ - 1

// "Message.Signal" with names as a DBC has them; the signal's may hold one {a..b} where it lists the samples in a
// frame.
bool is_signal(std::string_view text, bool lists_samples) {
  constexpr std::string_view kDigits = "0123456789";
  constexpr std::string_view kWord = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
  const auto take_all_of = [&](std::string_view letters) {
    const auto taken = text.substr(0, text.find_first_not_of(letters));
    text.remove_prefix(taken.size());
    return taken;
  };
  const auto take_name = [&] {
    const auto word = take_all_of(kWord);
    return !word.empty() && kDigits.find(word.front()) == std::string_view::npos;
  };
  const auto take_number = [&] {
    const auto digits = take_all_of(kDigits).size();
    return digits >= 1 && digits <= 3;
  };
  const auto take = [&](std::string_view token) {
    const bool there = text.starts_with(token);
    if (there) text.remove_prefix(token.size());
    return there;
  };
  if (!take_name() || !take(".") || !take_name()) return false;
  if (lists_samples && take("{")) {
    if (!take_number() || !take("..") || !take_number() || !take("}")) return false;
    take_all_of(kWord);
  }
  return text.empty();
}

std::string read_signal(TomlSection& section, std::string_view key, const std::optional<std::string>& fallback,
                        bool lists_samples) {
  std::string text = section.text(key, fallback);
  if (section.has(key) && !is_signal(text, lists_samples)) {
    section.fail(key, "\"" + text + "\" names no signal; give \"Message.Signal\"" +
                          (lists_samples ? " or, for several samples a frame, \"Message.Signal{0..9}\"" : ""));
  }
  return text;
}

AccelerometerSettings read_accelerometer(TomlSection section) {
  AccelerometerSettings sensor;
  sensor.line = section.line();
  sensor.sample_rate_hz = section.number("sample_rate_hz", above(0, 1e6));
  bool any_axis = false;
  constexpr std::array<std::string_view, 3> kAxisNames{"x", "y", "z"};
  for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
    sensor.axis[i] = read_signal(section, kAxisNames[i], "", true);
    any_axis = any_axis || !sensor.axis[i].empty();
  }
  sensor.counter = read_signal(section, "counter", "", false);
  sensor.unit_m_per_s2 = section.choice<double>("unit", {{"m/s^2", 1.0}, {"g", kStandardGravity}});
  const std::vector<double> rotation = section.numbers("rotation_deg", from(-360, 360));
  sensor.full_scale_m_per_s2 = section.number("full_scale_m_per_s2", above(0), kInfinity);
  section.finish();
  if (!any_axis) section.fail("x", "is missing, and so are y and z; give at least one axis");
  if (section.has("rotation_deg")) {
    if (rotation.size() != 3) section.fail("rotation_deg", "is not three angles; give those about x, y and z");
    for (std::size_t i = 0; i < 3; ++i) sensor.rotation[i] = deg_to_rad(rotation[i]);
  }
  return sensor;
}

HammerSettings read_hammer(TomlSection section) {
  HammerSettings hammer;
  hammer.line = section.line();
  hammer.sample_rate_hz = section.number("sample_rate_hz", above(0, 1e6));
  hammer.force = read_signal(section, "force_n", std::nullopt, true);
  hammer.counter = read_signal(section, "counter", "", false);
  hammer.full_scale_n = section.number("full_scale_n", above(0), kInfinity);
  section.finish();
  return hammer;
}

std::string read_bus(TomlSection& section, const std::filesystem::path& folder, bool needed) {
  // Where the command names another bus, the cell's need not be there.
  std::string bus = needed ? section.text("bus") : section.text("bus", "");
  if (!section.has("bus")) return bus;
  const auto colon = bus.find(':');
  const std::string kind = bus.substr(0, colon);
  const std::string name = colon == std::string::npos ? "" : bus.substr(colon + 1);
  const bool no_path = !name.empty() && name.find_first_of("/ \t") == std::string::npos;
  if (kind == "socketcan" && no_path) {
    if (name.size() > kLongestInterfaceName)
      section.fail("bus", "an interface's name has at most 15 letters; shorten it");
  } else if (kind == "log" && !name.empty()) {
    const auto file = absolute_path(folder, name);
    if (needed) check_file(section, "bus", file);
    bus = "log:" + file.string();
  } else if (kind != "local" || !no_path) {
    section.fail("bus", "\"" + bus + "\" is no bus; give socketcan:IFACE, log:FILE or local:NAME");
  }
  return bus;
}

// A posture's id as text, or coordinates as a list, which becomes the text that --posture takes ("j1,...,j6" or
// "x,y,z").
std::string read_posture(TomlSection& section) {
  if (!section.is_list("posture")) return section.text("posture", "");
  const std::vector<double> coordinates = section.numbers("posture", kAnyNumber);
  if (coordinates.size() != 6 && coordinates.size() != 3) {
    section.fail("posture", "is a list of " + std::to_string(coordinates.size()) +
                                " numbers; give an id in quotes, six joint angles in degrees, or x, y, z in mm");
  }
  std::string text;
  for (const double coordinate : coordinates) text.append(text.empty() ? "" : ",").append(csv_number(coordinate));
  return text;
}

}  // namespace

std::filesystem::path absolute_path(const std::filesystem::path& folder, const std::string& path) {
  return (folder / path).lexically_normal();
}

void check_file(const TomlSection& section, std::string_view key, const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) section.fail(key, "no file " + file.string() + "; correct the path");
  if (std::filesystem::is_directory(file, error)) section.fail(key, file.string() + " is a folder; name a file in it");
}

DynamicsSettings read_dynamics(TomlSection section, const std::filesystem::path& folder, const CellNeeds& needs) {
  DynamicsSettings dynamics;
  const std::string map = section.text("map");
  dynamics.interpolation = section.choice<InterpolationKind>(
      "interpolation",
      {{"modal", InterpolationKind::modal}, {"frf", InterpolationKind::frf}, {"trend", InterpolationKind::trend}},
      InterpolationKind::modal);
  dynamics.power = section.number("power", above(0, 20), 1.0);
  dynamics.posture = read_posture(section);
  section.finish();
  if (map.empty()) section.fail("map", "is empty; name the folder of postures.csv and modes.csv");
  dynamics.map = absolute_path(folder, map);
  std::error_code error;
  if (needs.map && !std::filesystem::exists(dynamics.map, error)) {
    section.fail("map", "no folder " + dynamics.map.string() + "; correct the path");
  }
  if (needs.map && !std::filesystem::is_directory(dynamics.map, error)) {
    section.fail("map", dynamics.map.string() + " is no folder; name the folder of postures.csv and modes.csv");
  }
  return dynamics;
}

CanSettings read_can(TomlSection section, const std::filesystem::path& folder, const CellNeeds& needs) {
  CanSettings can;
  can.line = section.line();
  can.bus = read_bus(section, folder, needs.bus);
  const std::string dbc = section.text("dbc");
  for (TomlSection& sensor : section.tables("accelerometer")) {
    can.accelerometers.push_back(read_accelerometer(std::move(sensor)));
  }
  if (auto spindle = section.table("spindle")) {
    can.spindle_speed = read_signal(*spindle, "speed_rpm", std::nullopt, false);
    spindle->finish();
  }
  if (auto hammer = section.table("hammer")) can.hammer = read_hammer(std::move(*hammer));
  section.finish();
  if (can.accelerometers.size() > kMaxSensors) {
    section.fail("accelerometer", "there are " + std::to_string(can.accelerometers.size()) +
                                      " accelerometers; at most " + std::to_string(kMaxSensors) + " are read");
  }
  if (dbc.empty()) section.fail("dbc", "is empty; name the DBC file");
  can.dbc = absolute_path(folder, dbc);
  if (needs.dbc) check_file(section, "dbc", can.dbc);
  return can;
}

std::string read_lcm_url(TomlSection section, const std::string& fallback) {
  std::string url = section.text("url", fallback);
  section.finish();
  if (!url.starts_with("udpm://") && !url.starts_with("memq://") && !url.starts_with("tcpq://")) {
    section.fail("url", "\"" + url + "\" is no LCM address; give for example \"" + fallback + "\"");
  }
  return url;
}

CellRuntime read_runtime(TomlSection section) {
  const CellRuntime runtime = section.choice<CellRuntime>("mode",
                                                          {{"off", {RuntimeMode::off, false}},
                                                           {"measure", {RuntimeMode::off, true}},
                                                           {"shadow", {RuntimeMode::shadow, false}},
                                                           {"active", {RuntimeMode::active, false}}},
                                                          CellRuntime{RuntimeMode::shadow, false});
  section.finish();
  return runtime;
}

DetectionSettings read_detection(TomlSection section) {
  DetectionSettings detection;
  const double limit = section.number("limit", kDetectionLimit, kDetectionLimit.min);
  const double release_ratio = section.number("release_ratio", kReleaseRatio, kReleaseRatio.min);
  section.finish();
  if (section.has("limit")) detection.limit = limit;
  if (section.has("release_ratio")) detection.release_ratio = release_ratio;
  return detection;
}

}  // namespace stillcut
