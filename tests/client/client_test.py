#!/usr/bin/env python3
"""The Python client's own parts: configuration, socket, arrays; and that its names are those of the header."""
import array
import logging
import math
import os
import re
import socket
import time
import unittest

import client_path
import scree_client as sc

logging.disable(logging.WARNING)
MS = 1_000_000


def hexadecimal(text):
    return b"" if text == "-" else bytes.fromhex(text)


class Sender:
    """Heartbeats of one sender, made from the golden one."""

    def __init__(self, port, host="127.0.0.1"):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        self.to = (host, port)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, data):
        self.socket.sendto(data, self.to)

    def heartbeat(self, seq):
        data = bytearray(client_path.golden("heartbeat"))
        data[24:32] = seq.to_bytes(8, "little")
        data[60:64] = sc.crc_of_datagram(data, len(data)).to_bytes(4, "little")
        self.send(bytes(data))


def config(**more):
    return sc.Config(**{"bind": "127.0.0.1:0", "stream_id": 7, **more})


def fresh_map():
    """A receiver with the golden announcement's window (200 x 150 cells) and one tile of costs."""
    receiver = sc.Receiver(config(accept_origins=(sc.LIVE, sc.SIM)), 0)
    for seq, name in enumerate(("announce", "heartbeat", "tile_cost_raw", "tile_elevation_lower"), 1):
        data = bytearray(client_path.golden(name))
        data[24:32] = seq.to_bytes(8, "little")
        data[60:64] = sc.crc_of_datagram(data, len(data)).to_bytes(4, "little")
        assert receiver.accept(bytes(data), 0) == "accepted"
    return receiver


class Names(unittest.TestCase):
    def test_counters_are_those_of_the_header(self):
        header = (client_path.ROOT / "client" / "scree_client.hpp").read_text()
        verdicts = re.search(r"kNames\[kVerdicts\] = \{(.*?)\}", header, re.S).group(1)
        self.assertEqual(tuple(re.findall(r'"(\w+)"', verdicts)), sc.VERDICTS)
        visited = re.findall(r'visit\("(\w+)", ', header)
        self.assertEqual(tuple(visited[:1]) + sc.VERDICTS + tuple(visited[1:]), sc.Counters)

    def test_occupancy_is_costmap_2d(self):
        self.assertEqual([sc.OCCUPANCY[c] for c in (0, 1, 2, 252, 253, 254, 255)], [0, 1, 1, 98, 99, 100, -1])
        self.assertEqual(list(sc.OCCUPANCY[:255]), sorted(sc.OCCUPANCY[:255]))

    def test_hash_of_the_standard_library_has_the_vectors_of_the_header(self):
        import hashlib
        for line in (client_path.GOLDEN / "blake2b.txt").read_text().splitlines()[1:]:
            key, data, digest = map(hexadecimal, line.split())
            self.assertEqual(hashlib.blake2b(data, key=key, digest_size=len(digest)).digest(), digest)


class Configuration(unittest.TestCase):
    def test_what_cannot_be_is_refused_by_name(self):
        for field, value in (("bind", "0.0.0.0:47800"), ("bind", "[::]:1"), ("bind", "localhost:1"), ("bind", "127.0.0.1"),
                             ("bind", "127.0.0.1:65536"), ("bind", "127.0.0.1:+1"), ("node", "[::1]:1"), ("node", "x:1"),
                             ("multicast", "127.0.0.1"), ("layers", (11,)), ("layers", ()), ("max_window_tiles", 0),
                             ("repeats", 4), ("region", (5, 0, 4, 0)), ("keys", (sc.Key(1, b"short"),)),
                             ("keys", (sc.Key(0, bytes(32)),)), ("keys", (sc.Key(1, bytes(32)),) * 2), ("accept_origins", ())):
            with self.subTest(f"{field} {value}"), self.assertRaisesRegex(ValueError, f"{field}: expected"):
                sc.Client(config(**{field: value}))

    def test_a_port_in_use_is_an_oserror(self):
        with sc.Client(config()) as first, self.assertRaises(OSError):
            sc.Client(config(bind=f"127.0.0.1:{first.port}"))


