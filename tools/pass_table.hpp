// The multibody paper's four passes as one table: what the paper says beside what our passes give.
#pragma once

#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "models/huynh_depth.hpp"
#include "models/huynh_pass.hpp"

namespace stillcut {

struct PassDepths {
  double by_lobes = 0.0, in_time = 0.0,
         in_part = 0.0;  // m; infinite: stable to the largest depth asked, NaN: no such depth found
};

struct PassRun {
  HuynhPass pass;
  HuynhPassResult result;
  std::optional<PassDepths> depths;
};

// "longitudinal down"
std::string pass_name(const HuynhPass& pass);

// Of one quantity: the paper's figure (NaN: none is printed) and ours, in the order of the runs.
struct PassRow {
  std::string quantity, unit;
  std::vector<double> paper, ours;
};

// Roughness as the mean over the slices, and the lowest and highest of them in rows of their own.
std::vector<PassRow> pass_rows(const std::vector<PassRun>& runs);

// For a terminal: a line a quantity, the paper's figure in brackets where there is one.
void print_pass_table(std::ostream& out, const std::vector<PassRun>& runs, const std::vector<PassRow>& rows);

}  // namespace stillcut
