#!/usr/bin/env python3
"""Writes the golden vectors of the map protocol (docs/protocol.md), with nothing but the standard library.

It shares no code with the node: tests/node/protocol_golden_test.cpp holds the C++ codec against these bytes in both
directions. Run it only when the protocol changes; the .hex files are what counts.
"""
import hashlib
import math
import pathlib
import struct
import zlib

HERE = pathlib.Path(__file__).parent
NAN = math.nan


def datagram(kind, body, *, flags=0, origin=0, seq=1, minor=0, extra_header=b"", key=None, key_id=0,
             about_map=(1700000000123456789, 12345, 42, 0x0005, 3, 0xDEADBEEF)):
    header_len = 64 + len(extra_header)
    total = header_len + len(body) + (16 if key else 0)
    head = struct.pack("<4sBBBBHHIQQqIIHHIHH", b"SCRE", 1, minor, kind, flags | origin << 4 | (1 if key else 0),
                       header_len, total, 7, 0x0123456789ABCDEF, seq, *about_map, key_id, 0)
    assert len(head) == 60
    crc = zlib.crc32(head + b"\0\0\0\0" + extra_header + body)
    data = head + struct.pack("<I", crc) + extra_header + body
    if key:
        data += hashlib.blake2b(data, key=key, digest_size=16).digest()
    assert len(data) == total <= 1200
    return data


def request(kind, body, **fields):
    """Of a client: its header tells of no map."""
    return datagram(kind, body, about_map=(0,) * 6, **fields)


def text(value):
    return value.encode().ljust(32, b"\0")


def announce(window=(-4, 1, 3, 5, -100, 33, 200, 150)):
    """Tiles tx_min, ty_min, tx_max, ty_max, then cells x_min, y_min, columns, rows."""
    layers = [(0, 0, 1.0, 0.0), (1, 1, 2.0 ** -12, 0.0), (2, 0, 1 / 254, 2.0), (8, 0, 2.0 ** -14, 0.0), (10, 0, 1.0, 0.0)]
    body = struct.pack("<Qd4d4i2i2I5IBBH", 9, 0.1, 49.5, 11.25, 310.0, 0.5, *window, 300, 1000, 0, 1000, 100, 5, len(layers), 0)
    body += text("map") + text("rover") + text("0.1.0")
    return body + b"".join(struct.pack("<BBHff", a, b, 0, c, d) for a, b, c, d in layers)


def tile(layer, encoding, cells, payload, *, row0=0, rows=32, scale=1.0, offset=0.0, unknown=255):
    known = sum(1 for c in cells if c != unknown)
    return struct.pack("<iiIBBBBBBHffI", -4, 5, 41, layer, encoding, 5, row0, rows, 0, known, scale, offset, 250) + payload


def run_length(cells):
    out, i = b"", 0
    while i < len(cells):
        n = 1
        while i + n < len(cells) and n < 255 and cells[i + n] == cells[i]:
            n += 1
        out += bytes([n, cells[i]])
        i += n
    return out


def elevation(row0):
    return [-32768 if i % 11 == 0 else (i * 127 + row0 * 1000) % 65535 - 32767 for i in range(512)]


