"""The node's own account of its sources (run.json) against the faults that were injected.

Only what docs/usb-protocol.md, docs/frame-stream.md and docs/devices.md promise of a fault is asked for; drivers may count
more, where one fault leads to another (a camera that was silent is closed, which is a loss).
"""

import json

import guest_config

# A frame that arrives with inverted bytes is refused by one of these checksums.
DAMAGED = ("payload_crc", "header_crc")
# A GEOMETRY that its frame contradicts.
CONTRADICTED = ("bad_frame", "bad_geometry")


def check(run, faults, expect):
    """`expect(condition, text)` is told each judgement."""
    sources = {source["name"]: source for source in json.loads((run / "findings" / "run.json").read_text())["sources"]}
    if not expect(sorted(sources) == ["camera", "scanner"], f"counters: expected scanner and camera, found {list(sources)}"):
        return
    for name, source in sources.items():
        expect(source["frames_mapped"] > 0, f"counters: expected frames of {name} in the map, found none")
        # to be gone, silent or damaged is no failure of a driver, and none may hang
        for key in ("failures", "abandoned"):
            expect(source[key] == 0, f"counters: {name}: expected no {key}, found {source[key]}")
    wanted = expected(faults, json.loads((run / "simulator.json").read_text()))
    for name, least, keys in wanted:
        found = sum(sources[name]["counters"][key] for key in keys)
        expect(found >= least, f"counters: {name}: expected {' + '.join(keys)} of {least} or more, found {found}")
    print("counters: " + ", ".join(f"{name} {' + '.join(keys)} {sum(sources[name]['counters'][key] for key in keys)} of {least}"
                                   for name, least, keys in wanted))


def expected(faults, simulated):
    """Of which source, how many at least, the sum of which counters."""
    def count(action, longer_than_s=-1.0):
        return sum(1 for fault in faults if fault.action == action and fault.lasts_s > longer_than_s)

    silent = count("freeze", 1e-3 * guest_config.DEADLINE_MS)
    # A newer frame takes the place of one that waits, also of a damaged one; which ones did is not told. The newest is
    # always sent, so of each row of damaged frames at least one arrives.
    corrupted, superseded = simulated["faults"]["frames_corrupted"], simulated["frames_superseded"]
    return [("scanner", count("stall"), ("stalls",)),
            ("scanner", count("babble"), ("overflows",)),
            ("scanner", max(count("corrupt"), corrupted - superseded), DAMAGED),
            ("scanner", count("wrong_geometry"), CONTRADICTED),
            ("scanner", silent, ("silences",)),
            ("scanner", count("unplug"), ("departures",)),
            ("camera", count("unplug"), ("losses",)),
            ("camera", silent, ("silences",))]
