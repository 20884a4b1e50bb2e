// `stillcut fit`: from measured frequency responses, a file a posture, to modes that bear the same number at every
// posture, with what the map made of them can be trusted for.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/modal_identification.hpp"
#include "models/mode_tracking.hpp"
#include "models/next_tap.hpp"

namespace stillcut {

struct FitQuestion {
  std::vector<std::string> files;  // frequency responses; the base name is the posture's id
  std::string postures;            // file that says where they are; empty: not known
  IdentificationSettings settings;
  std::map<std::string, std::vector<double>> poles_hz;  // of single postures, instead of the settings'
  int jobs = 1;
};

struct FittedPosture {
  std::string file;
  FrequencyResponse response;
  ModalFit fit;
  std::vector<std::string> notes;  // what was assumed or left out in reading
};

struct FitStudy {
  DynamicsMap map;                             // in the order of the postures file, without one in that of the files
  bool places_known = true;                    // a single posture without a place stands at 0, 0, 0
  std::vector<FittedPosture> postures;         // one each
  std::vector<std::string> without_responses;  // postures of the postures file that no file is of; left out
  ModeTracks tracks;
  std::optional<LeaveOneOut> left_out;  // where there are two postures at least, and their places are known
  std::optional<NextTap> next_tap;
  std::vector<std::string> doubts;  // of the map, whole sentences
};

// Postures are fitted on `jobs` threads. `progress` is told the share done, 0 to 1. Throws InputError, naming the file:
// two files of one posture, a file whose posture the postures file lacks, poles for a posture that is not there, what
// read_frf and read_postures refuse, and what identify_modes does.
FitStudy fit_map(const FitQuestion& question, const std::function<void(double)>& progress);

}  // namespace stillcut
