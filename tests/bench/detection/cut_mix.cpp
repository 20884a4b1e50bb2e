#include <array>

#include "tests/bench/detection/cut_plan.hpp"

namespace stillcut::detection {

std::string_view name(CutKind kind) {
  constexpr std::array<std::string_view, 10> kNames{"tool", "structural", "both",   "forced",      "steady",
                                                    "ramp", "entries",    "knocks", "interrupted", "deeper"};
  return kNames.at(static_cast<std::size_t>(kind));
}

CutKind mixed_kind(int index) {
  using enum CutKind;
  constexpr std::array<CutKind, 16> kMix{tool_chatter,       steady,       tool_chatter, forced_near_mode, tool_chatter,
                                         structural_chatter, tool_chatter, knocks,       tool_chatter,     interrupted,
                                         tool_chatter,       entries,      tool_chatter, both_kinds,       deeper,
                                         speed_ramp};
  return kMix[static_cast<std::size_t>(index) % kMix.size()];
}

CutKind sound_kind(int index) {
  constexpr int kFirst = static_cast<int>(CutKind::forced_near_mode), kLast = static_cast<int>(CutKind::deeper);
  return static_cast<CutKind>(kFirst + index % (kLast - kFirst + 1));
}

}  // namespace stillcut::detection
