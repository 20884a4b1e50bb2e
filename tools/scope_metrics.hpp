// The state of a cell for Prometheus: its text format 0.0.4. docs/scope.md lists the metrics.
#pragma once

#include <string>

#include "tools/cell_view.hpp"

namespace stillcut {

// cell: the label `cell` of every metric. now_ns: on the clock of CellView::take.
std::string prometheus_text(const CellView& view, const std::string& cell, std::int64_t now_ns);

}  // namespace stillcut
