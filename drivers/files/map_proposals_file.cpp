#include "drivers/files/map_proposals_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/input_error.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

const std::vector<std::string> kProposalColumns{
    "posture",         "mode",         "frequency_hz", "proposed_frequency_hz",
    "frequency_hz_se", "observations", "status",       "evidence"};
constexpr std::array kStatusNames{"open", "accepted", "rejected"};  // in the order of ProposalStatus
constexpr double kUnchanged = 1e-7;                                 // relative; digits of a proposal

double positive_number(const CsvTable& table, const CsvRow& row, std::size_t column, double most) {
  const double value = table.number(row, column);
  if (!(value > 0.0 && value <= most))
    table.fail(row, column,
               csv_number(value) + " is out of range; give a number above 0 and up to " + csv_number(most));
  return value;
}

int whole_number(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const double value = positive_number(table, row, column, 1e6);
  if (value != std::floor(value)) table.fail(row, column, csv_number(value) + " is no whole number");
  return static_cast<int>(value);
}

// Turning rad/s into Hz leaves a last digit that means nothing.
double rounded_hz(double hz) { return std::round(hz * 1e6) / 1e6; }

// All or nothing, so that a crash leaves a whole file.
template <class Write>
void replace_file(const std::filesystem::path& file, Write write) {
  std::filesystem::path fresh = file;
  fresh += ".new";
  std::ofstream out(fresh, std::ios::binary);
  write(out);
  out.close();
  if (!out) throw InputError(fresh.string(), 0, "cannot be written; check the folder's permissions and the disk");
  std::error_code error;
  std::filesystem::rename(fresh, file, error);
  if (error) throw InputError(file.string(), 0, "cannot be replaced (" + error.message() + ")");
}

}  // namespace

std::vector<MapProposal> read_map_proposals(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "proposals.csv";
  if (!std::filesystem::exists(file)) return {};
  const CsvTable table = read_csv(file);
  std::array<std::size_t, 8> column{};
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = table.require_column(kProposalColumns[i]);
  std::vector<MapProposal> proposals;
  for (const CsvRow& row : table.rows()) {
    MapProposal proposal;
    proposal.posture = table.text(row, column[0]);
    proposal.mode = whole_number(table, row, column[1]);
    proposal.frequency_hz = positive_number(table, row, column[2], 1e5);
    proposal.proposed_frequency_hz = positive_number(table, row, column[3], 1e5);
    proposal.frequency_hz_se = positive_number(table, row, column[4], 1e5);
    proposal.observations = whole_number(table, row, column[5]);
    const std::string status = table.text(row, column[6]);
    const auto* const name = std::find(kStatusNames.begin(), kStatusNames.end(), status);
    if (name == kStatusNames.end())
      table.fail(row, column[6], "\"" + status + "\" is no status; must be open, accepted or rejected");
    proposal.status = static_cast<ProposalStatus>(name - kStatusNames.begin());
    proposal.evidence = table.text(row, column[7]);
    for (const MapProposal& other : proposals)
      if (other.id() == proposal.id()) table.fail(row, column[1], proposal.id() + " stands twice; leave one of them");
    proposals.push_back(std::move(proposal));
  }
  return proposals;
}

void write_map_proposals(const std::filesystem::path& folder, const std::vector<MapProposal>& proposals) {
  replace_file(folder / "proposals.csv", [&](std::ostream& out) {
    write_csv_row(out, kProposalColumns);
    for (const MapProposal& one : proposals)
      write_csv_row(
          out, std::array{csv_text(one.posture), std::to_string(one.mode), csv_number(rounded_hz(one.frequency_hz)),
                          csv_number(rounded_hz(one.proposed_frequency_hz)),
                          csv_number(rounded_hz(one.frequency_hz_se)), std::to_string(one.observations),
                          std::string(kStatusNames.at(static_cast<std::size_t>(one.status))), csv_text(one.evidence)});
  });
}

DynamicsMap with_proposals(DynamicsMap map, const std::vector<MapProposal>& proposals,
                           const std::filesystem::path& folder) {
  const DynamicsMap before = map;
  for (const MapProposal& one : proposals) {
    const auto fail = [&](const std::string& what) {
      throw InputError((folder / "proposals.csv").string(), 0, one.id() + ": " + what + "; refine again");
    };
    const auto at = std::find_if(before.postures.begin(), before.postures.end(),
                                 [&](const Posture& posture) { return posture.id == one.posture; });
    if (at == before.postures.end() || static_cast<std::size_t>(one.mode) > at->modes.size())
      fail("is no longer in the map");
    const auto mode = static_cast<std::size_t>(one.mode - 1);
    const double hz = at->modes[mode].natural_frequency / kTwoPi;
    if (std::abs(hz - one.frequency_hz) > kUnchanged * hz)
      fail("has " + csv_number(rounded_hz(hz)) + " Hz in the map, not " + csv_number(one.frequency_hz) +
           " as when it was proposed");
    map.postures[static_cast<std::size_t>(at - before.postures.begin())].modes[mode].natural_frequency =
        kTwoPi * one.proposed_frequency_hz;
  }
  for (Posture& posture : map.postures) sort_modes(posture.modes);
  return map;
}

std::filesystem::path replace_modes(const std::filesystem::path& folder, const DynamicsMap& map) {
  const std::filesystem::path file = folder / "modes.csv";
  std::filesystem::path kept;
  for (int number = 1; kept.empty() || std::filesystem::exists(kept); ++number)
    (kept = file).concat(".").concat(std::to_string(number));
  std::error_code error;
  std::filesystem::copy_file(file, kept, error);
  if (error) throw InputError(kept.string(), 0, "cannot be written (" + error.message() + "); nothing was changed");
  replace_file(file, [&](std::ostream& out) { out << dynamics_map_text(map)[1]; });
  return kept;
}

}  // namespace stillcut
