#include "drivers/frame_server.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "drivers/stream_server.hpp"
#include "drivers/stream_socket.hpp"
#ifdef SCREE_WITH_USBREDIR
#include "drivers/usbredir_server.hpp"
#endif

namespace scree::drivers {
namespace {

constexpr std::string_view kUsbredir = "usbredir:";

bool is_stream(const std::string& address) {
  return address.starts_with("unix:") || address.starts_with("tcp:");
}

template <class Server>
Result<std::unique_ptr<FrameServer>> owned(Result<Server> server) {
  if (!server) return server.error();
  return std::unique_ptr<FrameServer>(std::make_unique<Server>(*std::move(server)));
}

}  // namespace

std::size_t LinkState::allowed(std::size_t total, Duration elapsed) const {
  if (unplugged || frozen) return 0;
  if (frame_time <= Duration{0}) return total;
  const double share = std::clamp(to_seconds(elapsed) / to_seconds(frame_time), 0.0, 1.0);
  return static_cast<std::size_t>(share * static_cast<double>(total));
}

Result<std::unique_ptr<FrameServer>> open_frame_server(const std::string& address,
                                                       [[maybe_unused]] const ServedShape& shape) {
  if (is_stream(address)) return owned(StreamServer::open(address));
#ifdef SCREE_WITH_USBREDIR
  if (address.starts_with(kUsbredir)) return UsbredirServer::open(address.substr(kUsbredir.size()), shape);
  const std::string also = ", or usbredir:PATH";
#else
  const std::string also = " in a build without SCREE_WITH_USBREDIR";
#endif
  return Error{ErrorKind::usage,
               "--serve: expected " + std::string(kStreamAddressGrammar) + also + ", found '" + address + "'"};
}

}  // namespace scree::drivers
