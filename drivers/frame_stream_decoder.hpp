#pragma once
// A byte stream taken apart into messages. Knows nothing of sockets: bytes come in pieces of any size.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/checksum.hpp"
#include "drivers/frame_stream.hpp"

namespace scree::drivers::stream {

/// A message whose CRCs are right; nothing else was judged. `payload` holds until the decoder is used again.
struct Message {
  Header header;
  std::span<const std::uint8_t> payload;
};

/// bytes == those of good messages + bytes_skipped + Decoder::held().
struct DecoderCounters {
  std::uint64_t bytes = 0;
  std::uint64_t bytes_skipped = 0;  ///< in no good message
  std::uint64_t messages = 0;
  // a magic was found, but
  std::uint64_t header_crc = 0;
  std::uint64_t version = 0;
  std::uint64_t oversize = 0;
  std::uint64_t payload_crc = 0;
  std::uint64_t frame_payload_crc = 0;  ///< among them: of a FRAME
  std::uint64_t work = 0;               ///< bytes that were checked or moved, each time that they were
};

/// Holds at most one message; its buffer grows to the largest one that a good header announced (twice that once a
/// search has found headers inside a damaged message) and stays.
class Decoder {
 public:
  /// Takes bytes from the front of `bytes` until a message is complete, or all of them. What any division into pieces
  /// gives is the same. Cost: one copy and one CRC of every byte; after a wrong payload CRC its bytes are searched,
  /// which costs a bounded multiple of them whatever they hold.
  std::optional<Message> next(std::span<const std::uint8_t>& bytes);

  /// What is held belongs to nothing that will follow (another connection): skipped and counted.
  void reset();

  std::size_t held() const { return end_ - begin_; }
  const DecoderCounters& counters() const { return counters_; }

 private:
  bool fill(std::size_t need, std::span<const std::uint8_t>& bytes);
  void make_room(std::size_t need);
  void skip(std::size_t bytes);
  void skip_to_magic();
  std::optional<Header> judge_header();
  std::uint32_t payload_crc(std::span<const std::uint8_t> payload);
  std::uint64_t position() const { return counters_.bytes - held(); }  ///< in the stream, of the first byte held
  std::span<const std::uint8_t> held_bytes() const { return std::span(buffer_).subspan(begin_, held()); }

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< of what is held
  std::size_t returned_ = 0;         ///< bytes of the message that next() returned last
  std::optional<Header> header_;     ///< of the message at begin_, once judged good
  std::uint64_t searched_to_ = 0;    ///< up to here a damaged message is looked through for others
  PartialChecksums parts_;           ///< meanwhile
  DecoderCounters counters_;
};

}  // namespace scree::drivers::stream
