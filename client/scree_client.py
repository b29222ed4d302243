#!/usr/bin/env python3
"""scree_client.py: receives Scree's terrain map over UDP. One file, Python >= 3.9, Linux, standard library only.

SPDX-License-Identifier: MIT. Copyright (c) 2026 The Scree authors. The licence's text stands at the end of this file.

    import scree_client
    client = scree_client.Client(scree_client.Config())  # hears 127.0.0.1:47800, stream 1, LIVE maps only
    while True:
        client.wait(0.02)                # until something arrives
        client.poll()                    # takes what is there; never blocks
        if not client.fresh():
            continue                     # stop the robot here
        print(client.cost(1.0, 2.0))     # 0 free ... 254 lethal, 255 unknown (never drive)

`python3 scree_client.py` prints the state of the map once a second; --help lists its options.

What it promises (docs/protocol.md has every rule, docs/client.md the story): whatever is not known to be current reads
as unknown. Every reading function judges freshness at the time it is called, so a program that stops calling poll()
reads unknown too. A datagram that is not used is counted under one reason. Names and counters are those of
scree_client.hpp. All times are integers, nanoseconds of time.monotonic_ns(), and may be passed in.
"""
import argparse
import array
import dataclasses
import hashlib
import hmac
import ipaddress
import itertools
import logging
import math
import operator
import os
import select
import socket
import struct
import sys
import time
import zlib

__all__ = ["Client", "Config", "Counters", "Grid", "Key", "Receiver"]

COST, ELEVATION, DIMENSION, ELEVATION_SIGMA, CELL_AGE, HITS, SLOPE, STEP, AMPLITUDE, DIMENSION_SIGMA, CELL_STATE = range(11)
LAYERS = 11
NEVER_SEEN, OCCLUDED, POSSIBLE_DROP, RECONSTRUCTED, MEASURED = range(5)
LIVE, REPLAY, SIM, HIL = range(4)
#: waiting: nothing heard yet. fresh: drive. stale: no heartbeat for 300 ms; values stay. lost: every cell is unknown.
WAITING, FRESH, STALE, LOST = "waiting", "fresh", "stale", "lost"
#: Bits of health(); FAULT (do not drive) makes the map lost. Two senders on one stream raise it here.
HEALTH = {1 << 0: "sensor_stale", 1 << 1: "sensor_lost", 1 << 2: "pose_stale", 1 << 3: "overload",
          1 << 4: "calibration_missing", 1 << 5: "clock_stepped", 1 << 6: "reduced_resolution",
          1 << 7: "recording_failed", 1 << 15: "fault"}
FAULT = 1 << 15
COST_LETHAL, COST_UNKNOWN = 254, 255
ANY_STREAM = -1

#: What became of a datagram, in the order of the checks.
VERDICTS = ("accepted", "too_short", "too_long", "magic", "version", "total_length", "header_length", "crc", "mac",
            "stream", "origin", "old_boot", "sequence", "type", "layer", "body_length", "body_value")

_HEADER_BYTES, _MAC_BYTES, _MAX_DATAGRAM_BYTES = 64, 16, 1200
_TILE_AREA = 1024
_TILE_INDEX_LIMIT = 1 << 26
_MAX_WINDOW_TILES = 65 * 65
_MS = 1_000_000
_STALE, _LOST, _BOOT_REORDER, _OUTDATED = 300 * _MS, 1000 * _MS, 1000 * _MS, 500 * _MS
_NACK_AFTER, _NACK_AGAIN = 50 * _MS, 100 * _MS
_SUBSCRIBE_EVERY = 250 * _MS  # twelve in a lease of 3 s: losses do not end it
_PING_EVERY = 1000 * _MS
_COOKIE_ANSWER = 100 * _MS  # bounds what forged cookies can make us send
_ANNOUNCE, _TILE, _MANIFEST, _HEARTBEAT, _POSE, _SUBSCRIBE, _COOKIE, _NACK, _PING, _PONG, _BYE = range(1, 12)

_HEADER = struct.Struct("<4sBBBBHHIQQqIIHHIHHI")
_TILE_HEAD = struct.Struct("<iiIBBBBBBHffI")
_ANNOUNCE_HEAD = struct.Struct("<Qd4d4i2i2I5IBBH32s32s32s")
_MANIFEST_HEAD = struct.Struct("<iiHHBBH")
_HEARTBEAT_HEAD = struct.Struct("<QQQQIIIIB7x")
_POSE_BODY = struct.Struct("<q7d6fI4x")
_BYTE = [bytes([value]) for value in range(256)]
_IS_UNKNOWN = bytes(255) + b"\1"
_ZERO_CRC = bytes(4)
_log = logging.getLogger("scree_client")


def _occupancy(cost):
    if cost == 255:
        return -1
    if cost >= 253:
        return cost - 154
    return 0 if cost == 0 else 1 + 97 * (cost - 1) // 251


#: As costmap_2d publishes: -1 unknown (255), 0 (0), 1 ... 98 (1 ... 252), 99 (253), 100 (254).
OCCUPANCY = tuple(_occupancy(cost) for cost in range(256))
_OCCUPANCY_BYTES = bytes(value & 0xFF for value in OCCUPANCY)


@dataclasses.dataclass(frozen=True)
class Key:
    """A shared secret of 32 bytes; id is 1 ... 65535 and must agree on both sides."""
    id: int
    bytes: bytes


@dataclasses.dataclass
class Config:
    bind: str = "127.0.0.1:47800"  #: one numeric address of this machine; port 0 = any free one
    multicast: str = None  #: IPv4 group to join on the interface of `bind`, at its port
    node: str = None  #: "127.0.0.1:47801": subscribe there, ask for lost tiles, ping
    stream_id: int = 1  #: ANY_STREAM: the first one heard
    accept_origins: tuple = (LIVE,)  #: others are dropped and counted
    #: Layers to hold (and to ask for). Memory and traffic grow with each.
    layers: tuple = (COST, ELEVATION, DIMENSION, CELL_AGE, AMPLITUDE, CELL_STATE)
    max_window_tiles: int = 1024  #: of 32 x 32 cells; a larger window is refused and counted
    cell_max_age_ns: int = 0  #: older blocks read as unknown; 0 = as the node announces
    keys: tuple = ()  #: up to two Key; the first one signs requests
    region: tuple = (-(1 << 26), -(1 << 26), (1 << 26) - 1, (1 << 26) - 1)  #: tx_min, ty_min, tx_max, ty_max
    datagrams_per_s: int = 0  #: at most; 0 = as the node paces
    repeats: int = 1  #: extra copies of each changed block, 0 ... 3


