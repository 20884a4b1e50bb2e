// How bad input is reported: one line that names the file, the line and what is wrong (exit 3), or the component that
// is missing and how to start it (exit 4). Thrown at start-up and by offline commands only, never on the real-time
// thread.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stillcut {

// what() is "FILE:LINE: message", or "FILE: message" when there is no line (line 0). A message quotes the user's names
// and values: a line break in one of them is shown as '?', so that the message stays one line.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, int line, const std::string& message)
      : std::runtime_error(one_line(place(file, line).append(": ").append(message))) {}

 private:
  static std::string place(std::string file, int line) {
    return line > 0 ? file.append(":").append(std::to_string(line)) : file;
  }
  static std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return text;
  }
};

// A component (CAN interface, LCM route) is missing or unreachable; what() says which and how to start it.
class ComponentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillcut
