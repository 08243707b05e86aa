#!/usr/bin/env python3
"""Writes scenes of the gallery: make_scenes.py FOLDER [NAME ...]

NAME is one of those below; without names all are written. The same names give the same bytes, on
every machine: random numbers are seeded, what grows is rounded as it grows, and what is written is
rounded to 3 to 5 decimals (polygons to 9, see `Plane`).

  ivory       the word in pairs of Bezier curves: a stroke is two curves that run apart towards its
              free ends, as a broad pen draws it, and meet where strokes join
  trefoil     a trefoil knot of 18 cubic Bezier curves, Hermite's through 18 points of it, so that
              tangents go on from curve to curve; the hue turns once along the knot
  leaves      a sprig: every half of a leaf is a cylinder bent along parallel veins, of polygons
              from vein to vein, toothed outside; where two meet, their fields add up to a vein
  oak         a spreading oak in winter, of segments that taper: space colonisation (Runions, Lane
              and Prusinkiewicz 2007) of a crown, widths by the pipe model
  coral       a coral likewise, smoothed, of polylines whose widths taper
  neuron      a nerve cell of polylines, 10 wide at the soma and 0.1 at the ends, on a random walk
              that forks (widths after Rall's law), in an ellipse some hundreds across
  all-shapes  a little ship: all seven shapes and all five kernels

Where one element begins on another's skeleton, the two fields would add up to a bulge. A point of
the same kernel and width and of the opposite strength at that place takes away just what is too
much: behind the place an element is as far as its end, so that there the sum is the first element's
alone, exactly. `joint` makes such a point.
"""

import functools
import json
import math
import operator
import pathlib
import random
import sys

BACKGROUND = [0.008, 0.01, 0.014]
RIM = {"direction": [0.6, 0.5, -0.65], "color": [0.8, 0.9, 1], "intensity": 0.6,
       "attached": "camera"}


# Vectors

def total(values):
    """From left to right; `sum` rounds otherwise from Python 3.12 on."""
    return functools.reduce(operator.add, values)


def add(*vectors):
    return tuple(map(total, zip(*vectors)))


def sub(p, q):
    return tuple(a - b for a, b in zip(p, q))


def mul(p, factor):
    return tuple(a * factor for a in p)


def dot(p, q):
    return total(a * b for a, b in zip(p, q))


def cross(p, q):
    return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])


def length(p):
    return math.sqrt(dot(p, p))


def unit(p):
    return mul(p, 1 / length(p))


def mix(p, q, t):
    return add(mul(p, 1 - t), mul(q, t))


def turned(p, axis, angle):
    """p, turned about an axis of length 1."""
    c, s = math.cos(angle), math.sin(angle)
    return add(mul(p, c), mul(cross(axis, p), s), mul(axis, dot(axis, p) * (1 - c)))


def sphere(numbers):
    """A direction, all alike."""
    while True:
        p = tuple(numbers.uniform(-1, 1) for _ in range(3))
        if 0.01 < dot(p, p) <= 1:
            return unit(p)


# What is written

def number(value, digits):
    value = round(value, digits)
    return int(value) if value == int(value) else value


def rounded(values, digits=3):
    return [number(value, digits) for value in values]


def color(lightness, chroma, hue):
    """Linear RGB of a colour of OKLCH (Ottosson 2020), the hue in degrees."""
    a, b = (chroma * f(math.radians(hue)) for f in (math.cos, math.sin))
    l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    rgb = (4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
           -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
           -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)
    return rounded(min(max(x, 0), 1) for x in rgb)


def between(stops, t):
    """Linear from stop to stop, t from 0 at the first to 1 at the last."""
    x = min(max(t, 0), 1) * (len(stops) - 1)
    i = min(int(x), len(stops) - 2)
    return mix(stops[i], stops[i + 1], x - i)


def blend(stops, t):
    """A colour between stops of lightness, chroma and hue."""
    return color(*between(stops, t))


def joint(position, width, strength=1, kernel=None):
    """Takes away what elements that meet at a position add up to too much, see above; `strength` is
    the sum of those of the elements that begin here on another's skeleton."""
    element = {"shape": "point", "position": rounded(position, 4)}
    if kernel:
        element["kernel"] = kernel
    return element | {"strength": number(-strength, 4), "width": number(width, 4),
                      "color": [0, 0, 0]}


def light(direction, rgb, intensity, attached="camera"):
    return {"direction": direction, "color": rgb, "intensity": intensity, "attached": attached}


