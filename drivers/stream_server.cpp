#include "drivers/stream_server.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace scree::drivers {

Result<StreamServer> StreamServer::open(const std::string& address) {
  auto parsed = parse_stream_address(address, "--serve");
  if (!parsed) return parsed.error();
  auto listener = StreamSocket::listen_at(*parsed);
  if (!listener) return listener.error();
  if (parsed->kind != StreamAddress::Kind::unix_path) parsed->port = listener->local_port();
  return StreamServer(*std::move(parsed), *std::move(listener));
}

void StreamServer::serve() {
  if (link_.unplugged) return;
  if (!listener_) {  // replugged; an address that somebody else has taken meanwhile is tried again in the next round
    if (auto again = StreamSocket::listen_at(address_)) listener_ = *std::move(again);
  }
  while (listener_) {
    auto came = listener_->accept();
    if (!came) break;
    ++counters_.readers;
    if (readers_.size() < kMaxReaders)
      readers_.push_back({*std::move(came), nullptr, 0, {}});
    else
      ++counters_.readers_refused;
  }
  push_all();
}

void StreamServer::send(const ServedFrame& frame) {
  if (readers_.empty()) ++counters_.unread;
  for (Reader& reader : readers_) {
    if (reader.message != nullptr) {
      ++counters_.superseded;
      continue;
    }
    reader.message = frame.message;
    reader.sent = 0;
    reader.began = MonotonicClock::now();
  }
  push_all();
}

bool StreamServer::busy() const {
  return std::any_of(readers_.begin(), readers_.end(), [](const Reader& r) { return r.message != nullptr; });
}

void StreamServer::set_link(const LinkState& link) {
  link_ = link;
  if (!link.unplugged) return;
  counters_.broken += static_cast<std::uint64_t>(
      std::count_if(readers_.begin(), readers_.end(), [](const Reader& r) { return r.message != nullptr; }));
  readers_.clear();
  listener_.reset();
}

void StreamServer::push_all() {
  std::erase_if(readers_, [this](Reader& reader) { return !push(reader); });
}

/// False when the reader is gone.
bool StreamServer::push(Reader& reader) {
  std::array<std::uint8_t, 256> heard;  // readers have nothing to say; this is how their leaving is noticed
  StreamSocket::Moved moved = reader.socket.read(heard, std::chrono::milliseconds(0));
  if (!moved.closed && reader.message != nullptr) {
    const auto elapsed = std::chrono::duration_cast<Duration>(MonotonicClock::now() - reader.began);
    const std::size_t until = std::max(link_.allowed(reader.message->size(), elapsed), reader.sent);
    moved = reader.socket.write(std::span(*reader.message).subspan(reader.sent, until - reader.sent));
    reader.sent += moved.bytes;
    if (reader.sent == reader.message->size()) {
      ++counters_.sent;
      reader.message = nullptr;
    }
  }
  if (moved.closed && reader.message != nullptr) ++counters_.broken;
  return !moved.closed;
}

}  // namespace scree::drivers
