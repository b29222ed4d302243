#!/usr/bin/env python3
"""The Python client for python_port.cpp: commands come in on stdin, answers go out on stdout (all little-endian).

  A now length bytes          accept; no answer
  R now                       advance; answer: count, then (length, bytes) of each request
  S now                       show; answer: state, grid, the layers' cells, counters
  V tx ty columns rows        revisions of cost, elevation, cell_state
"""
import resource
import struct
import sys

import client_path  # noqa: F401  (puts the client on the path)
import scree_client as sc

LAYERS = (sc.COST, sc.ELEVATION, sc.CELL_STATE)


def main():
    subscribe, repeats, key_id, key = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    keys = (sc.Key(key_id, bytes.fromhex(key)),) if key_id else ()
    receiver = sc.Receiver(sc.Config(node="127.0.0.1:1" if subscribe else None, repeats=repeats, layers=LAYERS, keys=keys), 0)
    read, write = sys.stdin.buffer.read, sys.stdout.buffer.write
    while True:
        command = read(1)
        if command == b"A":
            now, length = struct.unpack("<qH", read(10))
            receiver.accept(read(length), now)
            continue
        if command == b"R":
            write(requests(receiver, *struct.unpack("<q", read(8))))
        elif command == b"S":
            write(show(receiver, *struct.unpack("<q", read(8))))
        elif command == b"V":
            tx, ty, columns, rows = struct.unpack("<4i", read(16))
            revs = [receiver.tile_rev(layer, tx + x, ty + y) for layer in LAYERS for y in range(rows) for x in range(columns)]
            write(struct.pack(f"<{len(revs)}I", *revs))
        else:
            return
        sys.stdout.buffer.flush()


def requests(receiver, now):
    receiver.advance(now)
    out = []
    request = receiver.next_request(now)
    while request:
        out.append(struct.pack("<H", len(request)) + request)
        request = receiver.next_request(now)
    return struct.pack("<H", len(out)) + b"".join(out)


def show(receiver, now):
    grid = receiver.grid()
    state = (sc.WAITING, sc.FRESH, sc.STALE, sc.LOST).index(receiver.state(now))
    with open("/proc/self/statm", encoding="ascii") as file:
        resident = int(file.read().split()[1]) * resource.getpagesize()
    head = struct.pack("<BdddiiIIQQQ", state, grid.resolution_m, grid.x_min_m, grid.y_min_m, grid.x_min_cells, grid.y_min_cells,
                       grid.columns, grid.rows, receiver.counters["accepted"], receiver.counters["datagrams"], resident)
    return b"".join((head, receiver.copy_cost(now), receiver.to_occupancy(now).tobytes(),
                     receiver.copy_layer(sc.ELEVATION, now).tobytes(), receiver.copy_layer(sc.CELL_STATE, now).tobytes()))


if __name__ == "__main__":
    main()
