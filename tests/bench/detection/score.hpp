// The benchmark's table: what was wanted, what each detector reached, and whether ours met the target.
#pragma once

#include <array>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "tests/bench/detection/outcome.hpp"
#include "tools/plot.hpp"

namespace stillcut::detection {

struct Row {
  std::string measure, target, verdict;  // verdict: of the monitor; empty where nothing is asked
  std::array<std::string, kDetectors> reached;
};

std::vector<Row> score(std::span<const CutOutcome> cuts);
void print_table(std::ostream& out, std::span<const Row> rows);
void print_csv(std::ostream& out, std::span<const CutOutcome> cuts);
plot::Figure delay_figure(std::span<const CutOutcome> cuts, const std::string& title);

// Of values that may hold infinity (missed) but not NaN; NaN of none.
double percentile(std::vector<double> values, double share);

}  // namespace stillcut::detection
