// A host on which every check of `stillcut doctor` passes: a small folder of files, and facts. Tests spoil one thing.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "tests/drivers/files/temp_folder.hpp"
#include "tools/doctor.hpp"

namespace stillcut {

class HealthyHost : public TempFolder {
 public:
  HealthyHost() {
    for (const auto& [file, text] : files()) put(file, text);
    std::filesystem::create_directories(path() / "proc/irq/24/virtio0");  // a handler
    host.root = path();
    host.can_links = [this] { return std::optional{links}; };
    host.timer_resolution_ns = [this] { return resolution_ns; };
    host.clock_sync = [this] { return clock; };
    host.free_bytes = [this](const std::filesystem::path&) { return free_bytes; };
    host.lcm_hears_itself = [this](const std::string&) { return lcm_hears_itself; };
    wishes.lcm_url = "udpm://239.255.76.67:7667?ttl=0";
    wishes.recordings = "/var/lib/stillcut";
  }

  static std::map<std::string, std::string> files() {
    const std::string cpu = "sys/devices/system/cpu/", clock = "sys/devices/system/clocksource/clocksource0/";
    return {
        {"sys/kernel/realtime", "1\n"},
        {"proc/sys/kernel/osrelease", "6.1.0-18-rt-amd64\n"},
        {"proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1.76-1\n"},
        {"proc/cmdline", "quiet isolcpus=managed_irq,domain,3 nohz_full=3\n"},
        {cpu + "online", "0-3\n"},
        {cpu + "isolated", "3\n"},
        {cpu + "nohz_full", "3\n"},
        {cpu + "cpu0/cpufreq/scaling_governor", "powersave\n"},  // not the loop's
        {cpu + "cpu3/cpufreq/scaling_governor", "performance\n"},
        {cpu + "cpu3/cpuidle/state0/name", "POLL\n"},
        {cpu + "cpu3/cpuidle/state0/latency", "0\n"},
        {cpu + "cpu3/cpuidle/state0/disable", "0\n"},
        {cpu + "cpu3/cpuidle/state1/name", "C6\n"},
        {cpu + "cpu3/cpuidle/state1/latency", "133\n"},
        {cpu + "cpu3/cpuidle/state1/disable", "1\n"},
        {"proc/irq/24/effective_affinity_list", "1\n"},
        {"proc/irq/24/smp_affinity_list", "0-3\n"},
        {"proc/irq/25/smp_affinity_list", "0-3\n"},  // nobody handles it
        {"proc/self/limits",
         "Limit                     Soft Limit           Hard Limit           Units     \n"
         "Max locked memory         unlimited            unlimited            bytes     \n"
         "Max realtime priority     80                   80                   \n"},
        {"proc/self/status", "Name:\tstillcut\nCapEff:\t0000000000000000\n"},
        {"proc/sys/kernel/sched_rt_runtime_us", "950000\n"},
        {clock + "current_clocksource", "tsc\n"},
        {clock + "available_clocksource", "tsc hpet acpi_pm \n"},
        {"sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never\n"},
        {"proc/swaps", "Filename\tType\tSize\tUsed\tPriority\n"},
        {"proc/sys/net/core/rmem_max", "8388608\n"},
        {"proc/net/route",
         "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\tMTU\tWindow\tIRTT\n"
         "eth0\t0000000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n"
         "lo\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\t0\t0\t0\n"},
        {"sys/class/net/lo/flags", "0x1009\n"},
        {"sys/class/net/eth0/flags", "0x1003\n"},
        {"sys/class/net/can0/type", "280\n"},
        {"sys/class/net/can0/flags", "0x400c1\n"},
        {"sys/class/net/can0/mtu", "72\n"},
        {"proc/812/comm", "chronyd\n"},
        {"etc/security/limits.conf", "# <domain> <type> <item> <value>\n"},
    };
  }

  void put(const std::string& file, const std::string& text) const { (void)write(file, text); }
  void remove(const std::string& file) const { std::filesystem::remove_all(path() / file); }

  [[nodiscard]] std::vector<Check> examined() const { return examine(host, wishes); }
  [[nodiscard]] Check check(const std::string& name) const {
    for (const Check& check : examined()) {
      if (check.name == name) return check;
    }
    throw std::runtime_error("no check is named " + name);
  }

  Host host;
  DoctorWishes wishes;
  std::vector<CanLink> links{healthy_can()};
  std::optional<std::int64_t> resolution_ns = 1;
  std::optional<ClockSync> clock = ClockSync{true, 0.002};
  std::optional<std::uint64_t> free_bytes = 5ULL << 30;
  bool lcm_hears_itself = true;

 private:
  static CanLink healthy_can() {
    CanController controller;
    controller.bit_rate = 500'000;
    controller.data_bit_rate = 2'000'000;
    controller.restart_ms = 100;
    controller.state = CanController::State::active;
    controller.errors = CanController::Errors{0, 0};
    return {.name = "can0", .up = true, .mtu = 72, .is_virtual = false, .controller = controller};
  }
};

}  // namespace stillcut
