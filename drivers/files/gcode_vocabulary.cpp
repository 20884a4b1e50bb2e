#include "drivers/files/gcode_vocabulary.hpp"

#include <algorithm>
#include <array>

namespace stillcut {
namespace {

// Polar coordinates, compensations, rotation, constant surface speed: off. Tool length: the tip is where the program
// says it is. Exact stop and blending: the path as programmed. Return of cycles: there are none.
constexpr std::array kIdleG{150, 400, 430, 490, 610, 611, 640, 690, 911, 970, 980, 990};
constexpr std::array kIdleM{0, 1, 3, 5, 6, 7, 8, 9};

struct Refusal {
  int first, last;  // codes, G in tenths
  std::string_view why;
};

constexpr std::string_view kSubprogram = "calls a subprogram or a macro; post the program without them";
constexpr std::string_view kOrigin = "moves the origin; post the path in the coordinates of one workpiece offset";
constexpr std::string_view kPosition = "goes to a place that the program does not tell; remove the line";
constexpr std::string_view kUnknown =
    "is not known to leave the tool's way as written; remove it or post without it (docs/tool-paths.md lists the "
    "words)";

constexpr std::array kRefusedG{
    Refusal{50, 59, "splines are not read; post lines and arcs"},
    Refusal{100, 109, kOrigin},
    Refusal{180, 199, "arcs are read in the XY plane only; post G17, or lines"},
    Refusal{280, 280, kPosition},
    Refusal{300, 300, kPosition},
    Refusal{410, 429, "the tool's radius moves the path; let the CAM system write the way of the tool's centre"},
    Refusal{431, 449, "tool axes are not read from G-code; post three axes with G43, or give cutter locations (.cls)"},
    Refusal{520, 520, kOrigin},
    Refusal{530, 530, kPosition},
    Refusal{650, 679, kSubprogram},
    Refusal{730, 769, "canned cycles are not read; post G0 and G1"},
    Refusal{810, 899, "canned cycles are not read; post G0 and G1"},
    Refusal{901, 901, "arc centres in absolute coordinates; post I and J from the arc's start (G91.1)"},
    Refusal{920, 929, kOrigin},
    Refusal{930, 930, "feed as inverse time; post feed per minute (G94)"},
    Refusal{960, 960, "a spindle speed that follows the radius; post G97"},
};

constexpr std::array kRefusedM{
    Refusal{4, 4, "an anti-clockwise spindle would swap up and down milling; post M3"},
    Refusal{96, 99, kSubprogram},
};

template <class Table>
std::string_view why_refused(const Table& table, int code) {
  const auto found =
      std::find_if(table.begin(), table.end(), [code](const Refusal& r) { return r.first <= code && code <= r.last; });
  return found == table.end() ? kUnknown : found->why;
}

template <class Table>
bool holds(const Table& table, int code) {
  return std::find(table.begin(), table.end(), code) != table.end();
}

}  // namespace

bool gcode_changes_nothing(int tenths) { return holds(kIdleG, tenths); }
bool mcode_changes_nothing(int code) { return holds(kIdleM, code); }

std::string_view why_gcode_is_refused(int tenths) { return why_refused(kRefusedG, tenths); }
std::string_view why_mcode_is_refused(int code) { return why_refused(kRefusedM, code); }

std::string_view why_letter_is_refused(char letter) {
  if (letter == 'A' || letter == 'B' || letter == 'C')
    return "rotary axes are not read from G-code; post three axes, or give cutter locations (.cls) for a tilted tool";
  if (letter == 'U' || letter == 'V' || letter == 'W') return "second linear axes are not read; post X, Y and Z";
  if (letter == 'K') return "arcs are read in the XY plane only; give their centre by I and J";
  return "is no word that is known; remove it or put it in a comment ( )";
}

int gcode_group(int tenths) {
  if (tenths == 0 || tenths == 10 || tenths == 20 || tenths == 30 || tenths == 800) return 1;
  if (tenths == 200 || tenths == 210) return 2;
  if (tenths == 900 || tenths == 910) return 3;
  if (tenths == 940 || tenths == 950) return 4;
  if (tenths >= 540 && tenths <= 590 && tenths % 10 == 0) return 5;
  return 0;
}

}  // namespace stillcut