#: The names of Receiver.counters; "accepted" and the other verdicts sum up to "datagrams".
Counters = ("datagrams",) + VERDICTS + (
    "lost",  # gaps in seq that no late datagram filled
    "overflowed",  # dropped by the kernel: receive buffer full, poll() called too rarely
    "boots",  # senders heard, one after the other
    "tiles",  # blocks taken into the map
    "tiles_without_window",  # accepted, but no ANNOUNCE yet, or its window was refused
    "tiles_outside",  # accepted, but outside the window
    "tiles_outdated",  # accepted, but older than what is held
    "tiles_not_held",  # accepted, of a layer that Config leaves out
    "manifests_without_window",  # as tiles_without_window
    "windows_refused",  # announced windows beyond max_window_tiles
    "pongs_unasked",  # with a nonce that is not the last PING's
    "subscribes_sent", "nacks_sent", "tiles_nacked", "pings_sent", "send_errors", "receive_errors")


@dataclasses.dataclass(frozen=True)
class Grid:
    """The cells that the node speaks of. Cell (column, row) covers x in [x_min_m + column * resolution_m, + that)."""
    resolution_m: float = 0.0
    x_min_m: float = 0.0  #: lower left corner of cell (0, 0): the origin of an OccupancyGrid
    y_min_m: float = 0.0
    x_min_cells: int = 0  #: the same corner on the map's lattice
    y_min_cells: int = 0
    columns: int = 0  #: 0 while no window is known
    rows: int = 0


def crc_of_datagram(data, end):
    """zlib's CRC-32 of the first `end` bytes, the CRC's own four taken as zero."""
    return zlib.crc32(data[_HEADER_BYTES:end], zlib.crc32(_ZERO_CRC, zlib.crc32(data[:60])))


class _SequenceWindow:
    """Which datagrams of one sender were seen."""
    WINDOW = 1024

    def __init__(self):
        self._seen = bytearray(self.WINDOW)
        self._first = self._highest = self._received = 0

    def note(self, seq):
        """False: a duplicate, or too old to tell."""
        seen, highest = self._seen, self._highest
        if self._received == 0:
            self._first = self._highest = seq
        elif seq > highest:
            step = seq - highest
            if step >= self.WINDOW:
                seen[:] = bytes(self.WINDOW)
            else:
                for i in range(highest + 1, seq):
                    seen[i % 1024] = 0
            self._highest = seq
        elif highest - seq >= self.WINDOW or seen[seq % 1024]:
            return False
        elif seq < self._first:
            self._first = seq
        seen[seq % 1024] = 1
        self._received += 1
        return True

    @property
    def lost(self):
        return self._highest - self._first + 1 - self._received if self._received else 0


class _Opened:
    """The header's fields that are used after the checks, and the body."""
    __slots__ = ("minor", "type", "origin", "stream_id", "boot_id", "seq", "t_data_ns", "age_us", "map_rev", "health",
                 "cost_profile", "config_hash", "body")

    def body_fits(self, expected):
        """A body of 1.0 ends where its type says; what a later minor version appends is skipped."""
        return len(self.body) == expected if self.minor == 0 else len(self.body) >= expected


_NOTHING_YET = _Opened()
_NOTHING_YET.seq = _NOTHING_YET.t_data_ns = _NOTHING_YET.map_rev = _NOTHING_YET.health = 0
_NOTHING_YET.cost_profile = _NOTHING_YET.config_hash = 0


class _Block:
    __slots__ = ("rev", "age_ms", "scale", "offset", "arrived", "_cells", "_runs")

    def cells(self):
        """1024 raw bytes. Run-length blocks are expanded when first read: most are replaced before."""
        if self._cells is None:
            self._cells = b"".join(map(operator.mul, map(_BYTE.__getitem__, self._runs[1::2]), self._runs[0::2]))
            self._runs = None
        return self._cells


class _LayerTile:
    """One layer of one tile. 16-bit layers have two blocks."""
    __slots__ = ("block", "wanted_rev", "outdated", "wanted_since", "outdated_since", "outdated_rev", "nack_at")

    def __init__(self):
        self.block = [None, None]
        self.wanted_rev = 0  # the newest that a manifest named
        self.outdated = False  # a block is older than that, or missing
        self.wanted_since = 0  # when wanted_rev last grew
        self.outdated_since = 0
        self.outdated_rev = 0  # wanted at outdated_since: only a tile that has it begins to wait anew
        self.nack_at = 0  # not before

    def held_rev(self, layer):
        """The oldest revision among the blocks; a missing one counts as 0."""
        lower = self.block[0].rev if self.block[0] else 0
        if layer != ELEVATION:
            return lower
        return min(lower, self.block[1].rev if self.block[1] else 0)


def _check_runs(data, exact):
    """Pairs (count, value) that give exactly 1024 cells: verdict and how many bytes they take. Nothing may follow if
    `exact`."""
    counts = data[0::2]
    if len(data) % 2 == 0 and sum(counts) == _TILE_AREA and not counts.count(0):
        return "accepted", len(data)
    filled = used = 0
    while (exact or filled < _TILE_AREA) and len(data) - used >= 2:
        run = data[used]
        if run == 0 or run > _TILE_AREA - filled:
            return "body_value", 0
        filled += run
        used += 2
    return ("accepted", used) if filled == _TILE_AREA else ("body_length", 0)


def _known_in_runs(runs):
    return _TILE_AREA - sum(itertools.compress(runs[0::2], runs[1::2].translate(_IS_UNKNOWN)))


def _known_cells(cells, i16):
    if not i16:
        return _TILE_AREA - cells.count(255)
    if not cells[1::2].count(0x80):
        return _TILE_AREA // 2
    return _TILE_AREA // 2 - _shorts(cells).count(-32768)


def _shorts(cells):
    out = array.array("h", cells)
    if sys.byteorder == "big":
        out.byteswap()
    return out


