#!/usr/bin/env python3
"""Others on the same scenes: POV-Ray's isosurface (accuracy swept) and PyPI's isoray.

Both get the same field, camera, box and number of pixels, and are compared with `ivory render
--answers` at 1e-12. POV-Ray's time is the one that it prints for tracing; it gets the greatest
gradient that a seeded sample of the box shows, plus 5 %, as its manual advises. Its depth comes out
in two pictures of 16 bits a channel, high and low digits, which are not timed. isoray's is that of
`bisect_trace` and `newton_refine`, on an inclusion function made for these fields: the distance to a
skeleton changes by no more than the place does. What is not installed is left out, with a note.
Scenes of few points, segments and circles with Blinn's kernel only."""

import argparse
import csv
import io
import json
import math
import pathlib
import random
import re
import shutil
import struct
import subprocess
import tempfile
import time
import zlib

import host
import scenes

SWEEP = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8"]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def times(s, a):
    return [s * x for x in a]


def plus(a, b):
    return [x + y for x, y in zip(a, b)]


def unit(a):
    return times(1 / math.sqrt(dot(a, a)), a)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class View:
    """The frame of the camera, as in the contract."""

    def __init__(self, camera, width, height):
        self.position = camera["position"]
        self.forward = unit(minus(camera["target"], self.position))
        self.right = unit(cross(self.forward, camera["up"]))
        self.top = cross(self.right, self.forward)
        self.s = math.tan(math.radians(camera["fov"]) / 2)
        self.width, self.height = width, height

    def direction(self, i, j):
        x = (2 * (i + 0.5) / self.width - 1) * self.s * self.width / self.height
        y = (1 - 2 * (j + 0.5) / self.height) * self.s
        return unit(plus(plus(self.forward, times(x, self.right)), times(y, self.top)))


def distance(element, p):
    if element["shape"] == "point":
        away = minus(p, element["position"])
    elif element["shape"] == "segment":
        m, v = minus(element["b"], element["a"]), minus(p, element["a"])
        away = minus(v, times(max(0, min(1, dot(m, v) / dot(m, m))), m))
    else:
        n, v = unit(element["normal"]), minus(p, element["center"])
        h = dot(n, v)
        across = minus(v, times(h, n))
        away = [math.sqrt(dot(across, across)) - element["radius"], h, 0]
    return math.sqrt(dot(away, away))


def value(scene, p):
    return sum(e.get("strength", 1) * math.exp(-(distance(e, p) / e.get("width", 1)) ** 2)
               for e in scene["elements"]) - scene["threshold"]


def greatest_gradient(scene, box):
    numbers = random.Random(1)
    greatest, step = 0, 1e-5
    for _ in range(4000):
        p = [numbers.uniform(lo, hi) for lo, hi in zip(box["lo"], box["hi"])]
        gradient = []
        for axis in range(3):
            a, b = list(p), list(p)
            a[axis] -= step
            b[axis] += step
            gradient.append((value(scene, b) - value(scene, a)) / (2 * step))
        greatest = max(greatest, math.sqrt(dot(gradient, gradient)))
    return 1.05 * greatest


# The reference.

class Reference:
    def __init__(self, path, width, height):
        with tempfile.TemporaryDirectory() as folder:
            answers = pathlib.Path(folder) / "answers.csv"
            host.render(path, "--size", f"{width}x{height}", "--tolerance", "1e-12", "--answers",
                        answers)
            self.t = []
            for row in csv.reader(io.StringIO(answers.read_text())):
                if "status" in row or len(row) < 9:
                    continue
                known = row[6] in ("hit", "miss")
                self.t.append((float(row[7]) + float(row[8])) / 2 if row[6] == "hit" else
                              math.inf if known else math.nan)


