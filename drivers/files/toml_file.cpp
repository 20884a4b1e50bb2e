#include "drivers/files/toml_file.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "drivers/files/input_error.hpp"
#include "drivers/files/text_file.hpp"

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

}  // namespace

toml::table read_toml_file(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const unsigned line = error.source().begin.line;
    throw InputError(file.string(), static_cast<int>(line),
                     key_on_line(text, line) + std::string(error.description()) + "; mend this line");
  }
}

}  // namespace stillcut
