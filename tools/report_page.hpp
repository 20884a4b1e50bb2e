// The report as a page: one HTML file that holds all it needs, pictures included, without a script; well-formed XML, so
// that programs can read it too. Light and dark as the reader's system, and fit to be printed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "tools/report.hpp"

namespace stillcut {

inline constexpr std::size_t kMostReportRows = 200;  // of a table of cuts or episodes; the worst
inline constexpr std::size_t kMostReportLobes = 3;   // pictures of lobes

void write_report_page(const Report& report, std::ostream& out);

// The same figures as one object; all cuts and episodes.
nlohmann::ordered_json report_json(const Report& report);

}  // namespace stillcut
