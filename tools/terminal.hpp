// The whole terminal, for a program that redraws it: shows lines of styled text, tells keys, and gives the terminal
// back as it was however the program ends. ncurses is behind it, in terminal.cpp alone: its names collide with
// everyone's.
#pragma once

#include <memory>
#include <vector>

#include "tools/styled_text.hpp"

namespace stillcut {

class Terminal {
 public:
  struct Size {
    int columns = 0, rows = 0;
  };
  static constexpr int kTabKey = '\t';

  // Standard input and output are a terminal.
  static bool is_there() noexcept;

  // Takes the terminal, and keeps SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP and SIGCONT blocked but for the time that
  // key() waits: threads started after this never see them. One at a time. Throws ComponentError where TERM names no
  // known terminal. `plain_ascii`: draw with ASCII characters only.
  explicit Terminal(bool plain_ascii);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] Size size() const;

  // What is longer or wider than the terminal is not shown.
  void draw(const std::vector<TextLine>& lines);

  // The next key as a character, kTabKey or '\n', within so many milliseconds; 0: none, or one that has no character.
  // Stops the process, terminal given back, on ^Z, and takes it again afterwards.
  int key(int wait_ms);

  // The signal that asked to end, 0: none.
  [[nodiscard]] int ended_by() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace stillcut
