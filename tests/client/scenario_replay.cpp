#include "tests/client/scenario_replay.hpp"

#include <cmath>

namespace scree::test {
namespace {

client::Time at(const std::string& ms) {
  return client::Time{} + std::chrono::milliseconds(std::stol(ms));
}

template <class Bit>
std::uint32_t sum_of_bits(const std::string& list, Bit bit) {
  std::uint32_t sum = 0;
  std::istringstream stream(list);
  for (std::string word; std::getline(stream, word, ',');) sum |= bit(std::stoi(word));
  return sum;
}

const char* name(client::State state) {
  switch (state) {
    case client::State::waiting:
      return "waiting";
    case client::State::fresh:
      return "fresh";
    case client::State::stale:
      return "stale";
    case client::State::lost:
      return "lost";
  }
  return "?";
}

void expect_same(float found, float expected) {
  if (std::isnan(expected))
    EXPECT_TRUE(std::isnan(found)) << found;
  else
    EXPECT_NEAR(found, expected, 1e-5F * std::max(1.0F, std::abs(expected)));
}

}  // namespace

void ScenarioReplay::line(const Words& words) {
  if (words[0] == "config") return configure(words);
  if (!receiver_) open();
  const client::Time now = at(words[1]);
  if (words[2] == "receive" || words[2] == "golden") {
    const auto bytes = words[2] == "golden" ? golden_vector(words[3])
                       : words.size() > 3   ? from_hex(words[3])
                                            : std::vector<std::uint8_t>{};
    verdict_ = receiver_->accept(bytes.data(), bytes.size(), now);
  } else {
    expect(now, words[3], Words(words.begin() + 4, words.end()));
  }
}

void ScenarioReplay::configure(const Words& words) {
  const std::string& field = words[1];
  if (field == "subscribe") {
    config_.node = "127.0.0.1:1";
  } else if (field == "key") {
    client::Key& key = config_.keys[config_.keys[0].id == 0 ? 0 : 1];
    key.id = static_cast<std::uint16_t>(std::stoi(words[2]));
    const auto bytes = from_hex(words[3]);
    std::copy(bytes.begin(), bytes.end(), key.bytes.begin());
  } else if (field == "layers") {
    config_.layers = sum_of_bits(words[2], [](int i) { return client::layer_bit(static_cast<client::Layer>(i)); });
  } else if (field == "accept_origins") {
    config_.accept_origins = static_cast<std::uint8_t>(
        sum_of_bits(words[2], [](int i) { return std::uint32_t{client::origin_bit(static_cast<client::Origin>(i))}; }));
  } else if (field == "region") {
    std::int32_t* const bounds[] = {&config_.tx_min, &config_.ty_min, &config_.tx_max, &config_.ty_max};
    for (std::size_t i = 0; i < 4; ++i) *bounds[i] = std::stoi(words[2 + i]);
  } else if (field == "stream_id") {
    config_.stream_id = std::stol(words[2]);
  } else if (field == "max_window_tiles") {
    config_.max_window_tiles = static_cast<std::uint32_t>(std::stoul(words[2]));
  } else if (field == "cell_max_age_ms") {
    config_.cell_max_age = std::chrono::milliseconds(std::stol(words[2]));
  } else if (field == "repeats") {
    config_.repeats = static_cast<std::uint8_t>(std::stoi(words[2]));
  } else {
    FAIL() << "unknown setting " << field;
  }
}

void ScenarioReplay::open() {
  receiver_ = std::make_unique<client::Receiver>();
  ASSERT_TRUE(receiver_->open(config_, client::Time{})) << receiver_->error();
}

void ScenarioReplay::expect(client::Time now, const std::string& what, const Words& values) {
  const auto number = [&](std::size_t i) { return std::stol(values[i]); };
  const auto small = [&](std::size_t i) { return static_cast<int>(number(i)); };
  if (what == "verdict") {
    EXPECT_STREQ(client::name(verdict_), values[0].c_str());
  } else if (what == "state") {
    EXPECT_STREQ(name(receiver_->state(now)), values[0].c_str());
    EXPECT_EQ(receiver_->fresh(now), values[0] == "fresh");
  } else if (what == "cost") {
    expect_cost(now, number(0), number(1), small(2));
  } else if (what == "value") {
    expect_value(now, static_cast<client::Layer>(small(0)), small(1), small(2), std::stof(values[3]));
  } else if (what == "cell_state") {
    EXPECT_EQ(static_cast<int>(receiver_->cell_state_of_cell(number(0), number(1), now)), number(2));
  } else if (what == "occupancy") {
    std::vector<std::int8_t> cells(receiver_->grid().cells());
    ASSERT_TRUE(receiver_->to_occupancy(cells.data(), cells.size(), now));
    EXPECT_EQ(
        cells[static_cast<std::size_t>(number(1)) * receiver_->grid().columns + static_cast<std::size_t>(number(0))],
        number(2));
  } else if (what == "grid") {
    expect_grid(values);
  } else if (what == "counter") {
    expect_counter(values[0], static_cast<std::uint64_t>(number(1)));
  } else if (what == "health") {
    EXPECT_EQ(receiver_->health(now), number(0));
  } else if (what == "bye") {
    EXPECT_EQ(receiver_->bye_reason(), number(0));
  } else if (what == "request") {
    expect_request(now, small(0), values[1]);
  } else {
    FAIL() << "unknown expectation " << what;
  }
}

void ScenarioReplay::expect_cost(client::Time now, long x, long y, int cost) {
  EXPECT_EQ(receiver_->cost_of_cell(x, y, now), cost);
  const client::Grid grid = receiver_->grid();
  const double res = grid.columns > 0 ? grid.resolution_m : 1.0;
  EXPECT_EQ(receiver_->cost((static_cast<double>(x) + 0.5) * res, (static_cast<double>(y) + 0.5) * res, now), cost);
  if (index(x, y) < 0) return;
  std::vector<std::uint8_t> cells(grid.cells());
  ASSERT_TRUE(receiver_->copy_cost(cells.data(), cells.size(), now));
  EXPECT_EQ(cells[static_cast<std::size_t>(index(x, y))], cost);
}

void ScenarioReplay::expect_value(client::Time now, client::Layer layer, int x, int y, float value) {
  expect_same(receiver_->value_of_cell(layer, x, y, now), value);
  if (index(x, y) < 0) return;
  std::vector<float> cells(receiver_->grid().cells());
  ASSERT_TRUE(receiver_->copy_layer(layer, cells.data(), cells.size(), now));
  expect_same(cells[static_cast<std::size_t>(index(x, y))], value);
}

void ScenarioReplay::expect_grid(const Words& values) {
  const client::Grid grid = receiver_->grid();
  const double resolution = std::stod(values[4]);
  EXPECT_EQ(grid.columns, std::stoul(values[0]));
  EXPECT_EQ(grid.rows, std::stoul(values[1]));
  EXPECT_EQ(grid.x_min_cells, std::stoi(values[2]));
  EXPECT_EQ(grid.y_min_cells, std::stoi(values[3]));
  EXPECT_EQ(grid.resolution_m, resolution);
  EXPECT_EQ(grid.x_min_m, std::stoi(values[2]) * resolution);
  EXPECT_EQ(grid.y_min_m, std::stoi(values[3]) * resolution);
}

void ScenarioReplay::expect_counter(const std::string& name, std::uint64_t value) {
  bool found = false;
  receiver_->counters().for_each([&](const char* counter, std::uint64_t count) {
    if (name != counter) return;
    found = true;
    EXPECT_EQ(count, value) << name;
  });
  EXPECT_TRUE(found) << name;
}

void ScenarioReplay::expect_request(client::Time now, int type, const std::string& body) {
  std::uint8_t out[client::detail::kMaxDatagramBytes];
  const std::size_t size = receiver_->next_request(out, now);
  if (type == 0) {
    EXPECT_EQ(size, 0U) << "type " << int{out[6]};
    return;
  }
  ASSERT_GE(size, 64U);
  EXPECT_EQ(out[6], type);
  EXPECT_EQ(client::detail::u16(out + 10), size);
  EXPECT_EQ(client::detail::u32(out + 60), client::detail::datagram_crc(out, size));
  if (body == "*") return;
  EXPECT_EQ(std::vector<std::uint8_t>(out + 64, out + size), from_hex(body));
}

long ScenarioReplay::index(long x, long y) const {
  const client::Grid grid = receiver_->grid();
  const long column = x - grid.x_min_cells, row = y - grid.y_min_cells;
  if (column < 0 || column >= grid.columns || row < 0 || row >= grid.rows) return -1;
  return row * grid.columns + column;
}

}  // namespace scree::test
