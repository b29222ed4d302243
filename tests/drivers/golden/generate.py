#!/usr/bin/env python3
"""Writes the golden vectors of the frame stream (docs/frame-stream.md), with nothing but the standard library.

It shares no code with the drivers: tests/drivers/frame_stream_golden_test.cpp holds the C++ codec against these bytes in
both directions. Run it only when the format changes; the .hex files are what counts.
"""
import math
import pathlib
import struct
import zlib

HERE = pathlib.Path(__file__).parent
MAGIC = bytes([0x53, 0x43, 0x46, 0xD3])
BOOT = 0x0123456789ABCDEF


def message(kind, payload, *, seq, geometry_id, simulated, minor=0):
    head = MAGIC + struct.pack("<BBBBIIQQIQ", 1, minor, kind, 1 if simulated else 0, len(payload), zlib.crc32(payload),
                               BOOT, seq, geometry_id, 0)
    assert len(head) == 44
    return head + struct.pack("<I", zlib.crc32(head)) + payload


def geometry(kind, word_bytes, shift, rows, columns, trusted, invalid, period_ns, numbers, mounting, noise, limits, name,
             angles=()):
    """numbers: unit, fov h, fov v, per count, offset, fx, fy, cx, cy, depth unit, ambiguity."""
    body = struct.pack("<4B3HHiq", kind, word_bytes, shift, 0, rows, columns, trusted, 0, invalid, period_ns)
    body += struct.pack("<11d", *numbers) + struct.pack("<7d", *mounting) + struct.pack("<4d", *noise)
    body += struct.pack("<2d", *limits) + name.encode().ljust(32, b"\0")
    assert len(body) == 248
    return body + struct.pack(f"<{len(angles)}d", *angles)


def frame(rows, columns, word_bytes, times, poses, variances, words):
    body = struct.pack("<2HBBH6f", rows, columns, word_bytes, 0, len(poses), *variances)
    body += struct.pack(f"<{rows}q", *times)
    for pose in poses:
        body += struct.pack("<q7d", *pose)
    return body + struct.pack(f"<{rows * columns}{'H' if word_bytes == 2 else 'I'}", *words)


def pair(geo, fra, *, seq, simulated):
    ident = zlib.crc32(geo)
    return (message(1, geo, seq=seq, geometry_id=ident, simulated=simulated)
            + message(2, fra, seq=seq, geometry_id=ident, simulated=simulated))


T0 = 1_700_000_000_000_000_000
HALF = math.sqrt(0.5)


def scanner(seq, simulated=True):
    """A CMU scanner of 3 x 4 pixels with reflectance: pixel i has range 300 i + 5, reflectance 4095 - 7 i."""
    geo = geometry(1, 4, 16, 3, 4, 3, 0, 1_000_000, [0.0, 1.0, 0.75, 0.009765625, 0.0, 0, 0, 0, 0, 0, 40.0],
                   [0.25, 0.0, 1.5, 0.5, 0.5, 0.5, 0.5], [0.01, 0.001, 0.0001, 0.0], [0.5, 60.0], "test scanner")
    t = T0 + seq * 500_000_000
    poses = [(t - 1_000_000, 1.0, 2.0, 0.5, 0, 0, 0, 1), (t + 9_000_000, 1.5, 2.0, 0.5, 0, 0, HALF, HALF)]
    words = [(300 * i + 5) | (4095 - 7 * i) << 16 for i in range(12)]
    fra = frame(3, 4, 4, [t, t + 1_000_000, t + 2_000_000], poses, [0.25, 0.25, 0.5, 0.0, 0.0, 0.0625], words)
    return pair(geo, fra, seq=seq, simulated=simulated)


