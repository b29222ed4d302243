#!/usr/bin/env python3
"""Writes client/golden/scenarios/*.txt: what a receiver is told, when, and what it must then say.

Both clients' tests replay them (tests/client). Expected values are written down here by hand from docs/protocol.md;
nothing is computed by a client. Lines, times in milliseconds:

  config FIELD VALUE...                  stream_id N, accept_origins A,B, layers A,B, max_window_tiles N, subscribe,
                                         cell_max_age_ms N, key ID HEX, region TX_MIN TY_MIN TX_MAX TY_MAX, repeats N
  at T receive HEX                       a datagram;  golden NAME: the one of client/golden/NAME.hex
  at T expect verdict NAME               of the last datagram
  at T expect state NAME
  at T expect cost X Y COST              by cell of the lattice; likewise cell_state; value LAYER X Y NUMBER|nan
  at T expect occupancy COLUMN ROW N     of to_occupancy
  at T expect grid COLUMNS ROWS X_MIN Y_MIN RESOLUTION
  at T expect counter NAME N
  at T expect health N, bye N
  at T expect request TYPE BODY|*        the next request; 0 - for none
"""
import hashlib
import math
import pathlib
import struct
import zlib

FOLDER = pathlib.Path(__file__).parent / "scenarios"
KEY_1, KEY_2 = bytes(range(32)), bytes(range(255, 223, -1))
EVERYWHERE = (-2**26, -2**26, 2**26 - 1, 2**26 - 1)


