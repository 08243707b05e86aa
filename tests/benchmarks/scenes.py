#!/usr/bin/env python3
"""Writes the scenes of the benchmarks: scenes.py FOLDER [NAME ...]

NAME is one of figure-1-17, figure-2-23, mixed-N, points-N, mixed-all-N, curves-N, tapers-N, cloud-N, with any N;
without names those of the README's table. The same names give the same bytes, on every machine: the
numbers come from a seeded generator and are rounded to six decimals (vertices of polygons to nine).

  figure-1-17   figure 1 (assets/scenes), its camera moved along the view until the surface covers
  figure-2-23   17 % of a picture of 16:9; figure 2 likewise, 23 %
  mixed-N       points, segments, circles by turns, centres uniform in the unit ball, half-lengths
                and radii 0.5 to 1 times s, widths uniform in [w, 2 w], T = 0.5, camera at z = 3.9.
                N = 100: s = 0.3, w = 0.10; N = 1000: s = 0.12, w = 0.04; others as N^(-1/2) from 1000
  points-N      a cubic lattice of spacing h = (4 pi / 3 N)^(1/3), its N points nearest to the
                centre of the unit ball, each moved by up to 0.35 h along every axis, widths 0.75 h
                times 0.85 to 1.1, T = 0.5, camera at z = 3.6
  mixed-all-N   all seven shapes by turns, with the rule for mixed-N: discs' radii are like those of
                circles, see `polygon`, `cubic` and `chain` for the others
  curves-N      cubics only, with the rule for mixed-N
  tapers-N      segments whose widths taper: a tree that forks at the end of every segment, see
                `tapers`; 10,000 of them cover 30 % of a picture of 16:9
  cloud-N       3,000 points uniform in the unit ball, all of width N / 100, T half of the field at the
                centre, camera at z = 4
"""

import json
import math
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMES = ["figure-1-17", "figure-2-23", "mixed-100", "mixed-1000", "points-1000", "points-10000",
         "points-100000", "mixed-all-100", "mixed-all-1000", "curves-1000", "tapers-10000",
         "cloud-20", "cloud-100"]
SEED = 2
WIDE = 0.16  # of tapers-N: the trunk's width, 0.6 being its length
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


def total(values):
    """From left to right; `sum` rounds otherwise from Python 3.12 on."""
    result = 0.0
    for value in values:
        result += value
    return result


def unit(p):
    length = math.sqrt(total(x * x for x in p))
    return [x / length for x in p]


def along(p, direction_, distance):
    return [x + distance * d for x, d in zip(p, direction_)]


def ends(center, axis, half):
    return along(center, axis, -half), along(center, axis, half)


def across(axis):
    """Two directions that are square to the axis and to one another."""
    least = min(range(3), key=lambda i: abs(axis[i]))
    u = unit([(i == least) - axis[least] * axis[i] for i in range(3)])
    return u, [axis[i - 2] * u[i - 1] - axis[i - 1] * u[i - 2] for i in range(3)]


# What each shape is made of: a centre, a direction and half its length; numbers for the rest.

def point(center, _axis, _half, _numbers):
    return {"shape": "point", "position": rounded(center)}


def segment(center, axis, half, _numbers):
    a, b = ends(center, axis, half)
    return {"shape": "segment", "a": rounded(a), "b": rounded(b)}


def circle(center, axis, half, _numbers):
    return {"shape": "circle", "center": rounded(center), "normal": rounded(axis),
            "radius": round(half, 6)}


def disc(center, axis, half, numbers):
    return circle(center, axis, half, numbers) | {"shape": "disc"}


def polygon(center, axis, half, numbers):
    """3 to 8 vertices around the centre, on the circle of that radius and square to the axis, each
    moved along it by up to 0.3 of their distance; of half of those with 5 or more vertices every
    other one is drawn in, to 0.3 to 0.8 times where the polygon would stop being convex.

    The plane's origin, its two directions (times the radius) and the vertices' coordinates are whole
    numbers of millionths and thousandths, so that the vertices lie in it exactly, in nine decimals."""
    count = numbers.randint(3, 8)
    dented = numbers.random() < 0.5 and count >= 5
    origin = [round(1e6 * x) for x in center]
    u, v = ([round(1e6 * half * x) for x in d] for d in across(axis))
    vertices = []
    for k in range(count):
        angle = 2 * math.pi * (k + numbers.uniform(-0.3, 0.3)) / count
        reach = 1
        if dented and k % 2:
            reach = math.cos(2 * math.pi / count) * numbers.uniform(0.3, 0.8)
        x, y = round(1e3 * reach * math.cos(angle)), round(1e3 * reach * math.sin(angle))
        vertices.append([(1000 * o + x * a + y * b) / 1e9 for o, a, b in zip(origin, u, v)])
    return {"shape": "polygon", "vertices": vertices}


