// CSV files: reading (RFC 4180 quoting, header row, line numbers kept for messages) and the formatting of fields.
#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillcut {

struct CsvRow {
  int line = 0;                     // where the row begins
  std::vector<std::string> fields;  // as many as the header has
};

// A file with a header row. CRLF and a UTF-8 byte order mark are accepted; empty lines and lines beginning with #
// skipped.
class CsvTable {
 public:
  CsvTable(std::string file, int header_line, std::vector<std::string> header, std::vector<CsvRow> rows);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::vector<std::string>& header() const { return header_; }
  [[nodiscard]] int header_line() const { return header_line_; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return rows_; }

  // Index of a column; nothing, or for require_column an InputError, when the header lacks it.
  [[nodiscard]] std::optional<std::size_t> find_column(std::string_view name) const;
  [[nodiscard]] std::size_t require_column(std::string_view name) const;

  // A field as text without surrounding blanks, or as a finite number. Throw InputError with line and column name.
  [[nodiscard]] std::string text(const CsvRow& row, std::size_t column) const;
  [[nodiscard]] double number(const CsvRow& row, std::size_t column) const;

  // Throws an InputError at the row, naming the column.
  [[noreturn]] void fail(const CsvRow& row, std::size_t column, const std::string& message) const;

 private:
  std::string file_;
  int header_line_;
  std::vector<std::string> header_;
  std::vector<CsvRow> rows_;
};

// Both throw InputError: file missing, no header, a name twice in it, a row with more or fewer fields, a quote out of
// place or never closed. `file` in parse_csv is the name used in messages.
CsvTable read_csv(const std::filesystem::path& file);
CsvTable parse_csv(std::string_view text, const std::string& file);

// A column of the user's own is ignored, but one that looks like a misspelt known column, which the header lacks, is an
// InputError.
void check_column_names(const CsvTable& table, std::span<const std::string> known);

// Number in the shortest form that reads back as the same double; "nan", "inf", "-inf".
std::string csv_number(double value);
// As csv_number, but empty for NaN: not applicable.
std::string csv_number_or_empty(double value);
// Text, quoted where RFC 4180 asks for it.
std::string csv_text(std::string_view text);
// A row of finished fields (from the functions above) and its line feed.
void write_csv_row(std::ostream& out, std::span<const std::string> fields);

}  // namespace stillcut
