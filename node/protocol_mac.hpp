#pragma once
// Keyed BLAKE2b with 16 bytes of output: who holds no key can neither forge nor change a datagram.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace scree::node::protocol {

inline constexpr std::size_t kMacBytes = 16;
inline constexpr std::size_t kKeyBytes = 32;

/// `id` 1 … 65535; 0 stands for "no MAC" on the wire.
struct Key {
  std::uint16_t id = 0;
  std::array<std::uint8_t, kKeyBytes> bytes{};
};

/// The keys of one stream: the first signs, up to two verify, so that a key can be rolled over. Without keys nothing is
/// signed and nothing that has a MAC can be checked.
class KeyRing {
 public:
  static constexpr std::size_t kCapacity = 2;

  /// False, and nothing is kept, for a third key, an id of 0 and an id that is there already.
  bool add(const Key& key);
  bool empty() const { return size_ == 0; }
  /// The key that signs; null without keys.
  const Key* signer() const { return empty() ? nullptr : &keys_[0]; }
  /// The key with this id; null when there is none.
  const Key* find(std::uint16_t id) const;

 private:
  std::array<Key, kCapacity> keys_{};
  std::size_t size_ = 0;
};

using Mac = std::array<std::uint8_t, kMacBytes>;

/// Python: hashlib.blake2b(bytes, key=key, digest_size=16).digest(). About 1.5 µs for 1200 bytes.
Mac compute_mac(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, kKeyBytes>& key);

/// Takes as long for any `claimed`, right or wrong. It must have kMacBytes.
bool mac_matches(std::span<const std::uint8_t> bytes, const Key& key, std::span<const std::uint8_t> claimed);

}  // namespace scree::node::protocol
