#!/usr/bin/env python3
"""check.py RUN FAULTS: judges what came out of the hardware-in-the-loop test. RUN has the scene, the simulator's report and
log, and findings/ of the guest. Exit code 0 = all is well; else each thing that is not, a line."""

import json
import pathlib
import re
import sys

import check_counters
import check_map
import check_recovery
import faults as fault_script

TERRAIN_CELL_M = 0.02  # of hil.sh
# What Linux says of its own bugs; a warning is none, but is to be read.
KERNEL_BUG = re.compile(r"BUG:|kernel BUG at|\bOops\b|general protection fault")
KERNEL_WARNING = "WARNING: CPU"


class Judge:
    def __init__(self):
        self.failed = 0

    def __call__(self, condition, text):
        if not condition:
            self.failed += 1
            print(f"FAILED {text}")
        return bool(condition)


def check_exits(run, expect):
    log = (run / "findings" / "session.log").read_text()
    for program in ("run", "listen", "client"):
        found = re.search(rf"^{program} exit (\d+)$", log, re.MULTILINE)
        code = int(found.group(1)) if found else None
        expect(code == 0, f"{program} in the guest: expected exit code 0, found {code}")


def check_kernel(run, expect):
    lines = (run / "findings" / "dmesg.log").read_text().splitlines()
    bugs = [line for line in lines if KERNEL_BUG.search(line)]
    expect(not bugs, f"kernel: expected none of its own bugs, found {len(bugs)} in findings/dmesg.log: {bugs[:1]}")
    for line in lines:
        if KERNEL_WARNING in line:
            print(f"kernel: {line}")


def check_injected(run, faults, expect):
    """The simulator did what the script says."""
    report = json.loads((run / "simulator.json").read_text())
    for action in sorted({fault.action for fault in faults}):
        wanted = sum(1 for fault in faults if fault.action == action)
        found = report["faults"][action]
        expect(found == wanted, f"simulator: expected {wanted} x {action}, found {found}")
    rate_hz = report["frames_sent"] / report["duration_s"]
    print(f"simulator: {report['frames_rendered']} frames rendered, {report['frames_sent']} taken by {report['readers']} "
          f"readers in turn, {rate_hz:.1f} a second")


def check_listener(run, expect):
    """What a planner would have: the map, as HIL, without gaps that stayed."""
    heard = json.loads((run / "findings" / "listen.json").read_text())
    expect(heard["rejected"] == 0, f"listener: expected no datagram rejected, found {heard['rejected']}")
    expect(heard["datagrams"] > 0, "listener: expected datagrams, found none")


def main():
    run, faults = pathlib.Path(sys.argv[1]), fault_script.read(sys.argv[2])
    expect = Judge()
    check_exits(run, expect)
    if expect.failed:
        print((run / "findings" / "run.log").read_text()[-2000:])
        return 1
    check_kernel(run, expect)
    check_injected(run, faults, expect)
    check_listener(run, expect)
    check_counters.check(run, faults, expect)
    check_map.check(run, TERRAIN_CELL_M, expect)
    check_recovery.check(run, faults, expect)
    print("hil: all is well" if expect.failed == 0 else f"hil: {expect.failed} things are not as they should be")
    return 0 if expect.failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
