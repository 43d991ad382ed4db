#include "tools/doctor/checks/bus_checks.hpp"

#include <fmt/format.h>

namespace curbstone::doctor::checks {

namespace {

std::string route_by_hand(const BusAddress& address) {
  return fmt::format("ip route replace {}/32 dev lo", address.group);
}

Verdict check_route(const BusAddress& address, const std::optional<RouteFacts>& route) {
  if (!route) {
    return finding("route", fmt::format("{} has no route: nothing can be sent", address.group),
                   "ip link set lo up; ip link set lo multicast on; " + route_by_hand(address) +
                       " (systemctl enable --now curbstone-network)");
  }
  const std::string way = fmt::format("{} goes over {}", address.group, route->interface);
  if (address.ttl == 0 && !route->is_loopback) {
    return finding("route", fmt::format("{}: the bus of this host ends when that interface does", way),
                   route_by_hand(address));
  }
  return good("route", way);
}

Verdict check_ttl(const BusAddress& address, const RouteFacts& route) {
  if (address.ttl == 0) return good("ttl", "0: no message leaves this host");
  if (route.is_default) {
    return finding(
        "ttl",
        fmt::format("{} on the default route, over {}: the bus is open to that network", address.ttl, route.interface),
        "ttl=0 in the URL; for several hosts curbstone-relay, over a wire of their own");
  }
  return good("ttl", fmt::format("{}, over {}", address.ttl, route.interface));
}

Verdict check_round_trip(const BusProbeFacts& probe) {
  if (!probe.error.empty())
    return finding("round trip", probe.error, "mend the route; free the port: ss -ulpn shows who has it");
  if (!probe.round_trip)
    return finding("round trip", "a message was sent and not heard", "nft list ruleset: does a rule drop multicast?");
  return good("round trip", fmt::format("a message was heard after {} us", *probe.round_trip));
}

Verdict check_buffer(const BusAddress& address, const BusProbeFacts& probe) {
  if (address.buffer == 0) {
    return finding("receive buffer",
                   fmt::format("the URL asks for none, the default is {} bytes", probe.granted_buffer),
                   "add recv_buf_size=4194304 to LCM_DEFAULT_URL");
  }
  if (probe.granted_buffer < address.buffer) {
    return finding("receive buffer",
                   fmt::format("{} bytes of {}: bursts are lost", probe.granted_buffer, address.buffer),
                   fmt::format("sysctl -w net.core.rmem_max={} (60-curbstone.conf in /etc/sysctl.d)", address.buffer));
  }
  return good("receive buffer", fmt::format("{} bytes", address.buffer));
}

Verdict check_other_groups(const BusAddress& address, const BusProbeFacts& probe) {
  if (probe.other_groups.empty()) return good("port", fmt::format("{} is ours alone", address.port));
  const auto& [group, count] = *probe.other_groups.begin();
  return finding(
      "port",
      fmt::format("{} messages to {} came on port {}: LCM 1.3.1 takes them for ours", count, group, address.port),
      "give one of the two buses another port: LCM_DEFAULT_URL");
}

Verdict check_drops(const BusProbeFacts& probe) {
  if (probe.kernel_drops == 0) return good("losses", "no socket on this port has lost a message");
  return unknown(
      "losses",
      fmt::format("sockets on this port have dropped {} datagrams, those filtered out included", probe.kernel_drops),
      "dropped.kernel in SERVICE_STATUS has the losses: curbstone spy");
}

}  // namespace

Verdicts check_bus(const BusFacts& facts) {
  const auto address = parse_bus_url(facts.url);
  if (!address) {
    return {finding("bus", facts.url + " is no multicast bus",
                    "LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304'")};
  }
  Verdicts verdicts = {check_route(*address, facts.route)};
  if (facts.route) verdicts.push_back(check_ttl(*address, *facts.route));
  verdicts.push_back(check_round_trip(facts.probe));
  if (facts.probe.granted_buffer > 0) verdicts.push_back(check_buffer(*address, facts.probe));
  if (facts.probe.error.empty()) {
    verdicts.push_back(check_other_groups(*address, facts.probe));
    verdicts.push_back(check_drops(facts.probe));
  }
  return verdicts;
}

}  // namespace curbstone::doctor::checks
