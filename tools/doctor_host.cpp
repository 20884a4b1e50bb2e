#include "tools/doctor_host.hpp"

#include <lcm/lcm.h>
#include <sys/statvfs.h>
#include <sys/timex.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <fstream>
#include <sstream>

namespace stillcut {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;

std::optional<ClockSync> kernel_clock() {
  timex clock{};  // modes 0: only asks
  const int state = adjtimex(&clock);
  if (state < 0) return std::nullopt;
  const bool synchronized = state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0;
  return ClockSync{synchronized, static_cast<double>(clock.maxerror) * 1e-6};
}

std::optional<std::int64_t> kernel_timer_resolution() {
  timespec resolution{};
  if (clock_getres(CLOCK_MONOTONIC, &resolution) != 0) return std::nullopt;
  return resolution.tv_sec * 1'000'000'000LL + resolution.tv_nsec;
}

std::optional<std::uint64_t> room(const std::filesystem::path& folder) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

// LCM sends itself a message before it says that it is ready.
bool lcm_starts(const std::string& url) {
  lcm_t* const lcm = lcm_create(url.c_str());
  if (lcm != nullptr) lcm_destroy(lcm);
  return lcm != nullptr;
}

constexpr const char* kSysNet = "/sys/class/net";
constexpr std::int64_t kArpTypeCan = 280;  // ARPHRD_CAN

std::vector<CanLink> can_links_of_files(const Host& host) {
  std::vector<CanLink> links;
  for (const std::string& name : host.list(kSysNet)) {
    const auto number = [&](const char* file, int base) {
      return whole_number(host.read(std::string(kSysNet) + "/" + name + "/" + file).value_or(""), base).value_or(0);
    };
    if (number("type", 10) != kArpTypeCan) continue;
    CanLink link;
    link.name = name;
    link.up = (number("flags", 16) & 1) != 0;
    link.mtu = static_cast<unsigned>(number("mtu", 10));
    links.push_back(link);
  }
  return links;
}

}  // namespace

std::filesystem::path Host::at(const std::string& file) const {
  return root / std::filesystem::path(file).relative_path();
}

std::optional<std::string> Host::read(const std::string& file) const {
  std::error_code error;
  const auto kind = std::filesystem::status(at(file), error).type();
  if (kind != std::filesystem::file_type::regular) return std::nullopt;  // a pipe would wait for ever
  std::ifstream in{at(file), std::ios::binary};
  if (!in) return std::nullopt;
  std::string text;
  std::array<char, 4096> part{};
  while (text.size() < kMostBytes) {
    in.read(part.data(), part.size());
    text.append(part.data(), static_cast<std::size_t>(in.gcount()));
    if (!in) break;
  }
  if (in.bad()) return std::nullopt;
  const std::string around(" \t\r\n\0", 5);
  const auto first = text.find_first_not_of(around);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(around) - first + 1);
}

bool Host::exists(const std::string& file) const {
  std::error_code error;
  return std::filesystem::exists(at(file), error);
}

std::vector<std::string> Host::list(const std::string& folder) const {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry{at(folder), error}, end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Host this_host() { return {"/", can_links_of_kernel, kernel_timer_resolution, kernel_clock, room, lcm_starts}; }

Host copied_host(const std::filesystem::path& root) {
  Host host;
  host.root = root;
  host.can_links = [files = Host{root, {}, {}, {}, {}, {}}] { return can_links_of_files(files); };
  return host;
}

std::optional<std::int64_t> whole_number(const std::string& text, int base) {
  const char *first = text.data(), *const last = first + text.size();
  if (base == 16 && text.starts_with("0x")) first += 2;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(first, last, number, base);
  if (error != std::errc{} || end != last) return std::nullopt;
  return number;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in{text};
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream in{line};
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace stillcut
