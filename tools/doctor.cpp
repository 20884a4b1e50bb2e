#include "tools/doctor.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "tools/doctor_checks.hpp"

namespace stillcut {

std::string doctor::shell_word(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view{"@%+=:,./_-"}.find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

namespace {

// A line a check, whatever a host's files contain.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  constexpr std::size_t kLongest = 2000;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

using HostCheck = Check (*)(const Host&, const DoctorWishes&);
using LinkCheck = Check (*)(const CanLink&, const DoctorWishes&);

// The table: a check more is a line more.
constexpr std::array kRealTimeChecks{
    HostCheck{doctor::check_kernel},         HostCheck{doctor::check_isolated},
    HostCheck{doctor::check_tickless},       HostCheck{doctor::check_interrupts},
    HostCheck{doctor::check_governor},       HostCheck{doctor::check_idle_states},
    HostCheck{doctor::check_priority_limit}, HostCheck{doctor::check_memory_limit},
    HostCheck{doctor::check_throttling},     HostCheck{doctor::check_timer_resolution},
    HostCheck{doctor::check_clock_source},   HostCheck{doctor::check_huge_pages},
    HostCheck{doctor::check_swap},
};
constexpr std::array kBusChecks{
    HostCheck{doctor::check_receive_buffer},
    HostCheck{doctor::check_can_interface},
};
constexpr std::array kLinkChecks{
    LinkCheck{doctor::check_can_mtu},
    LinkCheck{doctor::check_can_bit_rate},
    LinkCheck{doctor::check_can_data_bit_rate},
    LinkCheck{doctor::check_can_restart},
    LinkCheck{doctor::check_can_up},
    LinkCheck{doctor::check_can_state},
    LinkCheck{doctor::check_can_errors},
};
constexpr std::array kOtherChecks{
    HostCheck{doctor::check_lcm_route},        HostCheck{doctor::check_lcm_interface},
    HostCheck{doctor::check_lcm_hears_itself}, HostCheck{doctor::check_clock_sync},
    HostCheck{doctor::check_disk_room},
};

}  // namespace

std::vector<Check> examine(const Host& host, const DoctorWishes& wishes) {
  std::vector<Check> checks;
  const auto look = [&](HostCheck check) { checks.push_back(check(host, wishes)); };
  std::for_each(kRealTimeChecks.begin(), kRealTimeChecks.end(), look);
  std::for_each(kBusChecks.begin(), kBusChecks.end(), look);
  for (const CanLink& link : doctor::can_links_in_use(host, wishes)) {
    for (const LinkCheck check : kLinkChecks) checks.push_back(check(link, wishes));
  }
  std::for_each(kOtherChecks.begin(), kOtherChecks.end(), look);
  for (Check& check : checks) {
    for (std::string* text : {&check.name, &check.found, &check.wanted}) *text = one_line(std::move(*text));
  }
  return checks;
}

std::size_t count_not_ok(const std::vector<Check>& checks) {
  return static_cast<std::size_t>(
      std::count_if(checks.begin(), checks.end(), [](const Check& check) { return !check.ok(); }));
}

}  // namespace stillcut
