// Checks of the kernel as it was built and set: flavour, timers, clock, throttling, memory.
#include <algorithm>
#include <array>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {

std::string boot_with(const std::string& words, const std::string& topic) {
  return "echo 'GRUB_CMDLINE_LINUX=\"$GRUB_CMDLINE_LINUX " + words + "\"' > /etc/default/grub.d/stillcut-" + topic +
         ".cfg && update-grub && reboot";
}

Check check_kernel(const Host& host, const DoctorWishes&) {
  const Subject subject{"kernel", "PREEMPT_RT"};
  const std::string release = host.read("/proc/sys/kernel/osrelease").value_or("");
  const std::string version = host.read("/proc/sys/kernel/version").value_or("");
  if (release.empty() && version.empty())
    return subject.not_ok(kUnreadable + "/proc/sys/kernel/version", "mount -t proc proc /proc");
  const bool real_time = host.read("/sys/kernel/realtime") == "1" || version.find("PREEMPT_RT") != std::string::npos ||
                         version.find("PREEMPT RT") != std::string::npos;
  if (real_time) return subject.ok(release + " PREEMPT_RT");
  const bool preemptible = version.find("PREEMPT") != std::string::npos;
  return subject.not_ok(release + (preemptible ? " without PREEMPT_RT" : " not preemptible"), kFullKernel);
}

Check check_timer_resolution(const Host& host, const DoctorWishes&) {
  const Subject subject{"timer resolution", "1 ns"};
  if (!host.timer_resolution_ns) return subject.not_applicable("not told by a copied folder");
  const auto resolution = host.timer_resolution_ns();
  if (resolution == 1) return subject.ok("1 ns");
  const auto words = words_of(host.read("/proc/cmdline").value_or(""));
  const auto off = std::find(words.begin(), words.end(), "highres=off");
  return subject.not_ok(
      resolution ? std::to_string(*resolution) + " ns" : "not told by clock_getres",
      off == words.end() ? kFullKernel : "sed -i 's/highres=off//' /etc/default/grub && update-grub && reboot");
}

Check check_clock_source(const Host& host, const DoctorWishes&) {
  // Read by a program without entering the kernel; others (hpet, acpi_pm, jiffies) cost microseconds or are coarse.
  constexpr std::array kQuick{"tsc", "arch_sys_counter", "kvm-clock", "hyperv_clocksource_tsc_page",
                              "riscv_clocksource"};
  const std::string folder = "/sys/devices/system/clocksource/clocksource0/";
  const Subject subject{"clock source", "tsc, or another that is read without a system call"};
  const auto now = host.read(folder + "current_clocksource");
  if (now && std::find(kQuick.begin(), kQuick.end(), *now) != kQuick.end()) return subject.ok(*now);
  const auto available = words_of(host.read(folder + "available_clocksource").value_or(""));
  const auto quick = std::find_first_of(kQuick.begin(), kQuick.end(), available.begin(), available.end());
  return subject.not_ok(now ? *now : kUnreadable + folder + "current_clocksource",
                        quick != kQuick.end() ? std::string("echo ") + *quick + " > " + folder + "current_clocksource"
                                              : boot_with("tsc=reliable clocksource=tsc", "clock"));
}

Check check_throttling(const Host& host, const DoctorWishes&) {
  constexpr std::int64_t kDefault_us = 950'000;
  const std::string file = "/proc/sys/kernel/sched_rt_runtime_us";
  const Subject subject{"real-time throttling", "950000 us a second for real-time threads, or -1 (no limit)"};
  const std::string mend = "sysctl -w kernel.sched_rt_runtime_us=950000";
  const auto text = host.read(file);
  const auto runtime = whole_number(text.value_or(""));
  if (!runtime) return subject.not_ok(kUnreadable + file, mend);
  if (*runtime == -1) return subject.ok("-1: a real-time thread that never sleeps would stop the host");
  const std::string found = *text + " us";
  return *runtime >= kDefault_us ? subject.ok(found) : subject.not_ok(found, mend);
}

Check check_huge_pages(const Host& host, const DoctorWishes&) {
  const std::string file = "/sys/kernel/mm/transparent_hugepage/enabled";
  const Subject subject{"transparent huge pages", "madvise or never"};
  if (!host.exists(file)) return subject.not_applicable("this kernel has none");
  const std::string text = host.read(file).value_or("");
  for (const char* choice : {"madvise", "never"}) {
    if (text.find('[' + std::string(choice) + ']') != std::string::npos) return subject.ok(choice);
  }
  const bool always = text.find("[always]") != std::string::npos;
  return subject.not_ok(always ? "always" : kUnreadable + file, "echo madvise > " + file);
}

Check check_swap(const Host& host, const DoctorWishes&) {
  const Subject subject{"swap", "none"};
  if (!host.exists("/proc/swaps")) return subject.not_applicable("this kernel has none");
  const auto text = host.read("/proc/swaps");
  const auto lines = lines_of(text.value_or(""));
  if (lines.empty()) return subject.not_ok(kUnreadable + "/proc/swaps", "swapoff -a");
  std::string found;
  for (std::size_t i = 1; i < lines.size(); ++i) {  // the first line is the table's head
    const auto words = words_of(lines[i]);
    if (!words.empty()) found += (found.empty() ? "" : ", ") + words[0];
  }
  if (found.empty()) return subject.ok("none");
  return subject.not_ok(found, "swapoff -a  # and take it out of /etc/fstab");
}

}  // namespace stillcut::doctor
