// `stillcut refine`: what chatter says about the dynamics map, as small corrections that wait until somebody accepts
// them.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "drivers/files/map_proposals_file.hpp"
#include "tools/cell_posture.hpp"
#include "tools/commands.hpp"
#include "tools/heard_chatter.hpp"
#include "tools/map_refinement_study.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct RefineOptions {
  std::string cell, lcm;
  std::vector<std::string> can, events, accept, reject;
  bool accepts = false, rejects = false, json = false;
  RefinementSettings settings;
};

constexpr std::array kStatusWords{"open", "accepted", "rejected"};

nlohmann::ordered_json proposal_json(const MapProposal& one) {
  return {{"id", one.id()},
          {"posture", one.posture},
          {"mode", one.mode},
          {"frequency_hz", one.frequency_hz},
          {"proposed_frequency_hz", one.proposed_frequency_hz},
          {"frequency_hz_se", one.frequency_hz_se},
          {"observations", one.observations},
          {"status", kStatusWords.at(static_cast<std::size_t>(one.status))},
          {"evidence", one.evidence}};
}

nlohmann::ordered_json proposals_json(const std::vector<MapProposal>& list) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const MapProposal& one : list) rows.push_back(proposal_json(one));
  return rows;
}

void print_proposals(const std::vector<MapProposal>& list) {
  if (list.empty()) std::cout << "no proposals\n";
  for (const MapProposal& one : list) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "%-12s %9.2f -> %9.2f Hz  %-9s %s\n", one.id().c_str(), one.frequency_hz,
                  one.proposed_frequency_hz, kStatusWords.at(static_cast<std::size_t>(one.status)),
                  one.evidence.c_str());
    std::cout << text.data();
  }
}

// The open proposals that were named; all of them where none was.
std::vector<MapProposal*> named_proposals(std::vector<MapProposal>& list, const std::vector<std::string>& ids,
                                          const std::filesystem::path& folder) {
  std::vector<MapProposal*> named;
  const auto take = [&](auto wanted) {
    const std::size_t before = named.size();
    for (MapProposal& one : list)
      if (one.status == ProposalStatus::open && wanted(one)) named.push_back(&one);
    return named.size() > before;
  };
  if (ids.empty() && !take([](const MapProposal&) { return true; }))
    throw InputError((folder / "proposals.csv").string(), 0, "has no open proposal; refine from recordings first");
  for (const std::string& id : ids)
    if (!take([&](const MapProposal& one) { return one.id() == id; }))
      throw InputError((folder / "proposals.csv").string(), 0,
                       id + ": is no open proposal; `stillcut refine CELL` lists them");
  return named;
}

void decide(const RefineOptions& options, const std::filesystem::path& folder, const DynamicsMap& map) {
  std::vector<MapProposal> list = read_map_proposals(folder);
  const std::vector<MapProposal*> named =
      named_proposals(list, options.accepts ? options.accept : options.reject, folder);
  std::filesystem::path kept;
  if (options.accepts) {
    std::vector<MapProposal> accepted;
    accepted.reserve(named.size());
    for (const MapProposal* one : named) accepted.push_back(*one);
    kept = replace_modes(folder, with_proposals(map, accepted, folder));
  }
  for (MapProposal* one : named) one->status = options.accepts ? ProposalStatus::accepted : ProposalStatus::rejected;
  write_map_proposals(folder, list);
  if (options.json) {
    std::cout << nlohmann::ordered_json{{"proposals", proposals_json(list)}, {"kept", kept.string()}}.dump() << '\n';
    return;
  }
  print_proposals(list);
  if (!kept.empty())
    std::cout << (folder / "modes.csv").string() << " is written anew, the old one is " << kept.string() << '\n';
}

std::vector<ChatteredCut> chattered_cuts(const RefineOptions& options, const Cell& cell) {
  std::vector<ChatteredCut> cuts;
  const auto add = [&](std::vector<ChatteredCut> more) { cuts.insert(cuts.end(), more.begin(), more.end()); };
  std::vector<std::string> warnings;
  for (const std::string& can : options.can)
    add(chattered_in_log(cell, {.can = can, .lcm = options.lcm, .lcm_offset_s = 0.0}, warnings));
  for (const std::string& warning : warnings) std::cerr << "stillcut: " << warning << '\n';
  for (const std::string& file : options.events) add(chattered_in_events(cell, file));
  return cuts;
}