def scene(threshold, camera, lights, elements):
    position, target, up, fov = camera
    return {"ivory": 1, "threshold": threshold, "background": BACKGROUND,
            "camera": {"position": position, "target": target, "up": up, "fov": fov},
            "lights": lights, "elements": elements}


def text(data):
    lines = ["{"]
    for key, value in data.items():
        comma = "" if key == "elements" else ","
        if key in ("lights", "elements"):
            rows = ",\n".join("    " + json.dumps(row) for row in value)
            lines.append(f'  "{key}": [\n{rows}\n  ]{comma}')
        else:
            lines.append(f'  "{key}": {json.dumps(value)}{comma}')
    return "\n".join(lines) + "\n}\n"


# The word

def ivory():
    width, strength, hair = 0.125, 0.8, 0.085
    numbers = random.Random(7)
    elements = []

    def place(x, y):
        """On a wide arc that comes towards the eye at its ends."""
        return (x, y, 0.012 * x * x)

    def curve(*points, wide=width, strong=strength, hue=76):
        shade = color(numbers.uniform(0.925, 0.965), numbers.uniform(0.026, 0.046),
                      hue + numbers.uniform(-6, 6))
        elements.append({"shape": "curve",
                         "control_points": [rounded(place(*p), 4) for p in points],
                         "strength": strong, "width": wide, "color": shade})

    def meet(point, times):
        elements.append(joint(place(*point), width, times * strength))

    def serif(x, y, reach_left, reach_right):
        """A hairline over the end of a stroke, hollow towards the outside."""
        dip = 0.05 if y < 0 else -0.05
        curve((x - reach_left, y), (x, y + dip), (x + reach_right, y), wide=hair, strong=1)

    def stroke(a, b, spread_a, spread_b, waist):
        """Two quadratic curves from a to b, apart by the spreads at the ends and by the waist
        between."""
        along = unit(sub(b, a))
        side = (along[1], -along[0])
        middle = mix(a, b, 0.5)
        for sign in (-1, 1):
            ends = [add(p, mul(side, sign * spread)) for p, spread in
                    ((a, spread_a), (b, spread_b))]
            control = add(middle, mul(side, sign * (2 * waist - (spread_a + spread_b) / 2)))
            curve(ends[0], control, ends[1])

    def stem(x, top, bottom):
        stroke((x, top), (x, bottom), 0.085, 0.085, 0.07)

    top, bottom, line = 0.9, -0.9, 1.02
    # I
    stem(-3.98, top, bottom)
    serif(-3.98, line, 0.34, 0.34)
    serif(-3.98, -line, 0.34, 0.34)
    # V
    foot = (-2.26, -1.0)
    stroke((-3.0, top), foot, 0.085, 0, 0.075)
    stroke((-1.58, top), foot, 0.03, 0, 0)
    meet(foot, 2)
    serif(-3.02, line, 0.3, 0.3)
    serif(-1.54, line, 0.27, 0.24)
    # O, two rings that touch at the top and the bottom: a stroke that swells at its sides
    for radius_x, radius_y in ((1.08, 1.03), (0.86, 1.01)):
        ends = [(-0.17, radius_y), (-0.17, -radius_y)]
        for sign in (-1, 1):
            x = -0.17 + sign * radius_x * 4 / 3
            curve(ends[0], (x, ends[0][1]), (x, ends[1][1]), ends[1])
        for end in ends:
            meet(end, 1)
    # R
    stem(1.4, top, bottom)
    # The serif fades out where the bowl begins
    serif(1.4, line, 0.34, 0.16)
    elements.append(joint(place(1.56, line), hair))
    serif(1.4, -line, 0.34, 0.32)
    head, waist = (1.46, 0.8), (1.44, -0.02)
    for reach in (1.2, 0.9):
        curve(head, (1.44 + reach, 1.26), (1.44 + reach, -0.08), waist)
    meet(head, 2.2)
    meet(waist, 2)
    hip = (1.8, 0.0)
    curve(hip, (2.1, -0.45), (2.3, -1.1), (2.82, -1.03))
    curve(hip, (2.22, -0.4), (2.38, -0.8), (2.56, -0.96))
    meet(hip, 2)
    # Y
    fork = (3.74, -0.08)
    stroke((3.02, top), fork, 0.085, 0, 0.07)
    stroke((4.4, top), fork, 0.03, 0, 0)
    stroke(fork, (3.74, bottom), 0, 0.085, 0.075)
    meet(fork, 4)
    serif(2.98, line, 0.3, 0.3)
    serif(4.44, line, 0.28, 0.26)
    serif(3.74, -line, 0.34, 0.34)
    # The flourish: one line of four curves whose tangents go on
    line = [(-3.86, -1.42), (-4.3, -1.3), (-4.42, -1.74), (-3.8, -1.78),
            (-2.4, -1.87), (-1.2, -1.3), (0.4, -1.5),
            (1.8, -1.68), (3.2, -2.02), (4.1, -1.7),
            (4.72, -1.48), (4.36, -1.05), (4.04, -1.3)]
    for i in range(0, 12, 3):
        curve(*line[i:i + 4], wide=0.07, strong=1, hue=66)
        if i:
            elements.append(joint(place(*line[i]), 0.07))
    lights = [light([-0.5, 0.65, 0.6], [1, 0.96, 0.9], 1),
              light([0.85, -0.25, 0.4], [1, 0.76, 0.55], 0.35), RIM]
    camera = ([1.6, -2.3, 10.6], [0.26, -0.33, 0.1], [0.04, 1, 0], 30)
    return scene(0.5, camera, lights, elements)


