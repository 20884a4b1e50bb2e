#include "drivers/can/can_bus.hpp"

#include "drivers/can/bus_kinds.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {

std::unique_ptr<CanBus> open_can_bus(const std::string& bus, std::span<const std::uint32_t> ids) {
  const std::size_t colon = bus.find(':');
  const std::string kind = bus.substr(0, colon);
  const std::string name = colon != std::string::npos ? bus.substr(colon + 1) : "";
  if (!name.empty()) {
    if (kind == "socketcan") return open_socketcan_bus(name, ids);
    if (kind == "log") return open_log_bus(name);
    if (kind == "local") return open_local_bus(name);
  }
  throw InputError("CAN bus '" + bus + "'", 0, "write socketcan:IFACE, log:FILE or local:NAME");
}

}  // namespace stillcut
