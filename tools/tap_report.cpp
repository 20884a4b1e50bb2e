#include "tools/tap_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>

#include "tools/tap_dialog.hpp"

namespace stillcut {
namespace {

constexpr double kExcites = 0.1;      // of the strongest line of force: -20 dB
constexpr double kDoubtful = 0.9;     // a coherence below it
constexpr double kFewDoubtful = 0.2;  // of the lines: antiresonances are always among them

double seconds_at(const TapHit& hit, const std::vector<TapRecording>& recordings) {
  return static_cast<double>(hit.at) / recordings[hit.recording].sample_rate_hz;
}

// Of a file with several recordings, which.
std::size_t recording_in_file(const TapHit& hit, const std::vector<std::string>& files) {
  const auto end = files.begin() + static_cast<std::ptrdiff_t>(hit.recording);
  return 1 + static_cast<std::size_t>(std::count(files.begin(), end, files[hit.recording]));
}

}  // namespace

TapQuality quality_of(const TapEstimate& estimate) {
  TapQuality quality;
  const std::vector<double>& force = estimate.force_spectrum;
  const double least = kExcites * std::ranges::max(force);
  // From its strongest line on; what comes back behind a zero of the pulse's spectrum is no use.
  auto end = std::ranges::max_element(force);
  while (end != force.end() && *end >= least) ++end;
  const auto lines = static_cast<std::size_t>(end - force.begin());
  quality.excited_to_hz = estimate.h1.frequencies_hz[lines - 1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double>& coherence = estimate.coherence[axis];
    if (coherence.empty()) continue;
    AxisQuality& of_axis = quality.axes[axis];
    of_axis.measured = true;
    if (estimate.hits_used < 2) continue;
    double sum = 0.0, doubtful = 0.0;
    for (std::size_t i = 0; i < lines; ++i) {
      sum += coherence[i];
      doubtful += coherence[i] < kDoubtful ? 1.0 : 0.0;
    }
    of_axis.coherence = sum / static_cast<double>(lines);
    of_axis.doubtful = doubtful / static_cast<double>(lines);
  }
  return quality;
}

void print_quality(const TapEstimate& estimate, HammerDirection hammer, std::ostream& out) {
  const TapQuality quality = quality_of(estimate);
  std::array<char, 160> text{};
  (void)std::snprintf(text.data(), text.size(),
                      "towards %s: %zu of %zu hits used, lines %.3g Hz apart; the hammer excites up to %.0f Hz\n",
                      direction_name(hammer).c_str(), estimate.hits_used, estimate.hits.size(), estimate.resolution_hz,
                      quality.excited_to_hz);
  out << text.data();
  if (estimate.hits_used < 2) {
    out << "  coherence is not known from one hit: hit more often\n";
    return;
  }
  out << "  coherence up to there:";
  bool low = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisQuality& of_axis = quality.axes[axis];
    if (!of_axis.measured) continue;
    low = low || of_axis.doubtful > kFewDoubtful;
    (void)std::snprintf(text.data(), text.size(), " %c %.3f (below 0.9 on %.0f %% of the lines)", "xyz"[axis],
                        of_axis.coherence, 100.0 * of_axis.doubtful);
    out << text.data();
  }
  out << '\n';
  if (low)
    out << "  low: hit one point, straight, at rest, and harder; check cables and mounting; an axis along which the "
           "structure hardly moves stays low\n";
}

void print_hits(const TapEstimate& estimate, const std::vector<std::string>& files,
                const std::vector<TapRecording>& recordings, std::ostream& out) {
  for (const TapHit& hit : estimate.hits) {
    std::array<char, 64> text{};
    (void)std::snprintf(text.data(), text.size(), ": at %.3f s, %.0f N: ", seconds_at(hit, recordings), hit.peak_n);
    out << "  " << files[hit.recording];
    if (std::ranges::count(files, files[hit.recording]) > 1) out << ", recording " << recording_in_file(hit, files);
    out << text.data() << describe(hit.fault) << '\n';
  }
}

nlohmann::ordered_json taps_to_json(const TapEstimate& estimate, HammerDirection hammer,
                                    const std::vector<std::string>& files,
                                    const std::vector<TapRecording>& recordings) {
  nlohmann::ordered_json hits = nlohmann::ordered_json::array();
  for (const TapHit& hit : estimate.hits)
    hits.push_back({{"file", files[hit.recording]},
                    {"recording", recording_in_file(hit, files)},
                    {"at_s", seconds_at(hit, recordings)},
                    {"peak_n", hit.peak_n},
                    {"sound", hit.fault == TapFault::none},
                    {"verdict", describe(hit.fault)}});
  const TapQuality quality = quality_of(estimate);
  nlohmann::ordered_json coherence;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (const AxisQuality& of_axis = quality.axes[axis]; of_axis.measured)
      coherence[std::string(1, "xyz"[axis])] = {{"mean", of_axis.coherence}, {"share_below_0.9", of_axis.doubtful}};
  return {{"axis", std::string(1, "xyz"[hammer.axis])},
          {"sense", hammer.sense},
          {"hits", hits},
          {"hits_used", estimate.hits_used},
          {"resolution_hz", estimate.resolution_hz},
          {"excited_to_hz", quality.excited_to_hz},
          {"added_decay_per_s", estimate.added_decay_per_s},
          {"coherence", coherence}};
}

}  // namespace stillcut
