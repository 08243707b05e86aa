#!/usr/bin/env python3
"""What a shape costs: scenes of one shape beside the same scenes with every element replaced by a
segment of the same length and width (a disc's diameter, the greatest distance of two vertices of a
polygon, the length of a curve and of a chain; the mean of a taper's widths), in the same places. So that
these cover about as many pixels, their widths are multiplied by what does it, or with `--match number`
there are more or fewer of them. `polyline-7` is polylines beside the seven segments of each, whose fields
add up at the joints; nothing is made alike there.

Pictures of the two are made by turns; a row has the median of the pairs' ratios, by the clock and by the
processors' time (of the whole program, reading and all, so a little nearer to 1)."""

import argparse
import itertools
import json
import math
import os
import pathlib
import random
import statistics
import subprocess

import host
import scenes

SHAPES = ["disc", "taper", "polygon", "curve", "polyline", "polyline-7"]


def distance(a, b):
    return math.dist(a, b)


def length(element):
    shape = element["shape"]
    if shape == "disc":
        return 2 * element["radius"]
    if shape == "polygon":
        return max(distance(a, b) for a, b in itertools.combinations(element["vertices"], 2))
    if shape == "curve":
        points = [bezier(element["control_points"], k / 64) for k in range(65)]
    elif shape == "polyline":
        points = element["points"]
    else:
        points = [element["a"], element["b"]]
    return scenes.total(distance(a, b) for a, b in zip(points, points[1:]))


def bezier(points, u):
    while len(points) > 1:
        points = [[(1 - u) * x + u * y for x, y in zip(p, q)] for p, q in zip(points, points[1:])]
    return points[0]


def taper(center, axis, half, numbers):
    """Its second width; `pairs` adds the first."""
    return scenes.segment(center, axis, half, numbers) | {"wide": numbers.uniform(1, 2)}


MAKERS = {"disc": scenes.disc, "taper": taper, "polygon": scenes.polygon, "curve": scenes.cubic,
          "polyline": scenes.chain}


def pairs(shape, count, thin, wanted):
    """So many elements with the rule for `mixed` of count, their widths times `thin`, and what replaces
    each: lists."""
    kind = shape.partition("-")[0]
    s, w = (x * math.sqrt(1000 / count) for x in (0.12, 0.04 * thin))
    numbers = random.Random(scenes.SEED)
    for _ in range(wanted):
        center, axis = scenes.in_ball(numbers), scenes.direction(numbers)
        element = MAKERS[kind](center, axis, s * numbers.uniform(0.5, 1), numbers)
        width, color = numbers.uniform(w, 2 * w), scenes.color(numbers)
        rest = {"width": round(width, 6), "color": color}
        if kind == "taper":
            widths = scenes.rounded([width, w * element.pop("wide")])
            replaced = [element | {"width": round(scenes.total(widths) / 2, 6), "color": color}]
            yield element | {"width": widths, "color": color}, replaced
        elif shape == "polyline-7":
            points = element["points"]
            yield element | rest, [{"shape": "segment", "a": a, "b": b} | rest
                                   for a, b in zip(points, points[1:])]
        else:
            segment = scenes.segment(center, axis, length(element) / 2, numbers)
            yield element | rest, [segment | rest]


def write(name, elements):
    path = host.BUILD / "scenes" / f"{name}.ivory.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(scenes.text({"ivory": 1, "threshold": 0.5, "camera": scenes.camera_at(3.9),
                                 "elements": elements}))
    return path


def hits(path, arguments):
    size = min("480x270", arguments.size, key=lambda text: int(text.partition("x")[0]))
    return host.render(path, "--size", size, "--threads", arguments.threads,
                       "--depth", os.devnull)["pixels"]["hit"]


def widened(segments, factor):
    return [segment | {"width": round(factor * segment["width"], 6)} for segment in segments]