def row_of(name, view, method, tolerance, threads, seconds, repeats, t, reference, least_width):
    """`seconds`: pairs of wall and processor time; `t`: of every pixel, inf on a miss."""
    wrong = hits = 0
    errors = []
    for mine, truth in zip(t, reference.t):
        hits += truth < math.inf
        if math.isnan(truth):
            continue
        if (mine < math.inf) != (truth < math.inf):
            wrong += 1
        elif truth < math.inf:
            errors.append(abs(mine - truth))
    processor = [both[1] for both in seconds]
    seconds = sorted(both[0] for both in seconds)
    return {
        "scene": name, "width": view.width, "height": view.height, "threads": threads,
        "method": method, "tolerance": tolerance, "delta": 0,
        "seconds": seconds[len(seconds) // 2], "seconds_least": seconds[0],
        "processor_seconds": sorted(processor)[len(processor) // 2], "repeats": repeats, "complete": 1,
        "evaluations": "", "element_evaluations": "", "pixels": view.width * view.height,
        "hits": hits, "wrong": wrong, "unresolved": 0, "claimed": view.width * view.height,
        "t_max": max(errors, default=0),
        "t_rms": math.sqrt(sum(e * e for e in errors) / max(len(errors), 1)),
        "normal_max": "", "normal_rms": "", "color_max": "", "color_rms": "",
        "least_width": least_width}


# POV-Ray.

def pov_vector(v):
    return "<" + ", ".join(repr(float(x)) for x in v) + ">"


def pov_square(element):
    """d^2 as a function of x, y, z; POV-Ray's functions know no vectors."""
    def around(c):
        return [f"({axis} - ({x!r}))" for axis, x in zip("xyz", map(float, c))]

    def inner(a, b):
        return "(" + " + ".join(f"{x}*({float(y)!r})" for x, y in zip(a, b)) + ")"

    if element["shape"] == "point":
        v = around(element["position"])
    elif element["shape"] == "segment":
        m = minus(element["b"], element["a"])
        v = around(element["a"])
        foot = f"max(0, min(1, {inner(v, m)}/({dot(m, m)!r})))"
        return sum_of_squares([f"({c} - {foot}*({float(x)!r}))" for c, x in zip(v, m)])
    else:
        n = unit(element["normal"])
        v = around(element["center"])
        h = inner(v, n)
        across = sum_of_squares([f"({c} - {h}*({x!r}))" for c, x in zip(v, n)])
        return f"(pow(sqrt({across}) - ({float(element['radius'])!r}), 2) + pow({h}, 2))"
    return sum_of_squares(v)


def sum_of_squares(parts):
    return "(" + " + ".join(f"pow({part}, 2)" for part in parts) + ")"


def pov_scene(scene, view, box, accuracy, gradient, digits):
    near, far = depth_range(view, box)
    field = " + ".join(f"({float(e.get('strength', 1))!r})*exp(-{pov_square(e)}/"
                       f"({float(e.get('width', 1)) ** 2!r}))" for e in scene["elements"])
    depth = "(sqrt(" + " + ".join(f"pow({axis} - ({float(c)!r}), 2)" for axis, c in
                                  zip("xyz", view.position)) + f") - {near!r})/{far - near!r}"
    shown = {"mask": "1", "high": f"floor({depth}*32768)/65535",
             "low": f"({depth}*32768 - floor({depth}*32768))*60000/65535 + 1000/65535"}[digits]
    return f"""#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 1 }}
background {{ rgb 0 }}
camera {{
  perspective location {pov_vector(view.position)} direction {pov_vector(view.forward)}
  right {pov_vector(times(2 * view.s * view.width / view.height, view.right))}
  up {pov_vector(times(2 * view.s, view.top))}
}}
isosurface {{
  function {{ {float(scene['threshold'])!r} - ({field}) }}
  contained_by {{ box {{ {pov_vector(box['lo'])}, {pov_vector(box['hi'])} }} }}
  accuracy {accuracy} max_gradient {gradient!r}
  pigment {{ function {{ {shown} }} color_map {{ [0 rgb 0] [1 rgb 1] }} }}
  finish {{ ambient 0 diffuse 0 emission 1 }}
}}
"""


def depth_range(view, box):
    corners = [[box[a][0], box[b][1], box[c][2]] for a in ("lo", "hi")
               for b in ("lo", "hi") for c in ("lo", "hi")]
    reach = [math.sqrt(dot(minus(c, view.position), minus(c, view.position))) for c in corners]
    return max(0.0, min(reach) * 0.9), max(reach) * 1.1


def sixteen_bits(path):
    """The first channel of a PNG of 16 bits, row by row (PNG, ISO 15948: filters 0 to 4)."""
    data, at, packed, width, height, channels = path.read_bytes(), 8, b"", 0, 0, 3
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
            channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
            assert bits == 16
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    raw, stride, step = zlib.decompress(packed), 2 * channels * width, 2 * channels
    before, values = bytearray(stride), []
    for j in range(height):
        kind = raw[j * (stride + 1)]
        line = bytearray(raw[j * (stride + 1) + 1:(j + 1) * (stride + 1)])
        for k in range(stride):
            left = line[k - step] if k >= step else 0
            above = before[k]
            corner = before[k - step] if k >= step else 0
            if kind == 4:
                guess = left + above - corner
                order = (abs(guess - left), abs(guess - above), abs(guess - corner))
                predicted = (left, above, corner)[order.index(min(order))]
            else:
                predicted = (0, left, above, (left + above) // 2)[kind]
            line[k] = (line[k] + predicted) & 255
        values += [line[k] << 8 | line[k + 1] for k in range(0, stride, step)]
        before = line
    return values


def povray(folder, scene, view, box, accuracy, gradient, digits, threads):
    path = folder / f"{digits}.pov"
    path.write_text(pov_scene(scene, view, box, accuracy, gradient, digits))
    result = subprocess.run(
        ["povray", f"+I{path}", f"+O{folder / digits}.png", f"+W{view.width}", f"+H{view.height}",
         "+FN16", "File_Gamma=1", "-D", "-A", f"+WT{threads}", "-P"],
        capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise RuntimeError(result.stderr[-2000:])
    spent = re.search(r"Trace Time:.*?\(([\d.]+) seconds\)", result.stderr)
    processor = re.search(r"with ([\d.]+) CPU-seconds", result.stderr[spent.end():])
    both = float(spent.group(1)), float((processor or spent).group(1))
    return both, sixteen_bits(folder / f"{digits}.png")


def run_povray(name, path, scene, view, box, reference, arguments):
    if not shutil.which("povray"):
        host.say("povray is not installed: left out (Debian's package povray)")
        return []
    gradient = greatest_gradient(scene, box)
    near, far = depth_range(view, box)
    least_width = min(e.get("width", 1) for e in scene["elements"])
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for accuracy in arguments.tolerances.split(","):
            seconds = [povray(folder, scene, view, box, accuracy, gradient, "mask",
                              arguments.threads)[0] for _ in range(arguments.repeats)]
            high = povray(folder, scene, view, box, accuracy, gradient, "high",
                          arguments.threads)[1]
            low = povray(folder, scene, view, box, accuracy, gradient, "low", arguments.threads)[1]
            t = [near + (far - near) * (a + (b - 1000) / 60000) / 32768 if b > 0 else math.inf
                 for a, b in zip(high, low)]
            rows.append(row_of(name, view, "povray", accuracy, arguments.threads, seconds,
                               arguments.repeats, t, reference, least_width))
            host.say(f"{name}, povray {accuracy}: {rows[-1]['seconds']} s, {rows[-1]['wrong']} "
                     f"wrong, greatest error of t {rows[-1]['t_max']:.1e}")
    return rows


# isoray.

def run_isoray(name, path, scene, view, box, reference, arguments):
    try:
        import numpy as np
        from isoray.tracer.bisection import bisect_trace
        from isoray.tracer.ray import ray_aabb_intersect
        from isoray.tracer.refine import newton_refine
    except ImportError:
        host.say("isoray is not installed: left out (pip install isoray)")
        return []

    def distances(p):
        for e in scene["elements"]:
            if e["shape"] == "point":
                away = p - np.array(e["position"])
            elif e["shape"] == "segment":
                m, v = np.subtract(e["b"], e["a"]), p - np.array(e["a"])
                away = v - np.clip(v @ m / (m @ m), 0, 1)[:, None] * m
            else:
                n, v = np.array(unit(e["normal"])), p - np.array(e["center"])
                h = v @ n
                rho = np.linalg.norm(v - h[:, None] * n, axis=1)
                yield e, np.hypot(rho - e["radius"], h)
                continue
            yield e, np.linalg.norm(away, axis=1)

    def field(p):
        total = -scene["threshold"]
        for e, d in distances(p):
            total = total + e.get("strength", 1) * np.exp(-(d / e.get("width", 1)) ** 2)
        return -total, None

    class Inclusion:
        def evaluate(self, lo, hi):
            half = np.linalg.norm(hi - lo, axis=1) / 2
            least = greatest = -scene["threshold"]
            for e, d in distances((lo + hi) / 2):
                b, w = e.get("strength", 1), e.get("width", 1)
                near = np.exp(-(np.maximum(d - half, 0) / w) ** 2)
                far = np.exp(-((d + half) / w) ** 2)
                least = least + b * (far if b > 0 else near)
                greatest = greatest + b * (near if b > 0 else far)
            return -greatest, -least

    directions = np.array([view.direction(i, j) for j in range(view.height)
                           for i in range(view.width)])
    origins = np.broadcast_to(np.array(view.position, float), directions.shape).copy()
    least_width = min(e.get("width", 1) for e in scene["elements"])
    rows = []
    for tolerance in arguments.tolerances.split(","):
        seconds = []
        for _ in range(arguments.repeats):
            start, processor = time.perf_counter(), time.process_time()
            t_min, t_max, inside = ray_aabb_intersect(
                origins, directions, np.array(box["lo"]), np.array(box["hi"]))
            result = bisect_trace(origins, directions, t_min, t_max, inside, Inclusion(), field,
                                  max_depth=60, threshold=float(tolerance) * least_width)
            t = newton_refine(result.t, origins, directions, result.hit, field,
                              t_lo=result.t_lo, t_hi=result.t_hi)
            seconds.append((time.perf_counter() - start, time.process_time() - processor))
        t = [float(x) if hit else math.inf for x, hit in zip(t, result.hit)]
        rows.append(row_of(name, view, "isoray", tolerance, 1, seconds, arguments.repeats, t,
                           reference, least_width))
        host.say(f"{name}, isoray {tolerance}: {rows[-1]['seconds']:.3f} s, {rows[-1]['wrong']} "
                 f"wrong, greatest error of t {rows[-1]['t_max']:.1e}")
    return rows


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run peers", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="figure-1-17,figure-2-23")
    parser.add_argument("--tolerances", default=",".join(SWEEP))
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--threads", default="1", help="of POV-Ray")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    rows = []
    for name in arguments.scenes.split(","):
        path = scenes.write(host.BUILD / "scenes", [name])[name]
        scene = json.loads(path.read_text())
        for element in scene["elements"]:
            if (element["shape"] not in ("point", "segment", "circle")
                    or element.get("kernel", "blinn") != "blinn"
                    or isinstance(element.get("width"), list)):
                raise SystemExit(f"peers: {name} has what they are not given here: {element}")
        info = json.loads(host.output_of([str(host.IVORY), "info", str(path), "--json"]))
        view = View(scene["camera"], width, height)
        reference = Reference(path, width, height)
        for contestant in (run_povray, run_isoray):
            rows += contestant(name, path, scene, view, info["box"], reference, arguments)
    if not rows:
        raise SystemExit("peers: none of them is installed")
    facts = host.facts()
    host.write_csv(arguments.output / "peers.csv", [row | facts for row in rows])
    if (arguments.output / "error_against_time.csv").is_file():
        host.plot(arguments.output)


if __name__ == "__main__":
    main()
