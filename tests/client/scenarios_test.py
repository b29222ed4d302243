#!/usr/bin/env python3
"""Replays client/golden/scenarios against the Python client: the same files as scenarios_test.cpp."""
import math
import unittest

import client_path
import scree_client

MS = 1_000_000


class Replay:
    def __init__(self, test):
        self.test = test
        self.settings = {}
        self.receiver = None
        self.verdict = None

    def config(self, field, *values):
        if field == "subscribe":
            self.settings["node"] = "127.0.0.1:1"
        elif field == "key":
            key = scree_client.Key(int(values[0]), bytes.fromhex(values[1]))
            self.settings["keys"] = self.settings.get("keys", ()) + (key,)
        elif field == "cell_max_age_ms":
            self.settings["cell_max_age_ns"] = int(values[0]) * MS
        elif field in ("layers", "accept_origins"):
            self.settings[field] = tuple(map(int, values[0].split(",")))
        elif field == "region":
            self.settings[field] = tuple(map(int, values))
        else:
            self.settings[field] = int(values[0])

    def line(self, words):
        if words[0] == "config":
            return self.config(*words[1:])
        if self.receiver is None:
            self.receiver = scree_client.Receiver(scree_client.Config(**self.settings), 0)
        now, what = int(words[1]) * MS, words[2]
        if what == "receive":
            self.verdict = self.receiver.accept(bytes.fromhex(words[3] if len(words) > 3 else ""), now)
        elif what == "golden":
            self.verdict = self.receiver.accept(client_path.golden(words[3]), now)
        else:
            getattr(self, "expect_" + words[3])(now, *words[4:])

    def expect_verdict(self, now, name):
        self.test.assertEqual(self.verdict, name)

    def expect_state(self, now, name):
        self.test.assertEqual(self.receiver.state(now), name)
        self.test.assertEqual(self.receiver.fresh(now), name == "fresh")

    def expect_cost(self, now, x, y, cost):
        self.test.assertEqual(self.receiver.cost_of_cell(int(x), int(y), now), int(cost))
        res = self.receiver.grid().resolution_m or 1.0
        middle = (int(x) + 0.5) * res, (int(y) + 0.5) * res
        self.test.assertEqual(self.receiver.cost(*middle, now), int(cost))
        self.in_window(x, y, self.receiver.copy_cost(now), int(cost))

    def expect_value(self, now, layer, x, y, value):
        found, expected = self.receiver.value_of_cell(int(layer), int(x), int(y), now), float(value)
        self.same(found, expected)
        self.in_window(x, y, self.receiver.copy_layer(int(layer), now), expected)

    def expect_cell_state(self, now, x, y, state):
        self.test.assertEqual(self.receiver.cell_state_of_cell(int(x), int(y), now), int(state))

    def expect_occupancy(self, now, column, row, value):
        grid = self.receiver.grid()
        self.test.assertEqual(self.receiver.to_occupancy(now)[int(row) * grid.columns + int(column)], int(value))

    def expect_grid(self, now, columns, rows, x_min, y_min, resolution):
        grid = self.receiver.grid()
        self.test.assertEqual((grid.columns, grid.rows, grid.x_min_cells, grid.y_min_cells, grid.resolution_m),
                              (int(columns), int(rows), int(x_min), int(y_min), float(resolution)))
        self.test.assertEqual((grid.x_min_m, grid.y_min_m), (int(x_min) * float(resolution), int(y_min) * float(resolution)))

    def expect_counter(self, now, name, value):
        self.test.assertEqual(self.receiver.counters[name], int(value), name)

    def expect_health(self, now, bits):
        self.test.assertEqual(self.receiver.health(now), int(bits))

    def expect_bye(self, now, reason):
        found = self.receiver.bye_reason
        self.test.assertEqual(-1 if found is None else found, int(reason))

    def expect_request(self, now, kind, body):
        request = self.receiver.next_request(now)
        if kind == "0":
            self.test.assertIsNone(request)
            return
        self.test.assertIsNotNone(request)
        self.test.assertEqual((request[:4], request[6], int.from_bytes(request[10:12], "little")),
                              (b"SCRE", int(kind), len(request)))
        self.test.assertEqual(int.from_bytes(request[60:64], "little"), scree_client.crc_of_datagram(request, len(request)))
        if body != "*":
            self.test.assertEqual(request[64:].hex(), body)

    def same(self, found, expected):
        if math.isnan(expected):
            self.test.assertTrue(math.isnan(found), found)
        else:
            self.test.assertAlmostEqual(found, expected, delta=1e-5 * max(1.0, abs(expected)))

    def in_window(self, x, y, window, expected):
        grid = self.receiver.grid()
        column, row = int(x) - grid.x_min_cells, int(y) - grid.y_min_cells
        if 0 <= column < grid.columns and 0 <= row < grid.rows:
            self.same(float(window[row * grid.columns + column]), float(expected))


class Scenarios(unittest.TestCase):
    def test_every_scenario(self):
        files = sorted((client_path.GOLDEN / "scenarios").glob("*.txt"))
        self.assertGreater(len(files), 20)
        for file in files:
            with self.subTest(file.stem):
                replay = Replay(self)
                for number, line in enumerate(file.read_text().splitlines(), 1):
                    if line.startswith("#"):
                        continue
                    try:
                        replay.line(line.split())
                    except AssertionError as error:
                        raise AssertionError(f"{file.name}:{number}: {line[:120]}: {error}") from None
                counters = replay.receiver.counters
                self.assertEqual(counters["datagrams"], sum(counters[name] for name in scree_client.VERDICTS))


if __name__ == "__main__":
    unittest.main()
