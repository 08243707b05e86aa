"""What every table of the benchmarks says of its origin, and where things are."""

import csv
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = pathlib.Path(os.environ.get("IVORY_BENCHMARK_BUILD", ROOT / "build" / "benchmarks"))
IVORY = BUILD / "app" / "ivory"
RESULTS = ROOT / "build" / "benchmarks" / "results"
COLUMNS = ["commit", "compiler", "cpu", "cores", "target", "date"]


def say(text):
    print(text, file=sys.stderr, flush=True)


def output_of(command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def commit():
    hash_ = output_of(["git", "-C", str(ROOT), "rev-parse", "--short=10", "HEAD"])
    changed = output_of(["git", "-C", str(ROOT), "status", "--porcelain", "--untracked-files=no"])
    return (hash_ or "unknown") + ("+changes" if changed else "")


def compiler():
    cache = (BUILD / "CMakeCache.txt").read_text().splitlines()
    path = next((line.split("=", 1)[1] for line in cache
                 if line.startswith("CMAKE_CXX_COMPILER:")), "")
    return (output_of([path, "--version"]).splitlines() or ["unknown"])[0] if path else "unknown"


def cpu():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"


def render(scene, *options, env=None):
    """The statistics of one `ivory render`."""
    command = [str(IVORY), "render", str(scene), "--stats", "-", "--quiet", *map(str, options)]
    result = subprocess.run(command, capture_output=True, text=True, env=env, check=False)
    if result.returncode != 0:
        raise SystemExit(result.stderr.strip() or f"ivory render failed on {scene}")
    return json.loads(result.stdout)


def facts():
    """The columns that every row ends with."""
    scene = ROOT / "assets" / "scenes" / "figure-1.ivory.json"
    target = render(scene, "--size", "16x16", "--depth", "/dev/null")["target"]
    now = datetime.datetime.now(datetime.timezone.utc).replace(microsecond=0)
    return dict(zip(COLUMNS, [commit(), compiler(), cpu(), os.cpu_count(), target,
                              now.isoformat()]))


def instruction_sets(scene):
    """Those that the machine has, best first."""
    known = ["AVX-512", "AVX2", "SSE4", "SSE2", "NEON", "SCALAR"]
    return [name for name in known if subprocess.run(
        [str(IVORY), "render", str(scene), "--size", "16x16", "--instructions", name, "--stats",
         os.devnull, "--quiet"], capture_output=True, check=False).returncode == 0]


def write_csv(path, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    say(f"wrote {path}")


def plot(folder, *options):
    """Debian's Python has Debian's matplotlib."""
    for python in ("/usr/bin/python3", sys.executable):
        if subprocess.run([python, "-c", "import matplotlib"], capture_output=True,
                          check=False).returncode == 0:
            subprocess.run([python, str(HERE / "plot.py"), str(folder), *options],
                           check=True)
            return
    say("no matplotlib: the tables are written, the plots are not")
