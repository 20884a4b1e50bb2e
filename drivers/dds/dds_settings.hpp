// Where and how to take part in DDS.
#pragma once

#include <string>

namespace stillcut {

inline constexpr int kMaxDomain = 232;  // the ports of higher ones do not exist

struct DdsSettings {
  int domain = 0;                 // 0 to kMaxDomain
  std::string partition;          // empty: none, as ROS 2 nodes have none
  std::string discovery_server;   // "HOST:PORT", several with ';' between; empty: multicast
  bool shared_memory = false;     // beside UDP, towards processes of this user on this host
  std::string interface_address;  // IPv4 address of the only network interface to use; empty: all
};

}  // namespace stillcut
