#include "drivers/files/sdf_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "models/surface_profiles.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kMostPoints = 65535;
constexpr std::string_view kSdfBlanks = " \t\r";

std::string_view bare_text(std::string_view text) {
  const auto first = text.find_first_not_of(kSdfBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSdfBlanks) + 1 - first);
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

class SdfReader {
 public:
  SdfReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  HeightMap read() {
    read_version();
    read_header();
    HeightMap map;
    map.along = size("NumPoints");
    map.across = size("NumProfiles");
    const std::size_t room = (text_.size() + 1) / 2;  // a digit and a blank each
    if (map.along > room || map.across > room / map.along)
      fail(line_, "has fewer heights than NumPoints times NumProfiles; is the file whole?");
    map.spacing_along = scale("Xscale");
    // Of a single profile the standard gives it no meaning.
    map.spacing_across = map.across == 1 ? map.spacing_along : scale("Yscale");
    read_heights(map, scale("Zscale"));
    return map;
  }

 private:
  struct Entry {
    std::string value;
    int line = 0;
  };

  [[noreturn]] void fail(int line, const std::string& message) const { throw InputError(file_, line, message); }

  // False at the end of the text.
  bool next_line(std::string_view& line) {
    if (text_.empty()) return false;
    const auto end = std::min(text_.find('\n'), text_.size());
    line = bare_text(text_.substr(0, end));
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++line_;
    return true;
  }

  void read_version() {
    std::string_view version;
    if (!next_line(version)) fail(0, "is empty; a surface data file begins with aISO-1.0");
    if (version.starts_with("bISO-") || version.starts_with("bBCR-"))
      fail(1, "is a binary surface data file; save it as ASCII");
    if (version != "aISO-1.0" && version != "aISO-2.0" && version != "aBCR-1.0")
      fail(1, "does not begin with aISO-1.0, aISO-2.0 or aBCR-1.0; give an ASCII surface data file");
  }

  void read_header() {
    std::string_view line;
    while (next_line(line)) {
      if (line == "*") {
        for (const char* name : {"Compression", "CheckType"})
          if (const auto entry = entries_.find(in_lower_case(name));
              entry != entries_.end() && entry->second.value != "0")
            fail(entry->second.line, std::string(name) + ": must be 0; save the file without it");
        return;
      }
      if (line.empty() || line.starts_with(';')) continue;
      const auto equals = line.find('=');
      if (equals == std::string_view::npos) fail(line_, "is no NAME = VALUE; a line of * ends the header");
      const std::string name(bare_text(line.substr(0, equals)));
      Entry entry{std::string(bare_text(line.substr(equals + 1))), line_};
      if (!entries_.emplace(in_lower_case(name), std::move(entry)).second)
        fail(line_, name + ": stands twice in the header; remove one");
    }
    fail(line_, "ends within the header; is the file whole?");
  }

  const Entry& entry(const std::string& name) const {
    const auto found = entries_.find(in_lower_case(name));
    if (found == entries_.end()) fail(0, name + ": the header lacks it; add it");
    return found->second;
  }

  std::size_t size(const std::string& name) const {
    const auto& [value, line] = entry(name);
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc{} || end != value.data() + value.size() || number == 0)
      fail(line, name + ": \"" + value + "\" is no count of points; give a whole number from 1");
    return number;
  }

  double scale(const std::string& name) const {
    const auto& [value, line] = entry(name);
    const double number = number_of(value, line, name);
    if (!(number > 0.0)) fail(line, name + ": \"" + value + "\" is not above 0; give it in m");
    return number;
  }

  double number_of(std::string_view text, int line, const std::string& name) const {
    const std::string_view digits = text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
      fail(line, name + ": \"" + std::string(text) + "\" is no number; give one with a dot as decimal point");
    return value;
  }

  void read_heights(HeightMap& map, double scale) {
    const std::size_t wanted = map.along * map.across;
    map.heights.reserve(wanted);
    bool ended = false, cut_short = false;
    std::string_view line;
    while (!ended && next_line(line)) {
      cut_short = text_.empty() && !last_line_ended();
      while (!line.empty() && !ended) {
        const auto end = std::min(line.find_first_of(kSdfBlanks), line.size());
        const std::string_view field = line.substr(0, end);
        line = bare_text(line.substr(end));
        ended = field == "*";
        if (ended) break;
        if (map.heights.size() == wanted) fail(line_, "has more heights than NumPoints times NumProfiles; mend either");
        map.heights.push_back(height(field, scale));
      }
    }
    // Some programs leave the closing * out: then the last line must be whole.
    if (map.heights.size() < wanted || (!ended && cut_short))
      fail(line_, "ends after " + std::to_string(map.heights.size()) + " of " + std::to_string(wanted) +
                      " heights; is the file whole?");
  }

  double height(std::string_view field, double scale) const {
    const std::string lower = in_lower_case(field);
    if (lower == "bad" || lower == "nan") return kNaN;
    const double value = number_of(field, line_, "height") * scale;
    if (!std::isfinite(value)) fail(line_, "height: \"" + std::string(field) + "\" is too large");
    return value;
  }

  [[nodiscard]] bool last_line_ended() const { return *(text_.data() - 1) == '\n'; }

  std::string_view text_;
  const std::string& file_;
  int line_ = 0;
  std::map<std::string, Entry> entries_;  // by their names in lower case
};

}  // namespace

HeightMap parse_sdf(std::string_view text, const std::string& file) { return SdfReader(text, file).read(); }

void write_sdf(std::ostream& out, const HeightMap& map) {
  require_sound_map(map);
  if (std::max(map.along, map.across) > kMostPoints)
    throw std::invalid_argument("a surface data file has room for 65535 points in a direction; write a CSV file");
  const std::array<std::pair<const char*, std::string>, 12> header{{{"ManufacID", "Stillcut"},
                                                                    {"CreateDate", "010119700000"},
                                                                    {"ModDate", "010119700000"},
                                                                    {"NumPoints", std::to_string(map.along)},
                                                                    {"NumProfiles", std::to_string(map.across)},
                                                                    {"Xscale", csv_number(map.spacing_along)},
                                                                    {"Yscale", csv_number(map.spacing_across)},
                                                                    {"Zscale", "1"},
                                                                    {"Zresolution", "-1"},
                                                                    {"Compression", "0"},
                                                                    {"DataType", "7"},
                                                                    {"CheckType", "0"}}};
  out << "aISO-1.0\r\n";
  for (const auto& [name, value] : header) out << name << " = " << value << "\r\n";
  out << "*\r\n";
  for (std::size_t j = 0; j < map.across; ++j) {
    for (std::size_t i = 0; i < map.along; ++i) {
      const double height = map.at(i, j);
      out << (i > 0 ? " " : "") << (std::isnan(height) ? "BAD" : csv_number(height));
    }
    out << "\r\n";
  }
  out << "*\r\n";
}

}  // namespace stillcut