void print_study(const RefinementStudy& study, const DynamicsMap& map) {
  std::cout << study.heard << " times regenerative chatter; " << study.between << " between postures, "
            << study.unexplained << " not explained by one mode\n";
  for (const ModeEvidence& one : study.evidence) {
    const Posture& posture = map.postures[one.posture];
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "%-12s %9.2f Hz  %3zu times  %+.2f %% ± %.2f %%  %s\n",
                  (posture.id + "/" + std::to_string(one.mode + 1)).c_str(),
                  posture.modes[one.mode].natural_frequency / kTwoPi, one.observations, 100.0 * (one.ratio - 1.0),
                  100.0 * one.standard_error, one.proposed ? "proposed" : "as it is");
    std::cout << text.data();
  }
}

nlohmann::ordered_json evidence_json(const RefinementStudy& study, const DynamicsMap& map) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ModeEvidence& one : study.evidence)
    rows.push_back({{"posture", map.postures[one.posture].id},
                    {"mode", one.mode + 1},
                    {"observations", one.observations},
                    {"shift", one.ratio - 1.0},
                    {"shift_se", one.standard_error},
                    {"proposed", one.proposed}});
  return rows;
}

void refine(const RefineOptions& options) {
  const bool listens = !options.can.empty() || !options.events.empty();
  const Cell cell = read_cell(options.cell, {.dbc = !options.can.empty(), .bus = false});
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const std::filesystem::path& folder = cell.dynamics->map;
  if (options.accepts || options.rejects) return decide(options, folder, dynamics.map);
  std::vector<MapProposal> list = read_map_proposals(folder);
  if (!listens) {
    if (options.json)
      std::cout << nlohmann::ordered_json{{"proposals", proposals_json(list)}}.dump() << '\n';
    else
      print_proposals(list);
    return;
  }
  const std::vector<ChatteredCut> cuts = chattered_cuts(options, cell);
  Progress progress("comparing");
  const RefinementStudy study =
      study_refinement(cell, dynamics, cuts, options.settings, [&](double share) { progress.update(share); });
  progress.finish();
  const bool had_any = !list.empty();
  list = with_new_proposals(std::move(list), study, dynamics.map);
  if (had_any || !list.empty()) write_map_proposals(folder, list);
  if (options.json) {
    std::cout << nlohmann::ordered_json{{"heard", study.heard},
                                        {"between_postures", study.between},
                                        {"unexplained", study.unexplained},
                                        {"evidence", evidence_json(study, dynamics.map)},
                                        {"proposals", proposals_json(list)}}
                     .dump()
              << '\n';
    return;
  }
  print_study(study, dynamics.map);
  print_proposals(list);
}

}  // namespace

void add_refine_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("refine", "Propose small corrections of the dynamics map from chatter heard");
  const auto options = std::make_shared<RefineOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  CLI::Option* can = command->add_option("--can", options->can,
                                         "CAN logs, recordings' folders (the newest recording), or FOLDER/NAME");
  command->add_option("--lcm", options->lcm, "The robot's messages beside a single CAN log")->needs(can);
  CLI::Option* events = command->add_option(
      "--events", options->events, "Events files of `stillcut replay`, of cuts at the cell's own posture and depth");
  command
      ->add_option("--least", options->settings.least_observations, "How often a mode must have been heard to chatter")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  CLI::Option* accept = command
                            ->add_option("--accept", options->accept,
                                         "Write these proposals (POSTURE/MODE; none named: all open ones) into the "
                                         "map; its old modes.csv is kept")
                            ->expected(0, -1);
  CLI::Option* reject =
      command->add_option("--reject", options->reject, "Mark these proposals as rejected")->expected(0, -1);
  for (CLI::Option* decision : {accept, reject}) decision->excludes(can)->excludes(events);
  accept->excludes(reject);
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Proposals stand in proposals.csv in the map's folder; without further options they are listed.\n"
      "Example:\n"
      "  stillcut refine cell.toml --can recordings\n"
      "  stillcut refine cell.toml --accept home/5");
  command->callback([options, accept, reject] {
    for (std::vector<std::string>* ids : {&options->accept, &options->reject}) std::erase(*ids, "");  // none named
    options->accepts = accept->count() > 0;
    options->rejects = reject->count() > 0;
    if (!options->lcm.empty() && options->can.size() != 1)
      throw CLI::ValidationError("--lcm", "goes with one CAN log; recordings hold the robot's messages themselves");
    refine(*options);
  });
}

}  // namespace stillcut