# The knot

def trefoil():
    pieces, width = 18, 0.96

    def at(t):
        return (math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t),
                -1.3 * math.sin(3 * t))

    def velocity(t):
        return (math.cos(t) + 4 * math.cos(2 * t), -math.sin(t) + 4 * math.sin(2 * t),
                -3.9 * math.cos(3 * t))

    elements, joints = [], []
    h = 2 * math.pi / pieces
    for i in range(pieces):
        t, end, hue = i * h, (i + 1) % pieces * h, 20 + 360 * i / pieces
        points = [at(t), add(at(t), mul(velocity(t), h / 3)),
                  sub(at(end), mul(velocity(end), h / 3)), at(end)]
        elements.append({"shape": "curve", "control_points": [rounded(p, 4) for p in points],
                         "kernel": "wyvill", "width": width,
                         "color": color(0.71 + 0.06 * math.cos(math.radians(hue - 95)), 0.14, hue)})
        joints.append(joint(at(t), width, kernel="wyvill"))
    lights = [light([-0.5, 0.7, 0.6], [1, 0.95, 0.88], 0.85),
              light([0.8, -0.1, 0.5], [0.5, 0.68, 1], 0.25), RIM]
    camera = ([1.2, -2.4, 13.2], [-0.05, -0.2, 0], [0, 1, 0], 30)
    return scene(0.5, camera, lights, elements + joints)


# Leaves

class Plane:
    """A plane through a point, along two directions, all of few decimals: the sums of multiples of
    few decimals are exact in nine, so that vertices lie in the plane but for their own rounding."""

    def __init__(self, origin, u, v):
        self.origin, self.u, self.v = (tuple(round(x, 4) for x in p) for p in (origin, u, v))

    def vertex(self, a, b):
        a, b = round(a, 5), round(b, 5)
        return rounded(add(self.origin, mul(self.u, a), mul(self.v, b)), 9)


def leaf(stalk, along, normal, size, breadth, fold, bend, hue, numbers):
    """Polygons and the rib of a leaf that begins at `stalk`; `fold` lifts the halves, `bend` is the
    angle by which it turns down towards its tip, both in radians."""
    panels, teeth, width = 5, 2, 0.036
    side = unit(cross(along, normal))
    ribs, step, heading = [stalk], size / panels, turned(along, side, bend * 0.35)
    for _ in range(panels):
        ribs.append(add(ribs[-1], mul(heading, step)))
        heading = turned(heading, side, -bend / panels)

    def outline(t):
        return breadth * 2.3 * t ** 0.7 * (1 - t) if 0 < t < 1 else 0.0

    elements = []
    for sign in (-1, 1):
        out = turned(mul(side, sign), along, sign * fold)
        vein = add(mul(out, 0.8), mul(along, 0.62))
        lightness, chroma, angle = hue
        for k in range(panels):
            plane = Plane(ribs[k], sub(ribs[k + 1], ribs[k]), vein)
            edge = []
            for j in range(2 * teeth + 1):
                s = j / (2 * teeth)
                reach = outline((k + s) / panels)
                if j % 2:
                    edge.append((s - 0.16 / teeth, reach * 1.045))
                    edge.append((s, reach * 0.9))
                elif reach > 0:
                    edge.append((s, reach))
            corners = [(0, 0), (1, 0)] + edge[::-1]
            shade = color(lightness + 0.02 * sign + numbers.uniform(-0.015, 0.015), chroma,
                          angle + 10 * (k / panels - 0.5))
            elements.append({"shape": "polygon", "vertices": [plane.vertex(*c) for c in corners],
                             "width": width, "color": shade})
    return elements, ribs


