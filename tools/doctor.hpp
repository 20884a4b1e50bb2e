// Is this host fit for real time, CAN and LCM: what `stillcut doctor` asks of it, check by check. A check looks at a
// Host (doctor_host.hpp) and says what it found, what it wanted, and the command that mends it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor_host.hpp"

namespace stillcut {

// Does not apply: nothing here that could be wrong, such as a virtual machine's frequency governor. What should be
// there and cannot be read is not_ok.
enum class Health : std::uint8_t { ok, not_ok, not_applicable };

struct Check {
  std::string name;
  Health health = Health::ok;
  std::string found, wanted;
  std::string mend;  // a command of the shell, as root; empty unless not_ok

  [[nodiscard]] bool ok() const noexcept { return health != Health::not_ok; }
};

// What is to run on the host.
struct DoctorWishes {
  std::optional<int> cpu;                    // the loop's processor; default: the isolated ones
  int priority = 80;                         // of the loop, SCHED_FIFO
  std::string user;                          // whose limits; empty: those of this process
  std::optional<std::string> can_interface;  // empty: the cell uses none (its bus is a log); default: all there are
  std::optional<std::uint32_t> bit_rate;     // bit/s; default: any
  std::optional<std::uint32_t> data_bit_rate;
  std::string lcm_url;
  std::filesystem::path recordings;  // folder
};

// Every check of the table, in its order; never throws for what a host may contain.
std::vector<Check> examine(const Host& host, const DoctorWishes& wishes);

std::size_t count_not_ok(const std::vector<Check>& checks);

}  // namespace stillcut
