// Checks of the processors: is one set apart for the loop, does nothing interrupt it there, does it run at full speed
// and wake at once.
#include <algorithm>
#include <iterator>
#include <set>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {
namespace {

constexpr int kMostProcessors = 8192;  // more than any kernel has: a list of more is no list
constexpr std::int64_t kSlowWake_us = 10;

const std::string kCpus = "/sys/devices/system/cpu/";

std::vector<int> listed(const Host& host, const std::string& file) {
  return processor_list(host.read(kCpus + file).value_or("")).value_or(std::vector<int>{});
}

bool contains(const std::vector<int>& processors, int cpu) {
  return std::find(processors.begin(), processors.end(), cpu) != processors.end();
}

// The processor that a command should set apart: the wished one, else the last.
int chosen(const Host& host, const DoctorWishes& wishes) {
  if (wishes.cpu) return *wishes.cpu;
  const auto online = listed(host, "online");
  return online.empty() ? 1 : online.back();
}

// Where governor and idle states matter: the loop's processors; while none is set apart, all.
std::vector<int> looked_at(const Host& host, const DoctorWishes& wishes) {
  auto processors = loop_processors(host, wishes);
  if (processors.empty()) processors = listed(host, "online");
  if (!processors.empty()) return processors;
  for (const std::string& name : host.list(kCpus)) {  // a kernel that does not tell which are online
    const auto number = name.starts_with("cpu") ? whole_number(name.substr(3)) : std::nullopt;
    if (number && *number >= 0 && *number < kMostProcessors) processors.push_back(static_cast<int>(*number));
  }
  return processors;
}

std::string folder_of(int cpu) { return kCpus + "cpu" + std::to_string(cpu) + "/"; }

bool has_handler(const Host& host, const std::string& irq) {  // then a folder of the handler's name is there
  const auto names = host.list("/proc/irq/" + irq);
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    std::error_code error;
    return std::filesystem::is_directory(host.at("/proc/irq/" + irq + "/" + name), error);
  });
}

std::string housekeeping(const Host& host, const std::vector<int>& loop) {
  const auto online = listed(host, "online");
  std::vector<int> rest;
  std::copy_if(online.begin(), online.end(), std::back_inserter(rest), [&](int cpu) { return !contains(loop, cpu); });
  return rest.empty() ? "0" : processor_text(rest);
}

std::string joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

const std::string kNoneSetApart = "no processor is set apart";

}  // namespace

std::optional<std::vector<int>> processor_list(const std::string& text) {
  std::vector<int> processors;
  if (text.empty() || text == "(null)") return processors;
  std::string parts = text;
  std::replace(parts.begin(), parts.end(), ',', ' ');
  for (const std::string& part : words_of(parts)) {
    const auto dash = part.find('-');
    const auto first = whole_number(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : whole_number(part.substr(dash + 1));
    if (!first || !last || *first < 0 || *last < *first || *last >= kMostProcessors) return std::nullopt;
    for (auto cpu = static_cast<int>(*first); cpu <= *last; ++cpu) processors.push_back(cpu);
  }
  std::sort(processors.begin(), processors.end());
  return processors;
}

std::string processor_text(const std::vector<int>& processors) {
  std::string text;
  for (std::size_t i = 0; i < processors.size(); ++i) {
    std::size_t last = i;
    while (last + 1 < processors.size() && processors[last + 1] == processors[last] + 1) ++last;
    if (!text.empty()) text += ',';
    text += std::to_string(processors[i]);
    if (last > i) text.append(1, '-').append(std::to_string(processors[last]));
    i = last;
  }
  return text;
}

std::vector<int> loop_processors(const Host& host, const DoctorWishes& wishes) {
  if (wishes.cpu) return {*wishes.cpu};
  const auto isolated = listed(host, "isolated"), online = listed(host, "online");
  std::vector<int> both;
  std::set_intersection(isolated.begin(), isolated.end(), online.begin(), online.end(), std::back_inserter(both));
  return both;
}

Check check_isolated(const Host& host, const DoctorWishes& wishes) {
  const std::string cpu = std::to_string(chosen(host, wishes));
  const Subject subject{"isolated processor", wishes.cpu ? "processor " + cpu + " for the loop alone" : "one at least"};
  const auto online = listed(host, "online");
  if (wishes.cpu && !online.empty() && !contains(online, *wishes.cpu))
    return subject.not_ok("processor " + cpu + " is not online", "echo 1 > " + folder_of(*wishes.cpu) + "online");
  if (online.size() == 1) return subject.not_applicable("one processor in all");
  const std::string mend = boot_with("isolcpus=managed_irq,domain," + cpu + " rcu_nocbs=" + cpu, "isolated");
  const auto text = host.read(kCpus + "isolated");
  const auto isolated = processor_list(text.value_or("?"));
  if (!isolated) return subject.not_ok(kUnreadable + kCpus + "isolated", mend);
  if (loop_processors(host, {}).empty()) return subject.not_ok("none", mend);
  if (wishes.cpu && !contains(*isolated, *wishes.cpu)) return subject.not_ok(*text, mend);
  return subject.ok(processor_text(*isolated));
}

Check check_tickless(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"tickless processor", "no timer tick where the loop runs (nohz_full)"};
  const auto loop = loop_processors(host, wishes);
  if (loop.empty() || listed(host, "online").size() == 1) return subject.not_applicable(kNoneSetApart);
  const std::string mend = boot_with("nohz_full=" + processor_text(loop), "tickless");
  const auto text = host.read(kCpus + "nohz_full");
  const auto tickless = processor_list(text.value_or("?"));
  if (!host.exists(kCpus + "nohz_full")) return subject.not_ok("this kernel cannot", kFullKernel);
  if (!tickless) return subject.not_ok(kUnreadable + kCpus + "nohz_full", mend);
  const bool all = std::all_of(loop.begin(), loop.end(), [&](int cpu) { return contains(*tickless, cpu); });
  const std::string found = tickless->empty() ? "none" : processor_text(*tickless);
  return all ? subject.ok(found) : subject.not_ok(found, mend);
}

