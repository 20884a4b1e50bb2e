// The fit of the reconstructed map to Table 1: what it costs, and how a set of parameters is looked at in the search.
#pragma once

#include <vector>

#include "models/linear_cut.hpp"
#include "tests/case_study/pattern_table.hpp"
#include "tests/case_study/pocket_map.hpp"

namespace stillcut::case_study {

// Squares of the relative errors of Table 1's figures (four lowest limits, four highest, four indices), added up; and
// nothing else.
double table1_cost(const Table1& ours);

// Zeroth order with the paper's projection, coarsely (coarse_lobes.hpp), at the plate's 49 points. Speeds in rad/s.
PlateFigures coarse_figures(const LinearCut& cut, const std::vector<double>& speeds,
                            const std::vector<double>& directions_deg, const PocketParameters& parameters);

}  // namespace stillcut::case_study
