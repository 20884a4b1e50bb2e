#include "tools/report_words.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "tools/number_text.hpp"

namespace stillcut {
namespace {

double time_in_cut(const Report& report) {
  double sum = 0.0;
  for (const State state : {State::entry, State::cut, State::exit, State::chatter})
    sum += report.state_s.at(static_cast<std::size_t>(state));
  return sum;
}

std::string count_of(std::size_t number, const char* singular, const char* plural) {
  return std::to_string(number) + " " + (number == 1 ? singular : plural);
}

bool ended_in_cut(const ReportEpisode& episode) {
  return std::isfinite(episode.end_s) && std::isnan(episode.again_s) &&
         episode.end_note.find("cut exit") == std::string::npos;
}

// What the corrections did, for the sentence of the verdict.
std::string effect_of(const Report& report) {
  std::size_t asked = 0, followed = 0, shadow = 0, helped = 0;
  double slowest_s = 0.0;
  for (const ReportEpisode& episode : report.episodes) {
    bool answered = false;
    for (const ReportCorrection& correction : episode.corrections) {
      if (correction.first_sequence == 0) continue;
      ++asked;
      shadow += correction.mode == RuntimeMode::shadow ? 1 : 0;
      followed += correction.accepted > 0 ? 1 : 0;
      answered = answered || correction.accepted > 0;
    }
    if (!answered || !ended_in_cut(episode)) continue;
    ++helped;
    slowest_s = std::max(slowest_s, episode.end_s - episode.corrections.front().time_s);
  }
  if (asked == 0) return "; no correction was asked for";
  if (shadow == asked) return "; corrections were shown only, as the cell is in shadow mode";
  std::string text =
      "; " + std::to_string(followed) + " of " + count_of(asked, "correction was", "corrections were") + " followed";
  if (helped > 0)
    text += ", and " + count_of(helped, "episode", "episodes") + " ended in the cut, " + shown(slowest_s, 2) +
            " s after the correction" + (helped > 1 ? " at most" : "");
  return text;
}

}  // namespace

std::string shown(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::string text;
  append_fixed(text, value, decimals);
  return text;
}

std::string duration_text(double seconds) {
  if (seconds < 60.0) return shown(seconds, 1) + " s";
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string utc_text(std::int64_t stamp_ns) {
  const std::time_t seconds = stamp_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &utc);
  return text.data();
}

const char* kind_text(ChatterKind kind) {
  switch (kind) {
    case ChatterKind::regenerative:
      return "regenerative";
    case ChatterKind::structural:
      return "structural";
    case ChatterKind::unknown:
      break;
  }
  return "unknown kind";
}

const char* mode_text(RuntimeMode mode) {
  return mode == RuntimeMode::active ? "active" : mode == RuntimeMode::shadow ? "shadow" : "off";
}

std::string answer_to(const ReportCorrection& correction) {
  if (correction.first_sequence == 0) return "no stable setting known";
  if (correction.mode == RuntimeMode::shadow) return "shown only (shadow)";
  if (correction.accepted > 0) return "followed";
  if (correction.refused > 0) return correction.refusal.empty() ? "refused" : "refused: " + correction.refusal;
  return "not answered";
}

std::string end_of(const ReportEpisode& episode) {
  if (std::isnan(episode.end_s)) return "went on to the end of the recording";
  if (std::isfinite(episode.again_s))
    return "came back " + shown(episode.again_s - episode.end_s, 2) + " s after its end";
  if (!ended_in_cut(episode)) return "ended when the tool left the cut";
  if (episode.corrections.empty()) return "ended by itself in the cut";
  return "ended in the cut, " + shown(episode.end_s - episode.corrections.front().time_s, 2) + " s after " +
         (episode.corrections.size() > 1 ? "the first correction" : "the correction");
}

std::string short_end_of(const ReportEpisode& episode) {
  if (std::isnan(episode.end_s)) return "goes on";
  if (std::isfinite(episode.again_s)) return "came back";
  return ended_in_cut(episode) ? "in the cut" : "tool left";
}

ReportVerdict verdict_of(const Report& report) {
  ReportVerdict verdict;
  const double in_cut_s = time_in_cut(report);
  const std::size_t cuts = report.cuts.size();
  const auto chattering = static_cast<std::size_t>(
      std::count_if(report.cuts.begin(), report.cuts.end(), [](const ReportCut& cut) { return cut.episodes > 0; }));
  if (!report.episodes.empty()) {
    const double chatter_s = report.state_s.at(static_cast<std::size_t>(State::chatter));
    const bool all_ended = std::all_of(report.episodes.begin(), report.episodes.end(), ended_in_cut);
    verdict.gravity = all_ended ? Gravity::notable : Gravity::bad;
    verdict.text = count_of(report.episodes.size(), "episode", "episodes") + " of chatter in " +
                   std::to_string(chattering) + " of " + count_of(cuts, "cut", "cuts") + ", " +
                   duration_text(chatter_s) + " of the " + duration_text(in_cut_s) + " in the cut" + effect_of(report) +
                   ".";
  } else if (cuts > 0) {
    verdict.text = "No chatter in " + count_of(cuts, "cut", "cuts") + " (" + duration_text(in_cut_s) +
                   " in the cut); the indicator reached " + shown(report.indicator, 2) + " of the alarm limit.";
  } else {
    verdict.gravity = Gravity::notable;
    verdict.text = "No cut was recognised in " + duration_text(report.played_s) + ".";
  }
  const double blind_s = report.state_s.at(static_cast<std::size_t>(State::cannot_tell)) +
                         report.state_s.at(static_cast<std::size_t>(State::fault));
  constexpr double kWorthTelling_s = 0.5;
  if (blind_s >= kWorthTelling_s) {
    if (verdict.gravity == Gravity::good) verdict.gravity = Gravity::notable;
    verdict.text += " For " + duration_text(blind_s) + " what was heard could not be trusted: see Health.";
  }
  return verdict;
}

}  // namespace stillcut
