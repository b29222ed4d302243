#include "node/udp_options.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace scree::node {
namespace {

Status set_required(int fd, int level, int option, const void* value, socklen_t size, const std::string& what,
                    const Endpoint& endpoint) {
  if (setsockopt(fd, level, option, value, size) == 0) return {};
  return unavailable(what, endpoint, errno);
}

/// The interface by its IPv4 address; "" = the kernel's choice.
Result<in_addr> parse_interface(const std::string& text, const std::string& what) {
  in_addr address{};
  if (text.empty() || inet_pton(AF_INET, text.c_str(), &address) == 1) return address;
  return Error{ErrorKind::usage, fmt::format("{}: expected the IPv4 address of an interface, found '{}'", what, text)};
}

}  // namespace

Error unavailable(const std::string& what, const Endpoint& endpoint, int error) {
  if (error == EADDRINUSE)
    return {ErrorKind::unavailable,
            fmt::format("{} {}: expected a free UDP port, found it in use", what, to_string(endpoint))};
  return {ErrorKind::unavailable, fmt::format("{} {}: {}", what, to_string(endpoint), std::strerror(error))};
}

void set_option(int fd, int level, int option, int value) {
  (void)setsockopt(fd, level, option, &value, sizeof value);
}

Status set_df(int fd, const Endpoint& endpoint, const std::string& what) {
  const int discover = endpoint.v6 ? IPV6_PMTUDISC_DO : IP_PMTUDISC_DO;
  return set_required(fd, endpoint.v6 ? IPPROTO_IPV6 : IPPROTO_IP, endpoint.v6 ? IPV6_MTU_DISCOVER : IP_MTU_DISCOVER,
                      &discover, sizeof discover, what, endpoint);
}

Status set_multicast_way(int fd, const Endpoint& group, const std::string& what, const MulticastWay& way) {
  if (group.v6) return set_required(fd, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, &way.ttl, sizeof way.ttl, what, group);
  const auto interface = parse_interface(way.interface_, what);
  if (!interface) return interface.error();
  if (auto set = set_required(fd, IPPROTO_IP, IP_MULTICAST_TTL, &way.ttl, sizeof way.ttl, what, group); !set)
    return set;
  return set_required(fd, IPPROTO_IP, IP_MULTICAST_IF, &*interface, sizeof *interface, what, group);
}

Status join_group(int fd, const Endpoint& group, const std::string& what, const std::string& interface_address) {
  if (group.v6) {
    ipv6_mreq request{};
    std::memcpy(&request.ipv6mr_multiaddr, group.address.data(), 16);
    return set_required(fd, IPPROTO_IPV6, IPV6_JOIN_GROUP, &request, sizeof request, what, group);
  }
  const auto interface = parse_interface(interface_address, what);
  if (!interface) return interface.error();
  ip_mreq request{};
  std::memcpy(&request.imr_multiaddr, group.address.data(), 4);
  request.imr_interface = *interface;
  return set_required(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request, what, group);
}

}  // namespace scree::node