def leaves():
    numbers = random.Random(11)
    stops = [(0.46, 0.1, 148), (0.56, 0.12, 130), (0.68, 0.13, 105), (0.68, 0.15, 70),
             (0.58, 0.17, 42), (0.47, 0.16, 24)]
    count = 11
    stem = []
    for i in range(25):
        t = i / 24
        stem.append((-3.6 + 6.2 * t, -1.55 + 1.9 * t + 0.75 * math.sin(2.6 * t),
                     0.35 * math.sin(3 * t)))
    elements = [{"shape": "polyline", "points": [rounded(p, 4) for p in stem],
                 "width": rounded((0.085 - 0.055 * i / 24 for i in range(25)), 4),
                 "color": color(0.42, 0.06, 60)}]
    for i in range(count):
        t = 0.12 + 0.88 * i / (count - 1)
        k = min(int(24 * t), 23)
        start, ahead = between(stem, t), unit(sub(stem[k + 1], stem[k]))
        last = i == count - 1
        turn = 0 if last else (1 if i % 2 else -1) * (1.0 - 0.25 * t)
        along = turned(ahead, (0, 0, 1), turn)
        along = unit(add(along, (0, 0, (0.36, 0.3, -0.05, -0.2)[i % 4])))
        normal = unit(add((0, 0, 1), mul(along, -along[2]), mul(sphere(numbers), 0.25)))
        normal = unit(sub(normal, mul(along, dot(normal, along))))
        stalk = add(start, mul(along, 0.3))
        size = 1.95 * (0.72 + 0.5 * math.sin(math.pi * (0.1 + 0.75 * t)))
        parts, ribs = leaf(stalk, along, normal, size, 0.42 * size, 0.4,
                           numbers.uniform(0.5, 0.95), between(stops, t), numbers)
        elements += parts
        points = [start] + ribs
        widths = [0.05, 0.045] + [0.04 - 0.026 * j / 5 for j in range(1, 6)]
        elements.append({"shape": "polyline", "points": [rounded(p, 4) for p in points],
                         "width": rounded(widths, 4), "strength": 0.7,
                         "color": blend([(0.5, 0.07, 80), (0.5, 0.12, 35)], t)})
    lights = [light([-0.5, 0.75, 0.55], [1, 0.95, 0.85], 0.95),
              light([0.8, -0.25, 0.5], [0.55, 0.7, 1], 0.3), RIM]
    camera = ([-0.9, -1.6, 10.7], [-0.05, 0.25, 0], [0, 1, 0], 30)
    return scene(0.5, camera, lights, elements)


# Trees

