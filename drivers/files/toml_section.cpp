#include "drivers/files/toml_section.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/spelling.hpp"

namespace stillcut {
namespace {

std::string type_in_words(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number with a decimal point";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string joined(const std::vector<std::string>& words) {
  std::string result;
  for (const std::string& word : words) result.append(result.empty() ? "" : ", ").append(word);
  return result;
}

}  // namespace

bool Bounds::contain(double value) const noexcept {
  return std::isfinite(value) && value <= max && (min_included ? value >= min : value > min);
}

std::string Bounds::describe() const {
  std::string words = "a number";
  if (std::isfinite(min)) words += (min_included ? " from " : " above ") + csv_number(min);
  if (std::isfinite(max)) words += (min_included ? " to " : " and up to ") + csv_number(max);
  return words;
}

TomlSection::TomlSection(std::string file, std::string name, int line, const toml::table& table)
    : file_(std::move(file)), name_(std::move(name)), line_(line), table_(&table) {}

double TomlSection::number(std::string_view key, Bounds bounds, std::optional<double> fallback) {
  const toml::node* node = find(key, !fallback);
  return node != nullptr ? checked_number(key, *node, bounds) : fallback.value_or(0.0);
}

int TomlSection::whole_number(std::string_view key, int min, int max) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return min;
  const std::string wanted = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  if (!node->is_integer()) fail_type(key, *node, wanted);
  const std::int64_t value = node->as_integer()->get();
  if (value < min || value > max) fail(key, std::to_string(value) + " is out of range; give " + wanted);
  return static_cast<int>(value);
}

std::string TomlSection::text(std::string_view key, const std::optional<std::string>& fallback) {
  const toml::node* node = find(key, !fallback);
  if (node == nullptr) return fallback.value_or("");
  if (!node->is_string()) fail_type(key, *node, "text in quotes");
  return node->as_string()->get();
}

bool TomlSection::truth(std::string_view key, std::optional<bool> fallback) {
  const toml::node* node = find(key, !fallback);
  if (node == nullptr) return fallback.value_or(false);
  if (!node->is_boolean()) fail_type(key, *node, "true or false");
  return node->as_boolean()->get();
}

std::string TomlSection::chosen_name(std::string_view key, const std::vector<std::string>& names, bool required) {
  const toml::node* node = find(key, required);
  if (node == nullptr) return "";
  const std::string wanted = "one of \"" + joined(names) + "\"";
  if (!node->is_string()) fail_type(key, *node, wanted);
  const std::string& value = node->as_string()->get();
  if (std::find(names.begin(), names.end(), value) == names.end()) {
    fail(key, "\"" + value + "\" is not known; give " + wanted);
  }
  return value;
}

std::vector<std::string> TomlSection::names(std::string_view key, const std::vector<std::string>& known) {
  std::vector<std::string> names;
  const toml::node* node = find(key, false);
  if (node == nullptr) return names;
  const std::string wanted = "a list of any of \"" + joined(known) + "\"";
  if (!node->is_array()) fail_type(key, *node, wanted);
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_string()) fail_type(key, element, wanted);
    names.push_back(element.as_string()->get());
    if (std::find(known.begin(), known.end(), names.back()) == known.end())
      fail(key, "\"" + names.back() + "\" is not known; give " + wanted);
  }
  return names;
}

std::vector<double> TomlSection::numbers(std::string_view key, Bounds bounds) {
  std::vector<double> values;
  if (const toml::node* node = find(key, false)) {
    if (!node->is_array()) fail_type(key, *node, "a list of numbers");
    for (const toml::node& element : *node->as_array()) values.push_back(checked_number(key, element, bounds));
  }
  return values;
}

std::vector<std::array<double, 2>> TomlSection::points(std::string_view key) {
  const toml::node* node = find(key, true);
  return node != nullptr ? points_in(key, *node) : std::vector<std::array<double, 2>>{};
}

