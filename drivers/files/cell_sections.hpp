// The sections of the cell file, each read from its TOML table and turned into SI units. All throw InputError; the
// caller finishes the file's root.
#pragma once

#include <filesystem>

#include "drivers/files/cell.hpp"
#include "drivers/files/toml_section.hpp"

namespace stillcut {

// Machining (cell_machining.cpp). A cut's radial depth is compared with the tool's diameter when the cell has a tool.
Tool read_tool(TomlSection section);
Material read_material(TomlSection section);
Cut read_cut(TomlSection section, const std::optional<Tool>& tool);
Region read_region(TomlSection section);
SpindleLimits read_spindle(TomlSection section);

// Devices and files (cell_devices.cpp). `folder` is where relative paths start.
DynamicsSettings read_dynamics(TomlSection section, const std::filesystem::path& folder, const CellNeeds& needs);
CanSettings read_can(TomlSection section, const std::filesystem::path& folder, const CellNeeds& needs);
std::string read_lcm_url(TomlSection section, const std::string& fallback);
struct CellRuntime {
  RuntimeMode mode = RuntimeMode::shadow;
  bool measures = false;
};
CellRuntime read_runtime(TomlSection section);
DetectionSettings read_detection(TomlSection section);

// A file's name from the folder, and the error where a key names none (cell_devices.cpp).
std::filesystem::path absolute_path(const std::filesystem::path& folder, const std::string& path);
void check_file(const TomlSection& section, std::string_view key, const std::filesystem::path& file);

// Corrections (cell_compensation.cpp).
CompensationSettings read_compensation(TomlSection section, const std::filesystem::path& folder);

// What is recorded (cell_recording.cpp).
RecordingSettings read_recording(TomlSection section, const std::filesystem::path& folder);

}  // namespace stillcut
