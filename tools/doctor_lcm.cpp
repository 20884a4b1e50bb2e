// Checks of LCM: the address's route, the interface at its end, and whether LCM hears itself there.
#include <arpa/inet.h>
#include <net/if.h>

#include <bit>

#include "tools/doctor_checks.hpp"

namespace stillcut::doctor {
namespace {

constexpr std::int64_t kRouteUp = 0x1, kRouteReject = 0x200;  // RTF_UP, RTF_REJECT of /proc/net/route

const std::string kRoutes = "/proc/net/route", kInterfaces = "/sys/class/net/";

// "udpm://ADDRESS:PORT?ttl=N"; LCM's own defaults for what is left out.
struct MulticastAddress {
  std::string text = "239.255.76.67";
  bool local = true;  // ttl 0: messages do not leave this machine
};

std::optional<MulticastAddress> address_of(const std::string& url) {
  const std::string scheme = "udpm://";
  if (!url.starts_with(scheme)) return std::nullopt;
  MulticastAddress address;
  const std::string rest = url.substr(scheme.size());
  const std::string host = rest.substr(0, rest.find_first_of(":?"));
  if (!host.empty()) address.text = host;
  const auto ttl = rest.find("ttl=");
  if (ttl != std::string::npos) address.local = rest.substr(ttl + 4, rest.find('&', ttl) - ttl - 4) == "0";
  return address;
}

std::optional<std::uint32_t> number_of(const std::string& address) {  // in network order, as the routing table has it
  in_addr number{};
  return inet_aton(address.c_str(), &number) != 0 ? std::optional<std::uint32_t>{number.s_addr} : std::nullopt;
}

struct Route {
  std::string interface;
  bool by_default = false;  // only because it is the way to everything
};

// The route that the kernel would take: the narrowest that fits, then the smallest metric.
std::optional<Route> route_to(const std::string& table, std::uint32_t address) {
  std::optional<Route> best;
  int best_bits = -1;
  std::int64_t best_metric = 0;
  for (const std::string& line : lines_of(table)) {
    const auto words = words_of(line);  // Iface Destination Gateway Flags RefCnt Use Metric Mask ...
    if (words.size() < 8) continue;
    const auto destination = whole_number(words[1], 16), flags = whole_number(words[3], 16),
               mask = whole_number(words[7], 16), metric = whole_number(words[6]);
    if (!destination || !flags || !mask || !metric || (*flags & kRouteUp) == 0) continue;
    const auto bits = std::popcount(static_cast<std::uint32_t>(*mask));
    if ((address & static_cast<std::uint32_t>(*mask)) != static_cast<std::uint32_t>(*destination)) continue;
    if (bits < best_bits || (bits == best_bits && *metric >= best_metric)) continue;
    best_bits = bits;
    best_metric = *metric;
    best.reset();  // a narrower one that rejects takes the way away
    if ((*flags & kRouteReject) == 0) best = Route{words[0], bits == 0};
  }
  return best;
}

std::optional<Route> route_of(const Host& host, const DoctorWishes& wishes) {
  const auto address = address_of(wishes.lcm_url);
  const auto number = address ? number_of(address->text) : std::nullopt;
  return number ? route_to(host.read(kRoutes).value_or(""), *number) : std::nullopt;
}

std::int64_t flags_of(const Host& host, const std::string& interface) {
  return whole_number(host.read(kInterfaces + interface + "/flags").value_or(""), 16).value_or(-1);
}

// Where messages should go: on this machine alone by loopback, else by the first network interface that is up.
std::string fitting_interface(const Host& host, const MulticastAddress& address) {
  if (address.local) return "lo";
  for (const std::string& name : host.list(kInterfaces)) {
    const std::int64_t flags = flags_of(host, name);
    if (flags > 0 && (flags & (IFF_UP | IFF_MULTICAST)) == (IFF_UP | IFF_MULTICAST) && (flags & IFF_LOOPBACK) == 0)
      return name;
  }
  return "lo";
}

std::string multicast_on(const std::string& interface) {
  const std::string set = "ip link set " + shell_word(interface);
  return set + " up; " + set + " multicast on";
}

constexpr const char* kNoMulticast = "LCM does not go by multicast here";

}  // namespace

Check check_lcm_route(const Host& host, const DoctorWishes& wishes) {
  const auto address = address_of(wishes.lcm_url);
  const Subject subject{"LCM route", address ? "a route to " + address->text : "udpm:// addresses only"};
  if (!address) return subject.not_applicable(kNoMulticast);
  const std::string interface = fitting_interface(host, *address);
  const std::string mend = multicast_on(interface) + "; ip route replace 224.0.0.0/4 dev " + shell_word(interface);
  const auto number = number_of(address->text);
  if (!number || !IN_MULTICAST(ntohl(*number)))
    return subject.not_ok(
        "no multicast address",
        "sed -i " + shell_word("s|" + wishes.lcm_url + "|udpm://239.255.76.67:7667?ttl=0|") + " CELL  # [lcm] url");
  if (!host.read(kRoutes)) return subject.not_ok(kUnreadable + kRoutes, mend);
  const auto route = route_of(host, wishes);
  if (!route) return subject.not_ok("none", mend);
  return subject.ok(route->interface + (route->by_default ? ", the default route" : ""));
}

Check check_lcm_interface(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"LCM interface", "up, multicast on"};
  if (!address_of(wishes.lcm_url)) return subject.not_applicable(kNoMulticast);
  const auto route = route_of(host, wishes);
  if (!route) return subject.not_applicable("no route leads to one");
  const std::string mend = multicast_on(route->interface);
  const std::int64_t flags = flags_of(host, route->interface);
  if (flags < 0) return subject.not_ok(kUnreadable + kInterfaces + route->interface + "/flags", mend);
  const bool up = (flags & IFF_UP) != 0, multicast = (flags & IFF_MULTICAST) != 0;
  const std::string found =
      route->interface + (up ? " up" : " down") + (multicast ? ", multicast on" : ", multicast off");
  return up && multicast ? subject.ok(found) : subject.not_ok(found, mend);
}

Check check_lcm_hears_itself(const Host& host, const DoctorWishes& wishes) {
  const Subject subject{"LCM loopback", "LCM hears its own message"};
  if (!host.lcm_hears_itself) return subject.not_applicable("not tried in a copied folder");
  if (!address_of(wishes.lcm_url)) return subject.not_applicable(kNoMulticast);
  if (!check_lcm_route(host, wishes).ok() || !check_lcm_interface(host, wishes).ok())
    return subject.not_applicable("as route and interface are");
  if (host.lcm_hears_itself(wishes.lcm_url)) return subject.ok("heard");
  return subject.not_ok("not heard", "iptables -I INPUT -p udp -d " + shell_word(address_of(wishes.lcm_url)->text) +
                                         " -j ACCEPT  # if a firewall drops it; nft and firewalld have their own");
}

}  // namespace stillcut::doctor
