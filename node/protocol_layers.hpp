#pragma once
// The layers that tiles carry, and how a metre becomes a raw value.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace scree::node::protocol {

enum class Layer : std::uint8_t {
  cost = 0,
  elevation = 1,
  dimension = 2,
  elevation_sigma = 3,
  cell_age = 4,
  hits = 5,
  slope = 6,
  step = 7,
  amplitude = 8,
  dimension_sigma = 9,
  cell_state = 10,
};
inline constexpr std::size_t kLayerCount = 11;

/// How the cells of a block are written.
enum class Encoding : std::uint8_t { u8 = 0, i16 = 1, u16 = 2, constant = 3, run_length = 4 };

inline constexpr std::int16_t kUnknownU8 = 255;
inline constexpr std::int16_t kUnknownI16 = -32768;

/// How a layer chooses scale and offset: `fixed` has the announced ones; in `ladder` (u8) and `centred` (i16) every
/// block has its own, a power of two as scale that is never below the announced one.
enum class ScaleRule : std::uint8_t { fixed, ladder, centred };

/// value = offset + scale·raw, in `unit`.
struct LayerFormat {
  Layer layer;
  std::string_view name;  ///< lower case, as in file names
  Encoding encoding;      ///< u8 or i16: the type of a raw value
  ScaleRule rule;
  float scale;      ///< `ladder` and `centred`: the finest one
  float max_scale;  ///< `ladder`: the coarsest one; a value beyond 254 of these is saturated
  float offset;     ///< `centred`: 0, each block has its own
};

inline constexpr std::array<LayerFormat, kLayerCount> kLayers = {{
    {Layer::cost, "cost", Encoding::u8, ScaleRule::fixed, 1.0f, 1.0f, 0.0f},
    {Layer::elevation, "elevation", Encoding::i16, ScaleRule::centred, 0x1p-12f, 0x1p+100f, 0.0f},
    {Layer::dimension, "dimension", Encoding::u8, ScaleRule::fixed, 1.0f / 254.0f, 1.0f / 254.0f, 2.0f},
    {Layer::elevation_sigma, "elevation_sigma", Encoding::u8, ScaleRule::ladder, 0x1p-14f, 0x1p-5f, 0.0f},
    {Layer::cell_age, "cell_age", Encoding::u8, ScaleRule::ladder, 0x1p-4f, 0x1p+8f, 0.0f},
    {Layer::hits, "hits", Encoding::u8, ScaleRule::fixed, 1.0f, 1.0f, 0.0f},
    {Layer::slope, "slope", Encoding::u8, ScaleRule::fixed, 1.5707964f / 254.0f, 1.5707964f / 254.0f, 0.0f},
    {Layer::step, "step", Encoding::u8, ScaleRule::ladder, 0x1p-14f, 0x1p-5f, 0.0f},
    {Layer::amplitude, "amplitude", Encoding::u8, ScaleRule::ladder, 0x1p-14f, 0x1p-5f, 0.0f},
    {Layer::dimension_sigma, "dimension_sigma", Encoding::u8, ScaleRule::fixed, 1.0f / 254.0f, 1.0f / 254.0f, 0.0f},
    {Layer::cell_state, "cell_state", Encoding::u8, ScaleRule::fixed, 1.0f, 1.0f, 0.0f},
}};

/// `layer` must be one of the enumerators.
constexpr const LayerFormat& layer_format(Layer layer) {
  return kLayers[static_cast<std::size_t>(layer)];
}
/// The layer with this number on the wire, if there is one.
constexpr std::optional<Layer> layer_from_wire(std::uint8_t number) {
  if (number >= kLayerCount) return std::nullopt;
  return static_cast<Layer>(number);
}
constexpr std::int16_t unknown_raw(Layer layer) {
  return layer_format(layer).encoding == Encoding::i16 ? kUnknownI16 : kUnknownU8;
}

}  // namespace scree::node::protocol
