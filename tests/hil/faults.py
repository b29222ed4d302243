#!/usr/bin/env python3
"""Fault scripts of `scree simulate --faults` as check.py needs them. faults.py --last FILE prints the whole second in
which the last fault is over."""

import dataclasses
import math
import pathlib
import sys


@dataclasses.dataclass
class Fault:
    at_s: float
    action: str
    lasts_s: float  # 0: at once

    @property
    def end_s(self):
        return self.at_s + self.lasts_s


def read(file):
    """The simulator has checked the file before; nothing is checked here."""
    faults = []
    for line in pathlib.Path(file).read_text().splitlines():
        words = line.split("#")[0].split()
        if words:
            lasts = 0.0 if words[1] in ("stall", "babble", "corrupt") else float(words[-1])
            faults.append(Fault(float(words[0]), words[1], lasts))
    return faults


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] != "--last":
        sys.exit("usage: faults.py --last FILE")
    print(math.ceil(max(fault.end_s for fault in read(sys.argv[2]))))
