#include "tests/support/map_sender.hpp"

#include <algorithm>

#include "core/random.hpp"

namespace scree::test {
namespace {

using namespace node::protocol;
using node::TileIndex;

constexpr Nanoseconds kTenth = std::chrono::milliseconds(100);
constexpr Nanoseconds kSecond = std::chrono::seconds(1);
constexpr Nanoseconds kRepeatAfter = std::chrono::milliseconds(20);
constexpr double kBucket_s = 0.02;

int blocks(Layer layer) {
  return layer_format(layer).encoding == Encoding::i16 ? 2 : 1;
}

Nanoseconds from_seconds(double seconds) {
  return Nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
}

std::uint64_t stream_of(Layer layer, std::uint32_t rev) {
  return std::uint64_t{rev} << 8 | static_cast<std::uint64_t>(layer);
}

/// Random in its left half, one value in its right half; a quarter of the rows unknown. States stay states.
std::int16_t cell_of(Layer layer, int row, int column, std::uint32_t word, std::uint32_t of_tile) {
  if ((of_tile >> (row % 32)) % 4 == 0) return unknown_raw(layer);
  const std::uint32_t value = column < 16 ? word : of_tile;
  if (layer == Layer::elevation) return static_cast<std::int16_t>(value & 0xFFFF);
  return static_cast<std::int16_t>(layer == Layer::cell_state ? value % 5 : value & 0xFF);
}

}  // namespace

MapSender::MapSender(const MapSenderSettings& settings)
    : settings_(settings), tiles_(node::tiles_touched(settings.window)) {
  if (settings.key) (void)keys_.add(*settings.key);
  units_.resize(settings.layers.size() * static_cast<std::size_t>(tiles_.tiles()));
  history_.resize(static_cast<std::size_t>(tiles_.tiles()));
}

TileBlock MapSender::content(std::uint64_t seed, Layer layer, TileIndex tile, std::uint32_t rev, int half) {
  TileBlock block;
  block.tx = tile.tx;
  block.ty = tile.ty;
  block.tile_rev = rev;
  block.layer = layer;
  const bool i16 = blocks(layer) == 2;
  block.row0 = static_cast<std::uint8_t>(i16 ? 16 * half : 0);
  block.rows = i16 ? 16 : 32;
  const auto of_tile = random_words(seed, stream_of(layer, rev), tile.tx, tile.ty);
  if (i16) block.scale = of_tile[1] % 2 == 0 ? 0x1p-12F : 0x1p-10F;
  if (i16) block.offset = static_cast<float>(of_tile[2] % 100);
  for (int i = 0; i < block.cells(); i += 4) {
    const int cell = i + block.row0 * 32;
    const auto words = random_words(seed + 1, stream_of(layer, rev), tile.tx * 1024 + cell, tile.ty);
    for (int k = 0; k < 4; ++k)
      block.raw[static_cast<std::size_t>(i + k)] =
          cell_of(layer, cell / 32, (cell + k) % 32, words[static_cast<std::size_t>(k)], of_tile[0]);
  }
  return block;
}

Header MapSender::header(Nanoseconds now) {
  Header out;
  out.stream_id = 1;
  out.boot_id = settings_.boot_id;
  out.seq = ++seq_;
  out.map_rev = revision_;
  out.t_data_ns = changed_at_.count() + 1;
  out.age_us = static_cast<std::uint32_t>((now - changed_at_).count() / 1000);
  return out;
}

void MapSender::revise(Nanoseconds now) {
  ++revision_;
  changed_at_ = now;
  changes_.clear();
  for (std::size_t t = 0; t < history_.size(); ++t) {
    const TileIndex tile = tiles_.tile(t);
    const double draw = to_uniform(random_words(settings_.seed + 2, revision_, tile.tx, tile.ty)[0]);
    if (revision_ > 1 && draw >= settings_.changing) continue;
    history_[t].push_back(revision_);
    for (std::size_t layer = 0; layer < settings_.layers.size(); ++layer) {
      const std::size_t unit = layer * history_.size() + t;
      units_[unit].rev = revision_;
      if (!units_[unit].pending) pending_.push_back(unit);
      units_[unit].pending = true;
      changes_.push_back({settings_.layers[layer], tile, revision_});
    }
  }
  manifest_wanted_ = true;
}

void MapSender::send_unit(std::size_t unit, Nanoseconds now, const Send& send) {
  const Layer layer = settings_.layers[unit / history_.size()];
  const TileIndex tile = tiles_.tile(unit % history_.size());
  for (int half = 0; half < blocks(layer); ++half) {
    TileBlock block = content(settings_.seed, layer, tile, units_[unit].rev, half);
    block.block_age_ms = static_cast<std::uint32_t>((now - changed_at_) / std::chrono::milliseconds(1));
    emit(block, now, send);
    tokens_ -= 1.0;
  }
  units_[unit].sent = now;
}

void MapSender::send_tiles(Nanoseconds now, const Send& send) {
  const Nanoseconds interval = from_seconds(settings_.refresh_s / static_cast<double>(units_.size()));
  while (tokens_ > 0.0) {
    std::size_t unit = 0;
    if (!pending_.empty()) {
      unit = pending_.front();
      pending_.pop_front();
      units_[unit].pending = false;
      for (int i = 1; i <= repeats_; ++i) copies_.push_back({now + i * kRepeatAfter, unit, units_[unit].rev});
    } else if (!copies_.empty() && copies_.front().due <= now) {
      const Copy copy = copies_.front();
      copies_.pop_front();
      if (units_[copy.unit].rev != copy.rev) continue;  // superseded
      unit = copy.unit;
    } else if (!nacked_.empty()) {
      unit = nacked_.front();
      nacked_.pop_front();
      units_[unit].nacked = false;
    } else if (now >= next_refresh_) {
      const auto oldest =
          std::min_element(units_.begin(), units_.end(), [](const Unit& a, const Unit& b) { return a.sent < b.sent; });
      unit = static_cast<std::size_t>(oldest - units_.begin());
      next_refresh_ = std::max(next_refresh_ + interval, now - kTenth);
    } else {
      return;
    }
    send_unit(unit, now, send);
  }
}

void MapSender::send_manifests(Nanoseconds now, const Send& send) {
  Manifest message;
  const std::int32_t rows_each =
      std::max<std::int32_t>(1, static_cast<std::int32_t>(kMaxManifestTiles) / tiles_.columns);
  for (std::size_t layer = 0; layer < settings_.layers.size(); ++layer) {
    message.layer = static_cast<std::uint8_t>(settings_.layers[layer]);
    for (std::int32_t y = 0; y < tiles_.rows; y += rows_each) {
      message.tx0 = tiles_.min.tx;
      message.ty0 = tiles_.min.ty + y;
      message.columns = static_cast<std::uint16_t>(tiles_.columns);
      message.rows = static_cast<std::uint16_t>(std::min(rows_each, tiles_.rows - y));
      const std::size_t first = layer * history_.size() + static_cast<std::size_t>(y * tiles_.columns);
      for (std::size_t i = 0; i < std::size_t{message.columns} * message.rows; ++i)
        message.tile_rev[i] = units_[first + i].rev;
      emit(message, now, send);
      tokens_ -= 1.0;
    }
  }
  next_manifest_ = now + kTenth;
  manifest_wanted_ = false;
}

void MapSender::send_announce(Nanoseconds now, const Send& send) {
  Announce message;
  message.map_id = settings_.boot_id;
  message.resolution_m = 0.1;
  message.window = settings_.window;
  message.refresh_ms = static_cast<std::uint32_t>(settings_.refresh_s * 1000.0);
  message.frame_name = "map";
  message.node_name = "sender";
  message.software_version = "test";
  emit(message, now, send);
  next_announce_ = now + kSecond;
}

void MapSender::tick(Nanoseconds now, const Send& send) {
  const double elapsed_s = static_cast<double>((now - last_tick_).count()) * 1e-9;
  tokens_ = std::min(tokens_ + settings_.datagrams_per_s * elapsed_s, settings_.datagrams_per_s * kBucket_s);
  last_tick_ = now;
  if (now >= next_revision_) {
    revise(now);
    next_revision_ = now + from_seconds(1.0 / settings_.revisions_per_s);
  }
  if (!subscribed(now)) return;
  if (now >= next_heartbeat_) {
    emit(Heartbeat{}, now, send);
    next_heartbeat_ = now + kTenth;
  }
  if (now >= next_announce_) send_announce(now, send);
  send_tiles(now, send);
  if (now >= next_manifest_ || (manifest_wanted_ && pending_.empty())) send_manifests(now, send);
}

void MapSender::say_bye(const Send& send) {
  for (int copy = 0; copy < 3; ++copy) emit(Bye{ByeReason::stopped}, last_tick_, send);
}

}  // namespace scree::test
