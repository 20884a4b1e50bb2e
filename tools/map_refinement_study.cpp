#include "tools/map_refinement_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "models/linear_cut.hpp"
#include "models/modal_refit.hpp"
#include "models/posture.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

constexpr double kLeastWeight = 0.5;    // of the nearest posture
constexpr double kSameMode = 0.1;       // relative, from a predicted mode to a measured one
constexpr double kRejectedAgain = 3.0;  // standard errors

// The measured mode that a predicted one stands for; the map has none where the two are too far apart.
std::optional<std::size_t> measured_mode(const Posture& posture, const Mode& predicted) {
  std::optional<std::size_t> nearest;
  double best = kSameMode;
  for (std::size_t m = 0; m < posture.modes.size(); ++m) {
    const Mode& mode = posture.modes[m];
    double cosine = 0.0;
    for (std::size_t i = 0; i < 3; ++i) cosine += mode.direction[i] * predicted.direction[i];
    const double distance =
        std::abs(std::log(mode.natural_frequency / predicted.natural_frequency)) + 1.0 - std::abs(cosine);
    if (distance >= best) continue;
    best = distance;
    nearest = m;
  }
  return nearest;
}

std::string evidence_text(const ModeEvidence& one) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%zu times chatter, %+.2f %% ± %.2f %% of the mode's frequency",
                one.observations, 100.0 * (one.ratio - 1.0), 100.0 * one.standard_error);
  return text.data();
}

}  // namespace

RefinementStudy study_refinement(const Cell& cell, const CellDynamics& dynamics, std::span<const ChatteredCut> cuts,
                                 const RefinementSettings& settings, const std::function<void(double)>& progress) {
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  RefinementStudy study;
  std::vector<ShiftObservation> observations;
  for (const ChatteredCut& one : cuts) {
    ++study.heard;
    try {
      const std::vector<double> weights =
          inverse_distance_weights(dynamics.map, one.posture, dynamics.interpolation.power);
      const auto nearest = static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
      if (weights[nearest] < kLeastWeight) {
        ++study.between;
        continue;
      }
      const PredictedPosture predicted =
          with_few_modes(predict_posture(dynamics.map, one.posture, dynamics.interpolation));
      const std::vector<Mode>& modes = predicted.posture.modes;
      const auto shift = shift_of_mode(linear_cut(tool, material, one.cut),
                                       modes_in_feed_frame(modes, one.cut.feed_direction), one.heard);
      const auto mode = shift ? measured_mode(dynamics.map.postures[nearest], modes[shift->mode]) : std::nullopt;
      if (mode)
        observations.push_back({nearest, *mode, shift->ratio});
      else
        ++study.unexplained;
    } catch (const std::invalid_argument& error) {
      throw InputError(cell.file.string(), 0,
                       std::string("no stability lobes to hold chatter against: ") + error.what());
    }
    progress(static_cast<double>(study.heard) / static_cast<double>(cuts.size()));
  }
  study.evidence = weigh_shifts(std::move(observations), settings);
  return study;
}

std::vector<MapProposal> with_new_proposals(std::vector<MapProposal> list, const RefinementStudy& study,
                                            const DynamicsMap& map) {
  for (const ModeEvidence& one : study.evidence) {
    const Posture& posture = map.postures[one.posture];
    MapProposal proposal;
    proposal.posture = posture.id;
    proposal.mode = static_cast<int>(one.mode) + 1;
    proposal.frequency_hz = posture.modes[one.mode].natural_frequency / kTwoPi;
    proposal.proposed_frequency_hz = proposal.frequency_hz * one.ratio;
    proposal.frequency_hz_se = proposal.frequency_hz * one.standard_error;
    proposal.observations = static_cast<int>(one.observations);
    proposal.evidence = evidence_text(one);
    const auto stands =
        std::find_if(list.begin(), list.end(), [&](const MapProposal& other) { return other.id() == proposal.id(); });
    if (stands != list.end()) {
      const double change = std::abs(stands->proposed_frequency_hz - proposal.proposed_frequency_hz);
      const bool rejected_before =
          stands->status == ProposalStatus::rejected &&
          change <= kRejectedAgain * std::hypot(stands->frequency_hz_se, proposal.frequency_hz_se);
      const bool of_no_use = stands->status == ProposalStatus::open && !one.proposed;  // newer evidence takes it back
      if (of_no_use) list.erase(stands);
      if (of_no_use || rejected_before || !one.proposed) continue;
      *stands = proposal;
    } else if (one.proposed) {
      list.push_back(proposal);
    }
  }
  return list;
}

}  // namespace stillcut