def cubic(center, axis, half, numbers):
    """Between the ends of the segment; its other control points, evenly along that, are moved by up
    to 0.6 of half its length."""
    a, b = ends(center, axis, half)
    inner = [along([x + (y - x) * k / 3 for x, y in zip(a, b)], in_ball(numbers), 0.6 * half)
             for k in (1, 2)]
    return {"shape": "curve", "control_points": [rounded(p) for p in (a, *inner, b)]}


def chain(center, axis, half, numbers):
    """8 points, evenly along the segment; those between its ends are moved by up to 0.3 of half its
    length."""
    a, b = ends(center, axis, half)
    inner = [along([x + (y - x) * k / 7 for x, y in zip(a, b)], in_ball(numbers), 0.3 * half)
             for k in range(1, 7)]
    return {"shape": "polyline", "points": [rounded(p) for p in (a, *inner, b)]}


def by_turns(makers, count):
    """Elements in the unit ball: of each a centre, a direction and a length; the fewer the larger."""
    s, w = {100: (0.3, 0.10), 1000: (0.12, 0.04)}.get(
        count, (0.12 * math.sqrt(1000 / count), 0.04 * math.sqrt(1000 / count)))
    numbers = random.Random(SEED + count)
    elements = []
    for i in range(count):
        center, axis, half = in_ball(numbers), direction(numbers), s * numbers.uniform(0.5, 1)
        element = makers[i % len(makers)](center, axis, half, numbers)
        element["width"] = round(numbers.uniform(w, 2 * w), 6)
        element["color"] = color(numbers)
        elements.append(element)
    return {"ivory": 1, "threshold": 0.5, "camera": camera_at(3.9), "elements": elements}


def mixed(count):
    return by_turns([point, segment, circle], count)


def mixed_all(count):
    return by_turns([point, segment, circle, disc, polygon, cubic, chain], count)


def curves(count):
    return by_turns([cubic], count)


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


def tapers(count):
    """Every segment begins at the end of the one that it grows from, as wide as that ends, and has
    two that go on from it, to opposite sides; they are in the order in which they came to be."""
    numbers = random.Random(SEED + count)
    grown = [([0.0, 0.0, 0.0], [0.0, 0.6, 0.0], WIDE, 0.85 * WIDE)]
    side = None
    for i in range(1, count):
        start, end, _, wide = grown[(i - 1) // 2]
        way = [e - s for s, e in zip(start, end)]
        reach = math.sqrt(total(x * x for x in way)) * numbers.uniform(0.78, 0.93)
        side = direction(numbers) if i % 2 else [-x for x in side]
        heading = unit(along(unit(way), side, numbers.uniform(0.5, 0.9)))
        grown.append((end, along(end, heading, reach), wide, wide * numbers.uniform(0.75, 0.88)))
    low, high = ([pick(p[i] for s in grown for p in s[:2]) for i in range(3)] for pick in (min, max))
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    scale = 2 / (high[1] - low[1])
    elements = []
    for start, end, wide_a, wide_b in grown:
        a, b = (rounded(scale * (x - m) for x, m in zip(p, middle)) for p in (start, end))
        elements.append({"shape": "segment", "a": a, "b": b,
                         "width": rounded(scale * w for w in (wide_a, wide_b)),
                         "color": color(numbers)})
    return {"ivory": 1, "threshold": 0.5, "camera": camera_at(3.25), "elements": elements}


def cloud(hundredths):
    width = hundredths / 100
    numbers = random.Random(SEED)
    places = [rounded(in_ball(numbers)) for _ in range(3000)]
    at_center = total(math.exp(-total(x * x for x in p) / (width * width)) for p in places)
    elements = [{"shape": "point", "position": p, "width": width, "color": color(numbers)}
                for p in places]
    return {"ivory": 1, "threshold": round(at_center / 2, 6), "camera": camera_at(4),
            "elements": elements}


MAKERS = {"mixed": mixed, "points": points, "mixed-all": mixed_all, "curves": curves,
          "tapers": tapers, "cloud": cloud}


def make(name):
    if name in DISTANCE:
        return figure(name)
    kind, _, count = name.rpartition("-")
    if kind not in MAKERS or not count.isdecimal() or int(count) == 0:
        raise SystemExit(f"scenes.py: no scene {name!r}; there are "
                         + ", ".join([*DISTANCE, *(f"{kind}-N" for kind in MAKERS)]))
    return MAKERS[kind](int(count))


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
