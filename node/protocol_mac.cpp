#include "node/protocol_mac.hpp"

#include <algorithm>
#include <cassert>
#include <sodium.h>

namespace scree::node::protocol {

static_assert(kKeyBytes == crypto_generichash_KEYBYTES && kMacBytes == crypto_generichash_BYTES_MIN);

bool KeyRing::add(const Key& key) {
  [[maybe_unused]] const int ready =
      sodium_init();  // chooses the fast BLAKE2b; the plain one that works without it gives the same bytes
  if (size_ == kCapacity || key.id == 0 || find(key.id) != nullptr) return false;
  keys_[size_++] = key;
  return true;
}

const Key* KeyRing::find(std::uint16_t id) const {
  const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto found = std::find_if(keys_.begin(), end, [id](const Key& key) { return key.id == id; });
  return found == end ? nullptr : &*found;
}

Mac compute_mac(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, kKeyBytes>& key) {
  Mac mac;
  crypto_generichash(mac.data(), mac.size(), bytes.data(), bytes.size(), key.data(), key.size());
  return mac;
}

bool mac_matches(std::span<const std::uint8_t> bytes, const Key& key, std::span<const std::uint8_t> claimed) {
  assert(claimed.size() == kMacBytes);
  const Mac mac = compute_mac(bytes, key.bytes);
  return sodium_memcmp(mac.data(), claimed.data(), kMacBytes) == 0;
}

}  // namespace scree::node::protocol
