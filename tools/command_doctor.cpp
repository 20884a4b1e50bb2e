// stillcut doctor: is this host fit for real time, CAN and LCM; what mends it.
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "tools/commands.hpp"
#include "tools/doctor.hpp"

namespace stillcut {
namespace {

struct DoctorOptions {
  std::string cell, root;
  bool json = false;
  DoctorWishes wishes;
};

DoctorWishes doctor_wishes(const DoctorOptions& options) {
  DoctorWishes wishes = options.wishes;
  Cell cell;  // its defaults, where none is given
  if (!options.cell.empty()) cell = read_cell(options.cell, {.map = false, .dbc = false, .bus = false});
  wishes.lcm_url = cell.lcm_url;
  const std::string socketcan = "socketcan:";
  if (!wishes.can_interface && cell.can && !cell.can->bus.empty())
    wishes.can_interface = cell.can->bus.starts_with(socketcan) ? cell.can->bus.substr(socketcan.size()) : "";
  if (wishes.recordings.empty()) wishes.recordings = std::filesystem::path(options.cell).parent_path();
  if (wishes.recordings.empty()) wishes.recordings = ".";
  wishes.recordings = std::filesystem::absolute(wishes.recordings).lexically_normal();
  return wishes;
}

nlohmann::ordered_json doctor_json(const std::vector<Check>& checks) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Check& check : checks) {
    list.push_back({{"name", check.name},
                    {"ok", check.ok()},
                    {"found", check.found},
                    {"wanted", check.wanted},
                    {"mend", check.mend},
                    {"applies", check.health != Health::not_applicable}});
  }
  return {{"fit", count_not_ok(checks) == 0}, {"checks", list}};
}

class DoctorTable {
 public:
  explicit DoctorTable(const std::vector<Check>& checks) {
    constexpr std::size_t kWidest = 44;  // what is longer shifts the rest of its own line only
    for (const Check& check : checks) {
      name_ = std::max(name_, check.name.size());
      if (check.found.size() <= kWidest) found_ = std::max(found_, check.found.size());
      if (check.wanted.size() <= kWidest) wanted_ = std::max(wanted_, check.wanted.size());
    }
  }

  void print(const Check& check, bool colours) const {
    const bool ok = check.health == Health::ok, not_ok = check.health == Health::not_ok;
    const char* const colour = ok ? "\033[32m" : not_ok ? "\033[1;31m" : "\033[2m";
    std::string line = std::string(ok ? "ok " : not_ok ? "NOT" : "-  ") + "  ";
    if (colours) line = colour + line + "\033[0m";
    line += padded(check.name, name_) + padded(check.found, found_);
    line += not_ok ? padded("wanted: " + check.wanted, wanted_ + 8) + "mend: " + check.mend : "wanted: " + check.wanted;
    std::cout << line << '\n';
  }

 private:
  static std::string padded(const std::string& text, std::size_t width) {
    return text + std::string(std::max(width, text.size()) - text.size() + 2, ' ');
  }
  std::size_t name_ = 0, found_ = 0, wanted_ = 0;
};

void print_checks(const std::vector<Check>& checks, bool copied) {
  const bool colours = isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  const DoctorTable table{checks};
  for (const Check& check : checks) table.print(check, colours);
  const std::size_t bad = count_not_ok(checks);
  if (bad > 0) {
    std::cout << "not fit: " << bad << " of " << checks.size() << " checks; the commands are for root\n";
  } else {
    std::cout << "fit" << (copied ? ", as far as a copied folder tells" : "") << '\n';
  }
}

void run_doctor(const DoctorOptions& options) {
  if (!options.root.empty() && !std::filesystem::is_directory(options.root))
    throw InputError(options.root, 0, "is no folder; --root wants a copied host with proc, sys and etc in it");
  const DoctorWishes wishes = doctor_wishes(options);
  const auto checks = examine(options.root.empty() ? this_host() : copied_host(options.root), wishes);
  if (options.json) {
    // A host may hold any bytes.
    std::cout << doctor_json(checks).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  } else {
    print_checks(checks, !options.root.empty());
  }
  if (count_not_ok(checks) > 0) throw CLI::RuntimeError(kExitComponentMissing);
}

}  // namespace

void add_doctor_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("doctor", "Is this host fit for real time, CAN and LCM; what mends it");
  const auto options = std::make_shared<DoctorOptions>();
  DoctorWishes& wishes = options->wishes;
  command->add_option("CELL", options->cell,
                      "Cell file: looks at its CAN interface, LCM address and folder; default: every CAN interface, "
                      "LCM's usual address, this folder");
  command->add_option("--cpu", wishes.cpu, "Processor of the loop (default: the isolated ones)")
      ->check(CLI::Range(0, 8191));
  command->add_option("--priority", wishes.priority, "SCHED_FIFO priority of the loop")
      ->capture_default_str()
      ->check(CLI::Range(1, 99));
  command->add_option("--user", wishes.user,
                      "Whose limits: the service that runs as NAME, else NAME's logins (default: this process)");
  command->add_option("--can", wishes.can_interface, "CAN interface (default: the cell's)");
  command->add_option("--bit-rate", wishes.bit_rate, "Of the bus in bit/s (default: any)");
  command->add_option("--data-bit-rate", wishes.data_bit_rate, "Of the data in CAN FD frames in bit/s (default: any)");
  command->add_option("--recordings", wishes.recordings, "Folder that must have room (default: the cell's)");
  command->add_option("--root", options->root,
                      "Look at a copied host instead (proc, sys, etc in this folder, as sosreport leaves them)");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "A line a check: ok, NOT, or - where it does not apply; beside what is not ok, the command that mends it, for\n"
      "root. Exit status 0: fit; 4: not. docs/doctor.md says how each is found.\n"
      "Example: the machine that will run the daemon as user stillcut with its loop on processor 3:\n"
      "  stillcut doctor /etc/stillcut/cell.toml --cpu 3 --user stillcut");
  command->callback([options] { run_doctor(*options); });
}

}  // namespace stillcut
