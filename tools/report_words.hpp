// What a report says in words: the verdict in one sentence, and what became of a correction. Shared by the page and its
// JSON.
#pragma once

#include <string>

#include "tools/report.hpp"

namespace stillcut {

enum class Gravity { good, notable, bad };

struct ReportVerdict {
  Gravity gravity = Gravity::good;
  std::string text;
};

[[nodiscard]] ReportVerdict verdict_of(const Report& report);

// "followed", "shown only (shadow)", "refused: busy", "not answered", "none known".
[[nodiscard]] std::string answer_to(const ReportCorrection& correction);

// "ended in the cut, 0.41 s after the correction", "ended when the tool left the cut", "came back 0.04 s later", ...
[[nodiscard]] std::string end_of(const ReportEpisode& episode);
// The same in a word or two, for a table.
[[nodiscard]] std::string short_end_of(const ReportEpisode& episode);

[[nodiscard]] const char* kind_text(ChatterKind kind);
[[nodiscard]] const char* mode_text(RuntimeMode mode);

// A number with so many decimals; "–" for what is not known.
[[nodiscard]] std::string shown(double value, int decimals);

// "2026-11-27 02:43:31 UTC"
[[nodiscard]] std::string utc_text(std::int64_t stamp_ns);

// "6.0 s", "12 min 5 s", "7 h 30 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace stillcut
