#include <cstdlib>

#include "tests/client/allocation_counter.hpp"
#include "tests/client/client_port.hpp"

namespace scree::test {
namespace {

client::Time at(Nanoseconds now) {
  return client::Time(std::chrono::duration_cast<client::Clock::duration>(now));
}

class CppPort : public ClientPort {
 public:
  explicit CppPort(const PortSettings& settings) {
    client::Config config;
    if (settings.subscribe) config.node = "127.0.0.1:1";
    config.repeats = settings.repeats;
    config.layers = client::layer_bit(client::Layer::cost) | client::layer_bit(client::Layer::elevation) |
                    client::layer_bit(client::Layer::cell_state);
    if (settings.key) config.keys[0] = *settings.key;
    if (!receiver_.open(config, client::Time{})) std::abort();
  }
  void accept(std::span<const std::uint8_t> datagram, Nanoseconds now) override {
    const std::uint64_t before = allocation_count();
    (void)receiver_.accept(datagram.data(), datagram.size(), at(now));
    allocations_ += allocation_count() - before;
  }
  std::vector<std::vector<std::uint8_t>> requests(Nanoseconds now) override {
    receiver_.advance(at(now));
    std::vector<std::vector<std::uint8_t>> out;
    std::uint8_t buffer[client::detail::kMaxDatagramBytes];
    while (const std::size_t size = receiver_.next_request(buffer, at(now))) out.emplace_back(buffer, buffer + size);
    return out;
  }
  Shown show(Nanoseconds now) override {
    Shown out;
    out.state = receiver_.state(at(now));
    out.grid = receiver_.grid();
    const std::size_t cells = out.grid.cells();
    out.cost.resize(cells);
    out.occupancy.resize(cells);
    out.elevation.resize(cells);
    out.cell_state.resize(cells);
    (void)receiver_.copy_cost(out.cost.data(), cells, at(now));
    (void)receiver_.to_occupancy(out.occupancy.data(), cells, at(now));
    (void)receiver_.copy_layer(client::Layer::elevation, out.elevation.data(), cells, at(now));
    (void)receiver_.copy_layer(client::Layer::cell_state, out.cell_state.data(), cells, at(now));
    out.accepted = receiver_.counters()[client::Verdict::accepted];
    out.datagrams = receiver_.counters().datagrams;
    out.memory = allocations_;
    return out;
  }
  std::vector<std::uint32_t> revisions(std::int32_t tx, std::int32_t ty, int columns, int rows) override {
    std::vector<std::uint32_t> out;
    for (const auto layer : {client::Layer::cost, client::Layer::elevation, client::Layer::cell_state})
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) out.push_back(receiver_.tile_rev(layer, tx + x, ty + y));
    return out;
  }

 private:
  client::Receiver receiver_;
  std::uint64_t allocations_ = 0;
};

}  // namespace

std::unique_ptr<ClientPort> cpp_port(const PortSettings& settings) {
  return std::make_unique<CppPort>(settings);
}

}  // namespace scree::test
