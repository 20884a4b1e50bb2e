// The guided tap test on a CAN bus: posture after posture, direction after direction, each written as it is accepted.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "tools/tap_files.hpp"

namespace stillcut {

struct LiveTapOptions {
  std::string bus;  // empty: the cell's
  std::size_t sensor = 0;
  std::vector<std::string> postures;
  std::filesystem::path places;  // a list of postures with their places; empty: none
  std::vector<HammerDirection> directions;
  int hits = 5;
  TapSettings settings;
  double highest_hz = 0.0;  // of the responses; 0: as the settings have it
  TapEstimator estimator = TapEstimator::h1;
  std::filesystem::path out;  // folder
  std::string ending = ".uff";
  UffForm form = UffForm::text;
  bool replace = false;  // what an earlier session left of these postures
};

struct TappedPosture {
  std::string posture;
  std::vector<TappedDirection> directions;
  FrequencyResponse response;
};

// Asks and tells by `answers` and `out`; notices go to standard error. Returns the postures with an accepted direction;
// ends early where the operator quits. Throws InputError (bad cell, no hammer, a log that ends, files that cannot be
// written or are there already) and ComponentError (no such bus).
std::vector<TappedPosture> tap_live(const Cell& cell, const LiveTapOptions& options, std::istream& answers,
                                    std::ostream& out);

}  // namespace stillcut
