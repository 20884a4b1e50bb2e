// Checks of CAN: the interface that a cell listens to (or all), its controller, and the sockets' buffers.
#include <algorithm>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {
namespace {

using State = CanController::State;

constexpr unsigned kFdMtu = 72;                 // CANFD_MTU
constexpr std::int64_t kBufferBytes = 8 << 20;  // what the daemon's socket asks for (drivers/can/can_socket.cpp)
constexpr unsigned kWorkedOff = 8;              // below the count of one transmit error
constexpr std::uint32_t kCommonRate = 500'000, kCommonDataRate = 2'000'000;  // bit/s, where none is known

const char* state_name(State state) {
  switch (state) {
    case State::active:
      return "error-active";
    case State::warning:
      return "error-warning";
    case State::passive:
      return "error-passive";
    case State::bus_off:
      return "bus-off";
    case State::stopped:
      return "stopped";
    case State::sleeping:
      break;
  }
  return "sleeping";
}

std::string anew(const CanLink& link, const std::string& setting) {  // most settings need the interface down
  const std::string set = "ip link set " + shell_word(link.name);
  return set + " down; " + set + " " + setting + " && " + set + " up";
}

// "type can bitrate B dbitrate D fd on": wished rates, else those that are set, else common ones.
std::string rates(const CanLink& link, const DoctorWishes& wishes) {
  const CanController now = link.controller.value_or(CanController{});
  const auto first = [](std::optional<std::uint32_t> wished, std::optional<std::uint32_t> set, std::uint32_t common) {
    return wished ? *wished : set.value_or(0) != 0 ? *set : common;
  };
  return "type can bitrate " + std::to_string(first(wishes.bit_rate, now.bit_rate, kCommonRate)) + " dbitrate " +
         std::to_string(first(wishes.data_bit_rate, now.data_bit_rate, kCommonDataRate)) + " fd on";
}

Check check_rate(const Subject& subject, const CanLink& link, const DoctorWishes& wishes,
                 std::optional<std::uint32_t> rate, std::optional<std::uint32_t> wished) {
  const std::string known = wished ? "" : "  # the rates of your bus";
  if (rate.value_or(0) == 0) return subject.not_ok("not set", anew(link, rates(link, wishes)) + known);
  const std::string found = std::to_string(*rate) + " bit/s";
  if (wished && *wished != *rate) return subject.not_ok(found, anew(link, rates(link, wishes)));
  return subject.ok(found);
}

std::string rate_wanted(std::optional<std::uint32_t> wished) {
  return wished ? std::to_string(*wished) + " bit/s" : "the rate of your bus";
}

// Why the controller of this interface has nothing to tell; empty where it has.
std::string silent(const CanLink& link) {
  if (link.is_virtual) return "virtual interface";
  return link.controller ? "" : "no CAN controller told";
}

std::string load(const std::string& interface) {
  if (interface.starts_with("vcan"))
    return "modprobe vcan; ip link add " + shell_word(interface) + " type vcan && ip link set " +
           shell_word(interface) + " mtu 72 up";
  return "modprobe can-raw; modprobe gs_usb  # or the driver of your adapter: peak_usb, kvaser_usb, mcp251xfd, m_can";
}

}  // namespace

Check check_receive_buffer(const Host& host, const DoctorWishes&) {
  const std::string file = "/proc/sys/net/core/rmem_max", conf = "/etc/sysctl.d/stillcut-rmem.conf";
  const std::string wanted = std::to_string(kBufferBytes);
  const Subject subject{"receive buffer", wanted + " bytes at least"};
  const std::string mend = "echo net.core.rmem_max=" + wanted + " > " + conf + " && sysctl -p " + conf;
  const auto bytes = whole_number(host.read(file).value_or(""));
  if (!bytes) return subject.not_ok(kUnreadable + file, mend);
  const std::string found = std::to_string(*bytes) + " bytes";
  return *bytes >= kBufferBytes ? subject.ok(found) : subject.not_ok(found, mend);
}

std::vector<CanLink> can_links_in_use(const Host& host, const DoctorWishes& wishes) {
  if (!host.can_links) return {};
  auto links = host.can_links().value_or(std::vector<CanLink>{});
  if (wishes.can_interface)
    std::erase_if(links, [&](const CanLink& link) { return link.name != *wishes.can_interface; });
  return links;
}