class Arrays(unittest.TestCase):
    def test_window_is_row_major_from_its_origin(self):
        receiver = fresh_map()
        grid = receiver.grid()
        self.assertEqual((grid.columns, grid.rows, grid.x_min_m, grid.y_min_m), (200, 150, -10.0, 33 * 0.1))
        cost = receiver.copy_cost(0)
        self.assertEqual(len(cost), 200 * 150)
        # tile (-4, 5): its cell (28, 0) is the window's first column; cell i = (7 i + 3) mod 256
        self.assertEqual(cost[(5 * 32 - 33) * 200], (7 * 28 + 3) % 256)
        occupancy = receiver.to_occupancy(0)
        self.assertIsInstance(occupancy, array.array)
        self.assertEqual([sc.OCCUPANCY[c] for c in cost], list(occupancy))

    def test_numpy_views_are_the_same_cells(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("numpy is not installed here")
        receiver = fresh_map()
        cost = receiver.cost_array(0)
        self.assertEqual((cost.shape, cost.dtype), ((150, 200), numpy.uint8))
        self.assertEqual(cost.tobytes(), bytes(receiver.copy_cost(0)))
        elevation = receiver.layer_array(sc.ELEVATION, 0)
        self.assertEqual((elevation.shape, elevation.dtype), ((150, 200), numpy.float32))
        self.assertEqual(float(elevation[5 * 32 - 33, 1]), receiver.value_of_cell(sc.ELEVATION, -99, 160, 0))

    def test_without_numpy_the_views_say_what_to_use(self):
        import sys
        from unittest import mock
        with mock.patch.dict(sys.modules, numpy=None), self.assertRaisesRegex(RuntimeError, "copy_cost"):
            fresh_map().cost_array(0)

    def test_places_that_are_none_are_unknown(self):
        receiver = fresh_map()
        for x, y in ((math.nan, 0.0), (math.inf, 0.0), (0.0, -math.inf), (1e300, 1e300)):
            self.assertEqual(receiver.cost(x, y, 0), 255)
            self.assertTrue(math.isnan(receiver.value(sc.ELEVATION, x, y, 0)))


class Sockets(unittest.TestCase):
    def test_heartbeat_makes_it_fresh_and_readings_age_without_poll(self):
        with sc.Client(config()) as client, Sender(client.port) as sender:
            self.assertFalse(client.wait(0.001))
            self.assertFalse(client.poll())
            sender.send(bytes(1201))
            sender.send(bytes(9000))
            now = 0
            for seq in range(1, 51):  # a machine may stall
                sender.heartbeat(seq)
                self.assertTrue(client.wait(10))
                now = time.monotonic_ns()
                self.assertTrue(client.poll(now))
                if client.state(now) == "fresh":
                    break
            self.assertEqual(client.state(now), "fresh")
            self.assertEqual(client.counters["too_long"], 2)
            self.assertEqual((client.state(now + 301 * MS), client.state(now + 1001 * MS)), ("stale", "lost"))

    def test_datagrams_are_as_old_as_the_kernel_says(self):
        with sc.Client(config()) as client, Sender(client.port) as sender:
            sender.heartbeat(1)
            time.sleep(0.4)
            now = time.monotonic_ns()
            client.poll(now)
            self.assertEqual(client.state(now), "stale")

    def test_what_the_kernel_drops_is_counted(self):
        with sc.Client(config()) as client, Sender(client.port) as sender:
            client._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 20_000)
            for seq in range(1, 1001):
                sender.heartbeat(seq)
            client.poll()
            sender.heartbeat(1001)  # the kernel tells with the next one
            client.wait(10)
            client.poll()
            self.assertGreater(client.counters["overflowed"], 0)
            self.assertEqual(client.counters["datagrams"] + client.counters["overflowed"], 1001)
            self.assertEqual(client.counters["lost"], client.counters["overflowed"])

    def test_a_multicast_group_has_several_listeners(self):
        bind = f"127.0.0.1:{20000 + os.getpid() % 12000}"
        try:
            one = sc.Client(config(bind=bind, multicast="239.255.71.4"))
        except OSError as error:
            self.skipTest(str(error))
        with one, sc.Client(config(bind=bind, multicast="239.255.71.4")) as two, Sender(one.port, "239.255.71.4") as sender:
            try:
                sender.heartbeat(1)
            except OSError as error:
                self.skipTest(str(error))
            for client in (one, two):
                self.assertTrue(client.wait(10))
                self.assertTrue(client.poll())
                self.assertNotEqual(client.state(), "waiting")

    def test_requests_leave_and_close_ends_the_subscription(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as node:
            node.bind(("127.0.0.1", 0))
            node.settimeout(10)
            with sc.Client(config(node=f"127.0.0.1:{node.getsockname()[1]}")) as client:
                client.poll()
                request, address = node.recvfrom(2000)
                self.assertEqual((request[6], address), (6, ("127.0.0.1", client.port)))
                cookie = bytearray(client_path.golden("cookie"))
                node.sendto(bytes(cookie), address)
                client.wait(10)
                client.poll()
                client.poll(time.monotonic_ns() + 200 * MS)
                kinds = [node.recvfrom(2000)[0] for _ in range(2)]
                self.assertEqual(sorted(request[6] for request in kinds), [6, 9])
            last = node.recvfrom(2000)[0]
            self.assertEqual((last[6], last[72:80]), (6, bytes(8)), "layer mask 0")


if __name__ == "__main__":
    unittest.main()