class Tree:
    """Nodes with a parent each, the first the root; parents stand before their children."""

    def __init__(self, root):
        self.points, self.parents = [root], [None]

    def grow(self, parent, point):
        self.points.append(tuple(round(x, 4) for x in point))
        self.parents.append(parent)
        return len(self.points) - 1

    def chain(self, parent, points):
        for point in points:
            parent = self.grow(parent, point)
        return parent

    def children(self):
        lists = [[] for _ in self.points]
        for node, parent in enumerate(self.parents):
            if parent is not None:
                lists[parent].append(node)
        return lists

    def colonise(self, attractors, numbers, step, reach, kill, rise, keep, noise, limit):
        """Grows towards the attractors: every one pulls the node next to it, if within reach, and
        goes where a node comes as near as kill. Every heading adds to this pull the way that its
        parent went, times keep, rise, and noise at random."""
        nearest = [self.next_to(p, range(len(self.points))) for p in attractors]
        while len(self.points) < limit:
            pulls = {}
            for attractor, (distance, node) in zip(attractors, nearest):
                if distance < reach:
                    pull = unit(sub(attractor, self.points[node]))
                    pulls[node] = add(pulls.get(node, (0, 0, 0)), pull)
            known, lists = len(self.points), self.children()
            for node, pull in sorted(pulls.items()):
                heading = add(mul(pull, 1 / (length(pull) + 1e-9)), rise,
                              mul(self.way(node), keep), mul(sphere(numbers), noise))
                point = add(self.points[node], mul(unit(heading), step))
                if all(length(sub(point, self.points[c])) > 0.45 * step for c in lists[node]):
                    self.grow(node, point)
            if len(self.points) == known:
                break
            fresh = range(known, len(self.points))
            nearest = [min(old, self.next_to(p, fresh)) for p, old in zip(attractors, nearest)]
            kept = [i for i, (distance, _) in enumerate(nearest) if distance > kill]
            attractors, nearest = [attractors[i] for i in kept], [nearest[i] for i in kept]

    def way(self, node):
        parent = self.parents[node]
        return (0, 0, 0) if parent is None else unit(sub(self.points[node], self.points[parent]))

    def next_to(self, point, nodes):
        return min((length(sub(point, self.points[node])), node) for node in nodes)

    def widths(self, tip, exponent, swell=0.0):
        """By the pipe model: a power of a node's width is the sum of its children's; `swell` lets
        it grow along a branch that does not fork, too."""
        widths = [0.0] * len(self.points)
        for node in range(len(self.points) - 1, -1, -1):
            widths[node] = max(widths[node], tip ** exponent) * (1 + swell)
            if self.parents[node] is not None:
                widths[self.parents[node]] += widths[node]
        return [w ** (1 / exponent) for w in widths]

    def smooth(self, times):
        """Draws every node but the root and the tips half-way to the middle of its neighbours."""
        lists = self.children()
        for _ in range(times):
            old = list(self.points)
            for node, parent in enumerate(self.parents):
                if parent is not None and lists[node]:
                    ahead = mul(add(*(old[c] for c in lists[node])), 1 / len(lists[node]))
                    self.points[node] = mix(old[node], mix(old[parent], ahead, 0.5), 0.5)
        self.points = [tuple(round(x, 4) for x in p) for p in self.points]

    def paths(self, widths):
        """Lists of nodes: on from every node with its widest child, anew with each of the others,
        from the node where they leave."""
        lists, found = self.children(), []
        starts = [(None, 0)]
        while starts:
            parent, node = starts.pop()
            path = [node] if parent is None else [parent, node]
            while lists[path[-1]]:
                main, *others = sorted(lists[path[-1]], key=lambda c: (-widths[c], c))
                starts += [(path[-1], other) for other in others]
                path.append(main)
            found.append(path)
        return found

    def depths(self):
        """Of every node the length of its way from the root."""
        depths = [0.0]
        for node in range(1, len(self.points)):
            parent = self.parents[node]
            depths.append(depths[parent] + length(sub(self.points[node], self.points[parent])))
        return depths


def in_crown(numbers, center, radii, floor):
    """A point of an ellipsoid above a floor."""
    while True:
        p = tuple(numbers.uniform(-1, 1) for _ in range(3))
        point = add(center, tuple(a * r for a, r in zip(p, radii)))
        if dot(p, p) <= 1 and point[1] > floor:
            return point


def oak():
    numbers = random.Random(5)
    tree = Tree((0.0, 0.0, 0.0))
    fork = tree.chain(0, [(0.06, 0.5, 0.02), (0.03, 1.0, 0.05), (-0.08, 1.5, 0.03),
                          (-0.14, 2.0, -0.03)])
    # The great limbs, so that they leave the trunk low and wide
    for heading, reach in (((-1, 0.55, 0.2), 5), ((1, 0.5, 0.25), 5), ((0.35, 1, -0.35), 4),
                           ((-0.45, 1, 0.4), 4), ((0.5, 0.6, 0.9), 3), ((-0.5, 0.6, -0.9), 3)):
        node, way = fork, unit(heading)
        for _ in range(reach):
            way = unit(add(way, (0, 0.02, 0), mul(sphere(numbers), 0.28)))
            node = tree.grow(node, add(tree.points[node], mul(way, 0.45)))
    crown = [in_crown(numbers, (0, 4.1, 0), (6.3, 3.6, 3.2), 1.9) for _ in range(1500)]
    tree.colonise(crown, numbers, step=0.3, reach=1.7, kill=0.46, rise=(0, 0.1, 0), keep=0.6,
                  noise=0.42, limit=1700)
    tree.smooth(4)
    widths = tree.widths(0.048, 2.3)
    lists, depths = tree.children(), tree.depths()
    far = max(depths)
    stops = [(0.4, 0.045, 50), (0.47, 0.06, 54), (0.6, 0.085, 64), (0.76, 0.11, 76)]
    elements = []
    for path in tree.paths(widths):
        start = path[0]
        wide = min(widths[start], 1.25 * widths[path[1]])
        nodes = [n for i, n in enumerate(path)
                 if i == 0 or len(lists[n]) != 1 or i % 2 == 0]
        for a, b in zip(nodes, nodes[1:]):
            shade = blend(stops, (depths[b] / far) ** 0.9)
            elements.append({"shape": "segment", "a": rounded(tree.points[a], 4),
                             "b": rounded(tree.points[b], 4),
                             "kernel": "wyvill", "width": rounded([wide, widths[b]], 4),
                             "color": shade})
            if a:
                elements.append(joint(tree.points[a], wide, kernel="wyvill"))
            wide = widths[b]
    # Roots and the ground
    crotch = (0.04, 0.8, 0.03)
    for i in range(8):
        angle = 2 * math.pi * (i + numbers.uniform(-0.25, 0.25)) / 8
        way = (math.cos(angle), 0, math.sin(angle))
        knee, end = add(mul(way, 0.5), (0, 0.0, 0)), add(mul(way, 1.5), (0, -0.28, 0))
        for a, b, wide in ((crotch, knee, (0.15, 0.55)), (knee, end, (0.55, 0.15))):
            elements.append({"shape": "segment", "a": rounded(a, 4), "b": rounded(b, 4),
                             "kernel": "wyvill", "width": rounded((x * widths[0] for x in wide), 4),
                             "color": blend(stops, 0)})
        elements.append(joint(knee, 0.55 * widths[0], kernel="wyvill"))
    elements.append({"shape": "disc", "center": [0, -0.4, 0], "normal": [0, 1, 0], "radius": 2.5,
                     "kernel": "wyvill", "width": 0.4, "color": color(0.42, 0.065, 126)})
    lights = [light([-0.55, 0.6, 0.6], [1, 0.93, 0.82], 0.95),
              light([0.85, -0.15, 0.4], [0.45, 0.62, 1], 0.35), RIM]
    camera = ([-1.2, 3.2, 18.6], [0, 3.3, 0], [0, 1, 0], 28)
    return scene(0.5, camera, lights, elements)


