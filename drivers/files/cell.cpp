#include "drivers/files/cell.hpp"

#include "drivers/files/cell_sections.hpp"
#include "drivers/files/toml_file.hpp"
#include "drivers/files/toml_section.hpp"

namespace stillcut {

Cell read_cell(const std::filesystem::path& file, const CellNeeds& asked) {
  const toml::table table = read_toml_file(file);
  const auto folder = std::filesystem::absolute(file).parent_path();

  Cell cell;
  cell.file = file;
  TomlSection root(file.string(), "", 0, table);
  if (auto section = root.table("runtime")) {
    const CellRuntime runtime = read_runtime(*section);
    cell.mode = runtime.mode;
    cell.measures = runtime.measures;
  }
  CellNeeds needs = asked;
  needs.map = asked.map && !cell.measures;  // it is about to be measured
  if (auto section = root.table("tool")) cell.tool = read_tool(*section);
  if (auto section = root.table("material")) cell.material = read_material(*section);
  if (auto section = root.table("cut")) cell.cut = read_cut(*section, cell.tool);
  if (auto section = root.table("region")) cell.region = read_region(*section);
  if (auto section = root.table("spindle")) cell.spindle = read_spindle(*section);
  if (auto section = root.table("dynamics")) cell.dynamics = read_dynamics(*section, folder, needs);
  if (auto section = root.table("can")) cell.can = read_can(*section, folder, needs);
  if (auto section = root.table("lcm")) cell.lcm_url = read_lcm_url(*section, cell.lcm_url);
  if (auto section = root.table("monitor")) cell.detection = read_detection(*section);
  if (auto section = root.table("compensation")) cell.compensation = read_compensation(*section, folder);
  if (auto section = root.table("recording")) cell.recording = read_recording(*section, folder);
  root.finish();
  return cell;
}

}  // namespace stillcut
