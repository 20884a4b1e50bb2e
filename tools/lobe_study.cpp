#include "tools/lobe_study.hpp"

#include <algorithm>
#include <stdexcept>

#include "models/leave_one_out.hpp"
#include "models/linear_cut.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

// What the user stated, then what the map's own scatter tells, then the defaults.
void settle_tolerance(LobeStudy& study, const Cell& cell, const CellDynamics& dynamics) {
  const ToleranceAsked& asked = study.question.tolerance;
  std::optional<ModalScatter> scatter;
  if (!asked.frequency || !asked.damping || !asked.stiffness) {
    try {
      scatter = left_out_scatter(dynamics.map, dynamics.interpolation);
    } catch (const std::invalid_argument& error) {
      throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0, error.what());
    }
  }
  const Tolerance known{scatter.value_or(ModalScatter{})};
  study.map_scatter = scatter.has_value();
  study.tolerance = {{asked.frequency.value_or(known.modes.frequency), asked.damping.value_or(known.modes.damping),
                      asked.stiffness.value_or(known.modes.stiffness)},
                     asked.ktc.value_or(known.ktc)};
}

LobeCurve curve_of(const Cell& cell, const LobeQuestion& question, const Tolerance& tolerance,
                   const PredictedPosture& predicted, const Cut& cut, const std::function<void(double)>& progress) {
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  const std::vector<Mode>& modes = predicted.posture.modes;
  constexpr double kTracesInASearch = 20.0;  // about: the nominal lobes are searched, the samples' traced
  const double nominal_share = question.confidence
                                   ? kTracesInASearch / (kTracesInASearch + question.confidence->samples)
                                   : 1.0;  // of the work of a curve
  LobeCurve curve{predicted, cut, {}, {}, {}, {}};
  curve.limits = depth_limits(tool, material, cut, modes, question.speeds, question.settings,
                              [&](double share) { progress(nominal_share * share); });
  if (question.confidence) {
    curve.bands =
        depth_bands(tool, material, cut, modes, question.speeds, question.settings, tolerance, *question.confidence,
                    [&](double share) { progress(nominal_share + (1.0 - nominal_share) * share); });
  }
  const LinearCut linear = linear_cut(tool, material, cut);
  const std::vector<Mode> turned = modes_in_feed_frame(modes, cut.feed_direction);
  const double max_depth = question.settings.max_depth, highest = slow_beside_teeth(tool, question.speeds);
  curve.coupling = mode_coupling_limit(linear, turned, max_depth, highest);
  if (modes.size() <= kMostFloquetModes) {
    curve.undamped_coupling = undamped_mode_coupling_limit(linear, turned, max_depth, highest);
  }
  return curve;
}

}  // namespace

double slow_beside_teeth(const Tool& tool, std::span<const double> speeds) {
  return tool.teeth * *std::min_element(speeds.begin(), speeds.end());
}

LobeStudy study_lobes(const Cell& cell, const LobeQuestion& question, const std::function<void(double)>& progress) {
  const Cut& nominal = require(cell, cell.cut, "cut");
  const Tool& tool = require(cell, cell.tool, "tool");
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const std::vector<std::string> postures =
      question.postures.empty() ? std::vector<std::string>{""} : question.postures;
  const std::vector<double> directions =
      question.feed_directions.empty() ? std::vector<double>{nominal.feed_direction} : question.feed_directions;
  std::vector<PredictedPosture> predicted;
  predicted.reserve(postures.size());
  for (const std::string& asked : postures) predicted.push_back(stability_posture(cell, dynamics, asked));

  LobeStudy study;
  study.question = question;
  study.coupling_below = slow_beside_teeth(tool, question.speeds);
  if (question.confidence) settle_tolerance(study, cell, dynamics);
  const auto count = static_cast<double>(postures.size() * directions.size());
  for (const PredictedPosture& posture : predicted) {
    for (std::string& line : stability_warnings(tool, nominal, posture)) {
      std::vector<std::string>& lines = study.warnings;
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
    }
    for (const double direction : directions) {
      Cut cut = nominal;
      cut.feed_direction = direction;
      const auto done = static_cast<double>(study.curves.size());
      try {
        study.curves.push_back(curve_of(cell, question, study.tolerance, posture, cut,
                                        [&](double share) { progress((done + share) / count); }));
      } catch (const std::invalid_argument& error) {
        throw InputError(cell.file.string(), 0, error.what());
      }
    }
  }
  return study;
}

}  // namespace stillcut
