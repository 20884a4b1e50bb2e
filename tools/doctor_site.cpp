// Checks of what is around the programs: the time of day, and room for recordings.
#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {
namespace {

constexpr std::uint64_t kRoomBytes = 1ULL << 30;

// Who may be setting the clock, by the names of running programs, and how each is told to get on with it.
struct TimeKeeper {
  const char *name, *mend;
};
constexpr std::array kTimeKeepers{
    TimeKeeper{"chronyd", "chronyc online && chronyc burst 4/8 && chronyc waitsync 30"},
    TimeKeeper{"ntpd", "systemctl restart ntpsec || systemctl restart ntp"},
    TimeKeeper{"phc2sys", "systemctl restart 'phc2sys*'"},
    TimeKeeper{"ptp4l",
               "systemctl restart 'ptp4l*' && phc2sys -a -r &  # ptp4l alone leaves the system's clock as it is"},
    TimeKeeper{"systemd-timesyn", "timedatectl set-ntp true && systemctl restart systemd-timesyncd"},  // 15 letters
};

const TimeKeeper* time_keeper(const Host& host) {
  std::set<std::string> running;
  for (const std::string& process : host.list("/proc")) {
    if (whole_number(process)) running.insert(host.read("/proc/" + process + "/comm").value_or(""));
  }
  const auto* const keeper = std::find_if(kTimeKeepers.begin(), kTimeKeepers.end(),
                                          [&](const TimeKeeper& k) { return running.contains(k.name); });
  return keeper != kTimeKeepers.end() ? keeper : nullptr;
}

std::string in_gib(std::uint64_t bytes) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f GiB", static_cast<double>(bytes) / static_cast<double>(kRoomBytes));
  return text.data();
}

}  // namespace

Check check_clock_sync(const Host& host, const DoctorWishes&) {
  const Subject subject{"clock", "synchronized"};
  if (!host.clock_sync) return subject.not_applicable("not told by a copied folder");
  const auto clock = host.clock_sync();
  const TimeKeeper* const keeper = time_keeper(host);
  const std::string by =
      keeper == nullptr ? ", no chronyd, ntpd, ptp4l or timesyncd runs" : std::string(", ") + keeper->name + " runs";
  if (clock && clock->synchronized) {
    std::array<char, 48> error{};
    std::snprintf(error.data(), error.size(), "synchronized within %.3g ms", clock->max_error_s * 1e3);
    return subject.ok(error.data() + (keeper == nullptr ? "" : by));
  }
  return subject.not_ok((clock ? "not synchronized" : "not told by adjtimex") + by,
                        keeper == nullptr ? "apt-get install chrony" : keeper->mend);
}

Check check_disk_room(const Host& host, const DoctorWishes& wishes) {
  const std::string folder = wishes.recordings.string();
  const Subject subject{"disk room", "1 GiB for recordings"};
  if (!host.free_bytes) return subject.not_applicable("not told by a copied folder");
  const auto bytes = host.free_bytes(wishes.recordings);
  if (!bytes) return subject.not_ok(kUnreadable + folder, "mkdir -p " + shell_word(folder));
  const std::string found = in_gib(*bytes) + " in " + folder;
  if (*bytes >= kRoomBytes) return subject.ok(found);
  return subject.not_ok(found, "du -ahx " + shell_word(folder) + " | sort -h | tail -20  # what to move elsewhere");
}

}  // namespace stillcut::doctor