def vectors():
    cost = [(i * 7 + 3) % 256 for i in range(1024)]
    runs = [255] * 300 + [0] * 400 + [254] * 1 + [17] * 323
    yield "announce", "ANNOUNCE: 200 x 150 cells, five layers, geo anchor; origin SIM", datagram(1, announce(), origin=2)
    yield "announce_no_anchor", "ANNOUNCE without a geo anchor (four NaN) and without layers", datagram(
        1, struct.pack("<Qd4d4i2i2I5IBBH", 9, 0.05, NAN, NAN, NAN, NAN, 0, 0, 0, 0, 0, 0, 1, 1, 200, 500, 2000, 250, 100,
                       5, 0, 0) + text("odom") + text("n") + text("9"))
    yield "tile_cost_raw", "TILE COST, encoding 0 (u8): cell i = (7 i + 3) mod 256", datagram(
        2, tile(0, 0, cost, bytes(cost)))
    yield "tile_cost_constant", "TILE COST, encoding 3 (constant): all 255 (unknown); a refresh copy", datagram(
        2, tile(0, 3, [255] * 1024, b"\xff"), flags=2)
    yield "tile_cost_run_length", "TILE COST, encoding 4 (run-length): 300 x 255, 400 x 0, 254, 323 x 17", datagram(
        2, tile(0, 4, runs, run_length(runs)))
    for row0, name in ((0, "lower"), (16, "upper")):
        cells = elevation(row0)
        yield f"tile_elevation_{name}", f"TILE ELEVATION, encoding 1 (i16), rows {row0} .. {row0 + 15}", datagram(
            2, tile(1, 1, cells, struct.pack("<512h", *cells), row0=row0, rows=16, scale=2.0 ** -12, offset=-3.0,
                    unknown=-32768), seq=2 + row0)
    yield "tile_elevation_constant", "TILE ELEVATION, encoding 3 (constant i16): all -1234", datagram(
        2, tile(1, 3, [-1234] * 512, struct.pack("<h", -1234), row0=16, rows=16, scale=2.0 ** -12, unknown=-32768))
    yield "tile_dimension", "TILE DIMENSION, encoding 0: cell i = 13 i mod 256, value = 2 + raw / 254", datagram(
        2, tile(2, 0, [i * 13 % 256 for i in range(1024)], bytes(i * 13 % 256 for i in range(1024)), scale=1 / 254,
                offset=2.0))
    yield "tile_amplitude", "TILE AMPLITUDE, encoding 4: 512 x 100, 512 x 255; scale 2^-10", datagram(
        2, tile(8, 4, [100] * 512 + [255] * 512, run_length([100] * 512 + [255] * 512), scale=2.0 ** -10))
    yield "tile_cell_state", "TILE CELL_STATE, encoding 4: rows 0 .. 15 measured, then reconstructed", datagram(
        2, tile(10, 4, [4] * 512 + [3] * 512, run_length([4] * 512 + [3] * 512)))
    yield "manifest", "MANIFEST: layer 1, tiles (-4, 5) .. (-2, 6), tile_rev 40 .. 45", datagram(
        3, struct.pack("<iiHHBBH6I", -4, 5, 3, 2, 1, 5, 0, *range(40, 46)))
    yield "heartbeat", "HEARTBEAT: two sensors; clock locked", datagram(
        4, struct.pack("<QQQQIIIIB7x", 61234, 1200, 3, 50_000_000, 8000, 15000, 22000, 49, 2)
        + struct.pack("<BBHI", 0, 1, 0, 12) + struct.pack("<BBHI", 1, 3, 0, 5000), flags=8)
    yield "heartbeat_minor_1", "HEARTBEAT of a later minor version: header_len 72, eight bytes appended; accepted", datagram(
        4, struct.pack("<QQQQIIIIB7x", 1, 2, 3, 4, 5, 6, 7, 8, 0) + b"appended", minor=1, extra_header=b"extended")
    yield "heartbeat_mac", "HEARTBEAT with keyed BLAKE2b-128, key 00 01 .. 1f, key_id 1; refused without the key", datagram(
        4, struct.pack("<QQQQIIIIB7x", 1, 2, 3, 4, 5, 6, 7, 8, 0), key=bytes(range(32)), key_id=1)
    yield "bye", "BYE: reason 1 (stopped by the operator), a repeat copy", datagram(11, bytes([1]) + bytes(7), flags=4)
    yield "pose_input", "POSE_INPUT: position (1.5, -2.25, 0.125), a quarter turn about z", datagram(
        13, struct.pack("<q3d4d6f", 1700000000000000000, 1.5, -2.25, 0.125, 0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5),
                        0.25, 0.25, 0.5, 0.0, 0.0, 0.0625))
    key_1, key_2 = bytes(range(32)), bytes(range(255, 223, -1))
    yield "heartbeat_mac_2", "The same with key ff fe .. e0, key_id 513 (the second key of a roll-over)", datagram(
        4, struct.pack("<QQQQIIIIB7x", 1, 2, 3, 4, 5, 6, 7, 8, 0), key=key_2, key_id=513)
    yield "tile_cost_raw_mac", "TILE COST, encoding 0, as long as a tile gets, with the MAC of key_id 1", datagram(
        2, tile(0, 0, cost, bytes(cost)), key=key_1, key_id=1)
    yield "pose", "POSE: the same pose as pose_input, 1500 us old", datagram(
        5, struct.pack("<q3d4d6fI4x", 1700000000000000000, 1.5, -2.25, 0.125, 0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5),
                       0.25, 0.25, 0.5, 0.0, 0.0, 0.0625, 1500))
    yield "subscribe_first", "SUBSCRIBE: no cookie yet, layers 0, 1 and 10, everywhere, the node's pacing", request(
        6, struct.pack("<QQiiiiIB3x", 0, 0x403, -2 ** 26, -2 ** 26, 2 ** 26 - 1, 2 ** 26 - 1, 0, 0))
    subscribe = struct.pack("<QQiiiiIB3x", 0x1122334455667788, 0x1, -4, 5, 3, 9, 500, 2)
    yield "subscribe", "SUBSCRIBE: layer 0, tiles (-4, 5) .. (3, 9), 500 datagrams/s, two repeats", request(6, subscribe, seq=2)
    yield "subscribe_mac", "The same with the MAC of key_id 1", request(6, subscribe, seq=2, key=key_1, key_id=1)
    yield "subscribe_end", "SUBSCRIBE: layer mask 0 ends the subscription", request(
        6, struct.pack("<QQiiiiIB3x", 0x1122334455667788, 0, -2 ** 26, -2 ** 26, 2 ** 26 - 1, 2 ** 26 - 1, 0, 0), seq=3)
    yield "cookie", "COOKIE: lease 3000 ms", datagram(7, struct.pack("<QI4x", 0x1122334455667788, 3000))
    yield "nack", "NACK: layer 1, tiles (-4, 5), (-67108864, 67108863), (0, 0)", request(
        8, struct.pack("<QBB6x6i", 0x1122334455667788, 1, 3, -4, 5, -2 ** 26, 2 ** 26 - 1, 0, 0), seq=4)
    yield "nack_full", "NACK: layer 10, the 128 tiles (i, -i)", request(
        8, struct.pack("<QBB6x", 0x1122334455667788, 10, 128) + b"".join(struct.pack("<ii", i, -i) for i in range(128)))
    yield "ping", "PING", request(9, struct.pack("<QqQQ", 0xFEDCBA9876543210, 1700000000000000000, 0, 0), seq=5)
    yield "pong", "PONG", datagram(
        10, struct.pack("<QQqq", 0xFEDCBA9876543210, 1700000000000000000, 1700000000000250000, 1700000000000300000))
    yield "pose_input_mac", "POSE_INPUT of pose_input with the MAC of key_id 1", datagram(
        13, struct.pack("<q3d4d6f", 1700000000000000000, 1.5, -2.25, 0.125, 0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5),
                        0.25, 0.25, 0.5, 0.0, 0.0, 0.0625), key=key_1, key_id=1)


