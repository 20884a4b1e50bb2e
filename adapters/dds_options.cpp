#include "adapters/dds_options.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "adapters/udp_port.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kLongestName = 200;  // Fast DDS's names end at 255, topics have theirs behind it

// A whole number of digits alone, or -1.
int number_in(const std::string& text) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? number : -1;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_host(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '-'; });
}

}  // namespace

std::string complain_of_domain(const std::string& text) {
  const int domain = number_in(text);
  if (domain >= 0 && domain <= kMaxDomain) return "";
  return "'" + text + "' is no DDS domain; --domain and ROS_DOMAIN_ID take 0 to " + std::to_string(kMaxDomain);
}

std::string complain_of_namespace(const std::string& text) {
  bool good = text.size() <= kLongestName && !text.empty() && text.back() != '/';
  char before = '/';
  for (const char c : text) {
    good = good && (is_letter(c) || (before != '/' && (is_digit(c) || c == '_' || c == '/')));
    before = c;
  }
  return good ? "" : "'" + text + "' is no ROS 2 name; write letters, digits and '_', a letter first: cell_2";
}

std::string complain_of_partition(const std::string& text) {
  const bool good = !text.empty() && text.size() <= kLongestName && text.find_first_of("*?[") == std::string::npos;
  return good ? "" : "'" + text + "' is no partition to publish in; write a name without '*', '?' and '['";
}

std::string complain_of_servers(const std::string& text) {
  std::istringstream servers{text};
  bool any = false, good = true;
  for (std::string server; std::getline(servers, server, ';');) {
    if (server.empty()) continue;  // a number that is left out, as ROS 2 allows
    const std::size_t colon = server.find(':');
    const int port = colon == std::string::npos ? 1 : number_in(server.substr(colon + 1));
    good = good && is_host(server.substr(0, colon)) && port >= 1 && port <= 65535;
    any = true;
  }
  return any && good ? "" : "'" + text + "' names no discovery server; write HOST:PORT, e.g. 192.168.1.2:11811";
}

void add_dds_options(CLI::App& app, DdsOptions& options) {
  app.add_option("CELL", options.cell, "cell file: LCM address, on which its monitor speaks");
  app.add_flag("--listen", options.listen, "without CELL: print what is heard on these topics");
  app.add_option("--lcm", options.lcm, "LCM address, instead of the cell's");
  app.add_option("--domain", options.dds.domain, "DDS domain, 0 to 232")
      ->envname("ROS_DOMAIN_ID")
      ->check(complain_of_domain)
      ->capture_default_str();
  app.add_option("--namespace", options.name, "first part of the topics' names; another for each cell")
      ->check(complain_of_namespace)
      ->capture_default_str();
  app.add_option("--partition", options.dds.partition, "DDS partition (default: none, as ROS 2 nodes)")
      ->check(complain_of_partition);
  app.add_option("--discovery-server", options.dds.discovery_server,
                 "HOST:PORT, instead of finding others by multicast")
      ->envname("ROS_DISCOVERY_SERVER")
      ->check(complain_of_servers);
  app.add_flag("--shared-memory", options.dds.shared_memory,
               "beside UDP, towards processes of the same user on this host");
  app.add_option("--interface", options.dds.interface_address, "address of the only network interface to use")
      ->check([](const std::string& text) {
        return read_ipv4_address(text + ":1") ? ""
                                              : "'" + text + "' is no address of this host; write e.g. 192.168.1.10";
      });
  app.add_option("--duration", options.duration_s, "end after this many seconds (default: on SIGTERM)");
}

}  // namespace stillcut
