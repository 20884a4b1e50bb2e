// A sentence for people out of texts and numbers; numbers to six digits.
#pragma once

#include <sstream>
#include <string>

namespace stillcut {

template <typename... Parts>
[[nodiscard]] std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

}  // namespace stillcut
