// The seven cuts of Table 2, judged at one point of the plate: by the lobes, the paper's and Floquet's, and by milling
// in time.
#pragma once

#include <span>

#include "drivers/files/cell.hpp"
#include "models/dynamics_map.hpp"
#include "tests/case_study/published.hpp"

namespace stillcut::case_study {

// "Marginal" was settled before a cut was looked at: the verdict turns within this share of the cut's depth.
inline constexpr double kMarginal = 0.2;

enum class Judge { paper_lobes, floquet, time };

struct CutVerdict {
  bool chatters = false;    // at the depth itself
  bool marginal = false;    // otherwise at a fifth less or a fifth more
  double chatter_hz = 0.0;  // NaN where it is stable
};

// Modes in workpiece axes.
CutVerdict judge_cut(const Cell& cell, std::span<const Mode> modes, const CutOfTable2& cut, Judge judge);

// A cut printed as stable or as chatter is met on its side of the limit, a marginal one within kMarginal of it.
bool agrees(Verdict paper, const CutVerdict& ours);

}  // namespace stillcut::case_study
