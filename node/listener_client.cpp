#include "node/listener_client.hpp"

namespace scree::node {
namespace {

std::int64_t unix_ns(Time time) {
  return time.time_since_epoch().count();
}

}  // namespace

template <class Message>
void NodeClient::send_message(const Message& message, const Send& send) {
  protocol::Header header;
  header.stream_id = stream_id_;
  header.boot_id = boot_id_;
  header.seq = ++seq_;
  protocol::Datagram datagram;
  encode(header, message, datagram, keys_.signer());
  send(datagram.view());
}

void NodeClient::subscribe(const Send& send) {
  ++counters_.subscribes;
  send_message(wish_, send);
}

void NodeClient::ping(MonotonicTime now, Time system_now, const Send& send) {
  ++counters_.pings;
  ping_sent_ = now;
  ping_open_ = true;
  send_message(protocol::Ping{++nonce_ ^ boot_id_, unix_ns(system_now)}, send);
}

void NodeClient::take_pong(const MapAssembly& assembly) {
  const auto& pong = assembly.pong();
  if (!ping_open_ || !pong || pong->message.nonce != (nonce_ ^ boot_id_)) return;
  ping_open_ = false;
  ++counters_.pongs;
  const protocol::Pong& m = pong->message;
  counters_.round_trip = pong->arrived - ping_sent_;
  // unsigned, as whoever answers may have sent any times
  const auto difference = [](std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  };
  const std::int64_t there = difference(m.t_receive_ns, m.t_request_ns);
  const std::int64_t back = difference(m.t_answer_ns, m.t_request_ns + counters_.round_trip->count());
  counters_.clock_offset = Duration(there / 2 + back / 2);
}

void NodeClient::tick(MonotonicTime now, Time system_now, MapAssembly& assembly, const Send& send) {
  take_pong(assembly);
  const auto cookie = assembly.cookie();
  const bool new_cookie = cookie && *cookie != wish_.cookie;
  if (new_cookie) wish_.cookie = *cookie;
  if (new_cookie || now >= next_subscribe_) {
    subscribe(send);
    next_subscribe_ = now + kPeriod;
  }
  if (now >= next_ping_) {
    ping(now, system_now, send);
    next_ping_ = now + kPeriod;
  }
  if (wish_.cookie == 0 || now < next_nack_) return;
  next_nack_ = now + kNackPeriod;
  protocol::Nack nack;
  nack.cookie = wish_.cookie;
  for (const protocol::LayerFormat& format : protocol::kLayers) {
    nack.layer = format.layer;
    while (assembly.take_missing(now, nack)) {
      ++counters_.nacks;
      counters_.nack_tiles += nack.count;
      send_message(nack, send);
    }
  }
}

void NodeClient::end(const Send& send) {
  wish_.layer_mask = 0;
  subscribe(send);
}

}  // namespace scree::node
