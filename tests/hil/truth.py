"""What the map must be: heights of the rendered terrain, from its nodes (docs/simulator.md, "Terrain")."""

import ast
import array
import math
import pathlib


def read_npy(file):
    """(values, rows, columns) of a two-dimensional little-endian float32 array in C order."""
    data = pathlib.Path(file).read_bytes()
    if data[:6] != b"\x93NUMPY":
        raise ValueError(f"{file}: expected an npy file, found {data[:6]!r}")
    size, begin = (int.from_bytes(data[8:10], "little"), 10) if data[6] == 1 else (int.from_bytes(data[8:12], "little"), 12)
    header = ast.literal_eval(data[begin:begin + size].decode("latin1"))
    if header["descr"] != "<f4" or header["fortran_order"] or len(header["shape"]) != 2:
        raise ValueError(f"{file}: expected rows x columns of <f4 in C order, found {header}")
    values = array.array("f")
    values.frombytes(data[begin + size:])
    return values, *header["shape"]


class Terrain:
    """Bilinear patches between nodes that are the centres of square cells, centred on the origin."""

    def __init__(self, file, cell_m):
        self.heights, self.rows, self.columns = read_npy(file)
        self.cell_m = cell_m
        self.x_min_m, self.y_min_m = -0.5 * self.columns * cell_m, -0.5 * self.rows * cell_m

    def height_m(self, x_m, y_m):
        u = (x_m - self.x_min_m) / self.cell_m - 0.5
        v = (y_m - self.y_min_m) / self.cell_m - 0.5
        c, r = math.floor(u), math.floor(v)
        if not (0 <= c < self.columns - 1 and 0 <= r < self.rows - 1):
            raise ValueError(f"({x_m}, {y_m}): expected a place on the terrain")
        u, v = u - c, v - r
        at = lambda row, column: self.heights[row * self.columns + column]
        low = at(r, c) * (1 - u) + at(r, c + 1) * u
        high = at(r + 1, c) * (1 - u) + at(r + 1, c + 1) * u
        return low * (1 - v) + high * v

    def _stops(self, low_m, high_m, origin_m):
        first = math.ceil((low_m - origin_m) / self.cell_m - 0.5)
        last = math.floor((high_m - origin_m) / self.cell_m - 0.5)
        return [low_m, high_m] + [origin_m + (i + 0.5) * self.cell_m for i in range(first, last + 1)]

    def range_m(self, x_min_m, x_max_m, y_min_m, y_max_m):
        """Lowest and highest ground in a rectangle: a bilinear patch has its extremes at the corners of whatever part
        of it lies inside."""
        heights = [self.height_m(x, y) for x in self._stops(x_min_m, x_max_m, self.x_min_m)
                   for y in self._stops(y_min_m, y_max_m, self.y_min_m)]
        return min(heights), max(heights)
