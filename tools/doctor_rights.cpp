#include "tools/doctor_rights.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {
namespace {

constexpr int kCapIpcLock = 14, kCapSysNice = 23;

// A limit as people write it: a number of `unit`s, with a suffix in units, or no limit.
std::optional<std::int64_t> limit_value(std::string text, std::int64_t unit) {
  text = text.substr(0, text.find(':'));  // systemd's soft:hard; the soft one counts
  if (text == "unlimited" || text == "infinity" || text == "-1") return kUnlimited;
  for (const auto& [suffix, factor] : {std::pair{'K', 10}, std::pair{'M', 20}, std::pair{'G', 30}}) {
    if (!text.empty() && text.back() == suffix) {
      text.pop_back();
      unit = std::int64_t{1} << factor;
      break;
    }
  }
  const auto number = whole_number(text);
  if (!number || *number < 0 || *number > kUnlimited / unit) return std::nullopt;
  return *number * unit;
}

Limits of_this_process(const Host& host) {
  Limits limits;
  const auto text = host.read("/proc/self/limits");
  limits.readable = text.has_value();
  limits.source = text ? "this process" : "/proc/self/limits";
  for (const std::string& line : lines_of(text.value_or(""))) {
    const auto words = words_of(line);  // Max realtime priority SOFT HARD; Max locked memory SOFT HARD bytes
    if (words.size() < 4) continue;
    if (line.starts_with("Max realtime priority")) limits.priority = limit_value(words[3], 1);
    if (line.starts_with("Max locked memory")) limits.locked_bytes = limit_value(words[3], 1);
  }
  for (const std::string& line : lines_of(host.read("/proc/self/status").value_or(""))) {
    const auto words = words_of(line);
    if (words.size() != 2 || words[0] != "CapEff:") continue;
    const auto capabilities = whole_number(words[1], 16).value_or(0);
    limits.may_set_priority = (capabilities >> kCapSysNice & 1) != 0;
    limits.may_lock_memory = (capabilities >> kCapIpcLock & 1) != 0;
  }
  return limits;
}

constexpr std::array kUnitFolders{"/etc/systemd/system", "/run/systemd/system", "/usr/local/lib/systemd/system",
                                  "/usr/lib/systemd/system", "/lib/systemd/system"};

// The lines of a unit and of its drop-ins in the order in which systemd reads them; none where there is no such unit.
std::vector<std::string> unit_lines(const Host& host, const std::string& unit) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& file) {
    const auto more = lines_of(host.read(file).value_or(""));
    lines.insert(lines.end(), more.begin(), more.end());
  };
  const auto* const folder = std::find_if(kUnitFolders.begin(), kUnitFolders.end(),
                                          [&](const char* f) { return host.exists(std::string(f) + "/" + unit); });
  if (folder == kUnitFolders.end()) return lines;
  add(std::string(*folder) + "/" + unit);
  std::map<std::string, std::string> drop_ins;  // by name, those of an earlier folder first
  for (const char* where : kUnitFolders) {
    std::string more = where;
    more.append("/").append(unit).append(".d");
    for (const std::string& name : host.list(more)) {
      if (name.ends_with(".conf")) drop_ins.emplace(name, std::string(more).append("/").append(name));
    }
  }
  for (const auto& [name, file] : drop_ins) add(file);
  return lines;
}

std::optional<Limits> of_unit(const Host& host, const std::string& unit, const std::string& user) {
  Limits limits;
  limits.source = unit;
  limits.from_unit = true;
  std::string runs_as;
  for (const std::string& line : unit_lines(host, unit)) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const auto keys = words_of(line.substr(0, equals)), values = words_of(line.substr(equals + 1));
    const std::string key = keys.size() == 1 ? keys[0] : "", value = values.empty() ? "" : values[0];
    if (key == "User") runs_as = value;
    if (key == "LimitRTPRIO") limits.priority = limit_value(value, 1);
    if (key == "LimitMEMLOCK") limits.locked_bytes = limit_value(value, 1);
    if (key != "AmbientCapabilities") continue;
    const auto grants = [&](const char* name) { return std::find(values.begin(), values.end(), name) != values.end(); };
    limits.may_set_priority = !values.empty() && (limits.may_set_priority || grants("CAP_SYS_NICE"));
    limits.may_lock_memory = !values.empty() && (limits.may_lock_memory || grants("CAP_IPC_LOCK"));
  }
  return runs_as == user ? std::optional{limits} : std::nullopt;
}

std::vector<std::string> fields_of(std::string line) {  // name:x:1000:...; an empty field keeps its place
  std::vector<std::string> fields;
  for (std::size_t colon = 0; colon != std::string::npos; line.erase(0, colon + 1)) {
    colon = line.find(':');
    fields.push_back(line.substr(0, colon));
    if (colon == std::string::npos) break;
  }
  return fields;
}

std::set<std::string> groups_of(const Host& host, const std::string& user) {
  std::string own;
  for (const std::string& line : lines_of(host.read("/etc/passwd").value_or(""))) {
    const auto fields = fields_of(line);
    if (fields.size() > 3 && fields[0] == user) own = fields[3];
  }
  std::set<std::string> groups;
  for (const std::string& line : lines_of(host.read("/etc/group").value_or(""))) {
    const auto fields = fields_of(line);
    if (fields.size() < 4) continue;
    std::string members = fields[3];
    std::replace(members.begin(), members.end(), ',', ' ');
    const auto names = words_of(members);
    if ((!own.empty() && fields[2] == own) || std::find(names.begin(), names.end(), user) != names.end())
      groups.insert(fields[0]);
  }
  return groups;
}

// pam_limits: a line for the user goes before one for a group, that before one for all; of equals the last one holds.
Limits of_login(const Host& host, const std::string& user) {
  std::vector<std::string> files{"/etc/security/limits.conf"};
  for (const std::string& name : host.list("/etc/security/limits.d")) {
    if (name.ends_with(".conf")) files.push_back("/etc/security/limits.d/" + name);
  }
  const auto groups = groups_of(host, user);
  Limits limits;
  limits.source = "limits.conf for " + user;
  int priority_rank = 0, memory_rank = 0;
  for (const std::string& file : files) {
    for (const std::string& line : lines_of(host.read(file).value_or(""))) {
      const auto words = words_of(line.substr(0, line.find('#')));
      if (words.size() != 4 || (words[1] != "-" && words[1] != "soft")) continue;
      const std::string& domain = words[0];
      int rank = 0;
      if (domain == "*" && user != "root") rank = 1;
      if (domain.starts_with('@') && groups.contains(domain.substr(1)) && user != "root") rank = 2;
      if (domain == user) rank = 3;
      const auto take = [&](const char* item, std::int64_t unit, int& so_far, std::optional<std::int64_t>& limit) {
        if (words[2] != item || rank == 0 || rank < so_far) return;
        limit = limit_value(words[3], unit);
        so_far = rank;
      };
      take("rtprio", 1, priority_rank, limits.priority);
      take("memlock", 1024, memory_rank, limits.locked_bytes);
    }
  }
  limits.may_set_priority = limits.may_lock_memory = user == "root";
  return limits;
}

}  // namespace

Limits limits_of(const Host& host, const std::string& user) {
  if (user.empty()) return of_this_process(host);
  for (const char* unit : {"stillcutd@.service", "stillcutd.service"}) {
    if (auto limits = of_unit(host, unit, user)) return *limits;
  }
  return of_login(host, user);
}

}  // namespace stillcut::doctor
