// From heard chatter to proposals for the dynamics map: what `stillcut refine` computes.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/map_proposals_file.hpp"
#include "models/map_refinement.hpp"
#include "tools/cell_posture.hpp"
#include "tools/heard_chatter.hpp"

namespace stillcut {

struct RefinementStudy {
  std::size_t heard = 0;        // regenerative chatter
  std::size_t between = 0;      // of it at places where no measured posture has half of the weight
  std::size_t unexplained = 0;  // and where no shift of a single mode explains the frequency
  std::vector<ModeEvidence> evidence;
};

// Chatter between postures counts for the nearest one. Throws InputError for a cell whose lobes cannot be computed.
RefinementStudy study_refinement(const Cell& cell, const CellDynamics& dynamics, std::span<const ChatteredCut> cuts,
                                 const RefinementSettings& settings, const std::function<void(double)>& progress);

// The list with what the study proposes: it takes the place of what stood there for the same mode, but a mode whose
// proposal was rejected is not proposed again unless the new one differs by three standard errors.
std::vector<MapProposal> with_new_proposals(std::vector<MapProposal> list, const RefinementStudy& study,
                                            const DynamicsMap& map);

}  // namespace stillcut
