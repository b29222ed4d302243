#include "node/protocol_tile.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "node/protocol_bytes.hpp"

namespace scree::node::protocol {
namespace {

constexpr int kMaxRun = 255;

int run_at(std::span<const std::int16_t> raw, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < raw.size() && end - begin < kMaxRun && raw[end] == raw[begin]) ++end;
  return static_cast<int>(end - begin);
}

/// Gives up, with raw.size(), as soon as it is not shorter than that.
std::size_t run_length_bytes(std::span<const std::int16_t> raw) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < raw.size() && bytes < raw.size(); i += static_cast<std::size_t>(run_at(raw, i)))
    bytes += 2;
  return bytes;
}

Encoding choose_encoding(Layer layer, std::span<const std::int16_t> raw) {
  if (std::all_of(raw.begin(), raw.end(), [&](std::int16_t value) { return value == raw[0]; }))
    return Encoding::constant;
  const Encoding plain = layer_format(layer).encoding;
  return plain == Encoding::u8 && run_length_bytes(raw) < raw.size() ? Encoding::run_length : plain;
}

void put_raw(ByteWriter& writer, Encoding type, std::int16_t value) {
  if (type == Encoding::i16)
    writer.put(value);
  else
    writer.put(static_cast<std::uint8_t>(value));
}

void put_cells(ByteWriter& writer, Layer layer, Encoding encoding, std::span<const std::int16_t> raw) {
  const Encoding type = layer_format(layer).encoding;
  if (encoding == Encoding::constant) {
    put_raw(writer, type, raw[0]);
  } else if (encoding == Encoding::run_length) {
    for (std::size_t i = 0; i < raw.size();) {
      const int run = run_at(raw, i);
      writer.put(static_cast<std::uint8_t>(run));
      writer.put(static_cast<std::uint8_t>(raw[i]));
      i += static_cast<std::size_t>(run);
    }
  } else {
    writer.put_all(raw, type == Encoding::i16 ? 2 : 1);
  }
}

std::int16_t get_raw(ByteReader& reader, Encoding type) {
  return type == Encoding::i16 ? reader.get<std::int16_t>() : static_cast<std::int16_t>(reader.get<std::uint8_t>());
}

Reject get_runs(ByteReader& reader, std::span<std::int16_t> raw) {
  std::size_t filled = 0;
  while (reader.remaining() >= 2) {
    const std::size_t run = reader.get<std::uint8_t>();
    const auto value = static_cast<std::int16_t>(reader.get<std::uint8_t>());
    if (run == 0 || run > raw.size() - filled) return Reject::body_value;
    std::fill_n(raw.begin() + static_cast<std::ptrdiff_t>(filled), run, value);
    filled += run;
  }
  return reader.remaining() == 0 && filled == raw.size() ? Reject::none : Reject::body_length;
}

Reject get_cells(ByteReader& reader, Layer layer, Encoding encoding, std::span<std::int16_t> raw) {
  const Encoding type = layer_format(layer).encoding;
  const std::size_t raw_bytes = type == Encoding::i16 ? 2 : 1;
  if (encoding == Encoding::constant) {
    if (reader.remaining() != raw_bytes) return Reject::body_length;
    std::fill(raw.begin(), raw.end(), get_raw(reader, type));
    return Reject::none;
  }
  if (encoding == Encoding::run_length) return type == Encoding::u8 ? get_runs(reader, raw) : Reject::body_value;
  if (encoding != type) return Reject::body_value;
  if (reader.remaining() != raw.size() * raw_bytes) return Reject::body_length;
  for (std::int16_t& value : raw) value = get_raw(reader, type);
  return Reject::none;
}

bool valid_index(std::int32_t index) {
  return index >= -kTileIndexLimit && index < kTileIndexLimit;
}

}  // namespace

std::uint16_t TileBlock::known_cells() const {
  const auto cells = view();
  return static_cast<std::uint16_t>(static_cast<std::ptrdiff_t>(cells.size()) -
                                    std::count(cells.begin(), cells.end(), unknown_raw(layer)));
}

bool valid_rows(Layer layer, int row0, int rows) {
  if (layer_format(layer).encoding == Encoding::i16) return rows == kHalfRows && (row0 == 0 || row0 == kHalfRows);
  return row0 == 0 && rows == kTileCells;
}

void encode(Header header, const TileBlock& block, Datagram& out, const Key* key) {
  assert(valid_rows(block.layer, block.row0, block.rows));
  header.type = MessageType::tile;
  const Encoding encoding = choose_encoding(block.layer, block.view());
  ByteWriter writer(out.body());
  writer.put(block.tx);
  writer.put(block.ty);
  writer.put(block.tile_rev);
  writer.put(static_cast<std::uint8_t>(block.layer));
  writer.put(static_cast<std::uint8_t>(encoding));
  writer.put(static_cast<std::uint8_t>(kTileLog2));
  writer.put(block.row0);
  writer.put(block.rows);
  writer.put(std::uint8_t{0});
  writer.put(block.known_cells());
  writer.f32(block.scale);
  writer.f32(block.offset);
  writer.put(block.block_age_ms);
  put_cells(writer, block.layer, encoding, block.view());
  assert(writer.ok());
  seal(header, writer.size(), out, key);
}

Reject decode(const Opened& opened, TileBlock& out) {
  if (opened.body.size() <= kTileHeaderBytes) return Reject::body_length;
  ByteReader reader(opened.body);
  out.tx = reader.get<std::int32_t>();
  out.ty = reader.get<std::int32_t>();
  out.tile_rev = reader.get<std::uint32_t>();
  const auto layer = layer_from_wire(reader.get<std::uint8_t>());
  const auto encoding = static_cast<Encoding>(reader.get<std::uint8_t>());
  const int tile_log2 = reader.get<std::uint8_t>();
  out.row0 = reader.get<std::uint8_t>();
  out.rows = reader.get<std::uint8_t>();
  reader.skip(1);
  const auto known_cells = reader.get<std::uint16_t>();
  out.scale = reader.f32();
  out.offset = reader.f32();
  out.block_age_ms = reader.get<std::uint32_t>();

  if (!layer) return Reject::layer;
  out.layer = *layer;
  if (tile_log2 != kTileLog2 || !valid_rows(out.layer, out.row0, out.rows)) return Reject::body_value;
  if (!valid_index(out.tx) || !valid_index(out.ty)) return Reject::body_value;
  if (!std::isfinite(out.scale) || !(out.scale > 0.0f) || !std::isfinite(out.offset)) return Reject::body_value;
  const auto raw = std::span(out.raw).first(static_cast<std::size_t>(out.cells()));
  if (const Reject reason = get_cells(reader, out.layer, encoding, raw); reason != Reject::none) return reason;
  return out.known_cells() == known_cells ? Reject::none : Reject::body_value;
}

}  // namespace scree::node::protocol