Check check_can_interface(const Host& host, const DoctorWishes& wishes) {
  const std::string name = wishes.can_interface.value_or("");
  const Subject subject{"CAN interface", name.empty() ? "one at least" : name};
  if (wishes.can_interface && name.empty()) return subject.not_applicable("the cell's bus is no interface");
  if (!host.can_links) return subject.not_applicable("not told");
  if (!host.can_links()) return subject.not_ok("not told by netlink", load(name));
  std::string found;
  for (const CanLink& link : can_links_in_use(host, wishes)) found += (found.empty() ? "" : " ") + link.name;
  return found.empty() ? subject.not_ok("none", load(name)) : subject.ok(found);
}

Check check_can_up(const CanLink& link, const DoctorWishes&) {
  const Subject subject{link.name + " link", "up"};
  return link.up ? subject.ok("up") : subject.not_ok("down", "ip link set " + shell_word(link.name) + " up");
}

Check check_can_mtu(const CanLink& link, const DoctorWishes& wishes) {
  const Subject subject{link.name + " MTU", "72: CAN FD frames pass"};
  const std::string found = std::to_string(link.mtu);
  if (link.mtu >= kFdMtu) return subject.ok(found);
  return subject.not_ok(found, anew(link, link.controller ? rates(link, wishes) : "mtu 72"));
}

Check check_can_bit_rate(const CanLink& link, const DoctorWishes& wishes) {
  const Subject subject{link.name + " bit rate", rate_wanted(wishes.bit_rate)};
  if (!link.controller) return subject.not_applicable(silent(link));
  return check_rate(subject, link, wishes, link.controller->bit_rate, wishes.bit_rate);
}

Check check_can_data_bit_rate(const CanLink& link, const DoctorWishes& wishes) {
  const Subject subject{link.name + " data bit rate", rate_wanted(wishes.data_bit_rate)};
  if (!link.controller) return subject.not_applicable(silent(link));
  if (link.mtu < kFdMtu) return subject.not_applicable("no CAN FD at this MTU");
  return check_rate(subject, link, wishes, link.controller->data_bit_rate, wishes.data_bit_rate);
}

Check check_can_state(const CanLink& link, const DoctorWishes&) {
  const Subject subject{link.name + " state", "error-active"};
  if (!link.controller) return subject.not_applicable(silent(link));
  if (!link.up) return subject.not_applicable("the interface is down");
  const std::string set = "ip link set " + shell_word(link.name);
  const std::string show = "ip -details -statistics link show " + shell_word(link.name);
  const auto state = link.controller->state;
  if (!state) return subject.not_ok("not told by the driver", show);
  if (*state == State::active) return subject.ok(state_name(*state));
  const bool errors_lead = *state == State::warning || *state == State::passive;
  return subject.not_ok(state_name(*state), errors_lead ? show + "  # wiring, termination, or bit rates are wrong"
                                                        : set + " down; " + set + " up");
}

Check check_can_errors(const CanLink& link, const DoctorWishes&) {
  const Subject subject{link.name + " error counters", "below 8: a bus in order works one error off at once"};
  if (!link.controller) return subject.not_applicable(silent(link));
  if (!link.up || link.controller->state != State::active) return subject.not_applicable("as the state is");
  if (!link.controller->errors) return subject.not_applicable("not told by the driver");
  const auto [transmit, receive] = *link.controller->errors;
  const std::string found = "transmit " + std::to_string(transmit) + ", receive " + std::to_string(receive);
  if (transmit < kWorkedOff && receive < kWorkedOff) return subject.ok(found);
  return subject.not_ok(
      found, "candump -e " + shell_word(link.name) + ",0~0,#FFFFFFFF  # shows which errors; check wiring and rates");
}

Check check_can_restart(const CanLink& link, const DoctorWishes&) {
  const Subject subject{link.name + " restart after bus-off", "on (restart-ms)"};
  if (!link.controller) return subject.not_applicable(silent(link));
  const auto after_ms = link.controller->restart_ms;
  if (after_ms.value_or(0) != 0) return subject.ok("after " + std::to_string(*after_ms) + " ms");
  return subject.not_ok(after_ms ? "off" : "not told by the driver", anew(link, "type can restart-ms 100"));
}

}  // namespace stillcut::doctor