class Node:
    """Numbers and seals the datagrams of one sender."""

    def __init__(self, boot_id=0xB007, stream_id=1, origin=0, key=None, key_id=0):
        self.boot_id, self.stream_id, self.origin, self.key, self.key_id = boot_id, stream_id, origin, key, key_id
        self.seq = 0

    def seal(self, kind, body, *, seq=None, health=0, rev=1, age_us=0, t_ns=10**18, minor=0, major=1, magic=b"SCRE",
             header_len=64, total=None, stream_id=None, extra=b"", origin=None, crc_xor=0, mac_xor=0, boot_id=None):
        if seq is None:
            self.seq += 1
            seq = self.seq
        flags = (self.origin if origin is None else origin) << 4 | (1 if self.key else 0)
        size = 64 + len(extra) + len(body) + (16 if self.key else 0)
        head = struct.pack("<4sBBBBHHIQQqIIHHIHH", magic, major, minor, kind, flags, header_len,
                           size if total is None else total, self.stream_id if stream_id is None else stream_id,
                           self.boot_id if boot_id is None else boot_id, seq, t_ns, age_us, rev, health, 0, 0,
                           self.key_id, 0)
        crc = zlib.crc32(head + bytes(4) + extra + body) ^ crc_xor
        data = head + struct.pack("<I", crc) + extra + body
        if self.key:
            mac = hashlib.blake2b(data, key=self.key, digest_size=16).digest()
            data += bytes([mac[0] ^ mac_xor]) + mac[1:]
        return data

    def heartbeat(self, **more):
        return self.seal(4, struct.pack("<QQQQIIIIB7x", 1000, 10, 0, 1, 1, 2, 3, 4, 0), **more)

    def announce(self, x_min=0, y_min=0, columns=64, rows=32, *, res=0.5, map_id=1, stale=300, lost=1000, max_age=0,
                 **more):
        tiles = (x_min >> 5, y_min >> 5, (x_min + columns - 1) >> 5, (y_min + rows - 1) >> 5)
        body = struct.pack("<Qd4d4i2i2I5IBBH", map_id, res, *[math.nan] * 4, *tiles, x_min, y_min, columns, rows, stale,
                           lost, max_age, 1000, 100, 5, 0, 0)
        return self.seal(1, body + b"".join(name.ljust(32, b"\0") for name in (b"map", b"n", b"v")), **more)

    def tile(self, tx=0, ty=0, rev=1, value=7, *, layer=0, age_ms=0, half=0, scale=1.0, offset=0.0, cells=None, **more):
        i16 = layer == 1
        unknown = -32768 if i16 else 255
        count = 512 if i16 else 1024
        known = 0 if value == unknown else count
        encoding, payload = 3, struct.pack("<h" if i16 else "<B", value)
        if cells is not None:
            encoding, payload, known = (1 if i16 else 0), cells, count
            known -= cells.count(255) if not i16 else struct.unpack("<512h", cells).count(-32768)
        head = struct.pack("<iiIBBBBBBHffI", tx, ty, rev, layer, encoding, 5, 16 * half, 16 if i16 else 32, 0, known, scale,
                           offset, age_ms)
        return self.seal(2, head + payload, rev=rev, **more)

    def manifest(self, revs, tx0=0, ty0=0, columns=None, layer=0, **more):
        columns = len(revs) if columns is None else columns
        head = struct.pack("<iiHHBBH", tx0, ty0, columns, len(revs) // columns, layer, 5, 0)
        return self.seal(3, head + struct.pack(f"<{len(revs)}I", *revs), **more)

    def cookie(self, cookie, **more):
        return self.seal(7, struct.pack("<QI4x", cookie, 3000), **more)

    def bye(self, reason=1, **more):
        return self.seal(11, bytes([reason]) + bytes(7), **more)


class Scenario:
    def __init__(self, comment):
        self.lines = [f"# {comment}"]

    def config(self, text):
        self.lines.append(f"config {text}")

    def receive(self, at, *datagrams, verdict="accepted"):
        for data in datagrams:
            self.lines.append(f"at {at} receive {data.hex()}")
            self.expect(at, f"verdict {verdict}")

    def golden(self, at, name, verdict="accepted"):
        self.lines.append(f"at {at} golden {name}")
        self.expect(at, f"verdict {verdict}")

    def expect(self, at, *texts):
        for text in texts:
            self.lines.append(f"at {at} expect {text}")


def started(s, node, at=0, **announce):
    """A fresh map of two tiles beside each other, cost 7 and 9."""
    s.receive(at, node.announce(**announce), node.tile(0, 0, value=7), node.tile(1, 0, value=9), node.heartbeat())


def map_appears():
    s, n = Scenario("ANNOUNCE, TILE, HEARTBEAT in any order make a fresh map; cells outside the window are unknown"), Node()
    s.expect(0, "state waiting", "cost 0 0 255", "grid 0 0 0 0 0")
    s.receive(0, n.tile(0, 0))
    s.expect(0, "counter tiles_without_window 1", "state waiting")
    s.receive(10, n.announce(-3, 2, 40, 30))
    cells = bytes(range(256)) * 4
    s.receive(20, n.tile(0, 0, 2, cells=cells), n.tile(-1, 0, 2, value=254), n.tile(9, 9, 2))
    s.expect(20, "state waiting", "cost 5 3 255", "counter tiles_outside 1", "counter tiles 2")
    s.receive(30, n.heartbeat())
    s.expect(30, "state fresh", "grid 40 30 -3 2 0.5", "cost 5 3 101", "cost -1 2 254", "cost -3 31 254", "cost 5 1 255",
             "cost -4 2 255", "cost 31 2 95", "cost 36 2 255", "cost 37 2 255", "cost 0 32 255", "cost 31 7 255", "cost 4000000000 0 255",
             "occupancy 0 0 100", "occupancy 3 0 25", "occupancy 34 5 -1", "occupancy 32 5 99", "occupancy 31 5 98",
             "occupancy 3 6 0", "occupancy 4 6 1", "value 0 5 3 101", "value 0 31 7 nan", "value 0 -4 2 nan",
             "cell_state 5 3 0", "counter accepted 6", "counter datagrams 6", "counter lost 0", "health 0")
    return s


def layers():
    s, n = Scenario("values of layers: scale and offset of the block; two halves of a 16-bit tile; unknown is NaN"), Node()
    s.config("layers 0,1,4,8,10")
    s.receive(0, n.announce(), n.heartbeat())
    lower = struct.pack("<512h", *[-32768 if i == 33 else i - 256 for i in range(512)])
    s.receive(10, n.tile(0, 0, 3, layer=1, cells=lower, scale=0.25, offset=-3.0),
              n.tile(0, 0, 3, layer=1, half=1, value=-1234, scale=0.5, offset=100.0),
              n.tile(0, 0, 3, layer=8, value=100, scale=2.0**-10), n.tile(0, 0, 3, layer=10, value=4),
              n.tile(1, 0, 3, layer=10, value=200), n.tile(0, 0, 3, layer=2, value=4),
              n.tile(0, 0, 3, layer=4, value=8, scale=0.25, age_ms=500))
    s.expect(10, "value 1 0 0 -67", "value 1 31 15 60.75", "value 1 1 1 nan", "value 1 0 16 -517", "value 1 32 0 nan",
             "value 8 3 3 0.09765625", "cell_state 3 3 4", "cell_state 40 3 0", "value 2 0 0 nan", "value 4 0 0 2.5",
             "counter tiles_not_held 1", "cost 0 0 255")
    s.expect(110, "value 4 0 0 2.6")
    return s


def silence():
    s, n = Scenario("300 ms without a heartbeat: stale, values stay; 1 s: lost, unknown, and tiles must come again"), Node()
    started(s, n)
    s.expect(299, "state fresh", "cost 0 0 7")
    s.expect(300, "state stale", "cost 0 0 7", "occupancy 0 0 3")
    s.receive(900, n.tile(0, 0, 1))
    s.expect(999, "state stale", "cost 0 0 7")
    s.expect(1000, "state lost", "cost 0 0 255", "value 0 0 0 nan", "occupancy 0 0 -1", "grid 64 32 0 0 0.5")
    s.receive(1500, n.heartbeat())
    s.expect(1500, "state fresh", "cost 0 0 255")
    s.receive(1510, n.tile(0, 0, 1))
    s.expect(1510, "cost 0 0 7", "cost 32 0 255")
    return s


def announced_times():
    s, n = Scenario("ANNOUNCE may shorten stale_ms and lost_ms, never lengthen them"), Node()
    started(s, n, stale=100, lost=400)
    s.expect(99, "state fresh")
    s.expect(100, "state stale")
    s.expect(399, "cost 0 0 7")
    s.expect(400, "state lost", "cost 0 0 255")
    started(s, n, 500, stale=5000, lost=9000)
    s.expect(799, "state fresh")
    s.expect(800, "state stale")
    s.expect(1500, "state lost", "cost 0 0 255")
    return s


def cell_max_age(configured, announced):
    s, n = Scenario(f"block age + time since receipt > 500 ms is unknown: configured {configured}, announced {announced}"), Node()
    if configured:
        s.config(f"cell_max_age_ms {configured}")
    s.receive(0, n.announce(max_age=announced), n.heartbeat(), n.tile(0, 0, 1, age_ms=300), n.tile(1, 0, 1))
    s.expect(200, "cost 0 0 7")
    s.expect(201, "cost 0 0 255", "cost 32 0 7")
    s.receive(250, n.heartbeat(), n.tile(0, 0, 1, age_ms=100))
    s.expect(500, "cost 0 0 7", "cost 32 0 7")
    s.expect(501, "cost 0 0 7", "cost 32 0 255")
    s.expect(650, "cost 0 0 7")
    s.expect(651, "cost 0 0 255")
    return s


def manifest():
    s, n = Scenario("a tile older than its manifest is unknown after 500 ms, until that revision comes"), Node()
    started(s, n)
    for at in range(200, 2001, 200):
        s.receive(at, n.heartbeat())
        if at == 200:
            s.receive(at, n.manifest([1, 2]))
        if at == 600:
            s.expect(at, "cost 32 0 9")
            s.receive(at, n.manifest([1, 2], rev=9))
            s.expect(700, "cost 32 0 9", "cost 0 0 7")
            s.expect(701, "cost 32 0 255", "cost 0 0 7", "occupancy 32 0 -1")
        if at == 800:
            s.receive(at, n.tile(1, 0, 1, value=3))
            s.expect(at, "cost 32 0 255")
            s.receive(at, n.tile(1, 0, 2, value=4))
            s.expect(at, "cost 32 0 4")
            s.receive(at, n.tile(1, 0, 1, value=3))
            s.expect(at, "cost 32 0 4", "counter tiles_outdated 1")
        if at == 1000:  # the manifest comes after a newer tile, or late: nothing is outdated
            s.receive(at, n.tile(0, 0, 6, value=5), n.manifest([5, 2]), n.manifest([3, 1]))
    s.expect(1900, "cost 0 0 5", "cost 32 0 4")
    return s


def manifest_halves():
    s, n = Scenario("both halves of a 16-bit tile must have the revision that the manifest names"), Node()
    s.receive(0, n.announce(), n.heartbeat(), n.tile(0, 0, 1, layer=1), n.tile(0, 0, 1, layer=1, half=1))
    s.receive(100, n.manifest([2], layer=1), n.tile(0, 0, 2, layer=1, value=8))
    s.receive(250, n.heartbeat())
    s.receive(500, n.heartbeat())
    s.expect(600, "value 1 0 0 8", "value 1 0 16 7")
    s.expect(601, "value 1 0 0 nan", "value 1 0 16 nan")
    s.receive(610, n.tile(0, 0, 2, layer=1, half=1, value=9))
    s.expect(610, "value 1 0 0 8", "value 1 0 16 9")
    return s


def boots():
    s = Scenario("a new boot_id: lost, every tile forgotten; the old one after more than 1 s: two senders, FAULT")
    a, b = Node(0xA), Node(0xB)
    started(s, a)
    s.receive(100, b.tile(0, 0, value=20))
    s.expect(100, "state lost", "cost 0 0 255", "cost 32 0 255", "grid 0 0 0 0 0", "counter boots 2", "health 0")
    s.receive(150, a.heartbeat(), verdict="old_boot")
    s.expect(150, "state lost")
    s.receive(200, b.announce(), b.heartbeat())
    s.expect(200, "state fresh", "cost 0 0 255")
    s.receive(300, b.tile(1, 0, value=21))
    s.expect(300, "cost 32 0 21", "cost 0 0 255")
    for at in range(400, 1101, 100):
        s.receive(at, b.heartbeat())
    s.receive(1100, a.heartbeat(), verdict="old_boot")
    s.expect(1100, "state fresh", "health 0")
    s.receive(1101, a.heartbeat(), verdict="old_boot")
    s.expect(1101, "state lost", "cost 32 0 255", "health 32768", "counter old_boot 3")
    for at in range(1200, 2101, 100):
        s.receive(at, b.heartbeat())
    s.expect(2100, "state lost", "cost 32 0 255")
    s.expect(2101, "state fresh", "health 0", "cost 32 0 21")
    return s


def bad_first_datagram():
    s = Scenario("a new boot_id counts only once one of its datagrams has passed every check")
    a, b = Node(0xA), Node(0xB)
    started(s, a)
    s.receive(100, b.tile(0, 0, layer=77), verdict="layer")
    s.receive(100, b.seal(99, b""), verdict="type")
    s.receive(100, b.seal(11, bytes(7)), verdict="body_length")
    s.receive(100, b.cookie(0), verdict="body_value")
    s.receive(100, b.heartbeat(origin=1), verdict="origin")
    s.expect(100, "state fresh", "cost 0 0 7", "counter boots 1")
    s.receive(110, b.bye())
    s.expect(110, "state lost", "cost 0 0 255", "bye 1", "counter boots 2")
    return s


def origins(accepted):
    s, n = Scenario(f"origin SIM where {accepted} is accepted"), Node(origin=2)
    if accepted != "live":
        s.config("accept_origins 0,2")
        started(s, n)
        s.receive(0, n.heartbeat(origin=1), verdict="origin")
        s.receive(0, n.heartbeat(origin=3), verdict="origin")
        s.expect(0, "state fresh", "cost 0 0 7", "counter origin 2")
        return s
    s.receive(0, n.announce(), n.tile(0, 0), n.heartbeat(), verdict="origin")
    s.expect(0, "state waiting", "cost 0 0 255", "counter origin 3", "counter boots 0")
    return s


def macs():
    s = Scenario("two keys: either will do; no MAC, another key_id, a wrong MAC or key are refused")
    s.config(f"key 1 {KEY_1.hex()}")
    s.config(f"key 513 {KEY_2.hex()}")
    n = Node(key=KEY_1, key_id=1)
    started(s, n)
    s.expect(0, "state fresh", "cost 0 0 7")
    n.key, n.key_id = KEY_2, 513
    s.receive(10, n.tile(0, 0, 2, value=8))
    s.expect(10, "cost 0 0 8")
    s.receive(20, n.tile(0, 0, 3, mac_xor=1), verdict="mac")
    n.key_id = 1
    s.receive(20, n.tile(0, 0, 3), verdict="mac")
    n.key_id = 2
    s.receive(20, n.tile(0, 0, 3), verdict="mac")
    n.key_id = 0
    s.receive(20, n.tile(0, 0, 3), verdict="mac")
    n.key = None
    s.receive(20, n.tile(0, 0, 3), n.bye(), verdict="mac")
    n.key_id = 1
    s.receive(20, n.tile(0, 0, 3), verdict="mac")
    s.expect(20, "cost 0 0 8", "counter mac 7", "state fresh")
    return s


def unasked_mac():
    s, n = Scenario("without a key a datagram with a MAC is refused: nothing can check it"), Node(key=KEY_1, key_id=1)
    s.receive(0, n.announce(), n.heartbeat(), verdict="mac")
    s.expect(0, "state waiting", "counter mac 2")
    return s


def checks():
    s, n = Scenario("every check has its counter; the first that fails counts; no cell changes"), Node()
    started(s, n)
    good = n.heartbeat()
    s.receive(0, b"", good[:63], verdict="too_short")
    s.receive(0, bytes(1201), verdict="too_long")
    s.receive(0, n.heartbeat(magic=b"SCRF", major=2), verdict="magic")
    s.receive(0, n.heartbeat(major=2, total=5), verdict="version")
    s.receive(0, n.heartbeat(total=121), good[:-1], good + b"\0", verdict="total_length")
    s.receive(0, n.heartbeat(header_len=63), n.heartbeat(header_len=121), verdict="header_length")
    s.receive(0, n.heartbeat(crc_xor=1), good[:100] + bytes([good[100] ^ 1]) + good[101:], verdict="crc")
    short_mac = bytearray(n.seal(11, bytes(8)))
    short_mac[7] |= 1
    s.receive(0, bytes(short_mac), verdict="too_short")
    s.receive(0, n.heartbeat(stream_id=2, origin=1), verdict="stream")
    s.receive(0, n.heartbeat(origin=1, boot_id=5), verdict="origin")
    s.receive(0, n.heartbeat(seq=n.seq))
    s.receive(0, n.heartbeat(seq=n.seq), n.seal(99, b"", seq=n.seq), verdict="sequence")
    s.receive(0, n.seal(0, b""), n.seal(6, bytes(40)), n.seal(8, bytes(24)), n.seal(9, bytes(32)), n.seal(12, b""),
              n.seal(13, bytes(88)), n.seal(200, b""), verdict="type")
    s.receive(0, n.tile(layer=11), n.manifest([1], layer=11), verdict="layer")
    s.receive(0, n.seal(2, bytes(32)), n.seal(3, bytes(15)), n.seal(4, bytes(55)), n.seal(4, bytes(57)),
              n.seal(1, bytes(199)), n.seal(5, bytes(95)), n.seal(7, bytes(15)), n.seal(10, bytes(33)),
              n.seal(11, bytes(9)), n.tile(cells=bytes(1023)), n.tile(cells=bytes(1025)), verdict="body_length")
    s.expect(0, "cost 0 0 7", "state fresh", "counter too_short 3", "counter too_long 1", "counter magic 1",
             "counter version 1", "counter total_length 3", "counter header_length 2", "counter crc 2",
             "counter stream 1", "counter origin 1", "counter sequence 2", "counter type 7", "counter layer 2",
             "counter body_length 11", "counter accepted 5", "counter datagrams 42")
    return s


def bad_bodies():
    s, n = Scenario("fields out of bounds or that contradict each other: body_value"), Node()
    started(s, n)

    def tile(offset, fmt, value, **fields):
        body = bytearray(n.tile(rev=9, value=1, **fields)[64:])
        struct.pack_into(fmt, body, offset, value)
        s.receive(0, n.seal(2, bytes(body)), verdict="body_value")

    for offset, fmt, value in ((0, "<i", 2**26), (4, "<i", -2**26 - 1), (13, "<B", 1), (13, "<B", 2), (13, "<B", 5),
                               (14, "<B", 4), (15, "<B", 16), (16, "<B", 16), (18, "<H", 1023), (20, "<f", 0.0),
                               (20, "<f", -1.0), (20, "<f", math.inf), (20, "<f", math.nan), (24, "<f", math.nan)):
        tile(offset, fmt, value)
    for offset, fmt, value in ((13, "<B", 4), (13, "<B", 0), (15, "<B", 8), (16, "<B", 32)):
        tile(offset, fmt, value, layer=1)
    runs = lambda payload, known: struct.pack("<iiIBBBBBBHffI", 0, 0, 9, 0, 4, 5, 0, 32, 0, known, 1.0, 0.0, 0) + payload
    s.receive(0, n.seal(2, runs(bytes([0, 1]) + bytes([255, 1] * 4 + [4, 1]), 1024)),
              n.seal(2, runs(bytes([255, 1] * 4 + [5, 1]), 1024)), n.seal(2, runs(bytes([255, 1] * 5), 1024)),
              n.seal(2, runs(bytes([255, 1] * 4 + [4, 255]), 1024)),
              n.seal(2, runs(bytes([255, 1] * 4 + [4, 1, 1, 1]), 1024)), verdict="body_value")
    s.receive(0, n.seal(2, runs(bytes([255, 1] * 4 + [3, 1]), 1024)), n.seal(2, runs(bytes([255, 1] * 4 + [4]), 1024)),
              n.seal(2, runs(bytes([255, 1] * 4 + [4, 1, 1]), 1024)), verdict="body_length")
    for columns, rows, tx in ((0, 1, 0), (257, 1, 0), (2, 129, 0), (1, 1, 2**26), (2, 1, 2**26 - 1)):
        s.receive(0, n.seal(3, struct.pack("<iiHHBBH", tx, 0, columns, rows, 0, 5, 0) + bytes(4 * min(columns * rows, 9))),
                  verdict="body_value")
    for offset, fmt, value in ((8, "<d", 0.0), (8, "<d", math.nan), (16, "<d", 0.0), (48, "<i", 1), (56, "<i", 3),
                               (72, "<I", 0), (76, "<I", 2**31), (80, "<I", 0), (84, "<I", 299), (92, "<I", 0),
                               (96, "<I", 0), (100, "<B", 4), (101, "<B", 65), (104, "<B", 0), (104, "<B", 7)):
        body = bytearray(n.announce()[64:])
        struct.pack_into(fmt, body, offset, value)
        s.receive(0, n.seal(1, bytes(body)), verdict="body_value")
    s.receive(0, n.seal(4, bytes(48) + bytes([17]) + bytes(7 + 8 * 17)), n.seal(7, bytes(16)), n.seal(5, bytes(96)),
              n.seal(4, bytes(48) + bytes([1]) + bytes(7) + bytes([0, 4]) + bytes(6)), verdict="body_value")
    s.expect(0, "cost 0 0 7", "state fresh", "counter tiles 2", "grid 64 32 0 0 0.5")
    return s


def sequence():
    s, n = Scenario("gaps are lost until a late datagram fills them; older than 1023 behind the newest is too late"), Node()
    s.receive(0, n.heartbeat(seq=100), n.heartbeat(seq=105))
    s.expect(0, "counter lost 4")
    s.receive(0, n.heartbeat(seq=103), n.heartbeat(seq=99))
    s.expect(0, "counter lost 3")
    s.receive(0, n.heartbeat(seq=103), verdict="sequence")
    s.receive(0, n.heartbeat(seq=1128), n.heartbeat(seq=106))
    s.receive(0, n.heartbeat(seq=104), verdict="sequence")
    s.receive(0, n.heartbeat(seq=105), verdict="sequence")
    s.receive(0, n.heartbeat(seq=5000), n.heartbeat(seq=3977))
    s.receive(0, n.heartbeat(seq=3976), verdict="sequence")
    s.receive(0, n.heartbeat(seq=1128), verdict="sequence")
    s.expect(0, "counter lost 4894", "counter sequence 5")
    return s


def reordered():
    s, n = Scenario("late datagrams of one sender take nothing back: windows, health, costs"), Node()
    old_announce, old_tile = n.announce(0, 0), n.tile(1, 0, 1, value=5)
    sick = n.heartbeat(health=0x8000)
    s.receive(0, n.announce(32, 0), n.tile(1, 0, 2, value=6), n.heartbeat(health=4))
    s.receive(10, old_announce, old_tile, sick)
    s.expect(10, "state fresh", "health 4", "grid 64 32 32 0 0.5", "cost 32 0 6", "cost 95 0 255", "counter lost 0")
    return s


def endings():
    s, n = Scenario("FAULT makes the map lost while it lasts; BYE for good, until another sender begins"), Node()
    started(s, n)
    s.receive(100, n.heartbeat(health=0x8001))
    s.expect(100, "state lost", "cost 0 0 255", "health 32769")
    s.receive(200, n.heartbeat(health=1))
    s.expect(200, "state fresh", "cost 0 0 7", "health 1")
    s.receive(250, n.heartbeat(health=0x8000))
    s.receive(1300, n.heartbeat())  # silent for longer than 1 s behind the FAULT: nothing of before may come back
    s.expect(1300, "state fresh", "cost 0 0 255")
    s.receive(1310, n.tile(0, 0, 2), n.bye(3))
    s.expect(1310, "state lost", "cost 0 0 255", "bye 3")
    s.receive(1350, n.heartbeat(), n.tile(0, 0, 3))
    s.expect(1350, "state lost", "cost 0 0 255")
    started(s, Node(0xC), 1400)
    s.expect(1400, "state fresh", "cost 0 0 7", "bye -1")
    return s


def windows():
    s, n = Scenario("a window that moves keeps the tiles it still has; one that is too large is refused and counted"), Node()
    s.config("max_window_tiles 4")
    started(s, n)
    s.receive(10, n.announce(32, 0))
    s.expect(10, "cost 32 0 9", "cost 0 0 255", "grid 64 32 32 0 0.5")
    s.receive(20, n.tile(2, 0, value=11), n.announce(48, -32, 32, 64))
    s.expect(20, "cost 48 0 9", "cost 47 0 255", "cost 64 0 11", "cost 79 0 11", "cost 80 0 255", "cost 48 -32 255")
    s.receive(30, n.announce(0, 0))
    s.expect(30, "cost 0 0 255", "cost 32 0 9", "cost 63 0 9", "cost 64 0 255")
    s.receive(40, n.announce(0, 0, 129, 32))
    s.expect(40, "cost 32 0 255", "grid 0 0 0 0 0", "counter windows_refused 1", "state fresh")
    s.receive(50, n.tile(1, 0, 2), n.manifest([3]))
    s.expect(50, "counter tiles_without_window 1", "counter manifests_without_window 1", "cost 32 0 255")
    s.receive(60, n.announce(0, 0, 128, 32), n.tile(3, 0, 2))
    s.expect(60, "cost 127 0 7", "cost 32 0 255")
    s.receive(70, n.announce(0, 0, 128, 32, map_id=2))
    s.expect(70, "cost 127 0 255")
    s.receive(80, n.tile(3, 0, 2), n.announce(0, 0, 128, 32, map_id=2, res=0.25))
    s.expect(80, "cost 127 0 255", "grid 128 32 0 0 0.25")
    return s


def later_minor():
    s, n = Scenario("of a later minor version, longer headers and bodies are read as far as they are known"), Node()
    more = dict(minor=3, header_len=72, extra=b"8 bytes.")
    s.receive(0, n.announce(**more), n.heartbeat(**more), n.tile(0, 0, **more))
    s.expect(0, "state fresh", "cost 0 0 7")
    s.receive(10, n.seal(4, n.heartbeat()[64:] + b"more", minor=1),
              n.seal(2, n.tile(1, 0, value=12)[64:] + b"more", minor=1),
              n.seal(3, n.manifest([1, 1])[64:] + b"more", minor=1), n.seal(11, bytes(12), minor=1))
    s.expect(10, "bye 0", "state lost", "counter tiles 2")
    return s


def subscription():
    s, n = Scenario("SUBSCRIBE each 250 ms, with the cookie once it is known; NACK 50 ms after a manifest, again each 100 ms"), Node()
    s.config("subscribe")
    s.config("layers 0,1")
    s.config("repeats 2")
    s.config("region 0 0 5 5")
    body = lambda cookie: struct.pack("<QQiiiiIB3x", cookie, 3, 0, 0, 5, 5, 0, 2).hex()
    nack = lambda layer, *tiles: struct.pack("<QBB6x", 77, layer, len(tiles)).hex() + "".join(
        struct.pack("<ii", *tile).hex() for tile in tiles)
    s.expect(0, f"request 6 {body(0)}", "request 0 -")
    n.seq = 9
    s.receive(5, n.cookie(77, seq=0), n.cookie(77, seq=0))  # outside of the stream: not judged by the sequence window
    s.receive(5, n.heartbeat(seq=0), n.heartbeat())
    s.receive(5, n.heartbeat(seq=0), verdict="sequence")
    s.expect(99, "request 9 *", "request 0 -")
    s.expect(100, f"request 6 {body(77)}", "request 0 -")
    s.receive(110, n.announce(-32, 0, 96, 32), n.heartbeat(), n.tile(0, 0), n.tile(1, 0), n.tile(-1, 0))
    s.expect(350, f"request 6 {body(77)}", "request 0 -")
    s.receive(360, n.heartbeat(), n.manifest([5, 5, 1], tx0=-1), n.manifest([4, 4], layer=1))
    s.expect(409, "request 0 -")
    s.expect(410, f"request 8 {nack(0, (0, 0))}", f"request 8 {nack(1, (0, 0), (1, 0))}", "request 0 -")
    s.receive(450, n.tile(0, 0, 4, layer=1), n.tile(0, 0, 4, layer=1, half=1))
    s.expect(509, "request 0 -")
    s.expect(510, f"request 8 {nack(0, (0, 0))}", f"request 8 {nack(1, (1, 0))}", "request 0 -")
    s.receive(520, n.tile(0, 0, 5), n.tile(1, 0, 4, layer=1))
    s.receive(530, n.manifest([5, 2], tx0=0))
    s.expect(579, "request 0 -")
    s.expect(580, f"request 8 {nack(0, (1, 0))}", "request 0 -")
    s.expect(600, f"request 6 {body(77)}", "request 0 -")
    s.expect(610, f"request 8 {nack(1, (1, 0))}", "request 0 -", "counter nacks_sent 6", "counter tiles_nacked 7")
    s.receive(620, n.heartbeat(), n.tile(1, 0, 2), n.tile(1, 0, 4, layer=1, half=1), n.manifest([1], tx0=3),
              n.manifest([9], layer=2))
    s.expect(849, "request 0 -")
    s.expect(850, f"request 6 {body(77)}", "request 0 -")
    s.expect(1099, f"request 9 *", "request 0 -", "counter subscribes_sent 5", "counter pings_sent 2")
    s.receive(1100, n.heartbeat())
    s.expect(1100, f"request 6 {body(77)}", "request 0 -")
    s.receive(1150, n.cookie(78))
    s.expect(1199, "request 0 -")
    s.expect(1200, f"request 6 {body(78)}", "request 0 -")
    s.receive(1210, n.manifest([9]))
    s.expect(2101, f"request 6 {body(78)}", "request 9 *", "request 0 -", "state lost")  # a node that is silent is sent no NACK
    return s


def golden():
    s = Scenario("the golden vectors, one after the other: all of them share boot_id and most of them seq 1")
    for name, verdict in (("heartbeat_mac", "mac"), ("pose_input", "type"), ("announce", "accepted"), ("tile_cost_raw", "sequence"),
                          ("tile_elevation_lower", "accepted"), ("tile_elevation_upper", "accepted")):
        s.golden(0, name, verdict)
    s.lines.insert(1, "config stream_id 7\nconfig accept_origins 0,2")
    return s


def golden_alone(name, *expected, kind="accepted", layers=None, key=None):
    """A golden vector behind an announcement of its window and a heartbeat of the same sender."""
    n = Node(0x0123456789ABCDEF, 7)
    n.seq = 1000
    if key:
        n.key, n.key_id = key[1], key[0]
    s = Scenario(f"golden vector {name}")
    s.config("stream_id 7")
    s.config("accept_origins 0,2")
    if layers:
        s.config(f"layers {layers}")
    if key:
        s.config(f"key {key[0]} {key[1].hex()}")
    s.receive(0, n.announce(-128, 160, 32, 32), n.heartbeat(health=5))
    s.golden(0, name, kind)
    s.expect(0, *expected)
    return s


def golden_tiles():
    at = lambda x, y: f"{x - 128} {y + 160}"
    raw = lambda i: (i * 7 + 3) % 256
    yield "tile_cost_raw", golden_alone("tile_cost_raw", *(
        f"cost {at(i % 32, i // 32)} {raw(i)}" for i in (0, 1, 31, 32, 100, 1023)))
    yield "tile_cost_raw_mac", golden_alone("tile_cost_raw_mac", f"cost {at(5, 0)} 38", key=(1, KEY_1))
    yield "tile_cost_constant", golden_alone("tile_cost_constant", f"cost {at(0, 0)} 255", "counter tiles 1")
    yield "tile_cost_run_length", golden_alone("tile_cost_run_length", f"cost {at(299 % 32, 9)} 255", f"cost {at(12, 9)} 0",
                                               f"cost {at(28, 21)} 254", f"cost {at(29, 21)} 17", f"cost {at(31, 31)} 17")
    elevation = lambda i, row0: (i * 127 + row0 * 1000) % 65535 - 32767
    yield "tile_elevation", golden_alone(
        "tile_elevation_lower", f"value 1 {at(0, 0)} nan", f"value 1 {at(1, 0)} {-3.0 + elevation(1, 0) / 4096}",
        f"value 1 {at(31, 15)} {-3.0 + elevation(511, 0) / 4096}", f"value 1 {at(0, 16)} nan")
    yield "tile_elevation_upper", golden_alone(
        "tile_elevation_upper", f"value 1 {at(1, 16)} {-3.0 + elevation(1, 16) / 4096}", f"value 1 {at(11, 16)} nan",
        f"value 1 {at(31, 31)} {-3.0 + elevation(511, 16) / 4096}")
    yield "tile_elevation_constant", golden_alone("tile_elevation_constant", f"value 1 {at(9, 20)} {-1234 / 4096}")
    yield "tile_dimension", golden_alone("tile_dimension", f"value 2 {at(4, 0)} {2 + 52 / 254}", f"value 2 {at(19, 1)} {2 + 151 / 254}")
    yield "tile_amplitude", golden_alone("tile_amplitude", f"value 8 {at(0, 15)} {100 / 1024}", f"value 8 {at(0, 16)} nan")
    yield "tile_cell_state", golden_alone("tile_cell_state", f"cell_state {at(3, 15)} 4", f"cell_state {at(3, 16)} 3")
    yield "manifest", golden_alone("manifest", "counter accepted 3", "state fresh", "health 5")
    yield "bye", golden_alone("bye", "bye 1", "state lost")
    yield "heartbeat", golden_alone("heartbeat", "state fresh", "health 5")
    yield "heartbeat_minor_1", golden_alone("heartbeat_minor_1", "state fresh")
    yield "heartbeat_mac", golden_alone("heartbeat_mac", key=(1, KEY_1))
    yield "heartbeat_mac_2", golden_alone("heartbeat_mac_2", key=(513, KEY_2))
    yield "announce_no_anchor", golden_alone("announce_no_anchor", "grid 32 32 -128 160 0.5")  # its seq is lower: late
    yield "pose", golden_alone("pose", "counter accepted 3")
    yield "cookie", golden_alone("cookie", "counter accepted 3")
    yield "pong", golden_alone("pong", "counter pongs_unasked 1")
    for name in ("subscribe", "nack", "ping", "pose_input"):
        yield name, golden_alone(name, "state fresh", kind="type")
    yield "subscribe_mac", golden_alone("subscribe_mac", kind="mac")


def blake2b_vectors():
    """Key, data and digest in hex: the example of RFC 7693 appendix A, then hashlib's around every block boundary."""
    rfc = ("ba80a53f981c4d0d6a2797b69f12f6e94c212f14685ac4b74b12bb6fdbffa2d1"
           "7d87c5392aab792dc252d5de4533cc9518d38aa8dbf1925ab92386edd4009923")
    assert hashlib.blake2b(b"abc").hexdigest() == rfc
    yield "# BLAKE2b: key, data, digest; - = empty"
    yield f"- {b'abc'.hex()} {rfc}"
    for size in (0, 1, 63, 64, 65, 127, 128, 129, 255, 256, 257, 1184):
        data = bytes(i * 7 % 251 for i in range(size))
        for key in (b"", b"k", KEY_1, bytes(range(64))):
            for digest in (16, 64):
                out = hashlib.blake2b(data, key=key, digest_size=digest).hexdigest()
                yield f"{key.hex() or '-'} {data.hex() or '-'} {out}"


def write_corpus(folder):
    """Seeds of the fuzz target `client`: per datagram u16 length, u8 milliseconds since the last one, the bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    read = lambda name: bytes.fromhex("".join(
        line for line in (FOLDER.parent / f"{name}.hex").read_text().splitlines() if not line.startswith("#")))
    n = Node(0x0123456789ABCDEF, 7)
    first = [n.announce(-128, 160, 32, 32), n.heartbeat()]
    framed = lambda datagrams: b"".join(struct.pack("<HB", len(data), 20) + data for data in datagrams)
    for file in sorted(FOLDER.parent.glob("*.hex")):
        (folder / file.stem).write_bytes(framed(first + [read(file.stem)]))
    session = ["tile_cost_raw", "tile_cost_run_length", "tile_elevation_lower", "tile_elevation_upper", "manifest", "cookie",
               "pose", "pong", "tile_cell_state", "bye"]
    (folder / "session").write_bytes(framed(first + [read(name) for name in session]))


def main():
    scenarios = {
        "map_appears": map_appears(), "layers": layers(), "silence": silence(), "announced_times": announced_times(),
        "cell_max_age_announced": cell_max_age(0, 500), "cell_max_age_configured": cell_max_age(500, 0),
        "cell_max_age_shorter": cell_max_age(500, 9000), "cell_max_age_shortest": cell_max_age(9000, 500),
        "manifest": manifest(), "manifest_halves": manifest_halves(), "boots": boots(),
        "bad_first_datagram": bad_first_datagram(), "origins_live": origins("live"), "origins_sim": origins("live and sim"),
        "macs": macs(), "unasked_mac": unasked_mac(), "checks": checks(), "bad_bodies": bad_bodies(),
        "sequence": sequence(), "reordered": reordered(), "endings": endings(), "windows": windows(),
        "later_minor": later_minor(), "subscription": subscription(), "golden": golden()}
    scenarios.update((f"golden_{name}", scenario) for name, scenario in golden_tiles())
    (FOLDER.parent / "blake2b.txt").write_text("\n".join(blake2b_vectors()) + "\n")
    FOLDER.mkdir(exist_ok=True)
    write_corpus(FOLDER.parents[2] / "tests/fuzz/corpus/client")
    for name, scenario in scenarios.items():
        (FOLDER / f"{name}.txt").write_text("\n".join(scenario.lines) + "\n")


if __name__ == "__main__":
    main()