def coral():
    numbers = random.Random(3)
    tree = Tree((0.0, -0.4, 0.0))
    for i in range(9):
        angle = 2 * math.pi * (i * 0.382)
        lean = 0.35 + 0.9 * i / 8
        way = (math.cos(angle) * lean * 1.3, 1, math.sin(angle) * lean * 0.8)
        tree.chain(0, [mul(unit(way), 0.14 * k) for k in range(1, 7)])
    bush = [in_crown(numbers, (0, 0.2, 0), (4.9, 4.3, 2.9), 0.35) for _ in range(1100)]
    tree.colonise(bush, numbers, step=0.1, reach=1.6, kill=0.4, rise=(0, 0.25, 0), keep=1.2,
                  noise=0.2, limit=4500)
    tree.smooth(8)
    widths = tree.widths(0.2, 3.2, 0.003)
    depths = tree.depths()
    far = max(depths)
    stops = [(0.42, 0.15, 12), (0.52, 0.18, 22), (0.63, 0.18, 34), (0.76, 0.13, 45),
             (0.92, 0.055, 65)]
    elements = []
    for path in tree.paths(widths):
        width = [min(widths[path[0]], 1.1 * widths[path[1]])] + [widths[n] for n in path[1:]]
        for i in range(0, len(path) - 1, 10):
            part, last = path[i:i + 11], i + 11 >= len(path)
            t = depths[part[len(part) // 2]] / far
            if last:
                t += 0.14
            elements.append({"shape": "polyline",
                             "points": [rounded(tree.points[n]) for n in part],
                             "kernel": "wyvill", "width": rounded(width[i:i + 11]),
                             "color": blend(stops, t)})
            if part[0]:
                elements.append(joint(rounded(tree.points[part[0]]), round(width[i], 3),
                                      kernel="wyvill"))
    # The rock that it stands on
    for x, y, z, width in ((0, -0.8, 0, 1.3), (-1, -0.95, 0.2, 0.85), (1, -0.9, 0.1, 0.95),
                           (0.4, -0.95, 0.8, 0.9), (-0.45, -0.95, 0.75, 0.75),
                           (-0.4, -0.9, -0.8, 1), (0.6, -0.9, -0.7, 0.9), (1.7, -1.02, 0.2, 0.6),
                           (-1.65, -1.02, 0.3, 0.55)):
        elements.append({"shape": "point", "position": [x, y, z], "kernel": "wyvill",
                         "width": width, "color": color(0.42, 0.03, 290)})
    lights = [light([-0.5, 0.7, 0.6], [1, 0.96, 0.9], 0.85),
              light([0.8, -0.2, 0.5], [0.4, 0.6, 1], 0.35), RIM]
    camera = ([1.5, 2.6, 13.6], [0.05, 1.6, 0], [0, 1, 0], 28)
    return scene(0.5, camera, lights, elements)


# The nerve cell

def neuron():
    numbers = random.Random(19)
    radii = (228, 120, 70)
    stops = [(0.8, 0.13, 78), (0.7, 0.17, 48), (0.6, 0.2, 18), (0.56, 0.19, -20),
             (0.58, 0.17, -62), (0.7, 0.12, -112)]
    elements = []

    def put(points, widths, t):
        elements.append({"shape": "polyline", "points": [rounded(p, 3) for p in points],
                         "width": rounded(widths, 4), "color": blend(stops, t)})

    def reach(way):
        return 1 / math.sqrt(total((a / r) ** 2 for a, r in zip(way, radii)))

    def branch(start, way, width, level, left):
        """A branch that begins at a point of its parent and takes a share of what is left."""
        ends = level == 4 or left < 22
        share = left if ends else left * numbers.uniform(0.8, 1.2) * (0.2, 0.27, 0.36, 0.48)[level]
        count = max(3, round(share / 7))
        points, widths = [start], [width]
        thin = 0.1 if ends else width * 0.66
        outward = way
        for i in range(count):
            way = unit(add(way, mul(sphere(numbers), 0.12 + 0.05 * level), mul(outward, 0.12)))
            points.append(add(points[-1], mul(way, share / count)))
            widths.append(thin + (width - thin) * (1 - (i + 1) / count) ** 2)
        points = [tuple(round(x, 3) for x in p) for p in points]
        put(points, widths, 0.12 + 0.88 * (level + 0.5) / 5)
        if ends:
            return
        axis = unit(cross(way, sphere(numbers)))
        axis = unit(add(axis, (0, 0, 1.4 if axis[2] > 0 else -1.4)))
        angle = numbers.uniform(0.35, 0.55)
        for sign, rest in ((1, numbers.uniform(0.9, 1)), (-1, numbers.uniform(0.75, 1))):
            branch(points[-1], turned(way, axis, sign * angle * (0.7 if rest > 0.9 else 1.2)),
                   thin * numbers.uniform(0.8, 0.95), level + 1, (left - share) * rest)

    soma = [(-9, -6, 0), (0, 0, 0), (8, 7, 2)]
    put(soma, [7, 10, 6], 0)
    for angle, depth, width, origin in ((12, 0.2, 4.4, 2), (52, -0.25, 3.6, 2), (98, 0.3, 3.8, 1),
                                        (140, -0.1, 4.2, 0), (184, 0.25, 4.4, 0),
                                        (228, -0.3, 3.6, 0), (282, 0.2, 3.4, 1),
                                        (328, -0.2, 4, 1)):
        a = math.radians(angle)
        way = unit((math.cos(a) * 1.1, math.sin(a), depth))
        branch(soma[origin], way, width, 0, reach(way))
    lights = [light([-0.5, 0.7, 0.6], [1, 0.95, 0.88], 0.9),
              light([0.8, -0.2, 0.5], [0.5, 0.6, 1], 0.4), RIM]
    camera = ([-40, 36, 562], [0, 8, 0], [0, 1, 0], 26)
    return scene(0.1, camera, lights, elements)


# The ship

def all_shapes():
    elements = []

    def put(shape, kernel, width, shade, **keys):
        elements.append({"shape": shape} | keys | {"kernel": kernel, "width": width,
                                                   "color": shade})

    wood, rail = color(0.47, 0.1, 48), color(0.66, 0.1, 62)
    cream, red, gold = color(0.93, 0.03, 85), color(0.55, 0.19, 27), color(0.82, 0.15, 82)
    sea, foam, cloud = color(0.45, 0.09, 232), color(0.86, 0.05, 215), color(0.93, 0.015, 250)
    # The sea and its waves
    put("disc", "blobtree", 0.5, sea, name="sea", center=[0, -1.75, 0], normal=[0, 1, 0],
        radius=3.1)
    for i in range(5):
        points, widths = [], []
        for k in range(97):
            angle = math.radians(208 + 124 * k / 96 + 14 * (i % 2) - 7)
            radius = 1.35 + 0.4 * i + 0.035 * math.sin(0.4 * k + 2 * i)
            points.append(rounded((radius * math.cos(angle), -1.5, -radius * math.sin(angle))))
            widths.append(0.03 + 0.11 * math.sin(math.pi * k / 96))
        put("polyline", "wyvill", rounded(widths), foam, points=points)
    # The hull, hollow: curves from the bow to the stern
    bow, stern = [-1.95, -0.3, 0], [1.8, -0.4, 0]
    for y, z, shade in ((-1.8, 0, wood), (-1.55, 0.62, wood), (-1.55, -0.62, wood),
                        (-1.05, 0.95, rail), (-1.05, -0.95, rail)):
        put("curve", "blinn", 0.21, shade, control_points=[bow, [-1.1, y, z], [0.95, y, z], stern])
    for end in (bow, stern):
        elements.append(joint(end, 0.21, 3.5))
    # The mast and its pennant
    put("segment", "wyvill", [0.24, 0.1], rail, name="mast", a=[0, -1.4, 0], b=[0.14, 2.55, 0])
    points = [rounded((0.14 + 0.075 * k, 2.52 - 0.012 * k + 0.09 * math.sin(0.75 * k) * k / 14,
                       0.1 * math.sin(0.6 * k))) for k in range(15)]
    put("polyline", "wyvill", rounded(0.19 - 0.011 * k for k in range(15)), red, points=points,
        name="pennant")
    # The main sail, hollow between its battens, and the jib
    plane = Plane((0.1, -0.5, 0.04), (0.95, 0, 0.32), (0.035, 1, 0))
    edge = [(1.55, 0), (1.6, 0.62), (1.42, 1.22), (1.12, 1.78), (0.72, 2.3), (0.1, 2.72)]
    corners = [(0.1, 0), edge[0]]
    for p, q in zip(edge, edge[1:]):
        corners += [add(mix(p, q, 0.5), (-0.09, -0.06)), q]
    put("polygon", "murakami", 0.1, red, name="sail", vertices=[plane.vertex(*c) for c in corners])
    for x, y in edge[:-1]:
        put("segment", "wyvill", [0.13, 0.08], gold, a=plane.vertex(0.04, y * 0.94),
            b=plane.vertex(x, y))
    plane = Plane((-1.72, -0.22, 0), (1.45, -0.12, 0.25), (1.72, 2.35, 0))
    corners = [(0, 0), (0.35, 0.02), (0.7, 0.01), (0.98, 0), (0.72, 0.24), (0.4, 0.54), (0, 0.97)]
    put("polygon", "murakami", 0.1, cream, name="jib", vertices=[plane.vertex(*c) for c in corners])
    # The sun and a cloud
    center = (-2.25, 1.75, -1.0)
    put("circle", "nishimura", 0.26, gold, name="sun", center=rounded(center),
        normal=[0.2, -0.05, 1], radius=0.58)
    put("point", "nishimura", 0.78, gold, position=rounded(center))
    for k in range(12):
        angle = math.radians(30 * k + 15)
        way = (math.cos(angle), math.sin(angle), -0.2 * math.cos(angle) + 0.05 * math.sin(angle))
        foot = add(center, mul(way, 0.58))
        put("segment", "wyvill", [0.2, 0.05], gold, a=rounded(foot),
            b=rounded(add(center, mul(way, 1.02))))
        elements.append(joint(foot, 0.2, kernel="wyvill"))
    for x, y, width in ((-0.62, -0.03, 0.3), (-0.22, 0.12, 0.4), (0.25, 0.08, 0.36),
                        (0.6, -0.06, 0.27), (0.05, -0.1, 0.32)):
        put("point", "blinn", width, cloud, position=rounded((2.3 + x, 1.75 + y, -0.9)))
    lights = [light([-0.5, 0.7, 0.6], [1, 0.95, 0.88], 0.85),
              light([0.8, -0.1, 0.5], [0.5, 0.68, 1], 0.25), RIM]
    camera = ([-2.4, 2.3, 12.9], [0, -0.02, 0], [0, 1, 0], 28)
    return scene(0.5, camera, lights, elements)


SCENES = {"ivory": ivory, "trefoil": trefoil, "leaves": leaves, "oak": oak, "coral": coral,
          "neuron": neuron, "all-shapes": all_shapes}


def main():
    if len(sys.argv) < 2:
        sys.exit("make_scenes.py FOLDER [NAME ...]: " + ", ".join(SCENES))
    names = sys.argv[2:] or list(SCENES)
    for name in names:
        if name not in SCENES:
            sys.exit(f"{name}: not one of {', '.join(SCENES)}")
    for name in names:
        path = pathlib.Path(sys.argv[1]) / f"{name}.ivory.json"
        path.write_text(text(SCENES[name]()), encoding="utf-8")


if __name__ == "__main__":
    main()