def as_many_pixels(name, segments, aim, arguments):
    """Those of the segments that cover so many pixels, nearly, or the first of them with other widths."""
    by_number = arguments.match == "number"
    low, high = (0, 1) if by_number else (0.25, 4)

    def some(x):
        if by_number:
            return segments[:max(1, round(x * len(segments)))]
        return widened(segments[:arguments.elements], x)

    for _ in range(7):
        middle = (low + high) / 2 if by_number else math.sqrt(low * high)
        if hits(write(name, some(middle)), arguments) < aim:
            low = middle
        else:
            high = middle
    return some(high)


def timed(path, arguments, repeat):
    """The statistics and the processors' seconds of one picture."""
    command = [str(host.IVORY), "render", str(path), "--stats", "-", "--quiet", "--depth", os.devnull,
               "--size", arguments.size, "--tolerance", arguments.tolerance, "--threads",
               arguments.threads, "--repeat", str(repeat)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"ivory render failed on {path}")
    return json.loads(text), (usage.ru_utime + usage.ru_stime) / repeat


def measured(shape, arguments):
    count = arguments.elements
    made = list(itertools.islice(pairs(shape, count, arguments.thin, 4 * count), 4 * count))
    ours = write(f"{shape}-{count}", [element for element, _ in made[:count]])
    segments = [segment for _, replaced in made for segment in replaced]
    name = f"{shape}-{count}-segments"
    if shape == "polyline-7":
        segments = segments[:7 * count]
    else:
        segments = as_many_pixels(name, segments, hits(ours, arguments), arguments)
    theirs = write(name, segments)
    repeats = {}
    for path in (ours, theirs):  # once to warm up, and to see how long it takes
        seconds = timed(path, arguments, 1)[0]["seconds"]["trace"]
        repeats[path] = min(max(round(0.5 / seconds), 1), 9)
    runs = [(timed(ours, arguments, repeats[ours]), timed(theirs, arguments, repeats[theirs]))
            for _ in range(arguments.pairs)]
    one, other = runs[-1][0][0], runs[-1][1][0]

    def median(of):
        return statistics.median(map(of, runs))

    row = {
        "shape": shape, "elements": count, "thin": arguments.thin, "segments": len(segments),
        "widths": segments[0]["width"] / made[0][1][0]["width"], "width": one["width"],
        "height": one["height"], "threads": arguments.threads, "tolerance": arguments.tolerance,
        "pairs": len(runs), "hits": one["pixels"]["hit"], "hits_of_segments": other["pixels"]["hit"],
        "unresolved": one["pixels"]["unresolved"],
        "trace": median(lambda r: r[0][0]["seconds"]["trace"]),
        "trace_of_segments": median(lambda r: r[1][0]["seconds"]["trace"]),
        "ratio": median(lambda r: r[0][0]["seconds"]["trace"] / r[1][0]["seconds"]["trace"]),
        "processor_ratio": median(lambda r: r[0][1] / r[1][1]),
        "alone": one["skipping"]["rays"]["alone"],
        "alone_of_segments": other["skipping"]["rays"]["alone"]}
    host.say("{shape}: {ratio:.2f} times ({processor_ratio:.2f} by processor time), {hits} and "
             "{hits_of_segments} pixels of {elements} elements and {segments} segments, {widths:.2f} times "
             "as wide".format(**row))
    return row


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run shapes", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", default=",".join(SHAPES))
    parser.add_argument("--elements", type=int, default=300)
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--tolerance", default="1e-6")
    parser.add_argument("--threads", default=str(os.cpu_count()))
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--thin", type=float, default=1, help="all widths are multiplied by that")
    parser.add_argument("--match", choices=["width", "number"], default="width")
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()
    facts = host.facts()
    rows = [measured(shape, arguments) | facts for shape in arguments.shapes.split(",")]
    host.write_csv(arguments.output / "shapes.csv", rows)


if __name__ == "__main__":
    main()
