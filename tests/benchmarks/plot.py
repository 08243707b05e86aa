#!/usr/bin/env python3
"""Draws the tables of a folder as SVG and PNG."""

import argparse
import csv
import pathlib
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402

matplotlib.rcParams.update({
    "svg.hashsalt": "ivory", "font.size": 9, "axes.grid": True, "grid.color": "#dddddd",
    "grid.linewidth": 0.5, "axes.axisbelow": True, "axes.spines.top": False,
    "axes.spines.right": False, "legend.frameon": False, "figure.dpi": 110})

# One look for every method, wherever it is drawn; ours stands out.
LOOK = {
    "proved": ("#b5521b", "o", 2.4),
    "bisection": ("#30638e", "s", 1.2),
    "affine": ("#7b4b94", "^", 1.2),
    "newton": ("#2e7d32", "v", 1.2),
    "sphere": ("#00838f", "D", 1.2),
    "segment": ("#a08000", "P", 1.2),
    "march": ("#777777", "X", 1.2),
    "povray": ("#c2185b", "*", 1.2),
    "isoray": ("#5d4037", "h", 1.2),
}


def rows_of(folder, name):
    path = folder / name
    if not path.is_file():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def number(row, key):
    return float(row[key]) if row.get(key) else float("nan")


TIME = "seconds"  # the column that is drawn


def microseconds(row):
    """A pixel; of all processors together where processor time is drawn."""
    return number(row, TIME) / number(row, "pixels") * 1e6


def time_label():
    return "microseconds a pixel" if TIME == "seconds" else "processor microseconds a pixel"


def save(figure, folder, name):
    for kind in ("svg", "png"):
        figure.savefig(folder / f"{name}.{kind}", bbox_inches="tight",
                       metadata={"Date": None} if kind == "svg" else None)
    plt.close(figure)
    print(folder / f"{name}.svg")


def origin(row):
    return f"{row['cpu']}, {row['target']}, {row['threads']} thread(s), " \
           f"{row['width']}x{row['height']}, commit {row['commit']}, {row['date'][:10]}"


def finished(rows):
    return [row for row in rows if row["method"] in LOOK and row["complete"] == "1"]


def by_method(rows):
    groups = defaultdict(list)
    for row in rows:
        groups[row["method"]].append(row)
    return sorted(groups.items(), key=lambda item: list(LOOK).index(item[0]))


def draw_curves(axis, rows, error, label_y):
    """Time per pixel over error; a line joins the tolerances of one method."""
    for method, runs in by_method(rows):
        color, marker, width = LOOK[method]
        runs = [run for run in runs if number(run, error) > 0 or error == "wrong"]
        runs.sort(key=lambda run: -number(run, "tolerance"))
        x = [microseconds(run) for run in runs]
        y = [number(run, error) for run in runs]
        if error.startswith("t_"):
            y = [value / number(run, "least_width") for value, run in zip(y, runs)]
        if error == "wrong":
            y = [value / number(run, "pixels") for value, run in zip(y, runs)]
        axis.plot(x, y, color=color, marker=marker, markersize=4, linewidth=width, label=method)
    axis.set_xscale("log")
    axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axis.xaxis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:g}"))
    axis.xaxis.set_minor_formatter(ticker.NullFormatter())
    if error == "wrong":
        axis.set_yscale("symlog", linthresh=1e-6)
        axis.set_ylim(bottom=0)
    else:
        axis.set_yscale("log")
    axis.set_ylabel(label_y)


def look_line(axis, rows):
    for row in rows:
        if row["method"] == "one look":
            axis.axvline(microseconds(row), color="#999999", linestyle=":", linewidth=1)


