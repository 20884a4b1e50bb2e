// Numbers into text that grows, without the detour over streams: exports write millions of them.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace stillcut {

// In the shortest form that reads back as the same number; nothing for what is not finite.
template <class Number>
void append_number(std::string& text, Number value) {
  if (!std::isfinite(static_cast<double>(value))) return;
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

// With a fixed number of decimals.
inline void append_fixed(std::string& text, double value, int decimals) {
  std::array<char, 64> digits{};
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  text.append(digits.data(), end.ptr);
}

}  // namespace stillcut
