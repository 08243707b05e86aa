#!/usr/bin/env python3
"""Writes the scenes of the benchmarks: scenes.py FOLDER [NAME ...]

NAME is one of figure-1-17, figure-2-23, mixed-N, points-N, with any N; without names those of the
README's table. The same names give the same bytes, on every machine: the numbers come from a seeded
generator and are rounded to six decimals.

  figure-1-17   figure 1 (assets/scenes), its camera moved along the view until the surface covers
  figure-2-23   17 % of a picture of 16:9; figure 2 likewise, 23 %
  mixed-N       points, segments, circles by turns, centres uniform in the unit ball, half-lengths
                and radii 0.5 to 1 times s, widths uniform in [w, 2 w], T = 0.5, camera at z = 3.9.
                N = 100: s = 0.3, w = 0.10; N = 1000: s = 0.12, w = 0.04; others as N^(-1/2) from 1000
  points-N      a cubic lattice of spacing h = (4 pi / 3 N)^(1/3), its N points nearest to the
                centre of the unit ball, each moved by up to 0.35 h along every axis, widths 0.75 h
                times 0.85 to 1.1, T = 0.5, camera at z = 3.6
"""

import json
import math
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMES = ["figure-1-17", "figure-2-23", "mixed-100", "mixed-1000", "points-1000", "points-10000",
         "points-100000"]
SEED = 2
# How much nearer or farther the camera stands than in the picture of the gallery.
DISTANCE = {"figure-1-17": ("figure-1", 1.251), "figure-2-23": ("figure-2", 0.957)}


def rounded(values):
    return [round(value, 6) for value in values]


def in_ball(numbers):
    while True:
        p = [numbers.uniform(-1, 1) for _ in range(3)]
        if sum(x * x for x in p) <= 1:
            return p


def direction(numbers):
    while True:
        p = in_ball(numbers)
        length = math.sqrt(sum(x * x for x in p))
        if length > 0.1:
            return [x / length for x in p]


def color(numbers):
    return rounded(numbers.uniform(0.05, 0.95) for _ in range(3))


def camera_at(z):
    return {"position": [0, 0, z], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40}


def figure(name):
    source, factor = DISTANCE[name]
    scene = json.loads((ROOT / "assets" / "scenes" / f"{source}.ivory.json").read_text())
    camera = scene["camera"]
    camera["position"] = rounded(t + factor * (p - t) for p, t in
                                 zip(camera["position"], camera["target"]))
    return scene


def mixed(count):
    s, w = {100: (0.3, 0.10), 1000: (0.12, 0.04)}.get(
        count, (0.12 * math.sqrt(1000 / count), 0.04 * math.sqrt(1000 / count)))
    numbers = random.Random(SEED + count)
    elements = []
    for i in range(count):
        center, axis, half = in_ball(numbers), direction(numbers), s * numbers.uniform(0.5, 1)
        if i % 3 == 0:
            element = {"shape": "point", "position": rounded(center)}
        elif i % 3 == 1:
            element = {"shape": "segment",
                       "a": rounded(c - half * d for c, d in zip(center, axis)),
                       "b": rounded(c + half * d for c, d in zip(center, axis))}
        else:
            element = {"shape": "circle", "center": rounded(center), "normal": rounded(axis),
                       "radius": round(half, 6)}
        element["width"] = round(numbers.uniform(w, 2 * w), 6)
        element["color"] = color(numbers)
        elements.append(element)
    return {"ivory": 1, "threshold": 0.5, "camera": camera_at(3.9), "elements": elements}


def points(count):
    h = (4 * math.pi / (3 * count)) ** (1 / 3)
    numbers = random.Random(SEED + count)
    reach = math.ceil(1.5 / h)
    steps = range(-reach, reach + 1)
    lattice = sorted((i * i + j * j + k * k, i, j, k) for i in steps for j in steps for k in steps
                     if (i * i + j * j + k * k) * h * h < 1.5)
    elements = []
    for _, i, j, k in lattice[:count]:
        elements.append({
            "shape": "point",
            "position": rounded(h * (x + numbers.uniform(-0.35, 0.35)) for x in (i, j, k)),
            "width": round(0.75 * h * numbers.uniform(0.85, 1.1), 6),
            "color": color(numbers)})
    return {"ivory": 1, "threshold": 0.5, "camera": camera_at(3.6), "elements": elements}


def make(name):
    if name in DISTANCE:
        return figure(name)
    kind, _, count = name.partition("-")
    makers = {"mixed": mixed, "points": points}
    if kind not in makers or not count.isdecimal() or int(count) == 0:
        raise SystemExit(f"scenes.py: no scene {name!r}; there are figure-1-17, figure-2-23, "
                         "mixed-N and points-N")
    return makers[kind](int(count))


def text(scene):
    """As the gallery's files are laid out: one element a line."""
    lines = [f'  "{key}": {json.dumps(value)},' for key, value in scene.items()
             if key != "elements"]
    elements = ",\n".join("    " + json.dumps(element) for element in scene["elements"])
    return "{\n" + "\n".join(lines) + '\n  "elements": [\n' + elements + "\n  ]\n}\n"


def write(folder, names=None):
    """Writes the named scenes; their paths by name."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = {}
    for name in names or NAMES:
        paths[name] = folder / f"{name}.ivory.json"
        paths[name].write_text(text(make(name)))
    return paths


def main():
    arguments = sys.argv[1:]
    if not arguments or arguments[0] in ("-h", "--help"):
        print(__doc__.strip())
        raise SystemExit(0 if arguments else 2)
    for path in write(arguments[0], arguments[1:]).values():
        print(path)


if __name__ == "__main__":
    main()
