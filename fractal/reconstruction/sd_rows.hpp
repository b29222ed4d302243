#pragma once
// The arithmetic of the sd map, a row at a time. Pointers named out, weight, ratio, model or sd overlap no other.

#include <cstdint>

namespace scree::fractal::sd_rows {

/// Of positive numbers; 0 counts as 1e-30.
void log_of(const float* x, float* out, int n);
/// out += factor·a
void add_scaled(const float* a, float factor, float* out, int n);
/// x = eˣ, x held within ±80.
void exp_in_place(float* x, int n);
/// 0 where measured, else 1.
void weigh(const std::uint8_t* measured, float* weight, int n);
/// What the fields say over what the model says, of unmeasured cells.
void ratio_row(const std::uint8_t* measured, const float* fields, const float* model, float* ratio, int n);
/// model ·= mean + share·(ratio/(row_weight·inside) − mean)
void correct_row(const float* ratio, const float* inside, float row_weight, float mean, float share, float* model,
                 int n);
/// `alone`: a cell's variance without a datum; `variance` of its datum, > 0, or NaN.
void write_row(const float* variance, const float* alone, float* sd, int n);

}  // namespace scree::fractal::sd_rows
