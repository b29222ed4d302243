#pragma once
// What a UDP socket is told when it is opened. Part of UdpSocket: nothing else works on file descriptors.

#include <string>

#include "core/result.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

/// `error` is an errno; `what` names the setting that `endpoint` is of.
Error unavailable(const std::string& what, const Endpoint& endpoint, int error);
/// A wish, as buffer sizes are.
void set_option(int fd, int level, int option, int value);
/// Never fragment.
Status set_df(int fd, const Endpoint& endpoint, const std::string& what);
Status set_multicast_way(int fd, const Endpoint& group, const std::string& what, const MulticastWay& way);
/// On the interface with this IPv4 address; "" = the kernel's choice.
Status join_group(int fd, const Endpoint& group, const std::string& what, const std::string& interface_address);

}  // namespace scree::node
