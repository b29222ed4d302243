// What clients may send to the node: reader, cookies, leases. An input is a session: for each datagram a command byte,
// a byte for the client, one for the time since the one before (in 16 ms), a u16 length and the bytes of the body.
// Lengths, CRC and MAC always fit; by the command's bits the cookie is the client's own and one byte is spoilt behind
// them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "node/subscriptions.hpp"

namespace {

using namespace scree;
using namespace scree::node;
using namespace scree::node::protocol;

constexpr std::uint32_t kStream = 7;
constexpr std::size_t kLimit = 3;

void expect(bool condition) {
  if (!condition) std::abort();
}

KeyRing make_keys() {
  KeyRing keys;
  (void)keys.add({1, {0x5A}});
  return keys;
}
const KeyRing kKeys = make_keys();

Endpoint client_of(std::uint8_t number) {
  Endpoint out;
  out.address[0] = 127;
  out.port = static_cast<std::uint16_t>(5000 + number % 6);
  return out;
}

Datagram make_datagram(std::uint8_t command, std::uint64_t seq, std::uint64_t cookie,
                       std::span<const std::uint8_t> body) {
  constexpr std::array kTypes = {MessageType::subscribe, MessageType::nack, MessageType::ping, MessageType::heartbeat};
  Header header;
  header.type = kTypes[command % 4];
  header.stream_id = kStream;
  header.boot_id = command & 4 ? 2 : 1;
  header.seq = command & 8 ? seq / 2 : seq;  // old ones too
  Datagram datagram;
  std::copy(body.begin(), body.end(), datagram.body().begin());
  if ((command & 16) != 0 && body.size() >= 8)
    for (std::size_t i = 0; i < 8; ++i) datagram.body()[i] = static_cast<std::uint8_t>(cookie >> (8 * i));
  seal(header, body.size(), datagram, kKeys.signer());
  if (command & 128) datagram.bytes[(command * 31u) % datagram.size] ^= 0x10;
  return datagram;
}

struct Session {
  CookieJar jar{std::array<std::uint8_t, 16>{1}};
  Subscriptions subscriptions{kLimit, jar, client_of(0)};
  RequestReader reader{kStream, kKeys};
  MonotonicTime now = MonotonicTime{} + std::chrono::hours(1);
  std::array<bool, kLimit + 1> streams{};

  void expire() {
    while (const auto slot = subscriptions.expire(now)) {
      expect(streams[*slot]);
      streams[*slot] = false;
    }
  }
  void take(const Request& request) {
    expire();
    const RequestOutcome outcome = subscriptions.take(request, now);
    using What = RequestOutcome::What;
    expect(outcome.slot <= kLimit);
    if (outcome.what == What::begin) {
      expect(!streams[outcome.slot]);
      streams[outcome.slot] = true;
    }
    if (outcome.what == What::change || outcome.what == What::resend) expect(streams[outcome.slot]);
    if (outcome.what == What::end) {
      expect(streams[outcome.slot]);
      streams[outcome.slot] = false;
    }
    if (outcome.what == What::begin || outcome.what == What::change) {
      const Subscribe& wish = subscriptions.wish(outcome.slot);
      expect(subscriptions.endpoint(outcome.slot) == request.from);
      expect(jar.check(wish.cookie, request.from, now) != CookieJar::Verdict::bad);
      expect(wish.layer_mask != 0 && wish.repeats <= kMaxRepeats && wish.region.tx_min <= wish.region.tx_max);
    }
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMostBody = kMaxDatagramBytes - kHeaderBytes - kMacBytes;
  Session session;
  std::uint64_t seq = 0;
  std::uint64_t accepted = 0;
  RequestQueue queue;
  for (std::span<const std::uint8_t> input(data, size); input.size() >= 5;) {
    const std::uint8_t command = input[0], client = input[1];
    session.now += std::chrono::milliseconds(16 * input[2]);
    const std::size_t length =
        std::min<std::size_t>({std::size_t{input[3]} | std::size_t{input[4]} << 8, input.size() - 5, kMostBody});
    const auto body = input.subspan(5, length);
    input = input.subspan(5 + length);
    const Endpoint from = client_of(client);
    const Datagram datagram = make_datagram(command, ++seq, session.jar.cookie(from, session.now), body);
    Request request;
    if (session.reader.read(datagram.view(), from, request) != Reject::none) continue;
    ++accepted;
    queue.push(request);
    Request popped;
    expect(queue.pop(popped) && popped.from == from && popped.seq == request.seq);
    session.take(popped);
  }
  const RequestCounters& counters = session.reader.counters();
  expect(counters.datagrams == counters.accepted + counters.rejected && counters.accepted == accepted);
  expect(session.subscriptions.active() <= kLimit);
  session.now += kLease;
  session.expire();
  expect(session.subscriptions.active() == 0 && queue.overflowed() == 0);
  for (const bool stream : session.streams) expect(!stream);
  return 0;
}
