// The tables of the case study's page, in Markdown. `cell` is the cell file of the example concerned.
#pragma once

#include <filesystem>
#include <iosfwd>

namespace stillcut::case_study {

// Table 1 beside ours by the paper's projection, the tensor with zeroth order and with Floquet: limits, indices, best
// directions, common pockets.
void print_patterns(const std::filesystem::path& cell, int jobs, std::ostream& out);

// The seven cuts of Table 2 at every point of the plate.
void print_cuts(const std::filesystem::path& cell, int jobs, std::ostream& out);

// The slender tool: peaks, limits and best directions over positions and radial depths.
void print_slender(const std::filesystem::path& cell, int jobs, std::ostream& out);

// The lobes of ZIG0 and ZIG90 at all points, by the paper's projection and by Floquet, with the paper's cuts: .svg or
// .png.
void draw_lobes(const std::filesystem::path& cell, int jobs, const std::filesystem::path& picture);

}  // namespace stillcut::case_study