std::vector<std::array<double, 2>> TomlSection::pairs(std::string_view key, Bounds first, Bounds second) {
  std::vector<std::array<double, 2>> pairs;
  const toml::node* node = find(key, false);
  if (node == nullptr) return pairs;
  const std::string wanted = "a list of pairs, [[a, b], [a, b]]";
  if (!node->is_array() || node->as_array()->empty()) fail_type(key, *node, wanted);
  for (const toml::node& element : *node->as_array()) {
    const toml::array* pair = element.as_array();
    if (pair == nullptr || pair->size() != 2) fail(key, "an entry is not a pair of numbers; give " + wanted);
    pairs.push_back({checked_number(key, (*pair)[0], first), checked_number(key, (*pair)[1], second)});
  }
  return pairs;
}

std::vector<std::vector<std::array<double, 2>>> TomlSection::lists_of_points(std::string_view key) {
  std::vector<std::vector<std::array<double, 2>>> lists;
  if (const toml::node* node = find(key, false)) {
    if (!node->is_array()) fail_type(key, *node, "a list of polygons");
    for (const toml::node& polygon : *node->as_array()) lists.push_back(points_in(key, polygon));
  }
  return lists;
}

std::optional<TomlSection> TomlSection::table(std::string_view key) {
  const toml::node* node = find(key, false);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) fail_type(key, *node, "a table, [" + full_name(key) + "]");
  return TomlSection(file_, full_name(key), static_cast<int>(node->source().begin.line), *node->as_table());
}

std::vector<TomlSection> TomlSection::tables(std::string_view key) {
  std::vector<TomlSection> sections;
  if (const toml::node* node = find(key, false)) {
    const std::string wanted = "tables, each headed [[" + full_name(key) + "]]";
    if (!node->is_array()) fail_type(key, *node, wanted);
    for (const toml::node& element : *node->as_array()) {
      if (!element.is_table()) fail_type(key, element, wanted);
      sections.emplace_back(file_, full_name(key), static_cast<int>(element.source().begin.line), *element.as_table());
    }
  }
  return sections;
}

void TomlSection::finish() const {
  for (const auto& [key, node] : *table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    const std::string_view meant = nearest_name(key.str(), known_);
    fail(key.str(), std::string("unknown ") + (node.is_table() ? "table; " : "key; ") +
                        (meant.empty() ? "remove it (known here: " + joined(known_) + ")"
                                       : "did you mean " + std::string(meant) + "?"));
  }
  if (!missing_.empty()) fail(missing_, "is missing; add it to [" + name_ + "]");
}

void TomlSection::fail(std::string_view key, const std::string& message) const {
  const auto found = table_->find(key);
  const int line = found == table_->end() ? line_ : static_cast<int>(found->first.source().begin.line);
  throw InputError(file_, line, full_name(key) + ": " + message);
}

void TomlSection::fail_type(std::string_view key, const toml::node& node, const std::string& wanted) const {
  fail(key, "is " + type_in_words(node) + "; give " + wanted);
}

const toml::node* TomlSection::find(std::string_view key, bool required) {
  known_.emplace_back(key);
  const toml::node* node = table_->get(key);
  if (node == nullptr && required && missing_.empty()) missing_ = key;
  return node;
}

double TomlSection::checked_number(std::string_view key, const toml::node& node, Bounds bounds) const {
  if (!node.is_number()) fail_type(key, node, bounds.describe());
  const double value =
      node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  if (!bounds.contain(value)) fail(key, csv_number(value) + " is out of range; give " + bounds.describe());
  return value;
}

std::vector<std::array<double, 2>> TomlSection::points_in(std::string_view key, const toml::node& node) const {
  const std::string wanted = "a polygon of at least three points, [[x, y], [x, y], [x, y]]";
  if (!node.is_array()) fail_type(key, node, wanted);
  std::vector<std::array<double, 2>> points;
  for (const toml::node& point : *node.as_array()) {
    const toml::array* pair = point.as_array();
    if (pair == nullptr || pair->size() != 2) fail(key, "a point is not a pair of numbers; give " + wanted);
    points.push_back({checked_number(key, (*pair)[0], kAnyNumber), checked_number(key, (*pair)[1], kAnyNumber)});
  }
  if (points.size() < 3) fail(key, "has " + std::to_string(points.size()) + " points; give " + wanted);
  return points;
}

std::string TomlSection::full_name(std::string_view key) const {
  return (name_.empty() ? "" : name_ + ".") + std::string(key);
}

}  // namespace stillcut
