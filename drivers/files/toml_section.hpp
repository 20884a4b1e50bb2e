// One table of a TOML file, read key by key: each getter checks type and range and throws an InputError that names
// file, line and key ("cell.toml:3: tool.diameter_mm: -25 is out of range; give a number above 0"). finish() then
// reports keys that nobody asked for, and keys that were asked for and are missing.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stillcut {

// The numbers that a key may have; NaN and infinity are never among them.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_included = true;

  [[nodiscard]] bool contain(double value) const noexcept;
  [[nodiscard]] std::string describe() const;  // "a number above 0 and up to 1000"
};

inline constexpr Bounds kAnyNumber{};
constexpr Bounds above(double min, double max = kAnyNumber.max) { return {min, max, false}; }
constexpr Bounds from(double min, double max = kAnyNumber.max) { return {min, max, true}; }

class TomlSection {
 public:
  // `name` is the table's dotted name, empty for the file's root. The table must outlive the section.
  TomlSection(std::string file, std::string name, int line, const toml::table& table);

  // A key without fallback is required. When it is missing, the getter returns a stand-in and finish() throws: a
  // misspelt key is then reported as unknown, with the right name, and not as the missing one.
  double number(std::string_view key, Bounds bounds, std::optional<double> fallback = {});
  int whole_number(std::string_view key, int min, int max);
  std::string text(std::string_view key, const std::optional<std::string>& fallback = {});
  bool truth(std::string_view key, std::optional<bool> fallback = {});
  template <class T>
  T choice(std::string_view key, std::initializer_list<std::pair<std::string_view, T>> choices,
           std::optional<T> fallback = {});

  // Lists; empty when the key is absent.
  std::vector<std::string> names(std::string_view key, const std::vector<std::string>& known);
  std::vector<double> numbers(std::string_view key, Bounds bounds);
  std::vector<std::array<double, 2>> points(std::string_view key);                              // [[x, y], ...]
  std::vector<std::array<double, 2>> pairs(std::string_view key, Bounds first, Bounds second);  // [[a, b], ...]
  std::vector<std::vector<std::array<double, 2>>> lists_of_points(std::string_view key);        // [[[x, y], ...], ...]

  // Tables within this one; they are finished on their own.
  std::optional<TomlSection> table(std::string_view key);
  std::vector<TomlSection> tables(std::string_view key);  // [[name]]

  [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }
  [[nodiscard]] bool is_list(std::string_view key) const { return table_->get_as<toml::array>(key) != nullptr; }
  [[nodiscard]] int line() const { return line_; }

  void finish() const;

  // Throws an InputError at the key's line (at the table's when the key is absent).
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;

 private:
  const toml::node* find(std::string_view key, bool required);
  [[noreturn]] void fail_type(std::string_view key, const toml::node& node, const std::string& wanted) const;
  double checked_number(std::string_view key, const toml::node& node, Bounds bounds) const;
  std::vector<std::array<double, 2>> points_in(std::string_view key, const toml::node& node) const;
  // The value of the key, one of `names`; empty when it is absent.
  std::string chosen_name(std::string_view key, const std::vector<std::string>& names, bool required);
  [[nodiscard]] std::string full_name(std::string_view key) const;

  std::string file_;
  std::string name_;
  int line_;
  const toml::table* table_;
  std::vector<std::string> known_;  // keys asked for
  std::string missing_;             // the first required key that is absent
};

template <class T>
T TomlSection::choice(std::string_view key, std::initializer_list<std::pair<std::string_view, T>> choices,
                      std::optional<T> fallback) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.emplace_back(name);
  const auto chosen = chosen_name(key, names, !fallback);
  for (const auto& [name, value] : choices) {
    if (name == chosen) return value;
  }
  return fallback.value_or(choices.begin()->second);
}

}  // namespace stillcut
