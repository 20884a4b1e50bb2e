#include "drivers/lcm/connection.hpp"

#include "drivers/files/input_error.hpp"

namespace stillcut {

LcmConnection open_lcm(const std::string& url) {
  LcmConnection connection(lcm_create(url.c_str()), [](lcm_t* lcm) {
    if (lcm != nullptr) lcm_destroy(lcm);
  });
  if (!connection) {
    throw ComponentError(
        "LCM cannot be reached at " + url +
        "; check the address, and where no network carries multicast run: ip link set lo multicast on; "
        "ip route add 224.0.0.0/4 dev lo");
  }
  return connection;
}

}  // namespace stillcut
