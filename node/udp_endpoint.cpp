#include <arpa/inet.h>
#include <charconv>
#include <fmt/format.h>
#include <netinet/in.h>

#include "node/udp_socket.hpp"

namespace scree::node {

Result<Endpoint> parse_address(const std::string& text, const std::string& what) {
  Endpoint out;
  const std::string name = text == "localhost" ? "127.0.0.1" : text;
  if (inet_pton(AF_INET, name.c_str(), out.address.data()) == 1) return out;
  out.v6 = true;
  const bool bracketed = name.size() > 2 && name.front() == '[' && name.back() == ']';
  const std::string bare = bracketed ? name.substr(1, name.size() - 2) : name;
  if (inet_pton(AF_INET6, bare.c_str(), out.address.data()) == 1) return out;
  return Error{ErrorKind::usage,
               fmt::format("{}: expected a numeric address such as 127.0.0.1, found '{}'", what, text)};
}

Result<Endpoint> parse_endpoint(const std::string& text, const std::string& what) {
  const std::size_t colon = text.rfind(':');
  unsigned port = 65536;
  if (colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + colon + 1, end, port);
    if (parsed.ec != std::errc{} || parsed.ptr != end) port = 65536;
  }
  if (port > 65535)
    return Error{ErrorKind::usage,
                 fmt::format("{}: expected ADDRESS:PORT with a port of 0 … 65535, found '{}'", what, text)};
  auto address = parse_address(text.substr(0, colon), what);
  if (!address) return address.error();
  address->port = static_cast<std::uint16_t>(port);
  return address;
}

std::string to_string(const Endpoint& endpoint) {
  char text[INET6_ADDRSTRLEN] = "";
  inet_ntop(endpoint.v6 ? AF_INET6 : AF_INET, endpoint.address.data(), text, sizeof text);
  return endpoint.v6 ? fmt::format("[{}]:{}", text, endpoint.port) : fmt::format("{}:{}", text, endpoint.port);
}

}  // namespace scree::node
