// A host as `stillcut doctor` sees it: files below a root folder, and facts that are no files. Tests fake both: a
// folder of their own, and functions that answer what they like.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace stillcut {

// A CAN controller with bit rates, as its driver tells by netlink; virtual interfaces (vcan, vxcan) have none.
struct CanController {
  enum class State : std::uint8_t { active, warning, passive, bus_off, stopped, sleeping };
  struct Errors {
    unsigned transmit = 0, receive = 0;
  };
  std::optional<std::uint32_t> bit_rate, data_bit_rate, restart_ms;  // bit/s; 0 or nothing: not set
  std::optional<State> state;
  std::optional<Errors> errors;  // the controller's two counters; not every driver tells them
};

struct CanLink {
  std::string name;
  bool up = false;
  unsigned mtu = 0;
  bool is_virtual = false;
  std::optional<CanController> controller;  // none: virtual, or not told
};

struct ClockSync {
  bool synchronized = false;
  double max_error_s = 0.0;
};

// A fact that could not be had is nothing (std::nullopt); a fact that this kind of host cannot have at all, as a copied
// folder has no clock, is an empty function.
struct Host {
  std::filesystem::path root = "/";
  std::function<std::optional<std::vector<CanLink>>()> can_links;
  std::function<std::optional<std::int64_t>()> timer_resolution_ns;
  std::function<std::optional<ClockSync>()> clock_sync;
  std::function<std::optional<std::uint64_t>(const std::filesystem::path&)> free_bytes;
  std::function<bool(const std::string& url)> lcm_hears_itself;

  [[nodiscard]] std::filesystem::path at(const std::string& file) const;  // of "/proc/swaps", say

  // The file's text without what surrounds it (blanks, zero bytes), a megabyte at most; nothing where it cannot be
  // read.
  [[nodiscard]] std::optional<std::string> read(const std::string& file) const;
  [[nodiscard]] bool exists(const std::string& file) const;
  [[nodiscard]] std::vector<std::string> list(const std::string& folder) const;  // names, sorted; none if not there
};

Host this_host();
Host copied_host(const std::filesystem::path& root);  // files only; CAN interfaces as far as /sys tells

// The CAN interfaces by netlink; nothing where the kernel does not answer.
std::optional<std::vector<CanLink>> can_links_of_kernel();

// Text of files taken apart; what is no number is nothing.
std::optional<std::int64_t> whole_number(const std::string& text, int base = 10);
std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> words_of(const std::string& line);

}  // namespace stillcut
