// The result of a campaign in words and numbers: a line or a CSV row a cell, and the shares that met each criterion.
#pragma once

#include <string>
#include <vector>

#include "tests/tools/closed_loop/metrics.hpp"

namespace stillcut::campaign {

struct CellRun {
  int index = 0;
  RandomCell cell;
  RunMetrics metrics;
  std::string problem;  // why the run broke off; empty: it did not
};

struct Summary {
  std::string text;
  bool met = false;  // every criterion of the class
};

// Runs of one class.
Summary summarise(const std::vector<CellRun>& runs);

std::string line_of(const CellRun& run);
std::string settings_text(const CellRun& run);  // a line a setting that was asked for
std::string csv_header();
std::string csv_row(const CellRun& run);

}  // namespace stillcut::campaign