def lidar():
    """Spherical, 2 x 3, counts 10000 i, no poses, from a real device."""
    geo = geometry(2, 2, 0, 2, 3, 2, -1, 0, [0, 0, 0, 0.002, -0.25, 0, 0, 0, 0, 0, 0.0], [0, 0, 1, 0, 0, 0, 1],
                   [0.02, 0, 0, 0.001], [0.9, 120.0], "lidar", [0.1, -0.2, 0.5, 0.0, -0.5])
    fra = frame(2, 3, 2, [T0, T0], [], [0] * 6, [10000 * i for i in range(6)])
    return pair(geo, fra, seq=0xFFFFFFFFFFFFFFFF, simulated=False)


def camera():
    """Pinhole, 2 x 2, one pose at the frame's very time."""
    geo = geometry(3, 2, 0, 2, 2, 2, 0, 0, [0, 0, 0, 0, 0, 80, 81, 0.5, 0.75, 0.001, 0.0], [0, 0, 2, 1, 0, 0, 0],
                   [0.005, 0, 0, 0], [0.3, 10.0], "depth camera")
    fra = frame(2, 2, 2, [T0, T0], [(T0, 7.0, -2.0, 1.25, 0, 0, 0, 1)], [0] * 6, [2000, 0, 65535, 1])
    return pair(geo, fra, seq=7, simulated=True)


def vectors():
    yield "frame_scanner", "GEOMETRY and FRAME 0 of a 3 x 4 CMU scanner with reflectance at bit 16, two poses; simulated", scanner(0)
    yield "frame_lidar", "GEOMETRY and FRAME of a spherical 2 x 3 device without poses; the last sequence number there is", lidar()
    yield "frame_camera", "GEOMETRY and FRAME 7 of a pinhole 2 x 2 device, one pose at the frame's time; simulated", camera()
    yield "drive_command", "Drive command 5: 0.75 m/s, curvature -0.5 / m", drive(BOOT, 5, 0.75, -0.5)


def drive(boot, seq, speed, curvature):
    head = b"SCDR" + struct.pack("<B3xQQff", 1, boot, seq, speed, curvature)
    assert len(head) == 32
    return head + struct.pack("<I", zlib.crc32(head))


def write_corpus(folder):
    """Seeds of the fuzz target `frame_stream`: per record u16 length, u8 what is repaired, the bytes (frame_stream_fuzz.cpp)."""
    folder.mkdir(parents=True, exist_ok=True)

    def split(data):
        while data:
            size = 48 + struct.unpack_from("<I", data, 8)[0]
            yield data[:size]
            data = data[size:]

    def session(data, command):
        return b"".join(struct.pack("<HB", len(m), command) + m for m in split(data))

    for name, _, data in vectors():
        if not name.startswith("frame"):
            continue
        (folder / name).write_bytes(session(data, 0))
    (folder / "drive").write_bytes(session(scanner(0) + scanner(1) + scanner(4), 0))
    (folder / "devices").write_bytes(session(scanner(0) + camera() + lidar() + scanner(1), 0))
    damaged = bytearray(scanner(1))
    damaged[400] ^= 0x10
    (folder / "damaged").write_bytes(session(scanner(0) + bytes(damaged) + scanner(2), 1))
    (folder / "garbage").write_bytes(session(scanner(0), 0) + struct.pack("<HB", 9, 1) + b"SCF\xd3noise" + session(scanner(1), 0))


def write_drive_corpus(folder):
    """Seeds of the fuzz target `drive_command`: datagrams of 36 bytes one after the other."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "drive").write_bytes(drive(1, 1, 0.5, 0.0) + drive(1, 2, 0.5, 1.0) + drive(1, 2, 0.5, 1.0) + drive(2, 1, -1, 0))


if __name__ == "__main__":
    for name, comment, data in vectors():
        lines = [data[i:i + 16].hex(" ") for i in range(0, len(data), 16)]
        (HERE / f"{name}.hex").write_text(f"# {comment}\n" + "\n".join(lines) + "\n")
    write_corpus(HERE.parent.parent / "fuzz/corpus/frame_stream")
    write_drive_corpus(HERE.parent.parent / "fuzz/corpus/drive_command")