def write_corpus(folder):
    """Seeds of the fuzz target `datagram`: per datagram u16 length, u8 milliseconds since the last one, the bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    by_name = {name: data for name, _, data in vectors()}
    by_name["small"] = datagram(1, announce((-4, 5, -4, 5, -128, 160, 32, 32)))  # one tile: a quick map
    framed = lambda names: b"".join(struct.pack("<HB", len(by_name[n]), 20) + by_name[n] for n in names)
    for name in by_name:
        (folder / name).write_bytes(framed(["small", "heartbeat", name]))
    (folder / "session").write_bytes(framed(["small", "heartbeat", "tile_cost_raw", "tile_elevation_lower",
                                             "tile_elevation_upper", "manifest", "tile_cell_state", "bye"]))


def write_requests(folder):
    """Seeds of the fuzz target `request`: per datagram u8 command, client and time, u16 length, the body."""
    folder.mkdir(parents=True, exist_ok=True)
    bodies = {name: data[64:] for name, _, data in vectors() if data[6] in (6, 8, 9) and not data[7] & 1}
    step = lambda command, name, client=1, time=10: struct.pack("<BBBH", command, client, time, len(bodies[name])) + bodies[name]
    kinds = {"subscribe": 0, "subscribe_first": 0, "subscribe_end": 0, "nack": 1, "nack_full": 1, "ping": 2}
    for name, kind in kinds.items():
        (folder / name).write_bytes(step(0, "subscribe_first") + step(16, "subscribe") + step(16 | kind, name))
    (folder / "leases").write_bytes(b"".join(step(16, "subscribe", client, 40) for client in range(6)) * 5)
    (folder / "spoilt").write_bytes(step(128, "subscribe") + step(129, "nack") + step(3, "ping") + step(24, "subscribe"))


for name, comment, data in vectors():
    lines = [data[i:i + 16].hex(" ") for i in range(0, len(data), 16)]
    (HERE / f"{name}.hex").write_text(f"# {comment}\n" + "\n".join(lines) + "\n")
write_corpus(HERE.parent.parent / "tests/fuzz/corpus/datagram")
write_requests(HERE.parent.parent / "tests/fuzz/corpus/request")
