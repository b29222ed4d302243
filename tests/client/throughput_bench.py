#!/usr/bin/env python3
"""Does the Python client keep up? A 400 x 400 map, four layers, 30 % of the tiles changing, at multiples of 10 Hz.

python3 tests/client/throughput_bench.py build/release/tests/tools/send_map [--seconds S]

Prints a table: what was sent, lost, and which share of a core the client took; then what accept() takes alone.
"""
import argparse
import json
import subprocess
import time

import client_path  # noqa: F401  (puts the client on the path)
import scree_client as sc

LAYERS = (sc.COST, sc.ELEVATION, sc.CELL_STATE, sc.DIMENSION)


def run(send_map, rate, seconds):
    client = sc.Client(sc.Config(bind="127.0.0.1:0", layers=LAYERS))
    sender = subprocess.Popen([send_map, "--to", f"127.0.0.1:{client.port}", "--rate", str(rate), "--duration", str(seconds)],
                              stdout=subprocess.PIPE)
    with client:
        client.wait(10)
        wall, busy = time.monotonic(), time.process_time()
        looks = 0
        while client.bye_reason is None:
            ended = sender.poll() is not None
            if not client.wait(0.02) and ended:
                break  # BYE was lost
            client.poll()
            if time.monotonic() - wall > 0.1 * looks:  # as a planner would: the whole map ten times a second
                looks += 1
                client.copy_cost()
        wall, busy = time.monotonic() - wall, time.process_time() - busy
        sent = json.loads(sender.communicate()[0])
        counters = client.counters
        lost = sent["sent"] - counters["datagrams"]
        print(f"| {rate:5.0f} | {sent['sent'] / wall:6.0f} | {sent['sent']} | {lost} | {counters['overflowed']} "
              f"| {counters['datagrams'] - counters['accepted']} | {100 * busy / wall:4.0f} % |", flush=True)
    return lost


def alone(send_map, seconds):
    """accept() on what one run sent, without a socket."""
    client = sc.Client(sc.Config(bind="127.0.0.1:0", layers=LAYERS))
    sender = subprocess.Popen([send_map, "--to", f"127.0.0.1:{client.port}", "--duration", str(seconds)], stdout=subprocess.PIPE)
    datagrams = []
    with client:
        accept = client.accept
        client.accept = lambda data, now: (datagrams.append(data), accept(data, now))
        while client.bye_reason is None:
            client.wait(0.02)
            client.poll()
    sender.communicate()
    best = 0.0
    for _ in range(3):
        receiver = sc.Receiver(sc.Config(layers=LAYERS), 0)
        begin = time.process_time()
        for data in datagrams:
            receiver.accept(data, 0)
        best = max(best, len(datagrams) / (time.process_time() - begin))
    print(f"\naccept() alone: {best:.0f} datagrams/s of CPU time, {len(datagrams)} datagrams, best of three")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("send_map")
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    print("| Hz | datagrams/s | sent | lost | of these in the kernel | not accepted | client's CPU |\n|---|---|---|---|---|---|---|")
    for rate in (10, 20, 40, 80):
        run(options.send_map, rate, options.seconds)
    alone(options.send_map, 2.0)


if __name__ == "__main__":
    main()
