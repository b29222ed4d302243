#include "fractal/reconstruction/stencil_rows.hpp"

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {

SCREE_CLONES void uniform_residual_row(BlendWeights w, const float* const* x, const float* __restrict c,
                                       const float* __restrict b, float* __restrict out, int n) {
  const float* __restrict up2 = x[0];
  const float* __restrict up = x[1];
  const float* __restrict mid = x[2];
  const float* __restrict down = x[3];
  const float* __restrict down2 = x[4];
  const float centre = 4 * w.w1 + 20 * w.w2, side = -w.w1 - 8 * w.w2, diagonal = 2 * w.w2, far = w.w2;
  for (int i = 0; i < n; ++i) {
    const float sides = (mid[i - 1] + mid[i + 1]) + (up[i] + down[i]);
    const float diagonals = (up[i - 1] + up[i + 1]) + (down[i - 1] + down[i + 1]);
    const float fars = (mid[i - 2] + mid[i + 2]) + (up2[i] + down2[i]);
    out[i] = b[i] - ((centre + c[i]) * mid[i] + side * sides + diagonal * diagonals + far * fars);
  }
}

SCREE_CLONES void laplacian_rows(const float* const* x, const float* __restrict half_w1, const float* __restrict w2,
                                 float* __restrict laplacian, float* __restrict inner, int n) {
  const float* __restrict up = x[0];
  const float* __restrict mid = x[1];
  const float* __restrict down = x[2];
  for (int i = 0; i < n; ++i) {
    const float l = 4.0F * mid[i] - ((mid[i - 1] + mid[i + 1]) + (up[i] + down[i]));
    laplacian[i] = l;
    inner[i] = half_w1[i] * mid[i] + w2[i] * l;
  }
}

SCREE_CLONES void varying_residual_row(const float* const* inner, const float* __restrict diagonal,
                                       const float* __restrict half_w1, const float* __restrict x,
                                       const float* __restrict laplacian, const float* __restrict b,
                                       float* __restrict out, int n) {
  const float* __restrict up = inner[0];
  const float* __restrict mid = inner[1];
  const float* __restrict down = inner[2];
  for (int i = 0; i < n; ++i) {
    const float l = 4.0F * mid[i] - ((mid[i - 1] + mid[i + 1]) + (up[i] + down[i]));
    out[i] = b[i] - (diagonal[i] * x[i] + half_w1[i] * laplacian[i] + l);
  }
}

SCREE_CLONES void broken_laplacian_rows(const float* const* x, const EdgeRows& edges, const float* __restrict half_w1,
                                        const float* __restrict w2, float* __restrict laplacian,
                                        float* __restrict inner, int n) {
  const float* __restrict up = x[0];
  const float* __restrict mid = x[1];
  const float* __restrict down = x[2];
  const float* __restrict right = edges.right;
  const float* __restrict below = edges.down;
  const float* __restrict above = edges.up;
  for (int i = 0; i < n; ++i) {
    const float l = (right[i] * (mid[i] - mid[i + 1]) + right[i - 1] * (mid[i] - mid[i - 1])) +
                    (below[i] * (mid[i] - down[i]) + above[i] * (mid[i] - up[i]));
    laplacian[i] = l;
    inner[i] = half_w1[i] * mid[i] + w2[i] * l;
  }
}

SCREE_CLONES void broken_residual_row(const float* const* inner, const EdgeRows& edges,
                                      const float* __restrict diagonal, const float* __restrict half_w1,
                                      const float* __restrict x, const float* __restrict laplacian,
                                      const float* __restrict b, float* __restrict out, int n) {
  const float* __restrict up = inner[0];
  const float* __restrict mid = inner[1];
  const float* __restrict down = inner[2];
  const float* __restrict right = edges.right;
  const float* __restrict below = edges.down;
  const float* __restrict above = edges.up;
  for (int i = 0; i < n; ++i) {
    const float l = (right[i] * (mid[i] - mid[i + 1]) + right[i - 1] * (mid[i] - mid[i - 1])) +
                    (below[i] * (mid[i] - down[i]) + above[i] * (mid[i] - up[i]));
    out[i] = b[i] - (diagonal[i] * x[i] + half_w1[i] * laplacian[i] + l);
  }
}

SCREE_CLONES void scaled_product_row(float factor, const float* __restrict a, const float* __restrict b,
                                     float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = factor * a[i] * b[i];
}

SCREE_CLONES void advance_row(float alpha, const float* __restrict p, const float* __restrict q, float factor,
                              const float* __restrict step, float* __restrict x, float* __restrict r,
                              float* __restrict z, int n) {
  for (int i = 0; i < n; ++i) {
    x[i] += alpha * p[i];
    const float rest = r[i] + alpha * q[i];
    r[i] = rest;
    z[i] = factor * step[i] * rest;
  }
}

SCREE_CLONES double correct_row(float factor, const float* __restrict step, const float* __restrict residual,
                                const float* __restrict z, const float* __restrict r, float* __restrict out, int n) {
  Lanes total = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    Lanes s, t, v, w;
    std::memcpy(&s, step + i, sizeof s);
    std::memcpy(&t, residual + i, sizeof t);
    std::memcpy(&v, z + i, sizeof v);
    std::memcpy(&w, r + i, sizeof w);
    const Lanes corrected = v + factor * s * t;
    std::memcpy(out + i, &corrected, sizeof corrected);
    total += w * corrected;
  }
  float rest = 0.0F;
  for (; i < n; ++i) {
    out[i] = z[i] + factor * step[i] * residual[i];
    rest += r[i] * out[i];
  }
  return static_cast<double>(sum(total)) + static_cast<double>(rest);
}

