// How rough a surface is: parameters of profiles (ISO 4287) and of areas (ISO 25178-2), with their form removed first
// and, if asked, what is longer than a cutoff. Heights that are NaN are left out and counted, never guessed.
#pragma once

#include <cstddef>
#include <span>

#include "models/height_map.hpp"
#include "models/surface_form.hpp"
#include "models/surface_profiles.hpp"

namespace stillcut {

struct RoughnessSettings {
  SurfaceForm form = SurfaceForm::linear;
  double cutoff = 0.0;  // λ_c, m; 0: no filter
};

// What all of the parameters are made of, about height 0.
struct HeightStatistics {
  double mean_distance = 0.0, rms = 0.0;  // (1/n) Σ|z|, √((1/n) Σz²)
  double lowest = 0.0, highest = 0.0;     // up from 0, where the mean is
  double skewness = 0.0, kurtosis = 0.0;  // (1/n) Σz³/rms³, (1/n) Σz⁴/rms⁴; NaN where all heights are 0
  std::size_t known = 0;
};
[[nodiscard]] HeightStatistics height_statistics(std::span<const double> heights);

// In the profile's own unit. R_t is over the whole profile, R_z the mean over sampling lengths: as long as the cutoff
// where there is one, otherwise fifths (all of a profile of fewer than 25 points).
struct ProfileRoughness {
  double ra = 0.0, rq = 0.0, rt = 0.0, rz = 0.0;
  double rsk = 0.0, rku = 0.0;  // NaN for a profile that is all flat
  std::size_t unknown = 0;      // points that are NaN
};

// Throws std::invalid_argument where less than half of the points or fewer than three (four for a quadratic form) are
// known, for a spacing that is not positive, and for a cutoff that `waviness` refuses.
[[nodiscard]] ProfileRoughness profile_roughness(std::span<const double> heights, double spacing,
                                                 const RoughnessSettings& settings = {});

// Means of several profiles: of each parameter over those that have one, NaN where none has. `unknown` is of all of
// them.
[[nodiscard]] ProfileRoughness mean_of(std::span<const ProfileRoughness> profiles);

// Means over the profiles of a map, the form of each removed by itself. A profile of which too little is known is left
// out and counted; throws std::invalid_argument where no profile is left.
struct MeanRoughness {
  ProfileRoughness mean;  // unknown: of the whole map
  std::size_t profiles = 0, left_out = 0;
};
[[nodiscard]] MeanRoughness mean_roughness(const HeightMap& map, ProfileDirection direction,
                                           const RoughnessSettings& settings = {});

struct ArealRoughness {
  double sa = 0.0, sq = 0.0, sz = 0.0;  // m
  double ssk = 0.0, sku = 0.0;          // NaN for a surface that is all flat
  std::size_t unknown = 0;              // points that are NaN
};

// Throws std::invalid_argument where less than half of the points or too few for the form are known.
[[nodiscard]] ArealRoughness areal_roughness(const HeightMap& map, const RoughnessSettings& settings = {});

}  // namespace stillcut
