#!/usr/bin/env python3
"""guest_config.py SCENE: the guest's configuration, for the sensor and the place of the recording SCENE, on stdout."""

import pathlib
import sys

DEADLINE_MS = 2000  # of both drivers: silence that lasts longer is one

HEAD = f"""# Two drivers of one device: its bulk frames through libusb, its images through V4L2.
sources:
  - {{name: scanner, kind: usb, deadline_ms: {DEADLINE_MS}}}
  - name: camera
    kind: v4l2
    device: /dev/video0
    format: Z16
    deadline_ms: {DEADLINE_MS}
"""

TAIL = """map: {cell_m: 0.1, size_cells: 64, draws: 2, headings: 2, align_frames: false}
publish: {origin: hil}
"""


def sensor_of(scene):
    """The section `sensor:` of recording.yaml, as lines."""
    lines = (scene / "recording.yaml").read_text().splitlines()
    begin = lines.index("sensor:")
    return [lines[begin]] + [line for line in lines[begin + 1:] if line.startswith(" ")]


def pose_of(scene):
    head, first = (scene / "truth" / "poses.csv").read_text().splitlines()[:2]
    names = [name for name in head.split(",") if name != "t_s"]
    return ", ".join(f"{name}: {value}" for name, value in zip(names, first.split(",")[1:]))


def main():
    scene = pathlib.Path(sys.argv[1])
    print(HEAD + "\n".join("    " + line for line in sensor_of(scene)))
    print(f"pose: {{source: static, T_map_body: {{{pose_of(scene)}}}}}")
    print(TAIL, end="")


if __name__ == "__main__":
    main()
