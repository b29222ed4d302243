#include "tests/support/bad_network.hpp"

#include <array>

#include "core/random.hpp"

namespace scree::test {
namespace {

/// Eight uniform numbers for each datagram (and copy of it): every effect has its own.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint64_t index, std::int32_t copy)
      : words_{random_words(seed, index, 2 * copy, 0), random_words(seed, index, 2 * copy + 1, 0)} {}
  double uniform(std::size_t i) const { return to_uniform(words_[i / 4][i % 4]); }
  std::uint32_t word(std::size_t i) const { return words_[i / 4][i % 4]; }

 private:
  std::array<std::array<std::uint32_t, 4>, 2> words_;
};

constexpr std::int32_t kLossDraws = 1000;  // beyond any number of copies

}  // namespace

bool BadNetwork::lose(std::uint64_t index) {
  const Draws draws(seed_, index, kLossDraws);
  const double leave = 1.0 / settings_.burst_length;
  const double enter = settings_.burst_loss / (settings_.burst_length * (1.0 - settings_.burst_loss));
  in_burst_ = draws.uniform(0) < (in_burst_ ? 1.0 - leave : enter);
  return in_burst_ || draws.uniform(1) < settings_.loss;
}

void BadNetwork::send(std::span<const std::uint8_t> datagram, Nanoseconds now) {
  const std::uint64_t index = counters_.received++;
  const bool lost = lose(index);  // the chain moves on during a black-out too
  if (black_out_) {
    ++counters_.blacked_out;
    return;
  }
  if (lost) {
    ++counters_.lost;
    return;
  }
  launch(datagram, now, index, 0);
  if (Draws(seed_, index, kLossDraws).uniform(2) >= settings_.duplicate) return;
  ++counters_.duplicated;
  launch(datagram, now + settings_.reorder_delay, index, 1);
}

void BadNetwork::launch(std::span<const std::uint8_t> datagram, Nanoseconds now, std::uint64_t index,
                        std::int32_t copy) {
  const Draws draws(seed_, index, copy);
  std::vector<std::uint8_t> bytes(datagram.begin(), datagram.end());
  Nanoseconds due =
      now + settings_.delay +
      Nanoseconds(static_cast<std::int64_t>(draws.uniform(0) * static_cast<double>(settings_.jitter.count())));
  if (draws.uniform(1) < settings_.reorder) {
    due += settings_.reorder_delay;
    ++counters_.reordered;
  }
  if (draws.uniform(2) < settings_.truncate && !bytes.empty()) {
    bytes.resize(draws.word(3) % bytes.size());
    ++counters_.truncated;
  }
  if (draws.uniform(4) < settings_.corrupt && !bytes.empty()) {
    const std::uint32_t flips = 1 + draws.word(5) % 8;
    for (std::uint32_t i = 0; i < flips; ++i) {
      const std::uint32_t bit = random_words(seed_, index, static_cast<std::int32_t>(i), 1 + copy)[0];
      bytes[bit / 8 % bytes.size()] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    ++counters_.corrupted;
  }
  flying_.push({due, order_++, std::move(bytes)});
}

}  // namespace scree::test
