// What a user may do on a host: the limits of this process, of a login (PAM's limits.conf), or of the service that runs
// as this user (systemd units: logins' limits do not reach them).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/doctor_host.hpp"

namespace stillcut::doctor {

struct Limits {
  std::string source;  // "this process", "limits.conf", or the unit's name
  bool from_unit = false;
  bool readable = true;                                    // false: `source` names what cannot be read
  std::optional<std::int64_t> priority;                    // of real-time threads; none: not set
  std::optional<std::int64_t> locked_bytes;                // none: not set
  bool may_set_priority = false, may_lock_memory = false;  // CAP_SYS_NICE, CAP_IPC_LOCK: no limit holds
};

inline constexpr std::int64_t kUnlimited = INT64_MAX;

Limits limits_of(const Host& host, const std::string& user);  // an empty user: this process

}  // namespace stillcut::doctor
