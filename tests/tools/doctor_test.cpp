// The checks of stillcut doctor against hosts that are folders: one that is fit, and each way to spoil it.
#include "tools/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "tests/tools/healthy_host.hpp"
#include "tools/doctor_checks.hpp"

namespace stillcut {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// One thing wrong, the one check that must say so, and what its command must name.
struct HostFault {
  const char* what;
  std::function<void(HealthyHost&)> spoil;
  const char *check, *mend;
};

const std::string kCpuFolder = "sys/devices/system/cpu/";

std::vector<HostFault> host_faults() {
  using H = HealthyHost;
  using State = CanController::State;
  const auto file = [](std::string name, std::string text) { return [name, text](H& h) { h.put(name, text); }; };
  const auto can = [](auto change) { return [change](H& h) { change(*h.links[0].controller); }; };
  const auto state = [&](State s) {
    return can([s](CanController& c) {
      c.state = s;
      c.errors = CanController::Errors{200, 200};
    });
  };
  return {
      {"ordinary kernel",
       [](H& h) {
         h.remove("sys/kernel/realtime");
         h.put("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian\n");
       },
       "kernel", "linux-image-rt"},
      {"none isolated",
       [](H& h) {
         h.put(kCpuFolder + "isolated", "\n"), h.put(kCpuFolder + "cpu0/cpufreq/scaling_governor", "performance");
       },
       "isolated processor", "isolcpus=managed_irq,domain,3"},
      {"isolated one offline",
       [](H& h) {
         h.put(kCpuFolder + "online", "0-2"), h.put(kCpuFolder + "cpu0/cpufreq/scaling_governor", "performance");
       },
       "isolated processor", "isolcpus"},
      {"ticks", file(kCpuFolder + "nohz_full", "(null)\n"), "tickless processor", "nohz_full=3"},
      {"interrupt", file("proc/irq/24/effective_affinity_list", "3\n"), "interrupts", "for i in 24; do echo 0-2 >"},
      {"governor", file(kCpuFolder + "cpu3/cpufreq/scaling_governor", "powersave\n"), "frequency governor",
       "cpu3/cpufreq"},
      {"governor unreadable", file(kCpuFolder + "cpu3/cpufreq/scaling_governor", ""), "frequency governor",
       "cpu3/cpufreq"},
      {"idle state", file(kCpuFolder + "cpu3/cpuidle/state1/disable", "0\n"), "idle states",
       "cpu3/cpuidle/state1/disable"},
      {"priority",
       file("proc/self/limits", "Max locked memory unlimited unlimited bytes\nMax realtime priority 79 99\n"),
       "real-time priority limit", "rtprio 80"},
      {"memory", file("proc/self/limits", "Max locked memory 8388608 unlimited bytes\nMax realtime priority 80 80\n"),
       "locked memory limit", "memlock unlimited"},
      {"throttled", file("proc/sys/kernel/sched_rt_runtime_us", "500000\n"), "real-time throttling",
       "sched_rt_runtime_us=950000"},
      {"coarse timer", [](H& h) { h.resolution_ns = 4'000'000; }, "timer resolution", "linux-image-rt"},
      {"coarse by choice",
       [](H& h) {
         h.resolution_ns = 4'000'000;
         h.put("proc/cmdline", "quiet highres=off\n");
       },
       "timer resolution", "highres=off"},
      {"slow clock", file("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n"), "clock source",
       "echo tsc"},
      {"huge pages", file("sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never\n"),
       "transparent huge pages", "echo madvise"},
      {"swap", file("proc/swaps", "Filename\tType\n/dev/sda2 partition 100 0 -2\n"), "swap", "swapoff"},
      {"buffer", file("proc/sys/net/core/rmem_max", "212992\n"), "receive buffer", "net.core.rmem_max=8388608"},
      {"no interface", [](H& h) { h.links.clear(); }, "CAN interface", "modprobe"},
      {"another interface", [](H& h) { h.wishes.can_interface = "vcan7"; }, "CAN interface",
       "ip link add vcan7 type vcan"},
      {"down", [](H& h) { h.links[0].up = false; }, "can0 link", "ip link set can0 up"},
      {"classic", [](H& h) { h.links[0].mtu = 16; }, "can0 MTU", "dbitrate 2000000 fd on"},
      {"no rate", can([](CanController& c) { c.bit_rate = 0; }), "can0 bit rate", "bitrate 500000"},
      {"other rate", [](H& h) { h.wishes.bit_rate = 1'000'000; }, "can0 bit rate", "bitrate 1000000 dbitrate 2000000"},
      {"no data rate", can([](CanController& c) { c.data_bit_rate.reset(); }), "can0 data bit rate",
       "dbitrate 2000000"},
      {"other data rate", [](H& h) { h.wishes.data_bit_rate = 5'000'000; }, "can0 data bit rate", "dbitrate 5000000"},
      {"warning", state(State::warning), "can0 state", "statistics link show can0"},
      {"passive", state(State::passive), "can0 state", "statistics link show can0"},
      {"bus-off", state(State::bus_off), "can0 state", "ip link set can0 down; ip link set can0 up"},
      {"errors", can([](CanController& c) { c.errors->transmit = 8; }), "can0 error counters", "candump -e can0"},
      {"stays off", can([](CanController& c) { c.restart_ms = 0; }), "can0 restart after bus-off", "restart-ms 100"},
      {"no route", file("proc/net/route", "Iface\tDestination\n"), "LCM route", "ip route replace 224.0.0.0/4 dev lo"},
      {"rejected",
       file("proc/net/route",
            "lo\t00000000\t00000000\t0001\t0\t0\t0\t00000000\n*\t000000E0\t00000000\t0201\t0\t0\t0\t000000F0\n"),
       "LCM route", "224.0.0.0/4"},
      {"no multicast", file("sys/class/net/lo/flags", "0x9\n"), "LCM interface", "ip link set lo multicast on"},
      {"deaf", [](H& h) { h.lcm_hears_itself = false; }, "LCM loopback", "239.255.76.67"},
      {"free clock", [](H& h) { h.clock->synchronized = false; }, "clock", "chronyc"},
      {"nobody's clock",
       [](H& h) {
         h.clock->synchronized = false;
         h.remove("proc/812");
       },
       "clock", "apt-get install chrony"},
      {"disk", [](H& h) { h.free_bytes = (1ULL << 30) - 1; }, "disk room", "/var/lib/stillcut"},
  };
}

std::vector<std::string> bad_names(const std::vector<Check>& checks) {
  std::vector<std::string> names;
  for (const Check& check : checks) {
    if (!check.ok()) names.push_back(check.name);
  }
  return names;
}

// Fails if a check calls a healthy host unfit, or finds nothing to look at there.
TEST(Doctor, HealthyHostIsFitAndEveryCheckApplies) {
  const HealthyHost healthy;
  std::set<std::string> names;
  for (const Check& check : healthy.examined()) {
    EXPECT_EQ(check.health, Health::ok) << check.name << ": " << check.found;
    EXPECT_EQ(check.mend, "") << check.name;
    EXPECT_NE(check.found, "") << check.name;
    EXPECT_NE(check.wanted, "") << check.name;
    EXPECT_TRUE(names.insert(check.name).second) << check.name << " is there twice";
  }
}

// Fails if a fault goes unnoticed, is told by another check as well, or has a command that mends something else.
TEST(Doctor, EachFaultFailsItsOwnCheckOnly) {
  for (const HostFault& fault : host_faults()) {
    HealthyHost host;
    fault.spoil(host);
    EXPECT_THAT(bad_names(host.examined()), ElementsAre(fault.check)) << fault.what;
    EXPECT_THAT(host.check(fault.check).mend, HasSubstr(fault.mend)) << fault.what;
  }
}

// Fails when a check is added to the table and no fault above shows that it can fail.
TEST(Doctor, EveryCheckHasAFault) {
  std::set<std::string> shown;
  for (const HostFault& fault : host_faults()) shown.insert(fault.check);
  for (const Check& check : HealthyHost{}.examined()) EXPECT_TRUE(shown.contains(check.name)) << check.name;
}

// Fails if a file that is absent, of another kind, or full of anything makes a check throw or forget its command.
TEST(Doctor, NoContentsOfAFileBreakIt) {
  constexpr char kNoise[] = "\xff\0\x01 9223372036854775807 -1 [ ,-, 0-99999999 \t:=\n\n= \xc3\n";
  const std::string noise{kNoise, sizeof kNoise - 1};
  HealthyHost host;
  for (const auto& [file, text] : HealthyHost::files()) {
    for (const std::string& contents :
         {std::string{"gone"}, std::string{"folder"}, std::string{}, noise, noise + text, std::string(1 << 21, '7')}) {
      host.wishes.user = contents.size() % 2 == 0 ? "milling" : "";
      host.remove(file);
      if (contents == "folder") std::filesystem::create_directories(host.path() / file);
      if (contents != "folder" && contents != "gone") host.put(file, contents);
      for (const Check& check : host.examined()) {
        EXPECT_EQ(check.mend.empty(), check.ok()) << file << ": " << check.name;
        EXPECT_EQ(check.found.find('\n'), std::string::npos) << file << ": " << check.name;
      }
    }
    host.remove(file);
    host.put(file, text);
  }
  host.wishes.user = "";
  EXPECT_THAT(bad_names(host.examined()), IsEmpty()) << "the host was not restored";
}

// Fails if what cannot be read, though it is needed, counts as fine.
TEST(Doctor, UnknownIsNotOk) {
  for (const auto& [file, check] : std::vector<std::pair<std::string, std::string>>{
           {"proc/self/limits", "real-time priority limit"},
           {"proc/sys/kernel/sched_rt_runtime_us", "real-time throttling"},
           {"sys/devices/system/clocksource/clocksource0/current_clocksource", "clock source"},
           {"proc/sys/net/core/rmem_max", "receive buffer"},
           {"proc/net/route", "LCM route"},
           {"sys/class/net/lo/flags", "LCM interface"},
           {kCpuFolder + "isolated", "isolated processor"},
           {kCpuFolder + "nohz_full", "tickless processor"}}) {
    HealthyHost host;
    host.remove(file);
    EXPECT_EQ(host.check(check).health, Health::not_ok) << check;
  }
  HealthyHost host;
  host.clock.reset(), host.resolution_ns.reset(), host.free_bytes.reset();
  host.host.can_links = [] { return std::nullopt; };
  EXPECT_THAT(bad_names(host.examined()), ElementsAre("timer resolution", "CAN interface", "clock", "disk room"));
}

// Fails if a virtual machine or a virtual interface is asked for what it cannot have.
TEST(Doctor, WhatDoesNotApplyIsNoFault) {
  HealthyHost host;
  host.remove(kCpuFolder + "cpu0/cpufreq");
  host.remove(kCpuFolder + "cpu3/cpufreq");
  host.remove(kCpuFolder + "cpu3/cpuidle");
  host.remove("proc/swaps");
  host.remove("sys/kernel/mm/transparent_hugepage");
  host.links[0] = {.name = "vcan0", .up = true, .mtu = 72, .is_virtual = true, .controller = {}};
  EXPECT_THAT(bad_names(host.examined()), IsEmpty());
  for (const char* name : {"frequency governor", "idle states", "swap", "transparent huge pages", "vcan0 bit rate",
                           "vcan0 state", "vcan0 restart after bus-off"})
    EXPECT_EQ(host.check(name).health, Health::not_applicable) << name;
  host.wishes.can_interface = "";  // a cell that listens to a log
  EXPECT_EQ(host.check("CAN interface").health, Health::not_applicable);
}

TEST(Doctor, WishedProcessorIsLookedAtInsteadOfTheIsolated) {
  HealthyHost host;
  host.wishes.cpu = 0;
  EXPECT_THAT(bad_names(host.examined()),
              ElementsAre("isolated processor", "tickless processor", "frequency governor"));
  host.wishes.cpu = 9;
  EXPECT_THAT(host.check("isolated processor").found, HasSubstr("not online"));
}

// Fails if the limits of a login are read in another order than pam_limits does: user before group before all, then
// last.
TEST(Doctor, LoginLimitsAreThoseOfPam) {
  HealthyHost host;
  host.wishes.user = "milling";
  EXPECT_THAT(bad_names(host.examined()), ElementsAre("real-time priority limit", "locked memory limit"));
  host.put("etc/passwd", "milling:x:1000:1000::/home/milling:/bin/sh\n");
  host.put("etc/group", "realtime:x:50:other,milling\nmilling:x:1000:\n");
  host.put("etc/security/limits.conf", "@realtime - rtprio 90\n@milling soft memlock unlimited # why\n* - rtprio 10\n");
  EXPECT_THAT(bad_names(host.examined()), IsEmpty());
  host.put("etc/security/limits.d/50-own.conf", "milling soft rtprio 20\nmilling hard memlock 64\n");
  EXPECT_THAT(bad_names(host.examined()), ElementsAre("real-time priority limit"));
  host.put("etc/security/limits.d/60-own.conf", "milling - rtprio 80\n");
  EXPECT_THAT(bad_names(host.examined()), IsEmpty());
}

// Fails if a service's user is judged by the limits of logins, or a drop-in is not heard.
TEST(Doctor, ServiceLimitsAreThoseOfItsUnit) {
  HealthyHost host;
  host.wishes.user = "stillcut";
  host.put("etc/security/limits.conf", "stillcut - rtprio 99\nstillcut - memlock unlimited\n");
  host.put("usr/lib/systemd/system/stillcutd@.service", "[Service]\nUser=stillcut\nLimitMEMLOCK=infinity\n");
  EXPECT_THAT(bad_names(host.examined()), ElementsAre("real-time priority limit"));
  EXPECT_THAT(host.check("real-time priority limit").mend, HasSubstr("/etc/systemd/system/stillcutd@.service.d"));
  host.put("etc/systemd/system/stillcutd@.service.d/more.conf",
           "[Service]\nAmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK\n");
  EXPECT_THAT(bad_names(host.examined()), IsEmpty());
  host.put("etc/systemd/system/stillcutd@.service.d/zero.conf", "[Service]\nAmbientCapabilities=\nLimitRTPRIO=79\n");
  EXPECT_THAT(bad_names(host.examined()), ElementsAre("real-time priority limit"));
}

TEST(Doctor, MulticastOfSeveralMachinesGoesOutByTheNetwork) {
  HealthyHost host;
  host.put("proc/net/route", "");
  host.wishes.lcm_url = "udpm://239.255.76.67:7667?ttl=1";
  EXPECT_THAT(host.check("LCM route").mend, HasSubstr("dev eth0"));
  host.wishes.lcm_url = "udpm://10.0.0.1:7667";
  EXPECT_EQ(host.check("LCM route").found, "no multicast address");
  host.wishes.lcm_url = "memq://";
  EXPECT_EQ(host.check("LCM route").health, Health::not_applicable);
}

TEST(Doctor, ProcessorsAreReadAndWrittenAsTheKernelDoes) {
  EXPECT_THAT(doctor::processor_list("0-2,5").value(), ElementsAre(0, 1, 2, 5));
  EXPECT_EQ(doctor::processor_text({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  for (const char* bad : {"a", "3-1", "-1", "1-", "0-999999999"}) EXPECT_FALSE(doctor::processor_list(bad)) << bad;
}

}  // namespace
}  // namespace stillcut
