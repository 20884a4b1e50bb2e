#include <fstream>
#include <sstream>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "tests/tools/closed_loop/random_cell.hpp"

namespace stillcut::campaign {
namespace {

constexpr int kSamplesAFrame = 10;

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

const char* milling_name(Milling milling) {
  return milling == Milling::down ? "down" : milling == Milling::up ? "up" : "slot";
}

// Ten samples of three axes in a frame, +-500 g.
std::string dbc_text() {
  std::ostringstream out;
  out << "VERSION \"\"\nNS_ :\nBS_:\nBU_: SENSOR DRIVE MONITOR\n\nBO_ 288 Vibration: 64 SENSOR\n"
         " SG_ Counter : 0|16@1+ (1,0) [0|65535] \"\" MONITOR\n";
  for (int i = 0, bit = 32; i < kSamplesAFrame; ++i)
    for (const char axis : {'X', 'Y', 'Z'}) {
      out << " SG_ " << axis << i << " : " << bit << "|16@1- (0.15,0) [0|0] \"m/s^2\" MONITOR\n";
      bit += 16;
    }
  out << "\nBO_ 304 Spindle: 8 DRIVE\n SG_ Speed : 0|32@1+ (0.15,0) [0|60000] \"rpm\" MONITOR\n\n"
         "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"reserved\",\"reserved\","
         "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
         "\"reserved\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
         "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n"
         "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
         "BA_ \"VFrameFormat\" BO_ 288 14;\nBA_ \"GenMsgCycleTime\" BO_ 304 20;\n";
  return out.str();
}

std::string cell_text(const RandomCell& cell, const std::string& map) {
  const auto number = [](double value) { return csv_number(value); };
  const auto& [name, ktc, krc, kac, kte, kre, kae, damping] = cell.material;
  std::ostringstream out;
  out << "[tool]\nshape = \"end\"\ndiameter_mm = " << number(1e3 * cell.tool.diameter)
      << "\nteeth = " << cell.tool.teeth << "\nrunout_mm = " << number(1e3 * cell.tool.runout)
      << "\n\n[material]\nname = \"" << name << "\"\nktc_mpa = " << number(1e-6 * ktc)
      << "\nkrc_mpa = " << number(1e-6 * krc) << "\nkac_mpa = " << number(1e-6 * kac)
      << "\nkte_n_per_mm = " << number(1e-3 * kte) << "\nkre_n_per_mm = " << number(1e-3 * kre)
      << "\n\n[cut]\nmilling = \"" << milling_name(cell.cut.milling)
      << "\"\nradial_depth_mm = " << number(1e3 * cell.cut.radial_depth)
      << "\naxial_depth_mm = " << number(1e3 * cell.cut.axial_depth)
      << "\nfeed_per_tooth_mm = " << number(1e3 * cell.cut.feed_per_tooth)
      << "\nspindle_speed_rpm = " << number(rad_s_to_rpm(cell.cut.spindle_speed))
      << "\nfeed_direction_deg = " << number(rad_to_deg(cell.cut.feed_direction))
      << "\n\n[spindle]\nmin_rpm = " << number(rad_s_to_rpm(cell.spindle.min_speed))
      << "\nmax_rpm = " << number(rad_s_to_rpm(cell.spindle.max_speed))
      << "\nacceleration_rpm_per_s = " << number(rad_s_to_rpm(cell.spindle.acceleration))
      << "\njerk_rpm_per_s2 = " << number(rad_s_to_rpm(cell.spindle.jerk)) << "\n\n[dynamics]\nmap = \"" << map
      << "\"\ninterpolation = \"modal\"\nposture = \"home\"\n\n"
         "[can]\nbus = \"local:campaign\"\ndbc = \"cell.dbc\"\n[[can.accelerometer]]\nsample_rate_hz = 25600\n"
         "x = \"Vibration.X{0..9}\"\ny = \"Vibration.Y{0..9}\"\nz = \"Vibration.Z{0..9}\"\n"
         "counter = \"Vibration.Counter\"\nunit = \"m/s^2\"\n[can.spindle]\nspeed_rpm = \"Spindle.Speed\"\n\n"
         "[compensation]\nspindle_time_constant_s = "
      << number(cell.controller.spindle_time_constant)
      << "\nfree_feed_turn_deg = " << number(rad_to_deg(cell.free_turn)) << '\n';
  return out.str();
}

std::string scenario_text(const RandomCell& cell) {
  std::ostringstream out;
  out << "# At " << csv_number(rad_s_to_rpm(cell.cut.spindle_speed)) << " rpm the limit is "
      << csv_number(1e3 * cell.depth_limit) << " mm, chatter at " << csv_number(cell.chatter_hz) << " Hz";
  if (cell.pocket_speed > 0.0)
    out << "; pocket at " << csv_number(rad_s_to_rpm(cell.pocket_speed)) << " rpm, margin "
        << csv_number(cell.pocket_margin);
  out << ".\ncell = \"cell.toml\"\nduration_s = " << csv_number(cell.duration)
      << "\nsensor_noise_m_per_s2 = 0.75\nseed = " << cell.seed << "\n\n[program]\naxial_depth_mm = [";
  for (std::size_t i = 0; i < cell.axial_depth.size(); ++i)
    out << (i == 0 ? "[" : ", [") << csv_number(cell.axial_depth[i].time) << ", "
        << csv_number(1e3 * cell.axial_depth[i].value) << ']';
  out << "]\n\n[controller]\ncycle_ms = " << csv_number(1e3 * cell.controller.cycle)
      << "\nlag_ms = " << csv_number(1e3 * cell.controller.lag)
      << "\nspindle_time_constant_s = " << csv_number(cell.controller.spindle_time_constant) << '\n';
  return out.str();
}

}  // namespace

void write_cell(const RandomCell& cell, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const bool machine : {false, true}) {
    const std::string map = machine ? "machine-map" : "map";
    DynamicsMap dynamics{true, {{"home", {}, {}, machine ? cell.modes : cell.map_modes}}};
    write_dynamics_map(folder / map, dynamics);
    write_text(folder / (machine ? "machine.toml" : "cell.toml"), cell_text(cell, map));
  }
  write_text(folder / "cell.dbc", dbc_text());
  write_text(folder / "scenario.toml", scenario_text(cell));
}

}  // namespace stillcut::campaign