def _decode_tile(opened):
    """Verdict, layer, tx, ty, half, block."""
    body = opened.body
    bad = (None,) * 5
    if len(body) <= 32:
        return ("body_length",) + bad
    tx, ty, rev, layer, encoding, tile_log2, row0, rows, _, known, scale, offset, age_ms = _TILE_HEAD.unpack_from(body)
    if layer >= LAYERS:
        return ("layer",) + bad
    i16 = layer == ELEVATION
    rows_ok = rows == 16 and row0 in (0, 16) if i16 else row0 == 0 and rows == 32
    if tile_log2 != 5 or not rows_ok or not (-_TILE_INDEX_LIMIT <= tx < _TILE_INDEX_LIMIT
                                             and -_TILE_INDEX_LIMIT <= ty < _TILE_INDEX_LIMIT):
        return ("body_value",) + bad
    if not math.isfinite(scale) or not scale > 0.0 or not math.isfinite(offset):
        return ("body_value",) + bad
    used, runs = _TILE_AREA, None
    if encoding == 3:  # constant
        used = 2 if i16 else 1
        if len(body) < 32 + used:
            return ("body_length",) + bad
        cells = body[32:32 + used] * (_TILE_AREA // used)
    elif encoding == 4 and not i16:  # run-length
        verdict, used = _check_runs(body[32:], opened.minor == 0)
        if verdict != "accepted":
            return (verdict,) + bad
        cells, runs = None, body[32:32 + used]
    elif encoding == (1 if i16 else 0):
        cells = body[32:32 + used]
        if len(cells) < used:
            return ("body_length",) + bad
    else:
        return ("body_value",) + bad
    if not opened.body_fits(32 + used):
        return ("body_length",) + bad
    if (_known_cells(cells, i16) if runs is None else _known_in_runs(runs)) != known:
        return ("body_value",) + bad
    block = _Block()
    block.rev, block.age_ms, block.scale, block.offset, block._cells, block._runs = rev, age_ms, scale, offset, cells, runs
    return "accepted", layer, tx, ty, 1 if row0 == 16 else 0, block


def _name(field):
    """The text of 1 ... 31 bytes without control characters before a NUL; None where it is not that."""
    text, nul, _ = field.partition(b"\0")
    if not nul or not text or any(byte < 0x20 or byte == 0x7F for byte in text):
        return None
    return text.decode("utf-8", "replace")


def _window_ok(tx_min, ty_min, tx_max, ty_max, x_min, y_min, columns, rows):
    """Not empty, within i32, and the window of tiles is the one that follows from the cells."""
    if not (0 < columns <= _MAX_WINDOW_TILES * 32 and 0 < rows <= _MAX_WINDOW_TILES * 32):
        return False
    if x_min + columns > 1 << 31 or y_min + rows > 1 << 31:
        return False
    if (tx_min, ty_min) != (x_min >> 5, y_min >> 5):
        return False
    if (tx_max, ty_max) != ((x_min + columns - 1) >> 5, (y_min + rows - 1) >> 5):
        return False
    return (tx_max - tx_min + 1) * (ty_max - ty_min + 1) <= _MAX_WINDOW_TILES


def _decode_announce(opened):
    """Verdict and a dict of the fields as docs/protocol.md names them."""
    body = opened.body
    if len(body) < 200:
        return "body_length", None
    (map_id, resolution, lat, lon, alt, heading, *window, stale, lost, cell_max_age, refresh, heartbeat, tile_log2, layers,
     _, frame, node, version) = _ANNOUNCE_HEAD.unpack_from(body)
    if not math.isfinite(resolution) or not resolution > 0.0:
        return "body_value", None
    anchored = not all(map(math.isnan, (lat, lon, alt, heading)))
    if anchored and not (abs(lat) <= 90.0 and abs(lon) <= 180.0 and math.isfinite(alt) and math.isfinite(heading)):
        return "body_value", None
    if not _window_ok(*window) or stale == 0 or lost < stale or refresh == 0 or heartbeat == 0:
        return "body_value", None
    if tile_log2 != 5 or layers > 64:
        return "body_value", None
    if not opened.body_fits(200 + 12 * layers):
        return "body_length", None
    names = [_name(field) for field in (frame, node, version)]
    entries = [struct.unpack_from("<BBHff", body, 200 + 12 * i) for i in range(layers)]
    good = all(math.isfinite(e[3]) and e[3] > 0.0 and math.isfinite(e[4]) for e in entries)
    if None in names or not good or len({e[0] for e in entries}) != layers:
        return "body_value", None
    return "accepted", {
        "map_id": map_id, "resolution_m": resolution, "latitude_deg": lat, "longitude_deg": lon, "altitude_m": alt,
        "heading_rad": heading, "tx_min": window[0], "ty_min": window[1], "tx_max": window[2], "ty_max": window[3],
        "x_min_cells": window[4], "y_min_cells": window[5], "columns": window[6], "rows": window[7], "stale_ms": stale,
        "lost_ms": lost, "cell_max_age_ms": cell_max_age, "refresh_ms": refresh, "heartbeat_ms": heartbeat,
        "frame_name": names[0], "node_name": names[1], "software_version": names[2], "layers": [e[0] for e in entries]}


def _decode_manifest(opened):
    """Verdict, layer, tx0, ty0, columns, revisions."""
    body = opened.body
    bad = (None,) * 5
    if len(body) < 16:
        return ("body_length",) + bad
    tx0, ty0, columns, rows, layer, tile_log2, _ = _MANIFEST_HEAD.unpack_from(body)
    tiles = columns * rows
    fits = (tx0 >= -_TILE_INDEX_LIMIT and tx0 + columns <= _TILE_INDEX_LIMIT and ty0 >= -_TILE_INDEX_LIMIT
            and ty0 + rows <= _TILE_INDEX_LIMIT)
    if not 1 <= tiles <= 256 or not fits or tile_log2 != 5:
        return ("body_value",) + bad
    if layer >= LAYERS:
        return ("layer",) + bad
    if not opened.body_fits(16 + 4 * tiles):
        return ("body_length",) + bad
    return "accepted", layer, tx0, ty0, columns, struct.unpack_from(f"<{tiles}I", body, 16)


def _decode_heartbeat(opened):
    body = opened.body
    if len(body) < 56:
        return "body_length", None
    values = _HEARTBEAT_HEAD.unpack_from(body)
    sensors = values[8]
    if sensors > 16:
        return "body_value", None
    if not opened.body_fits(56 + 8 * sensors):
        return "body_length", None
    entries = [struct.unpack_from("<BBHI", body, 56 + 8 * i) for i in range(sensors)]
    if any(state > 3 for _, state, _, _ in entries):
        return "body_value", None
    names = ("uptime_ms", "frames_in", "frames_dropped", "rss_bytes", "latency_p50_us", "latency_p99_us",
             "latency_max_us", "tiles_known")
    heartbeat = dict(zip(names, values))
    heartbeat["sensors"] = [{"sensor": s, "state": state, "age_ms": age} for s, state, _, age in entries]
    return "accepted", heartbeat


def _decode_pose(opened):
    if len(opened.body) < 96 or not opened.body_fits(96):
        return "body_length", None
    t_ns, *numbers, age_us = _POSE_BODY.unpack_from(opened.body)
    place, rotation, variances = numbers[:3], numbers[3:7], numbers[7:]
    if abs(t_ns) > 4_000_000_000 * 10**9 or not all(abs(value) <= 1e8 for value in place):
        return "body_value", None
    if not all(map(math.isfinite, rotation)) or not abs(math.hypot(*rotation) - 1.0) <= 1e-3:
        return "body_value", None
    if not all(math.isfinite(value) and value >= 0.0 for value in variances):
        return "body_value", None
    return "accepted", {"t_ns": t_ns, "position_m": tuple(place), "quaternion_xyzw": tuple(rotation),
                        "variances": tuple(variances), "age_ns": age_us * 1000}


def _decode_fixed(opened, size):
    """COOKIE, PONG and BYE have bodies of one size, of which any content will do but a cookie of 0."""
    if len(opened.body) < size or not opened.body_fits(size):
        return "body_length", None
    if opened.type == _COOKIE and not any(opened.body[:8]):
        return "body_value", None
    return "accepted", None


_CHECK_BODY = {_ANNOUNCE: _decode_announce, _TILE: _decode_tile, _MANIFEST: _decode_manifest,
               _HEARTBEAT: _decode_heartbeat, _POSE: _decode_pose, _COOKIE: lambda opened: _decode_fixed(opened, 16),
               _PONG: lambda opened: _decode_fixed(opened, 32), _BYE: lambda opened: _decode_fixed(opened, 8)}


class Receiver:
    """Everything but the socket: datagrams and a clock in; a map, its freshness and requests out. For those who have
    their own transport, and for tests. `now` (ns) must not run backwards."""

    def __init__(self, config, now=None):
        """Raises ValueError for a configuration that cannot be."""
        now = time.monotonic_ns() if now is None else now
        _check(config)
        self.config = config
        self.counters = dict.fromkeys(Counters, 0)
        self._keys = {key.id: bytes(key.bytes) for key in config.keys}
        self._layers = frozenset(config.layers)
        self._origins = frozenset(config.accept_origins)
        self._stream_id = None if config.stream_id == ANY_STREAM else config.stream_id
        self._boot_id = None
        self._sequence = _SequenceWindow()
        self._lost_before = 0
        self._old_boots = []  # of the last eight senders: (boot_id, when it was replaced)
        self._conflict_at = None
        self._link = WAITING
        self._logged = set()
        self.origin = LIVE
        self._forget_sender()
        self._own_boot_id, self._nonce = struct.unpack("<QQ", os.urandom(16))
        self._own_seq = self._cookie = 0
        self._next_subscribe = self._next_ping = now
        self._last_subscribe = now - _SUBSCRIBE_EVERY
        self._ping_at = None
        self._unix_offset = 0
        #: of the node's clock against this one, from the last PONG: (offset, round trip), None before it
        self.clock_offset_ns = None

    # --- taking datagrams ---

    def accept(self, data, now):
        """Takes one datagram (bytes) that arrived at `now`; returns its verdict. One that is not accepted changes nothing
        but a counter, except that one of an earlier sender can raise FAULT."""
        self.advance(now)
        verdict = self._judge(data, now)
        counters = self.counters
        counters["datagrams"] += 1
        counters[verdict] += 1
        counters["lost"] = self._lost_before + self._sequence.lost
        if verdict == "origin":
            self._log_once("a map was refused for its origin (replay, sim or hil); see Config.accept_origins")
        elif verdict == "mac":
            self._log_once("a datagram was refused for its MAC; see Config.keys")
        self._link = self.state(now)
        return verdict

    def _judge(self, data, now):
        opened = _Opened()
        verdict = self._open(data, opened)
        if verdict == "accepted":
            verdict = self._check_sender(opened, now)
        if verdict == "accepted":
            verdict = self._take(opened, now)
        if verdict != "accepted":
            return verdict
        if self._stream_id is None:
            self._stream_id = opened.stream_id
        self.origin = opened.origin
        if opened.seq >= self._newest.seq:
            self._newest = opened
            opened.body = None
            self._acquired = now - opened.age_us * 1000
        return verdict

    def _open(self, data, out):
        """Length, magic, version, total_len, header_len, CRC and MAC, in that order."""
        size = len(data)
        if size < _HEADER_BYTES:
            return "too_short"
        if size > _MAX_DATAGRAM_BYTES:
            return "too_long"
        (magic, major, out.minor, out.type, flags, header, total, out.stream_id, out.boot_id, out.seq, out.t_data_ns,
         out.age_us, out.map_rev, out.health, out.cost_profile, out.config_hash, key_id, _, crc) = _HEADER.unpack_from(data)
        if magic != b"SCRE":
            return "magic"
        if major != 1:
            return "version"
        if total != size:
            return "total_length"
        has_mac = flags & 1
        if has_mac and size < _HEADER_BYTES + _MAC_BYTES:
            return "too_short"
        end = size - _MAC_BYTES if has_mac else size
        if header < _HEADER_BYTES or header > end:
            return "header_length"
        if crc != crc_of_datagram(data, end):
            return "crc"
        if has_mac or self._keys:
            key = self._keys.get(key_id) if has_mac else None
            if key is None:
                return "mac"
            mac = hashlib.blake2b(data[:end], digest_size=_MAC_BYTES, key=key).digest()
            if not hmac.compare_digest(mac, data[end:]):
                return "mac"
        out.origin = flags >> 4 & 3
        out.body = data[header:end]
        return "accepted"

    def _check_sender(self, opened, now):
        if self._stream_id is not None and opened.stream_id != self._stream_id:
            return "stream"
        if opened.origin not in self._origins:
            return "origin"
        if opened.boot_id != self._boot_id:
            for boot_id, replaced in self._old_boots:
                if boot_id != opened.boot_id:
                    continue
                if now - replaced > _BOOT_REORDER:
                    self._conflict_at = now
                    self._log_once("two senders on one stream: the map is refused until one of them is silent")
                return "old_boot"
            # everything is forgotten for a new sender, so its first datagram must be good throughout
            check = _CHECK_BODY.get(opened.type)
            if check is None:
                return "type"
            verdict = check(opened)[0]
            if verdict != "accepted":
                return verdict
            self._begin_boot(opened.boot_id, now)
        if opened.seq == 0 and opened.type in (_COOKIE, _PONG):
            return "accepted"  # outside of any stream: an answer to somebody who has none (yet)
        return "accepted" if self._sequence.note(opened.seq) else "sequence"

    def _begin_boot(self, boot_id, now):
        if self._boot_id is not None:
            self._old_boots = (self._old_boots + [(self._boot_id, now)])[-8:]
            self._link = LOST
        self._lost_before += self._sequence.lost
        self.counters["boots"] += 1
        self._boot_id = boot_id
        self._sequence = _SequenceWindow()
        self._forget_sender()

    def _forget_sender(self):
        self.announce = None  #: the last one of the present sender: a dict, None before it
        self.heartbeat = None  #: likewise
        self._pose = None
        self._window = None  # tx_min, ty_min, tx_max, ty_max
        self._announce_seq = self._heartbeat_seq = self._pose_seq = 0
        self._heartbeat_at = self._pose_at = self._acquired = 0
        self.bye_reason = None  #: 0 end of the recording, 1 stopped, 2 an error, 3 restart; None: no BYE
        self._newest = _NOTHING_YET
        self._forget_tiles()

    def _forget_tiles(self):
        self._tiles = {}  # by (layer, tx, ty)
        self._outdated = {}  # those of them that wait for a newer revision

    def _take(self, opened, now):
        kind = opened.type
        if kind == _TILE:
            return self._take_tile(opened, now)
        if kind == _HEARTBEAT:
            return self._take_heartbeat(opened, now)
        if kind == _MANIFEST:
            return self._take_manifest(opened, now)
        if kind == _ANNOUNCE:
            return self._take_announce(opened)
        if kind == _POSE:
            return self._take_pose(opened, now)
        if kind == _COOKIE:
            return self._take_cookie(opened, now)
        if kind == _PONG:
            return self._take_pong(opened, now)
        if kind == _BYE:
            verdict, _ = _decode_fixed(opened, 8)
            if verdict == "accepted":
                self.bye_reason = opened.body[0]
            return verdict
        return "type"

    def _take_announce(self, opened):
        verdict, announce = _decode_announce(opened)
        if verdict != "accepted" or (self.announce and opened.seq < self._announce_seq):
            return verdict  # a late one tells nothing new
        before = self.announce
        if before and (before["map_id"], before["resolution_m"]) != (announce["map_id"], announce["resolution_m"]):
            self._forget_tiles()
        tx_min, ty_min, tx_max, ty_max = window = tuple(announce[n] for n in ("tx_min", "ty_min", "tx_max", "ty_max"))
        if (tx_max - tx_min + 1) * (ty_max - ty_min + 1) > self.config.max_window_tiles:
            self._window = None
            self._forget_tiles()
            self.counters["windows_refused"] += 1
            self._log_once("the map's window is larger than Config.max_window_tiles: every cell is unknown")
        elif window != self._window:
            self._window = window
            inside = lambda key: tx_min <= key[1] <= tx_max and ty_min <= key[2] <= ty_max
            self._tiles = {key: tile for key, tile in self._tiles.items() if inside(key)}
            self._outdated = {key: tile for key, tile in self._outdated.items() if inside(key)}
        self.announce = announce
        self._announce_seq = opened.seq
        return verdict

    def _take_tile(self, opened, now):
        verdict, layer, tx, ty, half, block = _decode_tile(opened)
        if verdict != "accepted":
            return verdict
        counters, window = self.counters, self._window
        if window is None:
            counters["tiles_without_window"] += 1
        elif layer not in self._layers:
            counters["tiles_not_held"] += 1
        elif not (window[0] <= tx <= window[2] and window[1] <= ty <= window[3]):
            counters["tiles_outside"] += 1
        else:
            self._put((layer, tx, ty), half, block, now)
        return verdict

    def _put(self, key, half, block, now):
        """Keeps the block unless a newer revision is held. An equal one renews its age."""
        tile = self._tiles.get(key)
        if tile is None:
            tile = self._tiles[key] = _LayerTile()
        held = tile.block[half]
        if held is not None and block.rev < held.rev:
            self.counters["tiles_outdated"] += 1
            return
        self.counters["tiles"] += 1
        block.arrived = now
        tile.block[half] = block
        if tile.outdated:
            held_rev = tile.held_rev(key[0])
            tile.outdated = held_rev < tile.wanted_rev
            if held_rev >= tile.outdated_rev:
                tile.outdated_since = tile.wanted_since
                tile.outdated_rev = tile.wanted_rev
            if not tile.outdated:
                self._outdated.pop(key, None)

    def _take_manifest(self, opened, now):
        verdict, layer, tx0, ty0, columns, revisions = _decode_manifest(opened)
        if verdict != "accepted":
            return verdict
        if self._window is None:
            self.counters["manifests_without_window"] += 1
            return verdict
        if layer not in self._layers:
            return verdict
        tx_min, ty_min, tx_max, ty_max = self._window
        # a subscription's region leaves the others out on purpose
        rx_min, ry_min, rx_max, ry_max = self.config.region
        tx_min, ty_min, tx_max, ty_max = max(tx_min, rx_min), max(ty_min, ry_min), min(tx_max, rx_max), min(ty_max, ry_max)
        tiles = self._tiles
        for i, rev in enumerate(revisions):
            tx, ty = tx0 + i % columns, ty0 + i // columns
            if not (tx_min <= tx <= tx_max and ty_min <= ty <= ty_max):
                continue
            key = (layer, tx, ty)
            tile = tiles.get(key)
            if tile is None:
                if rev == 0:
                    continue
                tile = tiles[key] = _LayerTile()
            if rev > tile.wanted_rev:
                self._want(key, tile, rev, now)
        return verdict

    def _want(self, key, tile, rev, now):
        tile.wanted_rev = rev
        tile.wanted_since = now
        if tile.outdated or tile.held_rev(key[0]) >= rev:
            return
        tile.outdated = True
        tile.outdated_since = now
        tile.outdated_rev = rev
        tile.nack_at = max(tile.nack_at, now + _NACK_AFTER)
        self._outdated[key] = tile

    def _take_heartbeat(self, opened, now):
        verdict, heartbeat = _decode_heartbeat(opened)
        if verdict != "accepted":
            return verdict
        self._heartbeat_at = now
        if not self.heartbeat or opened.seq >= self._heartbeat_seq:
            self.heartbeat = heartbeat
            self._heartbeat_seq = opened.seq
        return verdict

    def _take_pose(self, opened, now):
        verdict, pose = _decode_pose(opened)
        if verdict == "accepted" and not (self._pose and opened.seq < self._pose_seq):
            self._pose, self._pose_at, self._pose_seq = pose, now, opened.seq
        return verdict

    def _take_cookie(self, opened, now):
        verdict, _ = _decode_fixed(opened, 16)
        if verdict != "accepted":
            return verdict
        cookie, = struct.unpack_from("<Q", opened.body)
        if cookie != self._cookie:
            self._next_subscribe = min(self._next_subscribe, max(now, self._last_subscribe + _COOKIE_ANSWER))
        self._cookie = cookie
        return verdict

    def _take_pong(self, opened, now):
        verdict, _ = _decode_fixed(opened, 32)
        if verdict != "accepted":
            return verdict
        nonce, _, received, answered = struct.unpack_from("<Qqqq", opened.body)
        if self._ping_at is None or nonce != self._nonce:
            self.counters["pongs_unasked"] += 1
            return verdict
        sent, arrived = self._ping_at + self._unix_offset, now + self._unix_offset
        self._ping_at = None
        self.clock_offset_ns = ((received - sent + answered - arrived) // 2, arrived - sent - (answered - received))
        return verdict

    def _log_once(self, text):
        if text not in self._logged:
            self._logged.add(text)
            _log.warning(text)

    # --- freshness ---

    def _lost_after(self):
        # what the node announces may shorten a limit, never lengthen it
        return min(_LOST, self.announce["lost_ms"] * _MS) if self.announce else _LOST

    def _stale_after(self):
        return min(_STALE, self.announce["stale_ms"] * _MS) if self.announce else _STALE

    def _in_conflict(self, now):
        return self._conflict_at is not None and now - self._conflict_at < _LOST

    def state(self, now=None):
        """WAITING, FRESH, STALE or LOST."""
        now = time.monotonic_ns() if now is None else now
        if self._boot_id is None:
            return WAITING
        if self.bye_reason is not None or self._newest.health & FAULT or self._in_conflict(now):
            return LOST
        if self.heartbeat is None:
            return WAITING if self._link == WAITING else LOST
        silence = now - self._heartbeat_at
        if silence >= self._lost_after():
            return LOST
        return STALE if silence >= self._stale_after() else FRESH

    def fresh(self, now=None):
        return self.state(now) == FRESH

    def health(self, now=None):
        """Bits of HEALTH as the node last said, FAULT also for two senders on the stream."""
        now = time.monotonic_ns() if now is None else now
        return self._newest.health | (FAULT if self._in_conflict(now) else 0)

    def advance(self, now):
        """Applies the rules that depend on time alone."""
        self._link = self.state(now)
        # after a silence the map comes back with the refresh, not before
        if self.heartbeat is not None and self._tiles and now - self._heartbeat_at >= self._lost_after():
            self._forget_tiles()

    def _max_age(self):
        limits = [self.config.cell_max_age_ns, self.announce["cell_max_age_ms"] * _MS if self.announce else 0]
        return min((limit for limit in limits if limit), default=0)

    @staticmethod
    def _readable(tile, block, max_age, now):
        if block is None or (tile.outdated and now - tile.outdated_since > _OUTDATED):
            return False
        return max_age == 0 or block.age_ms * _MS + (now - block.arrived) <= max_age

    # --- reading ---

    def cost(self, x_m, y_m, now=None):
        """0 free, 1 ... 252 worse and worse, 253 the planner's own, 254 lethal, 255 unknown, at a place in metres."""
        return self.cost_of_cell(self._cell(x_m), self._cell(y_m), now)

    def value(self, layer, x_m, y_m, now=None):
        """NaN: unknown. COST gives 0 ... 254. CELL_AGE includes the time since the node sent it; a tile whose ages alone
        grew may be sent a second late, so take it as "at least"."""
        return self.value_of_cell(layer, self._cell(x_m), self._cell(y_m), now)

    def cell_state(self, x_m, y_m, now=None):
        return self.cell_state_of_cell(self._cell(x_m), self._cell(y_m), now)

    def cost_of_cell(self, x_cells, y_cells, now=None):
        found = self._find_cell(COST, x_cells, y_cells, time.monotonic_ns() if now is None else now)
        return found[0] if found else COST_UNKNOWN

    def value_of_cell(self, layer, x_cells, y_cells, now=None):
        now = time.monotonic_ns() if now is None else now
        found = self._find_cell(layer, x_cells, y_cells, now)
        if not found:
            return math.nan
        raw, block = found
        return block.offset + block.scale * raw + self._since(layer, block, now)

    def cell_state_of_cell(self, x_cells, y_cells, now=None):
        found = self._find_cell(CELL_STATE, x_cells, y_cells, time.monotonic_ns() if now is None else now)
        return found[0] if found and found[0] <= MEASURED else NEVER_SEEN

    @staticmethod
    def _since(layer, block, now):
        return (block.age_ms * _MS + now - block.arrived) * 1e-9 if layer == CELL_AGE else 0.0

    def _cell(self, metres):
        if self.announce is None:
            return None
        index = metres / self.announce["resolution_m"]
        return math.floor(index) if math.isfinite(index) else None

    def _valid(self, now):
        return self.state(now) in (FRESH, STALE)

    def _find_cell(self, layer, x, y, now):
        """Raw value and block of a known cell; None otherwise."""
        if self._window is None or x is None or y is None or not self._valid(now):
            return None
        a = self.announce
        column, row = x - a["x_min_cells"], y - a["y_min_cells"]
        if not (0 <= column < a["columns"] and 0 <= row < a["rows"]):
            return None
        tile = self._tiles.get((layer, x >> 5, y >> 5))
        if tile is None:
            return None
        i16 = layer == ELEVATION
        y &= 31
        block = tile.block[1 if i16 and y >= 16 else 0]
        if not self._readable(tile, block, self._max_age(), now):
            return None
        if i16:
            raw, = struct.unpack_from("<h", block.cells(), 2 * ((y & 15) * 32 + (x & 31)))
            return None if raw == -32768 else (raw, block)
        raw = block.cells()[y * 32 + (x & 31)]
        return None if raw == 255 else (raw, block)

    def grid(self):
        """The present window; columns 0 while none is known."""
        if self._window is None:
            return Grid()
        a = self.announce
        res, x, y = a["resolution_m"], a["x_min_cells"], a["y_min_cells"]
        return Grid(res, x * res, y * res, x, y, a["columns"], a["rows"])

    def _rows(self, layer, now):
        """For every readable row of a tile: index of its first cell in the window, cells (raw bytes), block."""
        if self._window is None or not self._valid(now):
            return
        a = self.announce
        x_min, y_min, columns, rows = a["x_min_cells"], a["y_min_cells"], a["columns"], a["rows"]
        tx_min, ty_min, tx_max, ty_max = self._window
        max_age = self._max_age()
        width = 2 if layer == ELEVATION else 1
        halves = 2 if layer == ELEVATION else 1
        for ty in range(ty_min, ty_max + 1):
            for tx in range(tx_min, tx_max + 1):
                tile = self._tiles.get((layer, tx, ty))
                if tile is None:
                    continue
                begin, end = max(tx * 32, x_min), min(tx * 32 + 32, x_min + columns)
                for half in range(halves):
                    block = tile.block[half]
                    if not self._readable(tile, block, max_age, now):
                        continue
                    first = ty * 32 + half * 16
                    cells = block.cells()
                    for y in range(max(first, y_min), min(first + 32 // halves, y_min + rows)):
                        at = (y - first) * 32 - tx * 32
                        yield (y - y_min) * columns + begin - x_min, cells[width * (at + begin):width * (at + end)], block

    def copy_cost(self, now=None):
        """The whole window: a bytearray, rows of growing y, in a row growing x; empty while no window is known. When the
        map is lost all of it is 255."""
        now = time.monotonic_ns() if now is None else now
        grid = self.grid()
        out = bytearray(b"\xff") * (grid.columns * grid.rows)
        for at, cells, _ in self._rows(COST, now):
            out[at:at + len(cells)] = cells
        return out

    def copy_layer(self, layer, now=None):
        """The same for any layer: an array of float, NaN = unknown."""
        now = time.monotonic_ns() if now is None else now
        grid = self.grid()
        out = array.array("f", [math.nan]) * (grid.columns * grid.rows)
        unknown = -32768 if layer == ELEVATION else 255
        for at, cells, block in self._rows(layer, now):
            raws = _shorts(cells) if layer == ELEVATION else cells
            offset, scale = block.offset + self._since(layer, block, now), block.scale
            values = [math.nan if raw == unknown else offset + scale * raw for raw in raws]
            out[at:at + len(values)] = array.array("f", values)
        return out

    def to_occupancy(self, now=None):
        """As the data of nav_msgs/OccupancyGrid (array of int8): see OCCUPANCY; resolution and origin are grid()'s."""
        return array.array("b", self.copy_cost(now).translate(_OCCUPANCY_BYTES))

    def cost_array(self, now=None):
        """copy_cost as a numpy array, rows x columns of uint8."""
        return _numpy().frombuffer(self.copy_cost(now), dtype="uint8").reshape(self.grid().rows, self.grid().columns)

    def layer_array(self, layer, now=None):
        """copy_layer as a numpy array, rows x columns of float32."""
        return _numpy().frombuffer(self.copy_layer(layer, now), dtype="float32").reshape(self.grid().rows,
                                                                                         self.grid().columns)

    def pose(self, now=None):
        """The last one: a dict, None before it. age_ns is since the pose was delivered to the node."""
        if self._pose is None:
            return None
        now = time.monotonic_ns() if now is None else now
        return dict(self._pose, age_ns=self._pose["age_ns"] + now - self._pose_at)

    def data_age_ns(self, now=None):
        """Since the map's newest sample was delivered to the node; None before the first map."""
        if self._newest.t_data_ns == 0:
            return None
        return (time.monotonic_ns() if now is None else now) - self._acquired

    boot_id = property(lambda self: self._boot_id or 0)
    map_rev = property(lambda self: self._newest.map_rev)
    t_data_ns = property(lambda self: self._newest.t_data_ns, doc="Unix time of the newest sample; 0 = no map yet")
    cost_profile = property(lambda self: self._newest.cost_profile)
    config_hash = property(lambda self: self._newest.config_hash)

    def tile_rev(self, layer, tx, ty):
        """The revision held of a layer of a tile; 0 = none or not complete. For tests and displays."""
        tile = self._tiles.get((layer, tx, ty))
        return tile.held_rev(layer) if tile else 0

    # --- requests ---

    def set_unix_offset(self, offset_ns):
        """This machine's Unix time minus time.monotonic_ns(), for PING; Client sets it."""
        self._unix_offset = offset_ns

    def _seal_request(self, kind, body):
        key = self.config.keys[0] if self.config.keys else None
        total = _HEADER_BYTES + len(body) + (_MAC_BYTES if key else 0)
        self._own_seq += 1
        fields = [b"SCRE", 1, 0, kind, 1 if key else 0, _HEADER_BYTES, total, self._stream_id, self._own_boot_id,
                  self._own_seq, 0, 0, 0, 0, 0, 0, key.id if key else 0, 0, 0]
        data = _HEADER.pack(*fields) + body
        fields[-1] = crc_of_datagram(data, len(data))
        data = _HEADER.pack(*fields) + body
        if key:
            data += hashlib.blake2b(data, digest_size=_MAC_BYTES, key=bytes(key.bytes)).digest()
        return data

    def next_request(self, now):
        """The next datagram to be sent to the node, None when there is none now."""
        if self.config.node is None:
            return None
        if now >= self._next_subscribe:
            self._last_subscribe = now
            self._next_subscribe = now + _SUBSCRIBE_EVERY
            self.counters["subscribes_sent"] += 1
            return self._subscribe(sum(1 << layer for layer in self._layers))
        if self._cookie == 0:
            return None
        if self._outdated and self._valid(now):
            nack = self._nack(now)
            if nack:
                return nack
        return self._ping(now) if now >= self._next_ping else None

    def end_request(self):
        """The SUBSCRIBE that ends the subscription; None without one."""
        if self.config.node is None or self._cookie == 0:
            return None
        self.counters["subscribes_sent"] += 1
        return self._subscribe(0)

    def _subscribe(self, layers):
        config = self.config
        return self._seal_request(_SUBSCRIBE, struct.pack("<QQiiiiIB3x", self._cookie, layers, *config.region,
                                                          config.datagrams_per_s, config.repeats))

    def _nack(self, now):
        """Up to 128 tiles of one layer whose time has come."""
        due = [key for key, tile in self._outdated.items() if now >= tile.nack_at]
        if not due:
            return None
        layer = min(key[0] for key in due)
        due = sorted((key for key in due if key[0] == layer), key=lambda key: (key[2], key[1]))[:128]
        for key in due:
            self._outdated[key].nack_at = now + _NACK_AGAIN
        self.counters["nacks_sent"] += 1
        self.counters["tiles_nacked"] += len(due)
        body = struct.pack("<QBB6x", self._cookie, layer, len(due))
        return self._seal_request(_NACK, body + b"".join(struct.pack("<ii", key[1], key[2]) for key in due))

    def _ping(self, now):
        self._next_ping = now + _PING_EVERY
        self._ping_at = now
        self._nonce = (self._nonce * 6364136223846793005 + 1442695040888963407) % 2**64
        self.counters["pings_sent"] += 1
        return self._seal_request(_PING, struct.pack("<QqQQ", self._nonce, now + self._unix_offset, 0, 0))


def _check(config):
    def require(good, what, expected, found):
        if not good:
            raise ValueError(f"{what}: expected {expected}, found {found!r}")

    layers, origins, keys = config.layers, config.accept_origins, config.keys
    require(layers and all(layer in range(LAYERS) for layer in layers), "layers", "numbers of layers, 0 to 10", layers)
    require(origins and all(origin in range(4) for origin in origins), "accept_origins", "LIVE, REPLAY, SIM or HIL", origins)
    require(1 <= config.max_window_tiles <= _MAX_WINDOW_TILES, "max_window_tiles", "1 to 4225", config.max_window_tiles)
    require(ANY_STREAM <= config.stream_id < 2**32, "stream_id", "0 to 4294967295 or ANY_STREAM", config.stream_id)
    require(config.node is None or config.stream_id != ANY_STREAM, "stream_id", "the stream to subscribe to", "ANY_STREAM")
    require(len(keys) <= 2, "keys", "at most two", len(keys))
    require(all(0 < key.id < 2**16 and len(key.bytes) == 32 for key in keys), "keys", "an id of 1 to 65535 and 32 bytes each",
            [(key.id, len(key.bytes)) for key in keys])
    require(len({key.id for key in keys}) == len(keys), "keys", "two different ids", [key.id for key in keys])
    require(0 <= config.repeats <= 3, "repeats", "0 to 3", config.repeats)
    require(config.cell_max_age_ns >= 0, "cell_max_age_ns", "0 or more", config.cell_max_age_ns)
    tx_min, ty_min, tx_max, ty_max = config.region
    limit = _TILE_INDEX_LIMIT
    require(-limit <= tx_min <= tx_max < limit and -limit <= ty_min <= ty_max < limit, "region",
            "tiles from -2^26 to 2^26 - 1, minimum first", config.region)


def _numpy():
    try:
        import numpy
    except ImportError as error:
        raise RuntimeError("numpy is not installed: use copy_cost() or copy_layer()") from error
    return numpy


def _address(text, what):
    """"127.0.0.1:47800" or "[::1]:47800" to (ipaddress, port); names are not looked up."""
    host, _, port = text.rpartition(":")
    try:
        address = ipaddress.ip_address(host.strip("[]"))
        number = int(port) if port.isascii() and port.isdigit() else 65536
    except ValueError:
        number = 65536
    if number > 65535:
        raise ValueError(f"{what}: expected a numeric ADDRESS:PORT, found {text!r}")
    return address, number


_SO_RXQ_OVFL, _SO_TIMESTAMPNS = 40, 35  # of Linux; the socket module does not name them
_TIMESPEC = struct.Struct("@ll")


class Client(Receiver):
    """A Receiver with its socket."""

    def __init__(self, config=None, now=None):
        """Binds and, with config.node, begins to subscribe. Raises ValueError and OSError."""
        config = Config() if config is None else config
        now = time.monotonic_ns() if now is None else now
        super().__init__(config, now)
        self._socket = None
        local, port = _address(config.bind, "bind")
        if local.is_unspecified:
            raise ValueError(f"bind: expected one address of this machine, not all of them, found {config.bind!r}")
        self._node = None
        if config.node is not None:
            if config.multicast is not None:
                raise ValueError(f"node: expected no subscription to a multicast group, found {config.node!r}")
            node, node_port = _address(config.node, "node")
            if node.is_unspecified or node.version != local.version:
                raise ValueError(f"node: expected an address of the same family as bind, found {config.node!r}")
            self._node = (str(node), node_port)
        self._socket = self._open_socket(config, local, port)
        self._drained = self._last_arrival = now
        self._stamped = False  # a datagram had a stamp from before it was read

    def _open_socket(self, config, local, port):
        family = socket.AF_INET if local.version == 4 else socket.AF_INET6
        out = socket.socket(family, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK | socket.SOCK_CLOEXEC)
        try:
            out.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)  # the kernel gives what net.core.rmem_max allows
            out.setsockopt(socket.SOL_SOCKET, _SO_RXQ_OVFL, 1)
            out.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
            if config.multicast is None:
                out.bind((str(local), port))
                return out
            group = ipaddress.ip_address(config.multicast)
            if group.version != 4 or local.version != 4 or not group.is_multicast:
                raise ValueError(f"multicast: expected an IPv4 group, 224.0.0.0 to 239.255.255.255, found {config.multicast!r}")
            # a group may have several listeners on a machine; an address of its own may not
            out.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            out.bind((str(group), port))
            out.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group.packed + local.packed)
            return out
        except (OSError, ValueError):
            out.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Ends the subscription and closes the socket. Readings go on to age."""
        if self._socket is None:
            return
        request = self.end_request()
        if request:
            self._send(request)
        self._socket.close()
        self._socket = None

    def fileno(self):
        """For select, poll or epoll; -1 while closed."""
        return self._socket.fileno() if self._socket else -1

    @property
    def port(self):
        """The one that is bound."""
        return self._socket.getsockname()[1]

    def wait(self, timeout_s):
        """Sleeps until something arrives, at most that long. Not longer than 0.05 when subscribed: NACKs wait."""
        return bool(select.select([self._socket], [], [], timeout_s)[0])

    def poll(self, now=None, at_most=4096):
        """Takes what has arrived (at most that many datagrams), applies the rules of time, sends requests that are due.
        Never blocks. Call it at least every 50 ms. True when something arrived."""
        if self._socket is None:
            return False
        now = time.monotonic_ns() if now is None else now
        unix = time.time_ns()
        self.set_unix_offset(unix - now)
        receive, accept = self._socket.recvmsg, self.accept
        taken = 0
        while taken < at_most:
            try:
                data, items, _, _ = receive(1280, 128)  # more than a datagram may have: longer ones show
            except BlockingIOError:
                self._drained = max(now, self._last_arrival)
                break
            except OSError:
                self.counters["receive_errors"] += 1
                break
            accept(data, self._arrival(items, now, unix))
            taken += 1
        latest = max(now, self._last_arrival)
        self.advance(latest)
        self._send_requests(latest)
        return taken > 0

    def _arrival(self, items, now, unix):
        """When the kernel got it, on this clock: a datagram that waited in the buffer is as old as it is. Where the
        kernel's clock disagrees, not before the buffer was last empty and not after now. The kernel begins to stamp a
        moment after it was told to, and gives what it did not stamp the time of reading: that may be as old as the
        buffer."""
        when = now
        for _, kind, data in items:
            if kind == _SO_TIMESTAMPNS:
                seconds, nanoseconds = _TIMESPEC.unpack(data)
                age = unix - seconds * 1_000_000_000 - nanoseconds
                self._stamped = self._stamped or age > 0
                when = now - age if self._stamped else self._drained
            elif kind == _SO_RXQ_OVFL:
                self.counters["overflowed"], = struct.unpack("@I", data)
        last = self._last_arrival
        when = max(when, self._drained, last)
        self._last_arrival = min(when, max(now, last))
        return self._last_arrival

    def _send_requests(self, now):
        request = self.next_request(now)
        while request:
            self._send(request)
            request = self.next_request(now)

    def _send(self, request):
        try:
            self._socket.sendto(request, self._node)
        except ConnectionRefusedError:
            pass  # the node is not there (yet)
        except OSError:
            self.counters["send_errors"] += 1


def main():
    parser = argparse.ArgumentParser(description="Prints the state of a Scree map once a second.")
    parser.add_argument("--bind", default=Config.bind, help="one numeric address of this machine (%(default)s)")
    parser.add_argument("--node", help="subscribe at this address, e.g. 127.0.0.1:47801 (then use --bind 127.0.0.1:0)")
    parser.add_argument("--multicast", help="IPv4 group to join")
    parser.add_argument("--stream", type=int, default=Config.stream_id, help="stream id (%(default)s)")
    parser.add_argument("--accept", default="live", help="comma-separated origins of live,replay,sim,hil (%(default)s)")
    parser.add_argument("--key", metavar="ID:FILE", help="key id and a file with 64 hexadecimal digits")
    parser.add_argument("--duration", type=float, default=math.inf, metavar="S", help="end after S seconds")
    options = parser.parse_args()
    origins = ("live", "replay", "sim", "hil")
    keys = ()
    try:
        if options.key:
            number, _, path = options.key.partition(":")
            with open(path, encoding="ascii") as file:
                keys = (Key(int(number), bytes.fromhex(file.read())),)
        client = Client(Config(bind=options.bind, node=options.node, multicast=options.multicast, keys=keys,
                               stream_id=options.stream,
                               accept_origins=tuple(origins.index(name) for name in options.accept.split(","))))
    except (OSError, ValueError) as error:
        parser.exit(64, f"scree_client.py: {error}\n")
    end = time.monotonic() + options.duration
    report = time.monotonic()
    with client:
        while time.monotonic() < end:
            client.wait(0.02)
            client.poll()
            if time.monotonic() < report:
                continue
            report += 1.0
            cost = client.copy_cost()
            print(f"{client.state():8} rev {client.map_rev} cells {len(cost)} known {len(cost) - cost.count(255)} "
                  + " ".join(f"{name} {value}" for name, value in client.counters.items() if value), flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass

# Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
# documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
# rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit
# persons to whom the Software is furnished to do so, subject to the following conditions: The above copyright notice and
# this permission notice shall be included in all copies or substantial portions of the Software. THE SOFTWARE IS PROVIDED
# "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF
# MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR COPYRIGHT HOLDERS
# BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
# OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