SCREE_CLONES void direction_row(float beta, const float* __restrict z, float* __restrict p, int n) {
  for (int i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
}

SCREE_CLONES double dot_row(const float* a, const float* b, int n) {
  Lanes total = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    Lanes x, y;
    std::memcpy(&x, a + i, sizeof x);
    std::memcpy(&y, b + i, sizeof y);
    total += x * y;
  }
  float rest = 0.0F;
  for (; i < n; ++i) rest += a[i] * b[i];
  return static_cast<double>(sum(total)) + static_cast<double>(rest);
}

SCREE_CLONES void restrict_row(const float* const* fine, float* __restrict line, float* __restrict out, int n) {
  const float* __restrict a = fine[0];
  const float* __restrict b = fine[1];
  const float* __restrict c = fine[2];
  const float* __restrict d = fine[3];
  float* __restrict centre = line + 1;
  for (int i = 0; i < 2 * n; ++i) centre[i] = (a[i] + d[i]) + 3.0F * (b[i] + c[i]);
  centre[-1] = centre[0];
  centre[2 * n] = centre[2 * n - 1];
  for (int j = 0; j < n; ++j)
    out[j] = (1.0F / 16.0F) * ((line[2 * j] + line[2 * j + 3]) + 3.0F * (line[2 * j + 1] + line[2 * j + 2]));
}

SCREE_CLONES void prolong_row(const float* near, const float* away, const float* __restrict transfer,
                              float* __restrict line, float* __restrict fine, int n) {
  for (int i = 0; i < n + 2; ++i) line[i] = 0.75F * near[i - 1] + 0.25F * away[i - 1];
  const float* __restrict centre = line + 1;
  float* __restrict spread = line + n + 2;
  for (int j = 0; j < n; ++j) {
    spread[2 * j] = 0.75F * centre[j] + 0.25F * centre[j - 1];
    spread[2 * j + 1] = 0.75F * centre[j] + 0.25F * centre[j + 1];
  }
  for (int i = 0; i < 2 * n; ++i) fine[i] += transfer[i] * spread[i];
}

}  // namespace scree::fractal
