#pragma once
// Numbers to and from little-endian bytes. Readers and writers do not check bounds: callers know the size of a body
// before they walk through it.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace scree::drivers {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

template <class T>
requires std::is_arithmetic_v<T> T read_number(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Walks through a body.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : at_(bytes.data()) {}
  template <class T>
  T take() {
    const T value = read_number<T>(at_);
    at_ += sizeof(T);
    return value;
  }
  void skip(std::size_t bytes) { at_ += bytes; }
  const std::uint8_t* here() const { return at_; }

 private:
  const std::uint8_t* at_;
};

class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> bytes) : at_(bytes.data()) {}
  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  void fill(std::size_t bytes) {
    std::memset(at_, 0, bytes);
    at_ += bytes;
  }

 private:
  std::uint8_t* at_;
};

}  // namespace scree::drivers
