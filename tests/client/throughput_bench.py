#!/usr/bin/env python3
"""Do the clients keep up? A 400 x 400 map, four layers, 30 % of the tiles changing, at multiples of 10 Hz.

python3 tests/client/throughput_bench.py build/release/tests/tools [--seconds S]

Prints a table: what was sent, lost, and which share of a core the client took; then what the Python client's accept()
takes alone.
"""
import argparse
import json
import pathlib
import subprocess
import time

import client_path  # noqa: F401  (puts the client on the path)
import scree_client as sc

LAYERS = (sc.COST, sc.ELEVATION, sc.CELL_STATE, sc.DIMENSION)


def start_sender(tools, port, rate, seconds):
    return subprocess.Popen([tools / "send_map", "--to", f"127.0.0.1:{port}", "--rate", str(rate), "--duration", str(seconds)],
                            stdout=subprocess.PIPE)


def report(language, rate, wall, busy, sent, datagrams, accepted, overflowed):
    print(f"| {language} | {rate} | {sent / wall:.0f} | {sent} | {sent - datagrams} | {overflowed} | {datagrams - accepted} "
          f"| {100 * busy / wall:.0f} % |", flush=True)


def run_cpp(tools, rate, seconds):
    client = subprocess.Popen([tools / "receive_map"], stdout=subprocess.PIPE)
    sender = start_sender(tools, int(client.stdout.readline()), rate, seconds)
    sent = json.loads(sender.communicate()[0])["sent"]
    got = json.loads(client.communicate()[0])
    report("C++", rate, got["wall_s"], got["cpu_s"], sent, got["datagrams"], got["accepted"], got["overflowed"])


def run_python(tools, rate, seconds):
    client = sc.Client(sc.Config(bind="127.0.0.1:0", layers=LAYERS))
    sender = start_sender(tools, client.port, rate, seconds)
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
        sent = json.loads(sender.communicate()[0])["sent"]
        counters = client.counters
        report("Python", rate, wall, busy, sent, counters["datagrams"], counters["accepted"], counters["overflowed"])


def alone(tools, seconds):
    """accept() on what one run sent, without a socket."""
    client = sc.Client(sc.Config(bind="127.0.0.1:0", layers=LAYERS))
    sender = start_sender(tools, client.port, 10, seconds)
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
    parser.add_argument("tools", type=pathlib.Path, help="folder of send_map and receive_map")
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    print("| client | Hz | datagrams/s | sent | lost | of these in the kernel | not accepted | CPU |\n" + 8 * "|---" + "|")
    for rate in (10, 20, 40):
        run_cpp(options.tools, rate, options.seconds)
        run_python(options.tools, rate, options.seconds)
    alone(options.tools, 2.0)


if __name__ == "__main__":
    main()
