#include "drivers/frame/cartesian.hpp"

#include "core/simd.hpp"

namespace scree {
namespace {

/// One row's tables and outputs as bare pointers, so that the compiler sees plain loops.
struct Row {
  const float *origin_x, *origin_y, *origin_z;
  const float *direction_x, *direction_y, *direction_z;
  const float* range_per_count;
  const float* range;
  const PixelState* state;
  int columns;
};

Row row_of(const Projection& p, const Grid<PixelState>& state, const Grid<float>& range_m, int r) {
  return {p.origin_x_m.row(r).data(),
          p.origin_y_m.row(r).data(),
          p.origin_z_m.row(r).data(),
          p.direction_x.row(r).data(),
          p.direction_y.row(r).data(),
          p.direction_z.row(r).data(),
          p.range_per_count_m.row(r).data(),
          range_m.row(r).data(),
          state.row(r).data(),
          p.columns};
}

void write_row(const Row& row, const RowPose& pose, const RangeNoise& noise, std::size_t n, PointFrame& out) {
  const Eigen::Matrix3f& R = pose.rotation;
  const Eigen::Vector3f& t = pose.origin_m;
  for (int c = 0; c < row.columns; ++c) {
    if (row.state[c] != PixelState::kept) continue;
    const float range = row.range[c];
    const float x = row.origin_x[c] + range * row.direction_x[c];
    const float y = row.origin_y[c] + range * row.direction_y[c];
    const float z = row.origin_z[c] + range * row.direction_z[c];
    out.x_m[n] = R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + t.x();
    out.y_m[n] = R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + t.y();
    out.z_m[n] = R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + t.z();
    out.range_m[n] = range;
    out.range_variance_m2[n] = range_variance_m2(noise, range, row.range_per_count[c]);
    out.direction_z[n] = R(2, 0) * row.direction_x[c] + R(2, 1) * row.direction_y[c] + R(2, 2) * row.direction_z[c];
    ++n;
  }
}

void count_rows(const Grid<PixelState>& state, std::vector<std::uint32_t>& row_begin) {
  row_begin.assign(static_cast<std::size_t>(state.rows()) + 1, 0);
  std::uint32_t total = 0;
  for (int r = 0; r < state.rows() && state.columns() > 0; ++r) {
    row_begin[static_cast<std::size_t>(r)] = total;
    for (const PixelState pixel : state.row(r)) total += pixel == PixelState::kept ? 1U : 0U;
  }
  row_begin.back() = total;
}

}  // namespace

void write_points(const RayTables& tables, const RowPoses& poses, const Grid<PixelState>& state,
                  const Grid<float>& range_m, Executor& executor, PointFrame& out) {
  count_rows(state, out.row_begin);
  for (auto* column : {&out.x_m, &out.y_m, &out.z_m, &out.range_m, &out.range_variance_m2, &out.direction_z})
    column->resize(out.row_begin.back());
  out.anchor_map_m = poses.anchor_map_m;
  out.sensor_m.resize(poses.rows.size());
  const Projection& projection = *tables.projection;
  for_rows(executor, state.rows(), [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const auto index = static_cast<std::size_t>(r);
      out.sensor_m[index] = poses.rows[index].origin_m;
      if (projection.columns == 0) continue;  // an empty cloud
      write_row(row_of(projection, state, range_m, r), poses.rows[index], tables.sensor->noise, out.row_begin[index],
                out);
    }
  });
}

}  // namespace scree
