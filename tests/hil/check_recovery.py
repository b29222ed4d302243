"""What the node and its client made of each fault.

Times are the guest's since boot. The simulator counts from its first reader; where that lies is told by the kernel, which
logs the unplugging. Both clocks are of one machine, and what lies between the two events is the emulated port.
"""

import dataclasses
import json
import math
import re

AGAIN_S = 2.0  # frames come again by then after a fault (the goal of the project)
BEAT_S = 0.1  # between two heartbeats
# A fault takes that long to arrive: a round of the simulator, the emulated port, the transfers under way.
ARRIVES_S = 0.3
STALE, LOST = 1, 2  # bits of health
FRAME_KB = 300  # 80 x 60 pixels of 64 bytes: counts, range, place, variances
SENSORS = ("scanner", "camera")


@dataclasses.dataclass
class Beat:
    at_s: float
    health: int
    map_rev: int
    data_s: float  # when the map's newest sample came; None = no map yet
    frame_s: list  # of each sensor: when its newest frame came; None = none yet


def read_beats(file):
    beats = []
    for line in file.read_text().splitlines():
        words = line.split()
        at_s, health, map_rev, data_age_ms, sensors = float(words[0]), *(int(words[i]) for i in (2, 6, 7, 8))
        frames = [None] * sensors
        for i in range(sensors):
            _, state, age_ms = (int(word) for word in words[9 + 3 * i:12 + 3 * i])
            frames[i] = None if state == 0 else at_s - 1e-3 * age_ms
        beats.append(Beat(at_s, health, map_rev, None if data_age_ms < 0 else at_s - 1e-3 * data_age_ms, frames))
    return beats


def zero_of_faults(run, faults, expect):
    """The guest's time of the simulator's zero."""
    log = (run / "findings" / "dmesg.log").read_text()
    gone = [float(t) for t in re.findall(r"^\[ *([0-9.]+)\] usb \S+: USB disconnect", log, re.MULTILINE)]
    begun = [float(t) for t in re.findall(r": unplug at ([0-9.]+) s$", (run / "simulator.log").read_text(), re.MULTILINE)]
    planned = [fault.at_s for fault in faults if fault.action == "unplug"]
    if not expect(len(gone) == len(begun) == len(planned) > 0,
                  f"unplugging: expected {len(planned)} times, found {len(begun)} in the simulator, {len(gone)} in the guest"):
        return None
    zeros = [there - here for there, here in zip(gone, begun)]
    expect(max(zeros) - min(zeros) < ARRIVES_S,
           f"unplugging: expected one distance between the clocks, found {zeros}")
    return min(zeros)


def check_map_again(name, over_s, beats, heard_s, expect):
    """The client has another map than while the fault lasted, with what came after it, as soon as a frame that comes
    within AGAIN_S can be mapped and heard of."""
    before = max((beat.map_rev for beat in beats if beat.at_s <= over_s), default=0)
    after = [beat for beat in beats if beat.map_rev > before and beat.data_s is not None and beat.data_s > over_s]
    again_s = after[0].at_s - over_s if after else math.inf
    expect(again_s <= AGAIN_S + heard_s,
           f"{name}: expected a map with later frames within {AGAIN_S + heard_s:.2f} s, found it after {again_s:.2f} s")
    return f"a later map after {again_s:.2f} s"


def check_fault(fault, zero_s, next_s, beats, heard_s, expect):
    """`next_s`: when the next fault begins, by which all is to be well."""
    begin_s, end_s = zero_s + fault.at_s, zero_s + fault.end_s
    over_s = end_s + (0 if fault.lasts_s else BEAT_S)
    name = f"{fault.action} at {fault.at_s:g} s"
    found = []
    for i, sensor in enumerate(SENSORS):
        times = sorted({round(beat.frame_s[i], 3) for beat in beats
                        if i < len(beat.frame_s) and beat.frame_s[i] is not None})
        during = [t for t in times if begin_s + ARRIVES_S < t < end_s]
        if fault.action in ("unplug", "freeze"):
            expect(not during, f"{name}: expected no frame of {sensor} while it lasts, found {len(during)}")
        after = [t for t in times if t >= over_s]
        again_s = after[0] - end_s if after else None
        expect(after and again_s <= AGAIN_S,
               f"{name}: expected frames of {sensor} again within {AGAIN_S} s, found {again_s}")
        found.append(f"{sensor} after {again_s:.2f} s" if after else f"{sensor} never")
    if fault.action in ("unplug", "freeze"):
        seen = 0
        for beat in beats:
            if begin_s < beat.at_s < end_s + BEAT_S:
                seen |= beat.health
        wanted = STALE | (LOST if fault.lasts_s > 2.0 + ARRIVES_S else 0)
        expect(seen & wanted == wanted, f"{name}: expected the client to see health bits {wanted}, found {seen}")
        good = [beat for beat in beats if end_s < beat.at_s < next_s and beat.health & (STALE | LOST) == 0]
        expect(good, f"{name}: expected health to be good again before the next fault, found it never")
    found.append(check_map_again(name, over_s, beats, heard_s, expect))
    print(f"{name}: frames again of {', '.join(found)}")


def check_resources(run, settled_s, later_faults, expect):
    """Open files, threads and memory of the node: the last sample before the second fault, when the map has grown and
    every part has been used once, and the last of all. Memory: not a frame with its points is lost to each fault."""
    rows = [[float(word) for word in line.split()]
            for line in (run / "findings" / "resources.log").read_text().splitlines() if len(line.split()) == 4]
    before = [row for row in rows if row[0] < settled_s]
    if not expect(before and len(rows) > len(before), f"resources: expected samples before and after, found {len(rows)}"):
        return
    stopping = float(re.search(r"^([0-9.]+) stopping$", (run / "findings" / "session.log").read_text(), re.MULTILINE).group(1))
    first, last = before[-1], [row for row in rows if row[0] < stopping][-1]
    for column, name in ((1, "open files"), (2, "threads")):
        expect(first[column] == last[column],
               f"resources: expected {first[column]:.0f} {name} as before the faults, found {last[column]:.0f}")
    grown_kb, limit_kb = last[3] - first[3], later_faults * FRAME_KB
    expect(grown_kb < limit_kb, f"resources: expected less than {limit_kb} kB more memory, found {grown_kb:.0f}")
    print(f"resources: {first[1]:.0f} files, {first[2]:.0f} threads, {first[3] / 1024:.1f} MB before; "
          f"{last[1]:.0f}, {last[2]:.0f}, {last[3] / 1024:.1f} MB after")


def check(run, faults, expect):
    zero_s = zero_of_faults(run, faults, expect)
    beats = read_beats(run / "findings" / "health.log")
    sensors = max((len(beat.frame_s) for beat in beats), default=0)
    if zero_s is None or not expect(sensors == len(SENSORS),
                                    f"client: expected heartbeats of {len(SENSORS)} sensors, found {sensors}"):
        return
    # A frame waits for the mapping of the one before, and is mapped. Not p99: the first frames of a run wait for seconds
    # in an emulated machine, and are more than 1 % of all.
    latency_ms = json.loads((run / "findings" / "run.json").read_text())["latency_ms"]["p50"]
    heard_s = 2e-3 * latency_ms + BEAT_S
    begins_s = [zero_s + fault.at_s for fault in faults]
    for fault, next_s in zip(faults, begins_s[1:] + [math.inf]):
        check_fault(fault, zero_s, next_s, beats, heard_s, expect)
    check_resources(run, zero_s + faults[1].at_s, len(faults) - 1, expect)
