#!/usr/bin/env python3
"""The Wireshark dissector on the golden vectors: types, fields, CRC, and that damage is told and breaks nothing."""
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

import client_path

DISSECTOR = client_path.ROOT / "client" / "wireshark" / "scree.lua"
TYPES = {"announce": 1, "announce_no_anchor": 1, "manifest": 3, "bye": 11, "cookie": 7, "nack": 8, "nack_full": 8, "ping": 9,
         "pong": 10, "pose": 5, "pose_input": 13, "pose_input_mac": 13}


def write_pcap(path, datagrams):
    """Raw IPv4, one UDP datagram each."""
    with open(path, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101))
        for i, data in enumerate(datagrams):
            udp = struct.pack(">HHHH", 47801, 47800, 8 + len(data), 0) + data
            ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), i, 0, 64, 17, 0, b"\x7f\0\0\1", b"\x7f\0\0\1")
            file.write(struct.pack("<IIII", 1700000000, i, len(ip + udp), len(ip + udp)) + ip + udp)


def tshark(datagrams, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "golden.pcap"
        write_pcap(path, datagrams)
        done = subprocess.run(["tshark", "-X", f"lua_script:{DISSECTOR}", "-r", str(path), *arguments], capture_output=True,
                              text=True, timeout=120, check=False)
    return done


def fields(datagrams, *names):
    """One list of values per datagram."""
    arguments = ["-T", "fields", "-E", "occurrence=a"]
    for name in names:
        arguments += ["-e", name]
    done = tshark(datagrams, *arguments)
    assert done.returncode == 0, done.stderr
    assert "Lua" not in done.stderr, done.stderr
    return [line.split("\t") for line in done.stdout.splitlines()]


@unittest.skipUnless(shutil.which("tshark"), "tshark is not installed here (Debian package tshark)")
class Dissector(unittest.TestCase):
    def test_every_golden_vector_has_its_type_and_a_good_crc(self):
        names = sorted(file.stem for file in client_path.GOLDEN.glob("*.hex"))
        self.assertGreater(len(names), 25)
        found = fields([client_path.golden(name) for name in names], "scree.type", "scree.crc.status", "_ws.expert.message",
                       "scree.flags.mac", "scree.mac")
        self.assertEqual(len(found), len(names))
        for name, (kind, crc, expert, has_mac, mac) in zip(names, found):
            with self.subTest(name):
                expected = TYPES.get(name, 2 if name.startswith("tile") else 6 if name.startswith("sub") else 4)
                self.assertEqual((int(kind), crc, expert), (expected, "1", ""))
                self.assertEqual((int(has_mac), bool(mac)), (1, True) if "_mac" in name else (0, False))

    def test_fields_are_what_the_vectors_say(self):
        expected = {
            "announce": {"resolution_m": "0.1", "frame_name": "map", "node_name": "rover", "columns": "200", "stale_ms": "300",
                         "layer": "0,1,2,8,10", "tx": "-4", "tx_max": "3", "latitude_deg": "49.5", "flags.origin": "2",
                         "boot_id": "0x0123456789abcdef", "t_data_ns": "1700000000123456789", "health": "0x0005",
                         "health.pose_stale": "1", "health.fault": "0", "config_hash": "0xdeadbeef", "stream_id": "7"},
            "tile_cost_run_length": {"layer": "0", "encoding": "4", "known_cells": "724", "tile_rev": "41", "tx": "-4",
                                     "ty": "5", "scale": "1", "block_age_ms": "250"},
            "tile_elevation_upper": {"row0": "16", "rows": "16", "offset": "-3", "seq": "18"},
            "manifest": {"manifest_columns": "3", "manifest_rows": "2", "tile_rev": "40,41,42,43,44,45"},
            "heartbeat": {"uptime_ms": "61234", "latency_p99_us": "15000", "sensor_state": "1,3", "sensor_age_ms": "12,5000",
                          "flags.clock_locked": "1"},
            "heartbeat_minor_1": {"header_len": "72", "surplus": "617070656e646564"},
            "pose": {"pose.x": "1.5", "pose.y": "-2.25", "variance": "0.25,0.25,0.5,0,0,0.0625", "pose_age_us": "1500"},
            "subscribe": {"cookie": "0x1122334455667788", "layer_mask": "0x0000000000000001", "ty_max": "9",
                          "datagrams_per_s": "500", "repeats": "2"},
            "cookie": {"lease_ms": "3000"},
            "nack": {"layer": "1", "tiles": "3", "tx": "-4,-67108864,0", "ty": "5,67108863,0"},
            "pong": {"nonce": "0xfedcba9876543210", "t_answer_ns": "1700000000000300000"},
            "bye": {"reason": "1", "flags.repeat": "1"},
            "pose_input": {"t_ns": "1700000000000000000", "pose.z": "0.125"}}
        for name, values in expected.items():
            with self.subTest(name):
                found = fields([client_path.golden(name)], *(f"scree.{field}" for field in values))
                self.assertEqual(dict(zip(values, found[0])), values)

    def test_damage_is_told_and_breaks_nothing(self):
        vectors = [client_path.golden(file.stem) for file in sorted(client_path.GOLDEN.glob("*.hex"))]
        flipped = [data[:-20] + bytes([data[-20] ^ 1]) + data[-19:] for data in vectors]
        for crc, expert in fields(flipped, "scree.crc.status", "_ws.expert.message"):
            self.assertEqual(crc, "0")
            self.assertIn("CRC-32 is wrong", expert)
        cut = [data[:length] for data in vectors for length in (5, 63, 64, 65, 80, 100, len(data) - 1) if length < len(data)]
        for line, in fields(cut, "_ws.expert.message"):
            self.assertNotEqual(line, "")
        body_cut = []  # whole by their length, too short for their type
        for data in vectors:
            head = bytearray(data[:64])
            head[7] &= 0xFE
            struct.pack_into("<HH", head, 8, 64, 66)
            body_cut.append(bytes(head) + data[64:66])
        for line, in fields(body_cut, "_ws.expert.message"):
            self.assertIn("cut short", line)

    def test_info_column_says_what_it_is(self):
        done = tshark([client_path.golden("tile_elevation_lower"), client_path.golden("announce")])
        self.assertIn("SCREE", done.stdout)
        self.assertIn("LIVE TILE seq 2 ELEVATION (-4, 5) rev 41", done.stdout)
        self.assertIn("SIM ANNOUNCE seq 1 200 x 150 cells", done.stdout)


if __name__ == "__main__":
    unittest.main()
