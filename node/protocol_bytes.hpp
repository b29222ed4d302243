#pragma once
// Little-endian fields, written and read one by one: no struct is ever laid over the bytes.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace scree::node::protocol {

/// Appends fields to a fixed buffer. Writing past its end writes nothing and clears ok().
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral T>
  void put(T value) {
    if (bytes_.size() - size_ < sizeof(T)) {
      ok_ = false;
      return;
    }
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_[size_++] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
  /// The low `width` (1 or 2) bytes of each value. One check of the room for all: blocks are most of what is sent.
  void put_all(std::span<const std::int16_t> values, std::size_t width) {
    if (bytes_.size() - size_ < values.size() * width) {
      ok_ = false;
      return;
    }
    std::uint8_t* out = bytes_.data() + size_;
    if (width == 1)
      for (std::size_t i = 0; i < values.size(); ++i) out[i] = static_cast<std::uint8_t>(values[i]);
    else
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto bits = static_cast<std::uint16_t>(values[i]);
        out[2 * i] = static_cast<std::uint8_t>(bits);
        out[2 * i + 1] = static_cast<std::uint8_t>(bits >> 8);
      }
    size_ += values.size() * width;
  }
  void f32(float value) { put(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void zeros(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) put(std::uint8_t{0});
  }
  /// At most `width` − 1 bytes of `text`, padded with NUL to `width`.
  void text(std::string_view text, std::size_t width) {
    text = text.substr(0, width - 1);
    for (const char c : text) put(static_cast<std::uint8_t>(c));
    zeros(width - text.size());
  }

  std::size_t size() const { return size_; }
  bool ok() const { return ok_; }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

/// Takes fields from a buffer. Reading past its end gives zeros and clears ok().
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T get() {
    if (remaining() < sizeof(T)) {
      ok_ = false;
      return T{};
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits |= std::uint64_t{bytes_[next_++]} << (8 * i);
    return static_cast<T>(bits);
  }
  float f32() { return std::bit_cast<float>(get<std::uint32_t>()); }
  double f64() { return std::bit_cast<double>(get<std::uint64_t>()); }
  std::span<const std::uint8_t> bytes(std::size_t count) {
    if (remaining() < count) {
      ok_ = false;
      return {};
    }
    next_ += count;
    return bytes_.subspan(next_ - count, count);
  }
  void skip(std::size_t count) { (void)bytes(count); }

  std::size_t remaining() const { return bytes_.size() - next_; }
  bool ok() const { return ok_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0;
  bool ok_ = true;
};

}  // namespace scree::node::protocol
