#include "tools/fit_study.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/frf_file.hpp"
#include "drivers/files/input_error.hpp"
#include "models/interpolation.hpp"
#include "models/sentence.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

// A milling machine's tool point gives way by no more and no less than this, N/m; outside, units are likely wrong.
constexpr double kSoftest = 1e4, kStiffest = 1e11;

// From more of them `frf` takes longer to judge than all modes to find; `stillcut map` tells of it.
constexpr std::size_t kFewPostures = 12;

std::string id_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// The files in the order of the map's postures, and the map without modes; what was left out goes to `doubts`.
std::vector<std::string> put_in_order(const FitQuestion& question, FitStudy& study) {
  std::vector<std::string> files = question.files;
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (id_of(files[i]) == id_of(files[j]))
        throw InputError(files[i], 0,
                         "is of posture " + id_of(files[i]) + " as " + files[j] + " is; a file a posture, by its name");
  const auto file_of = [&](const std::string& id) {
    return std::find_if(files.begin(), files.end(), [&](const std::string& file) { return id_of(file) == id; });
  };
  for (const auto& [id, unused] : question.poles_hz)
    if (file_of(id) == files.end()) throw InputError("--poles", 0, "no file is of posture " + id);
  if (question.postures.empty()) {
    study.places_known = files.size() == 1;
    for (const std::string& file : files) study.map.postures.emplace_back().id = id_of(file);
    study.doubts.emplace_back(
        study.places_known
            ? "where the posture is was not told (--postures); it stands at 0, 0, 0 in postures.csv"
            : "where the postures are was not told (--postures): postures.csv has no places, and no program takes the "
              "map until they are filled in; nothing can be said of the map between them");
    return files;
  }
  const DynamicsMap all = read_postures(question.postures);
  study.map.has_joints = all.has_joints;
  std::vector<std::string> ordered;
  std::vector<std::string>& without = study.without_responses;
  for (const Posture& posture : all.postures) {
    const auto file = file_of(posture.id);
    if (file == files.end()) {
      without.push_back(posture.id);
      continue;
    }
    study.map.postures.push_back(posture);
    ordered.push_back(*file);
  }
  for (const std::string& file : files)
    if (std::find(ordered.begin(), ordered.end(), file) == ordered.end())
      throw InputError(question.postures, 0, "has no posture " + id_of(file) + ", which " + file + " is of; add a row");
  if (!without.empty())
    study.doubts.push_back(sentence(without.size() == 1 ? "posture " : "postures from ", without.front(),
                                    without.size() == 1 ? "" : " on", " in ", question.postures,
                                    " without a file of responses, ", without.size(), " in all, left out"));
  return ordered;
}

FittedPosture fitted(const std::string& file, const FitQuestion& question,
                     const std::function<void(double)>& progress) {
  FittedPosture posture;
  posture.file = file;
  FrfFile frf = read_frf(file);
  posture.notes = std::move(frf.notes);
  posture.response = std::move(frf.response);
  IdentificationSettings settings = question.settings;
  const auto own = question.poles_hz.find(id_of(file));
  if (own != question.poles_hz.end()) settings.poles_hz = own->second;
  try {
    posture.fit = identify_modes(posture.response, settings, progress);
  } catch (const std::invalid_argument& error) {
    throw InputError(file, 0, error.what());
  }
  if (posture.fit.modes.empty())
    throw InputError(file, 0, posture.fit.doubts.empty() ? "no mode is left" : posture.fit.doubts.back());
  double compliance = 0.0;
  for (const IdentifiedMode& mode : posture.fit.modes) compliance += 1.0 / mode.mode.stiffness;
  const double stiffness = 1.0 / compliance;
  if (stiffness < kSoftest || stiffness > kStiffest)
    posture.fit.doubts.push_back(
        sentence("the tool point's stiffness would be ", stiffness, " N/m: are the responses in m/N?"));
  return posture;
}

// What the interpolation of the other programs makes of the modes, where that differs from the tracks.
void compare_matching(FitStudy& study) {
  std::size_t differing = 0;
  std::string first;
  for (const ModeTrack& match : match_modes(study.map)) {
    int number = 0;
    for (std::size_t p = 0; p < match.size(); ++p) {
      if (!match[p]) continue;
      const auto& modes = study.map.postures[p].modes;
      const auto at = std::find_if(modes.begin(), modes.end(), [&](const Mode& mode) {
        return mode.natural_frequency == match[p]->natural_frequency;
      });
      const int here = study.tracks.number[p][static_cast<std::size_t>(at - modes.begin())];
      if (number == 0) number = here;
      if (here == number) continue;
      if (differing++ == 0) first = study.map.postures[p].id;
    }
  }
  if (differing > 0)
    study.doubts.push_back(sentence(differing, differing == 1 ? " mode" : " modes", ", the first at posture ", first,
                                    ", the interpolation matches otherwise than the numbers in modes.csv"));
}

}  // namespace

FitStudy fit_map(const FitQuestion& question, const std::function<void(double)>& progress) {
  FitStudy study;
  const std::vector<std::string> files = put_in_order(question, study);
  study.postures.resize(files.size());
  std::vector<std::atomic<double>> done(files.size());
  const auto watch = [&] {
    double sum = 0.0;
    for (const auto& share : done) sum += share;
    progress(sum / static_cast<double>(files.size()));
  };
  run_tasks(
      files.size(), question.jobs,
      [&](std::size_t i) {
        study.postures[i] = fitted(files[i], question, [&](double share) { done[i] = share; });
        done[i] = 1.0;
      },
      watch);
  for (std::size_t i = 0; i < files.size(); ++i)
    for (const IdentifiedMode& mode : study.postures[i].fit.modes) study.map.postures[i].modes.push_back(mode.mode);
  study.tracks = track_modes(study.map, {.places_known = study.places_known});
  if (study.places_known && files.size() > 1) {
    study.left_out = leave_one_out(study.map, {}, {}, files.size() <= kFewPostures);
    study.next_tap = next_tap(study.map, *study.left_out);
    compare_matching(study);
  }
  for (std::string& doubt : map_doubts(study.map, study.tracks, study.left_out))
    study.doubts.push_back(std::move(doubt));
  return study;
}

}  // namespace stillcut
