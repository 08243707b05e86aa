#!/usr/bin/env python3
"""Run time against error: scenes x methods x tolerances, every run compared with a reference."""

import argparse
import csv
import io
import pathlib
import subprocess

import host
import scenes

TABLE = ["figure-1-17", "figure-2-23", "mixed-100"]
# With all shapes, and few pixels: most methods take long for each ray.
SHAPES = ["mixed-all-100", "mixed-all-1000", "curves-1000", "tapers-10000"]
BEARABLE = {"size": "48x27", "tolerances": "1e-2,1e-4,1e-6", "limit": "20", "repeats": "1"}


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run error_against_time",
                                     description=__doc__)
    parser.add_argument("--scenes", default=",".join(TABLE),
                        help="of tests/benchmarks/scenes.py or paths, split by commas; `shapes`: "
                        "those with all shapes, small")
    parser.add_argument("--methods", help="all by default")
    parser.add_argument("--tolerances", help="1e-2,1e-3,...,1e-12 by default")
    parser.add_argument("--size", help="480x270 by default")
    parser.add_argument("--threads", default="1")
    parser.add_argument("--repeats", help="3 by default")
    parser.add_argument("--limit", help="seconds, 10 by default; slower pictures are stopped")
    parser.add_argument("--processor", action="store_true",
                        help="draw processor time: on a machine that others use too")
    parser.add_argument("--output", type=pathlib.Path, default=host.RESULTS)
    arguments = parser.parse_args()

    defaults = {"size": "480x270", "limit": "10", "repeats": "3"}
    if arguments.scenes == "shapes":
        arguments.scenes, defaults = ",".join(SHAPES), BEARABLE
    for name, value in defaults.items():
        if getattr(arguments, name) is None:
            setattr(arguments, name, value)
    width, height = arguments.size.split("x")
    facts = host.facts()
    rows = []
    for name in arguments.scenes.split(","):
        path = pathlib.Path(name)
        if not path.is_file():
            path = scenes.write(host.BUILD / "scenes", [name])[name]
        command = [str(host.BUILD / "tests" / "benchmarks" / "error_against_time"), str(path),
                   "--name", path.name.removesuffix(".ivory.json"),
                   "--width", width, "--height", height, "--threads", arguments.threads,
                   "--repeats", arguments.repeats, "--limit", arguments.limit]
        if arguments.methods:
            command += ["--methods", arguments.methods]
        if arguments.tolerances:
            command += ["--tolerances", arguments.tolerances]
        host.say(f"{name} ...")
        text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
        rows += [row | facts for row in csv.DictReader(io.StringIO(text))]
    host.write_csv(arguments.output / "error_against_time.csv", rows)
    host.plot(arguments.output, *(["--processor"] if arguments.processor else []))


if __name__ == "__main__":
    main()
