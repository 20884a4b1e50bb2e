// The cell file: one TOML file that describes a machining cell (contracts.md, "The cell file"). Reading it checks every
// key: unknown keys, wrong types and values out of range are InputErrors with file, line and key.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "models/interpolation_kind.hpp"
#include "models/machining.hpp"
#include "models/region.hpp"
#include "rt/compensation_limits.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct DynamicsSettings {
  std::filesystem::path map;  // folder, absolute
  InterpolationKind interpolation = InterpolationKind::modal;
  double power = 1.0;
  std::string posture;  // id, six joint angles in degrees, or x,y,z in mm; may be empty
};

struct AccelerometerSettings {
  double sample_rate_hz = 0.0;
  std::array<std::string, 3> axis;          // "Message.Signal{a..b}" for x, y, z; empty: not measured
  std::string counter;                      // "Message.Signal"; empty: none
  double unit_m_per_s2 = 1.0;               // 1 for m/s^2, 9.80665 for g
  std::array<double, 3> rotation{};         // rad, sensor to tool frame, about x, y, z in turn
  int line = 0;                             // where the table stands in the cell file, for messages
  double full_scale_m_per_s2 = kInfinity;   // where its range ends; infinite: as the DBC file tells
  std::string table = "can.accelerometer";  // and the keys of its axes, for messages too
  std::array<std::string, 3> axis_keys{"x", "y", "z"};
};

// The impulse hammer of tap tests, sampled together with the accelerometer.
struct HammerSettings {
  double sample_rate_hz = 0.0;
  std::string force;                // "Message.Signal{a..b}", N
  std::string counter;              // "Message.Signal"; empty: none
  double full_scale_n = kInfinity;  // where its range ends; infinite: as the DBC file tells
  int line = 0;
};

struct CanSettings {
  std::string bus;            // socketcan:IFACE | log:FILE (absolute) | local:NAME
  std::filesystem::path dbc;  // absolute
  std::vector<AccelerometerSettings> accelerometers;
  std::string spindle_speed;  // "Message.Signal"; empty: none
  int line = 0;
  std::optional<HammerSettings> hammer;  // tap tests ask for it (stillcut tap), the daemon does not
};

// How readily chatter is called. What is left out is as the monitor's own defaults have it (dsp/monitor.hpp), so that
// they stand in one place only.
struct DetectionSettings {
  std::optional<double> limit;          // of the statistic S: a line's power over its running floor
  std::optional<double> release_ratio;  // of the limit: below it chatter has ended
};

// What corrections may ask. Spindle and feed per tooth are those of their own sections.
struct CompensationSettings {
  CompensationLimits limits;
  double min_cutting_speed = 0.0, max_cutting_speed = kInfinity;  // m/s, the tool's window
  std::filesystem::path feed_map;  // absolute: which way to feed where (feed_map_file.hpp); empty: none
};

// Where and how much the daemon records (tools/recorder.hpp).
struct RecordingSettings {
  std::filesystem::path folder;                        // absolute; empty: none
  double segment_s = 60.0;                             // length of a segment
  double keep_mib = 4096.0, keep_marked_mib = 4096.0;  // bounds of all segments; the oldest go first
  double mark_before_s = 10.0, mark_after_s = 10.0;    // kept about a mark
  bool only_marks = false;                             // nothing else is kept
};

struct Cell {
  std::filesystem::path file;  // as given on the command line
  // Sections that are absent stay empty: a command asks only for what it needs, through the require_* functions.
  std::optional<Tool> tool;
  std::optional<Material> material;
  std::optional<Cut> cut;
  std::optional<Region> region;
  std::optional<SpindleLimits> spindle;
  std::optional<DynamicsSettings> dynamics;
  std::optional<CanSettings> can;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  RuntimeMode mode = RuntimeMode::shadow;
  bool measures = false;  // [runtime] mode = "measure": mode is off, and no map is asked for
  DetectionSettings detection;
  CompensationSettings compensation;
  RecordingSettings recording;
};

// The files named in a cell that must be there. A command that needs fewer says so: `lobes` needs no CAN, and `replay`
// with --can no bus: read_cell(file, {.bus = false}).
struct CellNeeds {
  bool map = true;  // the folder [dynamics] map
  bool dbc = true;  // the file [can] dbc
  bool bus = true;  // the key [can] bus and, where it is log:FILE, the file
};

// Reads and checks a cell file. Throws InputError.
Cell read_cell(const std::filesystem::path& file, const CellNeeds& needs = {});

// The section, or an InputError "FILE: [tool] is missing; CELL needs it for ..." that names it.
template <class Section>
const Section& require(const Cell& cell, const std::optional<Section>& section, const char* name) {
  if (!section) throw InputError(cell.file.string(), 0, std::string("[") + name + "] is missing; add this section");
  return *section;
}

}  // namespace stillcut