def pareto(folder, table, peers):
    scenes = list(dict.fromkeys(row["scene"] for row in table))
    wanted = [("t_max", "greatest error of t\n(least widths)"), ("t_rms", "RMS error of t"),
              ("normal_max", "greatest error of\nthe normal (radians)"),
              ("wrong", "wrong pixels (share)")]
    figure, axes = plt.subplots(len(wanted), len(scenes), squeeze=False,
                                figsize=(4.2 * len(scenes), 2.6 * len(wanted)))
    for column, scene in enumerate(scenes):
        rows = [row for row in table + peers if row["scene"] == scene]
        for line, (error, label) in enumerate(wanted):
            axis = axes[line][column]
            draw_curves(axis, finished(rows), error, label if column == 0 else "")
            look_line(axis, rows)
            if line == 0:
                axis.set_title(scene)
            if line == len(wanted) - 1:
                axis.set_xlabel(time_label())
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    figure.suptitle(origin(table[0]), fontsize=8, y=1.0)
    figure.tight_layout()
    save(figure, folder, "error_against_time")


def differences(folder, table):
    scenes = list(dict.fromkeys(row["scene"] for row in table))
    figure, axis = plt.subplots(figsize=(5, 3.2))
    for scene in scenes:
        rows = [row for row in table
                if row["scene"] == scene and row["method"] == "central differences"]
        if not rows:
            continue
        rows.sort(key=lambda row: number(row, "delta"))
        line, = axis.loglog([number(row, "delta") for row in rows],
                            [number(row, "normal_max") for row in rows], marker="o", markersize=3,
                            label=f"{scene}, greatest")
        axis.loglog([number(row, "delta") for row in rows],
                    [number(row, "normal_rms") for row in rows], linestyle="--", linewidth=1,
                    color=line.get_color(), label=f"{scene}, RMS")
    axis.set_xlabel("delta of central differences (least widths)")
    axis.set_ylabel("error of the normal (radians)")
    axis.legend(loc="upper left", bbox_to_anchor=(1, 1))
    save(figure, folder, "normal_by_differences")


def chart(folder, table, peers, name="chart"):
    """Greatest error over time, scenes side by side."""
    scenes = list(dict.fromkeys(row["scene"] for row in table))[:3]
    figure, axes = plt.subplots(1, len(scenes), squeeze=False, figsize=(3.6 * len(scenes), 3.3),
                                sharey=True)
    for axis, scene in zip(axes[0], scenes):
        rows = [row for row in table + peers if row["scene"] == scene]
        draw_curves(axis, finished(rows), "t_max",
                    "greatest error of t (least widths)" if axis is axes[0][0] else "")
        look_line(axis, rows)
        axis.set_title(scene)
        axis.set_xlabel(time_label())
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    figure.text(0.01, -0.03, origin(table[0]) + ". Dotted: field, gradient, colour and light once "
                "at every pixel that is hit.", fontsize=7, color="#555555")
    figure.tight_layout()
    save(figure, folder, name)


def growth(folder, table):
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.3))
    kinds = [("elements", "elements", "milliseconds"), ("pixels", "pixels", "milliseconds"),
             ("threads", "threads", "milliseconds")]
    for axis, (kind, label, unit) in zip(axes, kinds):
        series = defaultdict(list)
        for row in table:
            if row["kind"] == kind:
                series[(row["scene_kind"], row["target"])].append(
                    (number(row, kind), 1e3 * number(row, "seconds")))
        for (scene, target), points in sorted(series.items()):
            points.sort()
            axis.plot(*zip(*points), marker="o", markersize=4, label=f"{scene}, {target}")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel(label)
        axis.set_ylabel(unit)
        if series:
            axis.legend(fontsize=7)
    figure.tight_layout()
    save(figure, folder, "growth")


def main():
    parser = argparse.ArgumentParser(prog="tests/benchmarks/run plot", description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="with the CSV files; the plots go there")
    parser.add_argument("--processor", action="store_true",
                        help="draw processor time: on a machine that others use too")
    arguments = parser.parse_args()
    if arguments.processor:
        global TIME
        TIME = "processor_seconds"
    table = rows_of(arguments.folder, "error_against_time.csv")
    peers = rows_of(arguments.folder, "peers.csv")
    if table:
        pareto(arguments.folder, table, peers)
        differences(arguments.folder, table)
        chart(arguments.folder, table, peers)
    grown = rows_of(arguments.folder, "growth.csv")
    if grown:
        growth(arguments.folder, grown)
    if not table and not grown:
        raise SystemExit(f"plot.py: {arguments.folder} has neither error_against_time.csv nor "
                         "growth.csv")


if __name__ == "__main__":
    main()
