#include "drivers/files/cell.hpp"

#include <string_view>

#include "drivers/files/cell_sections.hpp"
#include "drivers/files/text_file.hpp"
#include "drivers/files/toml_section.hpp"

namespace stillcut {
namespace {

// "diameter_mm: " when the line that could not be parsed begins like a key, to name it in the message.
std::string key_on_line(std::string_view text, unsigned line) {
  for (unsigned i = 1; i < line; ++i) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return "";
    text.remove_prefix(end + 1);
  }
  constexpr std::string_view kKeyLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  text.remove_prefix(std::min(text.find_first_not_of(" \t["), text.size()));
  const std::string_view key = text.substr(0, std::min(text.find_first_not_of(kKeyLetters), text.size()));
  return key.empty() ? "" : std::string(key) + ": ";
}

toml::table parse(const std::string& file, std::string_view text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const unsigned line = error.source().begin.line;
    throw InputError(file, static_cast<int>(line),
                     key_on_line(text, line) + std::string(error.description()) + "; mend this line");
  }
}

}  // namespace

Cell read_cell(const std::filesystem::path& file, const CellNeeds& needs) {
  const std::string text = read_text_file(file);
  const toml::table table = parse(file.string(), text);
  const auto folder = std::filesystem::absolute(file).parent_path();

  Cell cell;
  cell.file = file;
  TomlSection root(file.string(), "", 0, table);
  if (auto section = root.table("tool")) cell.tool = read_tool(*section);
  if (auto section = root.table("material")) cell.material = read_material(*section);
  if (auto section = root.table("cut")) cell.cut = read_cut(*section, cell.tool);
  if (auto section = root.table("region")) cell.region = read_region(*section);
  if (auto section = root.table("spindle")) cell.spindle = read_spindle(*section);
  if (auto section = root.table("dynamics")) cell.dynamics = read_dynamics(*section, folder, needs);
  if (auto section = root.table("can")) cell.can = read_can(*section, folder, needs);
  if (auto section = root.table("lcm")) cell.lcm_url = read_lcm_url(*section, cell.lcm_url);
  if (auto section = root.table("runtime")) cell.mode = read_runtime_mode(*section);
  root.finish();
  return cell;
}

}  // namespace stillcut
