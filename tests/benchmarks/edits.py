#!/usr/bin/env python3
"""From an edit to its picture, kind by kind.

edits.csv: the viewer's render session without a window: until a first picture of the edited scene is
complete, and until the session says that no byte of it will change, at one sample a pixel (after a change
of shape that includes the tenth of a second in which the hand has to rest).

edits_in_window.csv: the viewer itself, without a display, software OpenGL and all, every picture of
every pixel (motion has those that have to be there in time). first: from the input to the first changed
picture (median and greatest of the steps, of which a drag has ten); final:
all frames from the first input, such as a click into a field, until the viewer says that it is final.
Tiles: how many were traced in all these steps together, and how many there are."""

import argparse
import csv
import io
import json
import os
import pathlib
import statistics
import subprocess
import tempfile

import host
import scenes

# Name and steps. Every kind begins with a final picture and the element selected.
KINDS = [
    ("colour", [{"widget": "element.color", "set": [0.9, 0.4, 0.1]}]),
    ("light", [{"widget": "light.0.intensity", "set": 0.3}]),
    ("background", [{"widget": "background", "set": [0.2, 0.2, 0.3]}]),
    ("drag by 5 pixels", [{"drag": {"element": "point 1", "handle": "position", "by": [5, 0]}}]),
    ("drag by 60 pixels", [{"drag": {"element": "point 1", "handle": "position",
                                     "by": [60, -20]}}]),
    ("width", [{"widget": "element.width", "set": 0.12}]),
    ("threshold", [{"widget": "threshold", "set": 0.6}]),
    ("hide", [{"widget": "element.visible"}]),
    ("undo", [{"key": "ctrl+z"}]),
    ("camera", [{"widget": "toolbar.right"}]),
]


def script_of(folder, kinds):
    steps = [{"wait": "final"}, {"select": "point 1"}, {"wait": "final"},
             {"state": str(folder / "start.json")}]
    for number, (_, edit) in enumerate(kinds):
        steps += edit + [{"wait": "final"}, {"state": str(folder / f"{number}.json")}]
    return "\n".join(json.dumps(step) for step in steps) + "\n"


def added(before, after, key):
    """What the later list (of at most 256) has that the earlier one has not."""
    old, new = before["milliseconds"][key], after["milliseconds"][key]
    for start in range(len(old) + 1):
        kept = old[start:]
        if new[:len(kept)] == kept:
            return new[len(kept):]
    return new


def measure(name, path, size):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "steps.script").write_text(script_of(folder, KINDS))
        result = subprocess.run(
            [str(host.IVORY), str(path), "--headless", "--size", size, "--script",
             str(folder / "steps.script")], capture_output=True, text=True, check=False)
        if result.returncode != 0:
            host.say(f"{name} left out: {result.stderr.strip()}")
            return []
        before = json.loads((folder / "start.json").read_text())
        rows = []
        for number, (kind, _) in enumerate(KINDS):
            after = json.loads((folder / f"{number}.json").read_text())
            edits, frames = added(before, after, "edits"), added(before, after, "frames")
            rows.append({
                "scene": name, "edit": kind,
                "width": after["viewport"][2], "height": after["viewport"][3],
                "steps": len(edits),
                "first_ms": round(statistics.median(edits), 3) if edits else "",
                "first_ms_max": round(max(edits), 3) if edits else "",
                "final_ms": round(sum(frames), 3),
                "tiles_traced": after["tiles"]["traced"], "tiles": after["tiles"]["total"]})
            host.say(f"{name}, {kind}: first {rows[-1]['first_ms']} ms, final "
                     f"{rows[-1]['final_ms']} ms, {rows[-1]['tiles_traced']} of "
                     f"{rows[-1]['tiles']} tiles")
            before = after
        return rows


def in_session(name, path, arguments):
    width, height = arguments.picture.split("x")
    text = subprocess.run(
        [str(host.BUILD / "tests" / "benchmarks" / "edit_latency"), str(path), "--name", name,
         "--width", width, "--height", height, "--threads", str(os.cpu_count()), "--repeats",
         arguments.repeats], stdout=subprocess.PIPE, text=True, check=True).stdout
    rows = list(csv.DictReader(io.StringIO(text)))
    for row in rows:
        host.say(f"{name}, {row['edit']}: first {row['first_ms']} ms, final {row['final_ms']} ms, "
                 f"{row['tiles_traced']} tiles")
    return rows


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run edits", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="figure-1-17,mixed-100,points-1000")
    parser.add_argument("--picture", default="1920x1080", help="size without a window")
    parser.add_argument("--repeats", default="7")
    parser.add_argument("--size", default="2500x1150", help="of the window; the panels take some")
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()
    session, window = [], []
    for name in arguments.scenes.split(","):
        path = scenes.write(host.BUILD / "scenes", [name])[name]
        session += in_session(name, path, arguments)
        window += measure(name, path, arguments.size)
    facts = host.facts()
    for file, rows in (("edits.csv", session), ("edits_in_window.csv", window)):
        if rows:
            host.write_csv(arguments.output / file, [row | facts for row in rows])


if __name__ == "__main__":
    main()
