#!/usr/bin/env python3
"""How calm the picture is while a hand moves: an orbit and a drag, recorded in memory at the pace of a
person (60 steps a second, and a picture wanted within two of them) with software OpenGL, every frame.

motion.csv, one row for each scene, size and motion:
  frames_a_second      while the hand moves
  frame_ms             of a frame, what its own drawing takes: panels, skeleton, the picture to the screen
  resolutions          pixels of the window a side that one of the picture covers, and in how many frames
  full                 share of the frames that show every pixel
  changes              how often the resolution is another than in the frame before
  mixed                frames that show some tiles finer than others while the hand moves: none
  age_ms, age_ms_95    from an input to the end of the frame that shows its picture: median, 95 %
  handle_px            the farthest that a dragged handle is drawn from where its surface has it
  hand_px              and from where the hand has it
  final_ms             from the last input until a frame shows every pixel, of one sample; the last tiles
                       may still be fading in
  others               share of all cores that other processes used meanwhile: with more than a tenth
                       the times are theirs, too"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time

import host
import scenes

GALLERY = ["figure-2", "hand", "molecule"]
SCENES = ["figure-2", "hand", "molecule", "mixed-1000", "points-100000"]
SMALL = ["figure-2", "hand"]
LARGE = "1280x720"
HANDLES = {"point": "position", "segment": "middle", "circle": "center", "disc": "center",
           "polygon": "position", "curve": "position", "polyline": "position"}
STEPS = 90


def path_of(name):
    if name in GALLERY:
        return host.ROOT / "assets" / "scenes" / f"{name}.ivory.json"
    return scenes.write(host.BUILD / "scenes", [name])[name]


def element_of(scene):
    """A visible element with a short way to a handle."""
    counts = {}
    for element in scene["elements"]:
        shape = element["shape"]
        counts[shape] = counts.get(shape, 0) + 1
        if element.get("visible", True):
            return element.get("name", f"{shape} {counts[shape]}"), HANDLES[shape]
    raise SystemExit("motion.py: a scene without elements")


def moves(across, down):
    """There and back again, so that what is seen stays in the picture."""
    turn = [1] * (STEPS // 4) + [-1] * (STEPS // 2) + [1] * (STEPS - STEPS // 4 - STEPS // 2)
    return [{"move": [across * sign, down * sign]} for sign in turn]


def script_of(folder, scene, size, pace):
    """The small window is all picture: panels would leave nothing of it."""
    name, handle = element_of(scene)
    width, height = (int(number) for number in size.split("x"))
    small = [] if size == LARGE else [{"resize": size}, {"key": "tab"}]
    rest = [{"frames": 90}]
    return "\n".join(json.dumps(step) for step in [
        {"select": name}, *small, {"wait": "final"}, {"mouse": [0.3 * width, 0.9 * height]},
        {"pace": pace}, {"frames": 30}, {"state": str(folder / "still.json")},
        {"press": "left"}, *moves(6, 1), {"release": "left"}, *rest, {"wait": "final"},
        {"state": str(folder / "orbit.json")},
        {"pace": 0}, {"grab": {"element": name, "handle": handle}}, {"pace": pace}, {"frames": 30},
        {"state": str(folder / "grabbed.json")},
        *moves(3, 1), {"release": "left"}, *rest, {"wait": "final"},
        {"state": str(folder / "drag.json")}]) + "\n"


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else 0


def row_of(frames):
    asked = [i for i, is_asked in enumerate(frames["asked"]) if is_asked]
    first, last = asked[0], asked[-1]
    moving = range(first, last + 1)
    shown = [frames["resolution"][i] for i in moving]
    fine = [frames["fine"][i] for i in moving]
    ages = [frames["age"][i] for i in moving if frames["age"][i] is not None]
    seconds = (frames["at"][last] - frames["at"][first]) / 1000
    counts = {step: shown.count(step) for step in sorted(set(shown))}
    farthest = lambda key: max([frames[key][i] for i in moving if frames[key][i] is not None],
                               default=0)
    final = next((i for i in range(last, len(frames["at"])) if frames["resolution"][i] == 1
                  and frames["fine"][i] == 1), len(frames["at"]) - 1)
    return {
        "frames_a_second": round((last - first) / seconds, 1),
        "frame_ms": round(statistics.median(frames["drew"][i] for i in moving), 1),
        "resolutions": " ".join(f"{step:g}:{count}" for step, count in counts.items()),
        "full": round(counts.get(1, 0) / len(shown), 3),
        "changes": sum(a != b for a, b in zip(shown, shown[1:])),
        "mixed": sum(0 < share < 1 for share in fine),
        "age_ms": round(statistics.median(ages), 1),
        "age_ms_95": round(percentile(ages, 0.95), 1),
        "handle_px": round(farthest("handle_to_surface"), 2),
        "hand_px": round(farthest("handle_to_hand"), 2),
        "final_ms": round(frames["at"][final] + frames["took"][final] - frames["at"][last], 0),
    }


def used_seconds():
    """Of the processor: by all processes, and by this one's children."""
    numbers = pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]
    user, nice, system = (int(number) for number in numbers[:3])
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ((user + nice + system) / os.sysconf("SC_CLK_TCK"),
            children.ru_utime + children.ru_stime)


def measure(name, size, threads, pace):
    path = path_of(name)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        script = script_of(folder, json.loads(path.read_text()), size, pace)
        (folder / "steps.script").write_text(script)
        start, (all_before, own_before) = time.monotonic(), used_seconds()
        result = subprocess.run(
            [str(host.IVORY), str(path), "--headless", "--size", LARGE, "--threads", str(threads),
             "--script", str(folder / "steps.script")], capture_output=True, text=True, check=False)
        all_after, own_after = used_seconds()
        others = ((all_after - all_before) - (own_after - own_before)) / (
            (time.monotonic() - start) * os.cpu_count())
        if result.returncode != 0:
            host.say(f"{name} left out: {result.stderr.strip()}")
            return []
        rows = []
        for motion in ("orbit", "drag"):
            state = json.loads((folder / f"{motion}.json").read_text())
            row = {"scene": name, "motion": motion, "pace": pace, "window": size,
                   "picture": "{2}x{3}".format(*state["viewport"])} | row_of(state["frames"]) | {
                       "others": round(others, 2)}
            rows.append(row)
            host.say("  ".join(f"{key} {value}" if key not in ("scene", "motion") else value
                               for key, value in row.items()))
        return rows


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run motion", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=",".join(SCENES), help="at 1280x720")
    parser.add_argument("--small", default=",".join(SMALL), help="at 640x360, too")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--pace", type=float, default=60,
                        help="steps a second; with a tenth of 60 a machine of which others leave a "
                             "tenth shows what it would do alone, all times ten times as long")
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()
    rows = []
    for names, size in ((arguments.scenes, LARGE), (arguments.small, "640x360")):
        for name in filter(None, names.split(",")):
            rows += measure(name, size, arguments.threads, arguments.pace)
    facts = host.facts()
    if rows:
        host.write_csv(arguments.output / "motion.csv", [row | facts for row in rows])


if __name__ == "__main__":
    main()
