#include "tools/terminal.hpp"

#define NCURSES_NOMACROS 1
#include <ncurses.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <ctime>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr std::array kEnding{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

// What the handlers leave for key().
volatile std::sig_atomic_t ending_signal = 0, stop_asked = 0, continued = 0;

void note_signal(int signal) {
  if (signal == SIGTSTP)
    stop_asked = 1;
  else if (signal == SIGCONT)
    continued = 1;
  else
    ending_signal = signal;
}

attr_t attributes_of(Ink ink, bool colours) {
  const auto pair = [&](short number) { return colours ? static_cast<attr_t>(COLOR_PAIR(number)) : attr_t{0}; };
  switch (ink) {
    case Ink::plain:
      return A_NORMAL;
    case Ink::strong:
      return A_BOLD;
    case Ink::faint:
      return A_DIM;
    case Ink::good:
    case Ink::caution:
    case Ink::alarm:
    case Ink::doubt:
    case Ink::advice:
      return pair(static_cast<short>(ink)) | (ink == Ink::good ? A_NORMAL : A_BOLD);
  }
  return A_NORMAL;
}

}  // namespace

struct Terminal::State {
  bool ascii = false, colours = false;
  SCREEN* screen = nullptr;
  sigset_t caught{}, before{};
  std::array<struct sigaction, kEnding.size() + 2> handlers_before{};

  static int signal_at(std::size_t i) {
    return i < kEnding.size() ? kEnding[i] : i == kEnding.size() ? SIGTSTP : SIGCONT;
  }

  void catch_signals() {
    ending_signal = 0;
    stop_asked = 0;
    continued = 0;
    sigemptyset(&caught);
    for (std::size_t i = 0; i < handlers_before.size(); ++i) sigaddset(&caught, signal_at(i));
    pthread_sigmask(SIG_BLOCK, &caught, &before);
    struct sigaction action {};
    action.sa_handler = note_signal;
    sigfillset(&action.sa_mask);
    for (std::size_t i = 0; i < handlers_before.size(); ++i) sigaction(signal_at(i), &action, &handlers_before[i]);
  }

  void release_signals() {
    for (std::size_t i = 0; i < handlers_before.size(); ++i) sigaction(signal_at(i), &handlers_before[i], nullptr);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  // As a shell expects it of ^Z: the terminal is as it was, and the process is stopped by that very signal.
  void stop() {
    stop_asked = 0;
    endwin();
    struct sigaction ours {};
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    sigaction(SIGTSTP, &usual, &ours);
    sigset_t only{};
    sigemptyset(&only);
    sigaddset(&only, SIGTSTP);
    raise(SIGTSTP);  // waits in the blocked ones
    pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
    pthread_sigmask(SIG_BLOCK, &only, nullptr);
    sigaction(SIGTSTP, &ours, nullptr);
    take_again();
  }

  // After a stop, whoever asked for it: the shell has had the terminal.
  static void take_again() {
    continued = 0;
    reset_prog_mode();
    clearok(curscr, TRUE);
    refresh();
  }
};

bool Terminal::is_there() noexcept { return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1; }

Terminal::Terminal(bool plain_ascii) : state_{std::make_unique<State>()} {
  State& s = *state_;
  // Numbers keep their dots. A shell that names no language mostly stands in a terminal that reads UTF-8.
  const char* locale = std::setlocale(LC_CTYPE, "");
  if (locale == nullptr || std::string_view(locale) == "C" || std::string_view(locale) == "POSIX")
    locale = std::setlocale(LC_CTYPE, "C.UTF-8");
  s.ascii = plain_ascii || locale == nullptr || MB_CUR_MAX < 3;
  s.catch_signals();  // first: ncurses leaves alone what is not at its default
  s.screen = newterm(nullptr, stdout, stdin);
  if (s.screen == nullptr) {
    s.release_signals();
    const char* name = std::getenv("TERM");
    throw ComponentError("the terminal '" + std::string(name != nullptr ? name : "") +
                         "' is not known here; try TERM=xterm, or --once");
  }
  set_escdelay(25);
  cbreak();
  noecho();
  nonl();
  keypad(stdscr, TRUE);
  nodelay(stdscr, TRUE);
  curs_set(0);
  s.colours = has_colors() && std::getenv("NO_COLOR") == nullptr && start_color() == OK;
  if (!s.colours) return;
  const bool own = use_default_colors() == OK;
  const short ground = own ? short{-1} : short{COLOR_BLACK};
  constexpr std::array<std::pair<Ink, short>, 5> kColours{{{Ink::good, COLOR_GREEN},
                                                           {Ink::caution, COLOR_YELLOW},
                                                           {Ink::alarm, COLOR_RED},
                                                           {Ink::doubt, COLOR_MAGENTA},
                                                           {Ink::advice, COLOR_CYAN}}};
  for (const auto& [ink, colour] : kColours) init_pair(static_cast<short>(ink), colour, ground);
}

Terminal::~Terminal() {
  // After ^S the terminal could not be given back. Linux starts only what was stopped by the same call.
  tcflow(STDOUT_FILENO, TCOOFF);
  tcflow(STDOUT_FILENO, TCOON);
  endwin();
  delscreen(state_->screen);
  state_->release_signals();
}

Terminal::Size Terminal::size() const {
  winsize now{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &now) == 0 && now.ws_col > 0 && now.ws_row > 0) return {now.ws_col, now.ws_row};
  return {getmaxx(stdscr), getmaxy(stdscr)};
}

void Terminal::draw(const std::vector<TextLine>& lines) {
  // After ^S, or on a link that is full, a frame is not worth waiting for: signals would have to wait as well.
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  if (poll(&output, 1, 0) == 0) return;
  const Size now = size();
  if (now.columns != getmaxx(stdscr) || now.rows != getmaxy(stdscr)) {
    resizeterm(now.rows, now.columns);
    clearok(curscr, TRUE);
  }
  werase(stdscr);
  const int rows = std::min(now.rows, static_cast<int>(lines.size()));
  for (int row = 0; row < rows; ++row) {
    wmove(stdscr, row, 0);
    for (const TextPiece& piece : clipped(lines[static_cast<std::size_t>(row)], now.columns)) {
      wattrset(stdscr, static_cast<int>(attributes_of(piece.ink, state_->colours)));
      const std::string text = state_->ascii ? ascii(piece.text) : piece.text;
      waddnstr(stdscr, text.data(), static_cast<int>(text.size()));
    }
  }
  wattrset(stdscr, A_NORMAL);
  wrefresh(stdscr);
}

int Terminal::key(int wait_ms) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const timespec wait{wait_ms / 1000, wait_ms % 1000 * 1'000'000L};
  const int ready = ppoll(&input, 1, &wait, &state_->before);
  if (stop_asked != 0) state_->stop();
  if (continued != 0) State::take_again();
  if (ready <= 0) return 0;
  if ((input.revents & POLLIN) == 0) ending_signal = SIGHUP;  // the terminal is gone
  const int key = wgetch(stdscr);
  if (key == ERR && (input.revents & POLLHUP) != 0) ending_signal = SIGHUP;
  if (key == '\r' || key == KEY_ENTER) return '\n';
  return key > 0 && key < 0x80 ? key : 0;
}

int Terminal::ended_by() const { return ending_signal; }

}  // namespace stillcut
