#!/usr/bin/env python3
"""How the time grows: with the elements at the same covered area, the pixels, the threads, and
how it falls with better instruction sets.

Rows by threads have `side_by_side`, the time of as many independent runs of one thread at once: n
threads can at best take an n-th of it, and `efficiency` is the share of that which they reach."""

import argparse
import concurrent.futures
import os
import pathlib

import host
import scenes

FRAME = ["compile", "trace", "shade"]


def sizes(megapixels):
    """16:9, whole multiples of 16 wide."""
    width = max(16, round((megapixels * 1e6 * 16 / 9) ** 0.5 / 16) * 16)
    return f"{width}x{round(width * 9 / 16)}"


def measured(kind, value, name, path, size, arguments, threads=None, options=()):
    threads = threads or arguments.threads
    statistics = host.render(path, "--size", size, "--tolerance", arguments.tolerance,
                             "--threads", threads, "--repeat", arguments.repeats,
                             "--method", arguments.method, "-o", os.devnull, *options)
    seconds = statistics["seconds"]
    pixels = statistics["width"] * statistics["height"]
    row = {
        "kind": kind, kind: value, "scene_kind": name.rsplit("-", 1)[0], "scene": name,
        "width": statistics["width"], "height": statistics["height"], "threads": threads,
        "method": arguments.method, "tolerance": arguments.tolerance,
        "seconds": sum(seconds[part] for part in FRAME),
        **{part: seconds[part] for part in FRAME},
        "covered": statistics["pixels"]["hit"] / pixels,
        "unresolved": statistics["pixels"]["unresolved"],
        "evaluations": statistics["evaluations"],
        "element_evaluations": statistics["element_evaluations"],
        "reached": statistics["elements"]["reached"], "elements_total":
        statistics["elements"]["total"], "empty_tiles": statistics["tiles"]["empty"],
        "tiles": statistics["tiles"]["total"]}
    host.say(f"{kind} {value}, {name}, {size}: {1e3 * row['seconds']:.1f} ms")
    return row


def side_by_side(count, name, path, arguments):
    """The mean time of `count` runs of one thread each, at the same time."""
    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        runs = [pool.submit(measured, "threads", 1, name, path, arguments.size, arguments, 1)
                for _ in range(count)]
        return sum(run.result()["seconds"] for run in runs) / count


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run growth", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", default="10,100,1000,10000,100000")
    parser.add_argument("--megapixels", default="0.1,0.5,2,8")
    parser.add_argument("--threads-list", default=None, help="1, 2, 4 ... all cores by default")
    parser.add_argument("--scene", default="mixed-100", help="of the rows by pixels and threads")
    parser.add_argument("--size", default="1920x1080", help="of the rows by elements and threads")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--tolerance", default="1e-6")
    parser.add_argument("--method", default="proved")
    parser.add_argument("--repeats", default="5")
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()

    folder = host.BUILD / "scenes"
    rows = []
    for count in filter(None, arguments.elements.split(",")):
        name = f"points-{count}"
        rows.append(measured("elements", int(count), name, scenes.write(folder, [name])[name],
                             arguments.size, arguments))
    path = scenes.write(folder, [arguments.scene])[arguments.scene]
    for megapixels in filter(None, arguments.megapixels.split(",")):
        size = sizes(float(megapixels))
        rows.append(measured("pixels", round(float(megapixels) * 1e6), arguments.scene, path, size,
                             arguments))
    cores = os.cpu_count()
    counts = (arguments.threads_list.split(",") if arguments.threads_list is not None else
              sorted({1, cores, *(2 ** n for n in range(8) if 2 ** n < cores)}))
    for threads in map(int, counts):
        row = measured("threads", threads, arguments.scene, path, arguments.size, arguments,
                       threads)
        row["side_by_side"] = side_by_side(threads, arguments.scene, path, arguments)
        row["efficiency"] = row["side_by_side"] / (threads * row["seconds"])
        host.say(f"threads {threads}: {row['efficiency']:.3f} of what independent runs reach")
        rows.append(row)
    for name in host.instruction_sets(path):
        rows.append(measured("instructions", name, arguments.scene, path, arguments.size,
                             arguments, options=("--instructions", name)))
    facts = host.facts()
    keys = list(dict.fromkeys(key for row in rows for key in row))
    host.write_csv(arguments.output / "growth.csv",
                   [{key: row.get(key, "") for key in keys} | facts for row in rows])
    host.plot(arguments.output)


if __name__ == "__main__":
    main()
