// Cell files, of all their sections; of what they name, no file is asked for.
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "drivers/files/cell.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) try {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("stillcut-fuzz-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  struct Removed {
    ~Removed() { std::filesystem::remove(file); }
  } const removed;
  const Cell cell = read_cell(file, {.map = false, .dbc = false, .bus = false});
  if (cell.tool)
    require_that(cell.tool->teeth >= 1 && std::isfinite(cell.tool->diameter) && cell.tool->diameter > 0.0,
                 "a tool has teeth and a diameter");
  if (cell.spindle) require_that(cell.spindle->min_speed <= cell.spindle->max_speed, "speeds in their order");
  return 0;
} catch (const InputError&) {
  return 0;
}
