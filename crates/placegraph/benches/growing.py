#!/usr/bin/env python3
"""How steady results are while a map grows, and what a session saves: prints the table of docs/ros2.md.

usage: growing.py PROGRAM [--buildings 10] [--steps 30] [--first 0] [--no-hold]

A simulated robot maps buildings (`placegraph generate --growing`), and `placegraph replay --check` labels the map after every few scans in a
session, and anew with the result before as the earlier one. PROGRAM is the program `placegraph`, as it is built for users (--release).
"""

import argparse
import csv
import json
import pathlib
import shutil
import statistics
import subprocess
import tempfile

STYLES = ["home", "office", "hospital", "hotel", "school"]
SMALL = 0.9  # steps in which so many scans are known again change little


def steps_of(program, folder, style, seed, n_steps):
    """The folder of one building, with its map after more and more scans in `n_steps` steps, the last of which is the whole map."""
    generate = [program, "generate", "--style", style, "--seed", str(seed), "--resolution", "0.05", "--growing", "5"]
    subprocess.run([*generate, "--out", folder / "made"], check=True, capture_output=True)
    (building,) = (folder / "made").iterdir() if (folder / "made").is_dir() else ()
    maps = sorted((building / "growing").glob("*.yaml"))
    chosen = {round(k * (len(maps) - 1) / max(n_steps - 2, 1)) for k in range(n_steps - 1)}
    for number, path in enumerate(maps):
        if number not in chosen:
            path.unlink()
    last = building / "growing" / "whole"
    last.mkdir()
    for name in ["map.yaml", "map.png"]:
        shutil.copy(building / name, last / name)
    return building


def replay(program, folder, building, options):
    """The rows of the replay's table, and the share of the last labels that are right."""
    out = folder / "steps"
    command = [program, "replay", building / "growing", "--check", "--out", out, *options]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"a step is not what a fresh run gives: {done.stderr}"
    evaluate = [program, "evaluate", out / "labels.png", building / "labels.png", "--json"]
    judged = json.loads(subprocess.run(evaluate, check=True, capture_output=True).stdout)
    with open(out / "replay.csv", newline="") as file:
        return list(csv.DictReader(file)), 100 * judged["cells"]["accuracy"]


def row(name, steps, right):
    """A line of the table. The first step of a building has nothing before it."""
    number = lambda step, key: float(step[key])
    total = lambda key: sum(int(step[key]) for step in steps)
    flicker = [100 * number(step, "relabeled") for step in steps]
    ratio = lambda of: 100 * sum(number(s, "seconds") for s in of) / max(sum(number(s, "fresh_seconds") for s in of), 1e-9)
    same = lambda step: number(step, "reused") * number(step, "free_cells")
    small = [step for step in steps if number(step, "reused") >= SMALL]
    shares = [
        name,
        f"{len(steps)}",
        f"{100 * statistics.mean(number(step, 'reused') for step in steps):.0f} %",
        f"{statistics.mean(flicker):.2f} %, {statistics.median(flicker):.2f} %, {max(flicker):.1f} %",
        f"{sum(share > 1 for share in flicker)}",
        f"{100 * sum(same(s) * number(s, 'flicker') for s in steps) / max(sum(same(s) for s in steps), 1):.2f} %",
        f"{total('there_kept')} of {total('there')}: {100 * total('there_kept') / max(total('there'), 1):.1f} %",
        f"{total('doorways_lost')} of {total('doorways')}, {total('doorways_found')}",
        f"{ratio(steps):.0f} %",
        f"{ratio(small):.0f} % ({len(small)})" if small else "none",
        f"{statistics.mean(right):.1f} %",
    ]
    print(f"| {' | '.join(shares)} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--buildings", type=int, default=10)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--no-hold", action="store_true")
    args = parser.parse_args()
    options = ["--no-hold"] if args.no_hold else []
    print(
        "| building | steps | scans known again | cells with another label: mean, median, largest | steps with more than 1 % | the same of cells whose scan is the same | places still there "
        "that keep their number | doorways lost, found again | time of a session, by that of fresh runs | the same, small steps | last labels right |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    all_steps, all_right = [], []
    for number in range(args.first, args.first + args.buildings):
        style, seed = STYLES[number % len(STYLES)], 70 + number
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            building = steps_of(args.program.resolve(), folder, style, seed, args.steps)
            steps, right = replay(args.program.resolve(), folder, building, options)
        row(f"{style} {seed}", steps[1:], [right])
        all_steps += steps[1:]
        all_right.append(right)
    row("**all**", all_steps, all_right)


if __name__ == "__main__":
    main()