Check check_interrupts(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"interrupts", "none of a device where the loop runs"};
  const auto loop = loop_processors(host, wishes);
  if (loop.empty() || listed(host, "online").size() == 1) return subject.not_applicable(kNoneSetApart);
  std::string irqs, unreadable;
  for (const std::string& irq : host.list("/proc/irq")) {
    if (!whole_number(irq) || !has_handler(host, irq)) continue;
    auto affinity =
        host.read("/proc/irq/" + irq + "/effective_affinity_list");  // where it goes now, if the kernel tells
    if (!affinity || affinity->empty()) affinity = host.read("/proc/irq/" + irq + "/smp_affinity_list");
    const auto processors = processor_list(affinity.value_or("?"));
    if (!processors) unreadable += " " + irq;
    if (processors && std::any_of(loop.begin(), loop.end(), [&](int cpu) { return contains(*processors, cpu); }))
      irqs += " " + irq;
  }
  if (irqs.empty() && unreadable.empty()) return subject.ok("none on " + processor_text(loop));
  const std::string found =
      irqs.empty() ? kUnreadable + "affinity of" + unreadable : "on " + processor_text(loop) + ":" + irqs;
  return subject.not_ok(found, "for i in" + (irqs.empty() ? unreadable : irqs) + "; do echo " +
                                   housekeeping(host, loop) + " > /proc/irq/$i/smp_affinity_list; done");
}

Check check_governor(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"frequency governor", "performance"};
  std::set<std::string> found;
  std::string files;
  for (const int cpu : looked_at(host, wishes)) {
    const std::string file = folder_of(cpu) + "cpufreq/scaling_governor";
    if (!host.exists(file)) continue;
    const auto governor = host.read(file);
    if (governor != "performance") files += " " + file;
    found.insert(governor && !governor->empty() ? *governor : kUnreadable + file);
  }
  if (found.empty()) return subject.not_applicable("no frequency scaling here");
  return files.empty() ? subject.ok("performance") : subject.not_ok(joined(found), "echo performance | tee" + files);
}

Check check_idle_states(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"idle states", "none that takes more than 10 us to leave"};
  std::set<std::string> slow;
  std::string files;
  bool any = false;
  for (const int cpu : looked_at(host, wishes)) {
    for (const std::string& state : host.list(folder_of(cpu) + "cpuidle")) {
      if (!state.starts_with("state")) continue;
      any = true;
      const std::string folder = folder_of(cpu) + "cpuidle/" + state + "/";
      const auto latency = whole_number(host.read(folder + "latency").value_or(""));
      if (latency && *latency <= kSlowWake_us) continue;
      if (host.read(folder + "disable") == "1") continue;
      const std::string name = host.read(folder + "name").value_or(state);
      slow.insert(name + " " + (latency ? std::to_string(*latency) + " us" : "unknown"));
      files += " " + folder + "disable";
    }
  }
  if (!any) return subject.not_applicable("the kernel has no idle states to choose from");
  return files.empty() ? subject.ok("all quick or switched off") : subject.not_ok(joined(slow), "echo 1 | tee" + files);
}

}  // namespace stillcut::doctor
