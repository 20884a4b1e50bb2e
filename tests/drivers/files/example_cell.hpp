// The example of a cell file in the contract (docs/cell-file.md describes its keys), word for word.
#pragma once

#include <algorithm>
#include <string>

#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {

inline const std::string kExampleCell = R"toml([tool]
shape = "end"              # end | ball
diameter_mm = 25.0
teeth = 2
pitch_deg = [180.0, 180.0] # * tooth spacing, default equal
helix_deg = 0.0            # *
runout_mm = 0.0            # * radial
runout_angle_deg = 0.0     # *
axial_runout_mm = 0.0      # *

[material]
name = "AL7075-T6"
ktc_mpa = 800.0            # shear coefficients
krc_mpa = 300.0
kac_mpa = 0.0              # *
kte_n_per_mm = 0.0         # * edge coefficients
kre_n_per_mm = 0.0         # *
kae_n_per_mm = 0.0         # *
process_damping_n_per_m = 0.0   # * see physics.md

[cut]                      # nominal; the robot's own messages override it live
milling = "down"           # down | up | slot
radial_depth_mm = 12.5
axial_depth_mm = 0.15
feed_per_tooth_mm = 0.05
spindle_speed_rpm = 3330
feed_direction_deg = 0.0   # from workpiece +X toward +Y
tilt_deg = 0.0             # * tool orientation, surface paper's angles
lead_deg = 0.0             # *
redundancy_deg = 0.0       # *
step_over_mm = 0.0         # * 0: the radial depth
path = "unidirectional"    # * unidirectional | zigzag

[region]                   # * what is machined, for paths and patterns
polygon_mm = [[0, 0], [300, 0], [300, 300], [0, 300]]
islands_mm = []

[spindle]
min_rpm = 2800
max_rpm = 3800
acceleration_rpm_per_s = 2000
jerk_rpm_per_s2 = 20000

[dynamics]
map = "map"                # folder: postures.csv, modes.csv
interpolation = "modal"    # modal | frf
power = 1.0                # inverse-distance power
posture = "12"             # default: a posture's id, or six joint angles in degrees

[can]
bus = "socketcan:can0"     # socketcan:IFACE | log:FILE | local:NAME
dbc = "cell.dbc"
[[can.accelerometer]]
sample_rate_hz = 25600     # per axis
x = "Vibration.X{0..9}"    # Message.Signal; {a..b} lists the samples in a frame, oldest first
y = "Vibration.Y{0..9}"
z = "Vibration.Z{0..9}"
counter = "Vibration.Counter"   # * shows lost frames; wraps at its own width
unit = "m/s^2"             # m/s^2 | g, after the DBC's scaling; an axis left out is not measured
rotation_deg = [0, 0, 0]   # * sensor to tool frame, about x, y, z in turn
[can.spindle]
speed_rpm = "Spindle.Speed"

[lcm]
url = "udpm://239.255.76.67:7667?ttl=0"

[runtime]
mode = "shadow"            # * off | shadow | active
)toml";

// The example in a folder of its own, with the files that it names.
inline std::filesystem::path write_example_cell(const TempFolder& folder, const std::string& text = kExampleCell) {
  std::filesystem::create_directories(folder.path() / "map");
  std::ofstream(folder.path() / "cell.dbc") << "VERSION \"\"\n";
  return folder.write("cell.toml", text);
}

// `text` with the first `from` replaced by `to`; throws when it is not there, so that no test runs on the wrong text.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  return text.replace(text.find(from), from.size(), to);
}

// The line, counted from 1, of the first occurrence of `word`.
inline int line_of(std::string_view text, std::string_view word) {
  const auto at = text.find(word);
  if (at == std::string_view::npos) throw std::runtime_error("not in the text: " + std::string(word));
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace stillcut
