"""The map that came out of the guest against the terrain that the simulator rendered.

The simulator adds no noise. A cell's height is a mean of returns that lie in the cell, so it lies between the lowest and
the highest ground of the cell, but for what is rounded on the way: depths to whole counts of 1 mm, at most 0.5 mm / cos a
along a ray that is a off the axis (the sensor's corner has 1 / cos a = sqrt(1 + (39.5^2 + 29.5^2) / 65.625^2)), which moves
a return into a neighbouring cell by as much; and heights on the wire to 2^-12 m.
"""

import json
import math

import truth

COUNT_M = 0.001
OFF_AXIS = math.hypot(1.0, math.hypot(39.5, 29.5) / 65.625)
RETURN_M = 0.5 * COUNT_M * OFF_AXIS
WIRE_M = 0.5 * 2.0 ** -12
FLOAT_M = 2.0 ** -20  # float32 coordinates of a few metres, some operations
MEASURED = 4  # of the cell states


def check(run, terrain_cell_m, expect):
    """`expect(condition, text)` is told each judgement."""
    place = json.loads((run / "findings" / "map.json").read_text())
    elevation, rows, columns = truth.read_npy(run / "findings" / "map.elevation.npy")
    state, *shape = truth.read_npy(run / "findings" / "map.cell_state.npy")
    expect(shape == [rows, columns], f"map: expected layers of one size, found {rows} x {columns} and {shape}")
    terrain = truth.Terrain(run / "scene" / "truth" / "terrain.npy", terrain_cell_m)
    cell_m = place["cell_m"]
    measured = [i for i in range(rows * columns) if state[i] == MEASURED]
    outside, worst_m, square = [], 0.0, 0.0
    for i in measured:
        x_m, y_m = place["x_min_m"] + i % columns * cell_m, place["y_min_m"] + i // columns * cell_m
        low, high = terrain.range_m(x_m - RETURN_M, x_m + cell_m + RETURN_M, y_m - RETURN_M, y_m + cell_m + RETURN_M)
        beyond = max(low - elevation[i], elevation[i] - high)
        worst_m = max(worst_m, beyond)
        square += (elevation[i] - 0.5 * (low + high)) ** 2
        if not beyond <= RETURN_M + WIRE_M + FLOAT_M:
            outside.append(f"({x_m:.2f}, {y_m:.2f}): expected {low:.4f} ... {high:.4f} m, found {elevation[i]:.4f}")
    expect(not outside, f"map: {len(outside)} of {len(measured)} measured cells are not the ground: {outside[:3]}")
    if measured:
        print(f"map: {len(measured)} measured cells, {len(outside)} not their ground; at most {1e3 * worst_m:.2f} mm beyond, rms "
              f"{1e3 * math.sqrt(square / len(measured)):.1f} mm from its middle")
    check_coverage(run, measured, state, shape, place, expect)


def check_coverage(run, measured, state, shape, place, expect):
    """Every cell that a replay of the same frame measures is measured."""
    replayed, *size = truth.read_npy(run / "replay.cell_state.npy")
    its_place = json.loads((run / "replay.json").read_text())
    same = size == shape and all(its_place[key] == place[key] for key in ("cell_m", "x_min_m", "y_min_m"))
    expect(same, f"map: expected the window of the replay, {size} at {its_place}, found {shape} at {place}")
    if not same:
        return
    expected = sum(1 for value in replayed if value == MEASURED)
    missing = sum(1 for i, value in enumerate(replayed) if value == MEASURED and state[i] != MEASURED)
    print(f"map: a replay of one frame measures {expected} cells")
    expect(expected > 0, "map: expected a replay that measures cells, found none")
    expect(missing == 0, f"map: {missing} cells that a replay of the same frame measures are not measured")
