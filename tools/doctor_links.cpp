// The CAN interfaces by netlink, what `ip -details link show` prints. Only the doctor asks by netlink: the daemon's
// service does without these rights.
#include <linux/can/netlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <netlink/netlink.h>
#include <netlink/route/link.h>
#include <netlink/route/link/can.h>

#include <memory>

#include "tools/doctor_host.hpp"

namespace stillcut {
namespace {

using ControllerState = CanController::State;

std::optional<ControllerState> controller_state(std::uint32_t state) {
  switch (state) {
    case CAN_STATE_ERROR_ACTIVE:
      return ControllerState::active;
    case CAN_STATE_ERROR_WARNING:
      return ControllerState::warning;
    case CAN_STATE_ERROR_PASSIVE:
      return ControllerState::passive;
    case CAN_STATE_BUS_OFF:
      return ControllerState::bus_off;
    case CAN_STATE_STOPPED:
      return ControllerState::stopped;
    case CAN_STATE_SLEEPING:
      return ControllerState::sleeping;
    default:
      return std::nullopt;
  }
}

CanController controller_of(rtnl_link* link) {
  CanController controller;
  std::uint32_t number = 0;
  can_bittiming timing{};
  can_berr_counter errors{};
  if (rtnl_link_can_get_bitrate(link, &number) == 0) controller.bit_rate = number;
  if (rtnl_link_can_get_data_bittiming(link, &timing) == 0) controller.data_bit_rate = timing.bitrate;
  if (rtnl_link_can_get_restart_ms(link, &number) == 0) controller.restart_ms = number;
  if (rtnl_link_can_state(link, &number) == 0) controller.state = controller_state(number);
  if (rtnl_link_can_berr(link, &errors) == 0) controller.errors = {errors.txerr, errors.rxerr};
  return controller;
}

CanLink can_link_of(rtnl_link* link) {
  CanLink can;
  can.name = rtnl_link_get_name(link);
  can.up = (rtnl_link_get_flags(link) & IFF_UP) != 0;
  can.mtu = rtnl_link_get_mtu(link);
  const char* const type = rtnl_link_get_type(link);
  const std::string kind = type == nullptr ? "" : type;
  can.is_virtual = kind == "vcan" || kind == "vxcan";
  if (rtnl_link_is_can(link) != 0) can.controller = controller_of(link);
  return can;
}

}  // namespace

std::optional<std::vector<CanLink>> can_links_of_kernel() {
  const std::unique_ptr<nl_sock, void (*)(nl_sock*)> socket{nl_socket_alloc(), nl_socket_free};
  nl_cache* links = nullptr;
  if (!socket || nl_connect(socket.get(), NETLINK_ROUTE) < 0) return std::nullopt;
  if (rtnl_link_alloc_cache(socket.get(), AF_UNSPEC, &links) < 0) return std::nullopt;
  const std::unique_ptr<nl_cache, void (*)(nl_cache*)> owner{links, nl_cache_free};
  std::vector<CanLink> result;
  for (nl_object* object = nl_cache_get_first(links); object != nullptr; object = nl_cache_get_next(object)) {
    auto* const link = reinterpret_cast<rtnl_link*>(object);  // libnl's own way: a link is an object
    if (rtnl_link_get_arptype(link) == ARPHRD_CAN && rtnl_link_get_name(link) != nullptr)
      result.push_back(can_link_of(link));
  }
  return result;
}

}  // namespace stillcut
