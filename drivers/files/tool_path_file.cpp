#include "drivers/files/tool_path_file.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/cl_file.hpp"
#include "drivers/files/cl_statements.hpp"
#include "drivers/files/gcode_file.hpp"
#include "drivers/files/gcode_words.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/text_file.hpp"

namespace stillcut {
namespace {

constexpr std::array<std::string_view, 5> kGcodeEndings{".nc", ".ngc", ".gcode", ".tap", ".cnc"};
constexpr std::array<std::string_view, 4> kClEndings{".cl", ".cls", ".apt", ".aptsource"};
constexpr std::array<std::string_view, 14> kFirstClWords{"PARTNO", "PPRINT", "MACHIN", "TOOL PATH", "UNITS",
                                                         "MULTAX", "CUTTER", "TLDATA", "LOADTL",    "MSYS",
                                                         "FROM",   "FEDRAT", "SPINDL", "GOTO"};

template <class Names>
bool is_among(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool begins_as_cutter_locations(std::string_view text, const std::string& file) {
  try {
    ClStatement statement;
    int line = 0;
    return next_cl_statement(text, file, line, statement) && is_among(kFirstClWords, statement.word);
  } catch (const InputError&) {
    return false;
  }
}

bool begins_as_gcode(std::string_view text, const std::string& file) {
  std::vector<GcodeWord> words;
  try {
    while (!text.empty()) {
      const auto end = std::min(text.find('\n'), text.size());
      const std::string_view line = text.substr(0, end);
      if (line.starts_with('%')) return true;
      read_gcode_words(line, file, 1, words);
      if (!words.empty()) return true;
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  } catch (const InputError&) {
    return false;
  }
  return false;
}

}  // namespace

ToolPath read_tool_path(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (is_among(kGcodeEndings, ending)) return read_gcode(file);
  if (is_among(kClEndings, ending)) return read_cutter_locations(file);
  if (ending == ".mpf" || ending == ".spf")
    throw InputError(file.string(), 0, "is a Sinumerik program, which is not read; post G-code (.nc) or give the .cls");
  const std::string text = read_text_file(file);
  if (begins_as_cutter_locations(text, file.string())) return parse_cutter_locations(text, file.string());
  if (begins_as_gcode(text, file.string())) return parse_gcode(text, file.string());
  throw InputError(file.string(), 0,
                   "begins neither as G-code (%, G21, N10 G0) nor as APT cutter locations (PARTNO, TOOL PATH/, GOTO/); "
                   "name it .nc or .cls if it is one");
}

}  // namespace stillcut
