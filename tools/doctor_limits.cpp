// Checks of what the daemon's user may do: real-time priority, locked memory.
#include "tools/doctor_checks.hpp"
#include "tools/doctor_rights.hpp"

namespace stillcut::doctor {
namespace {

// Raises a limit where it was found: in a drop-in of the unit, or for the user's logins.
std::string raise(const Limits& limits, const std::string& user, const std::string& unit_line,
                  const std::string& login_item) {
  const std::string topic = login_item.substr(0, login_item.find(' '));
  if (limits.from_unit) {
    const std::string folder = "/etc/systemd/system/" + limits.source + ".d";
    return "mkdir -p " + folder + " && printf '[Service]\\n" + unit_line + "\\n' > " + folder + "/stillcut-" + topic +
           ".conf && systemctl daemon-reload";
  }
  return "echo " + shell_word((user.empty() ? "*" : user) + " - " + login_item) +
         " > /etc/security/limits.d/stillcut-" + topic + ".conf  # holds from the next login";
}

}  // namespace

Check check_priority_limit(const Host& host, const DoctorWishes& wishes) {
  const std::string wanted = std::to_string(wishes.priority);
  const Subject subject{"real-time priority limit", wanted + " or CAP_SYS_NICE"};
  const Limits limits = limits_of(host, wishes.user);
  const std::string mend = raise(limits, wishes.user, "LimitRTPRIO=" + wanted, "rtprio " + wanted);
  if (!limits.readable) return subject.not_ok(kUnreadable + limits.source, mend);
  if (limits.may_set_priority) return subject.ok("CAP_SYS_NICE, " + limits.source);
  const std::int64_t priority = limits.priority.value_or(0);
  const std::string found = (priority == kUnlimited ? "unlimited"
                             : limits.priority      ? std::to_string(priority)
                                                    : "not set") +
                            ", " + limits.source;
  return priority >= wishes.priority ? subject.ok(found) : subject.not_ok(found, mend);
}

// As the daemon sees it (rt/thread.cpp): below a limit it locks nothing, as a later allocation could fail for it.
Check check_memory_limit(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"locked memory limit", "unlimited or CAP_IPC_LOCK"};
  const Limits limits = limits_of(host, wishes.user);
  const std::string mend = raise(limits, wishes.user, "LimitMEMLOCK=infinity", "memlock unlimited");
  if (!limits.readable) return subject.not_ok(kUnreadable + limits.source, mend);
  if (limits.may_lock_memory) return subject.ok("CAP_IPC_LOCK, " + limits.source);
  if (limits.locked_bytes == kUnlimited) return subject.ok("unlimited, " + limits.source);
  const std::string found =
      limits.locked_bytes ? std::to_string(*limits.locked_bytes / 1024) + " kB" : std::string("not set");
  return subject.not_ok(found + ", " + limits.source, mend);
}

}  // namespace stillcut::doctor
