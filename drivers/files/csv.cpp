#include "drivers/files/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "drivers/files/input_error.hpp"
#include "drivers/files/spelling.hpp"
#include "drivers/files/text_file.hpp"

namespace stillcut {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

// Cuts the text into rows and fields, keeping count of lines.
class Splitter {
 public:
  Splitter(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  // False at the end of the text.
  bool next(CsvRow& row) {
    skip_comments();
    if (text_.empty()) return false;
    row.line = line_;
    row.fields.clear();
    do {
      row.fields.push_back(text_.starts_with('"') ? quoted_field() : plain_field());
    } while (skip_one(','));
    if (!skip_line_end() && !text_.empty()) fail("text after the closing quote; double a quote within a field");
    return true;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, line_, message); }

  bool skip_one(char c) {
    const bool there = text_.starts_with(c);
    if (there) text_.remove_prefix(1);
    return there;
  }

  bool skip_line_end() {
    if (!text_.starts_with('\n') && !text_.starts_with("\r\n")) return false;
    skip_one('\r');
    skip_one('\n');
    ++line_;
    return true;
  }

  void skip_comments() {
    while (!text_.empty()) {
      if (text_.front() == '#') text_.remove_prefix(std::min(text_.find('\n'), text_.size()));
      if (!skip_line_end()) return;
    }
  }

  std::string plain_field() {
    std::size_t length = std::min(text_.find_first_of(",\n"), text_.size());
    std::string_view field = text_.substr(0, length);
    text_.remove_prefix(length);
    if (!text_.starts_with(',') && field.ends_with('\r')) field.remove_suffix(1);
    if (field.find('"') != std::string_view::npos) fail("a quote within a field; quote the whole field");
    return std::string(field);
  }

  std::string quoted_field() {
    const int first_line = line_;
    std::string field;
    skip_one('"');
    while (true) {
      const auto quote = text_.find('"');
      if (quote == std::string_view::npos) throw InputError(file_, first_line, "a quote is never closed; close it");
      field += text_.substr(0, quote);
      line_ += static_cast<int>(std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(quote), '\n'));
      text_.remove_prefix(quote + 1);
      if (!skip_one('"')) return field;
      field += '"';
    }
  }

  std::string_view text_;
  const std::string& file_;
  int line_ = 1;
};

}  // namespace

CsvTable::CsvTable(std::string file, int header_line, std::vector<std::string> header, std::vector<CsvRow> rows)
    : file_(std::move(file)), header_line_(header_line), header_(std::move(header)), rows_(std::move(rows)) {}

std::optional<std::size_t> CsvTable::find_column(std::string_view name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

std::size_t CsvTable::require_column(std::string_view name) const {
  if (const auto column = find_column(name)) return *column;
  throw InputError(file_, header_line_, std::string(name) + ": the header lacks this column; add it");
}

std::string CsvTable::text(const CsvRow& row, std::size_t column) const {
  return std::string(trimmed(row.fields.at(column)));
}

double CsvTable::number(const CsvRow& row, std::size_t column) const {
  const std::string field = text(row, column);
  // from_chars takes no plus sign.
  const bool plus = field.starts_with('+') && !field.starts_with("+-");
  const std::string_view digits = std::string_view(field).substr(plus ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    fail(row, column, "\"" + field + "\" is no number; give one with a dot as decimal point");
  }
  return value;
}

void CsvTable::fail(const CsvRow& row, std::size_t column, const std::string& message) const {
  throw InputError(file_, row.line, header_.at(column) + ": " + message);
}

CsvTable read_csv(const std::filesystem::path& file) { return parse_csv(read_text_file(file), file.string()); }

CsvTable parse_csv(std::string_view text, const std::string& file) {
  Splitter splitter(text, file);
  CsvRow row;
  if (!splitter.next(row)) throw InputError(file, 0, "is empty; a CSV file begins with a header row");
  const int header_line = row.line;
  std::vector<std::string> header;
  for (const std::string& name : row.fields) {
    header.emplace_back(trimmed(name));
    if (std::count(header.begin(), header.end(), header.back()) > 1) {
      throw InputError(file, header_line, header.back() + ": stands twice in the header; remove one");
    }
  }
  std::vector<CsvRow> rows;
  while (splitter.next(row)) {
    if (row.fields.size() != header.size()) {
      throw InputError(file, row.line,
                       "has " + std::to_string(row.fields.size()) + " fields, the header " +
                           std::to_string(header.size()) + "; add or remove fields");
    }
    rows.push_back(row);
  }
  return {file, header_line, std::move(header), std::move(rows)};
}

void check_column_names(const CsvTable& table, std::span<const std::string> known) {
  for (const std::string& name : table.header()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string_view meant = nearest_name(name, known);
    if (!meant.empty() && !table.find_column(meant)) {
      throw InputError(table.file(), table.header_line(),
                       name + ": unknown column; did you mean " + std::string(meant) + "?");
    }
  }
}

std::string csv_number(double value) {
  if (std::isnan(value)) return "nan";  // without the sign that some NaNs carry
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, result.ptr};
}

std::string csv_number_or_empty(double value) { return std::isnan(value) ? "" : csv_number(value); }

std::string csv_text(std::string_view text) {
  const bool plain = text.find_first_of(",\"\r\n") == std::string_view::npos && !text.starts_with('#');
  if (plain) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

void write_csv_row(std::ostream& out, std::span<const std::string> fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) out << (i > 0 ? "," : "") << fields[i];
  out << '\n';
}

}  // namespace stillcut
