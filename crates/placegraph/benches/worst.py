#!/usr/bin/env python3
"""Inputs that could make the program slow, beside an ordinary building: prints the tables of docs/worst-cases.md and writes its plot.

usage: worst.py PROGRAM [--size 1000] [--plot worst-cases.svg] [NAME...]

Every map is labeled on one thread, once with SIZE x SIZE cells and once with four times as many, and time and memory of every stage are
told for each free cell. PROGRAM is the program `placegraph`, as it is built for users (--release).
"""

import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import plots

FREE, WALL, UNKNOWN = 254, 0, 205
# Runs a program and tells its seconds and the most memory it had: a process that is started directly has that of who starts it at least.
MEASURE = """
import os, sys
quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
program = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=quiet)
_, status, usage = os.wait4(program, 0)
print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss)
"""
STAGES = ["classify", "smooth", "doorways", "spaces", "regions", "correct", "topology"]
LIMIT = 5.0


class Drawing:
    """A map of size x size cells, all walls at first."""

    def __init__(self, size, fill=WALL):
        self.size, self.rows = size, [bytearray([fill]) * size for _ in range(size)]

    def box(self, x, y, width, height, value=FREE):
        x, y = max(x, 0), max(y, 0)
        width, height = min(width, self.size - x), min(height, self.size - y)
        for row in self.rows[y : y + max(height, 0)]:
            row[x : x + width] = bytes([value]) * max(width, 0)

    def write(self, folder, resolution_m):
        (folder / "map.pgm").write_bytes(b"P5\n%d %d\n255\n" % (self.size, self.size) + b"".join(self.rows))
        (folder / "map.yaml").write_text(
            f"image: map.pgm\nresolution: {resolution_m}\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")


def office(size):
    """Corridors of 2 m every 13 m, and rooms of 4 by 5 m with a door on both sides of them."""
    map = Drawing(size)
    for y in range(2, size, 260):
        map.box(2, y + 106, size - 4, 40)
        for x in range(2, size - 84, 84):
            for low, door in ((y + 2, y + 102), (y + 150, y + 146)):
                map.box(x, low, 80, 100)
                map.box(x + 30, door, 18, 4)
    return map


def hall(size):
    map = Drawing(size)
    map.box(1, 1, size - 2, size - 2)
    return map


def noise(share):
    def draw(size):
        dice, map = random.Random(1), hall(size)
        for row in map.rows:
            for x in range(size):
                if dice.random() < share:
                    row[x] = WALL
        return map

    return draw


def chessboard(side):
    def draw(size):
        map = Drawing(size)
        for y in range(0, size, side):
            for x in range((y // side) % 2 * side, size, 2 * side):
                map.box(x, y, side, side)
        return map

    return draw


def comb(size):
    """Dead ends of half a meter on both sides of a spine."""
    map = Drawing(size)
    map.box(1, size // 2 - 10, size - 2, 20)
    for x in range(1, size - 12, 14):
        map.box(x, 1, 10, size - 2)
    return map


def maze(side):
    """A random tree of ways that are `side` cells wide, with walls of two cells."""

    def draw(size):
        dice, map, step = random.Random(1), Drawing(size), side + 2
        n = (size - 2) // step
        seen, way = {(0, 0)}, [(0, 0)]
        map.box(2, 2, side, side)
        while way:
            x, y = way[-1]
            ahead = [(x + dx, y + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))]
            ahead = [(u, v) for u, v in ahead if 0 <= u < n and 0 <= v < n and (u, v) not in seen]
            if not ahead:
                way.pop()
                continue
            u, v = dice.choice(ahead)
            seen.add((u, v))
            way.append((u, v))
            map.box(2 + min(x, u) * step, 2 + min(y, v) * step, side + abs(u - x) * step, side + abs(v - y) * step)
        return map

    return draw


def spiral(size):
    """One way of a meter, from the rim to the middle."""
    map, at = Drawing(size), 1
    while 2 * (at + 24) < size:
        end = size - 2 * at
        map.box(at, at, end, 20)
        map.box(at + end - 20, at, 20, end)
        map.box(at, at + end - 20, end, 20)
        map.box(at, at + 24, 20, end - 24)
        map.box(at + 20, at + 24, 4, 20)
        at += 24
    return map


def cells_apart(size):
    """Rooms of 0.4 m without doors: places without neighbors, if they are any."""
    map = Drawing(size)
    for y in range(1, size - 9, 10):
        for x in range(1, size - 9, 10):
            map.box(x, y, 8, 8)
    return map


def cells_joined(size):
    """The same with doors of 0.2 m."""
    map = cells_apart(size)
    for at in range(1, size - 9, 10):
        map.box(1, at + 2, size - 4, 4)
    return map


def doors(size):
    """Rooms of 1.5 m with doors of 0.9 m to all four sides."""
    map = Drawing(size)
    for y in range(1, size - 33, 33):
        for x in range(1, size - 33, 33):
            map.box(x, y, 31, 31)
            map.box(x + 7, y, 18, 34)
            map.box(x, y + 7, 34, 18)
    return map


def closets(size):
    """Rooms of 1.3 by 1.5 m on both sides of corridors, each with a door of 0.8 m: seven doors on ten square meters."""
    map = Drawing(size)
    for y in range(1, size - 98, 100):
        map.box(1, y + 34, size - 2, 28)
        for x in range(1, size - 27, 28):
            for low, door in ((y, y + 30), (y + 66, y + 62)):
                map.box(x, low, 26, 30)
                map.box(x + 5, door, 16, 4)
    return map


def rays(size):
    """Wedges of a star: narrow places of every width at one spot."""
    map = hall(size)
    middle = size / 2
    for y, row in enumerate(map.rows):
        for x in range(size):
            dx, dy = x - middle, y - middle
            if dx * dx + dy * dy > 400 and (int(abs(dx * 37 - dy * 11)) // 64 + int(abs(dy * 29 + dx * 17)) // 64) % 7 == 0:
                row[x] = WALL
    return map


# Name, drawing, meters a cell.
CASES = [
    ("ordinary offices", office, 0.05),
    ("one empty hall", hall, 0.05),
    ("random noise, 1 %", noise(0.01), 0.05),
    ("random noise, 10 %", noise(0.1), 0.05),
    ("random noise, 40 %", noise(0.4), 0.05),
    ("chessboard of single cells", chessboard(1), 0.05),
    ("chessboard of 8 cells", chessboard(8), 0.05),
    ("comb", comb, 0.05),
    ("maze, ways of 0.3 m", maze(6), 0.05),
    ("maze, ways of 1 m", maze(20), 0.05),
    ("spiral", spiral, 0.05),
    ("rooms of 0.4 m, closed", cells_apart, 0.05),
    ("rooms of 0.4 m with doors", cells_joined, 0.05),
    ("closets along corridors", closets, 0.05),
    ("doors in all walls", doors, 0.05),
    ("a star of stripes", rays, 0.05),
    ("offices at 1 cm a cell", office, 0.01),
    ("offices at 0.5 cm a cell", office, 0.005),
    ("empty hall at 1 cm a cell", hall, 0.01),
]


def run(program, draw, size, resolution_m):
    """Free cells, nanoseconds of every stage and bytes for each, places and doorways; `None` where the program refuses the map."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        map = draw(size)
        map.write(folder, resolution_m)
        n_free = sum(row.count(FREE) for row in map.rows)
        command = [program, "map", folder / "map.yaml", "--threads", "1", "--out", folder / "out"]
        ran = subprocess.run([sys.executable, "-c", MEASURE, *command], capture_output=True, text=True)
        document = folder / "out" / "topology.json"
        if not document.exists():
            return None, ran.stderr.strip().splitlines()[-1]
        seconds, kilobytes = [float(word) for word in ran.stdout.split()]
        found = json.loads(document.read_text())
        ns = {stage: 1e6 * found["timings_ms"].get(stage, 0.0) / n_free for stage in STAGES}
        ns["whole"] = 1e9 * seconds / n_free
        n_doors = sum("doorway" in place for place in found["places"])
        return dict(free=n_free, ns=ns, bytes=1024 * kilobytes / n_free, places=len(found["places"]), doors=n_doors), None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--size", type=int, default=1000)
    parser.add_argument("--plot", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    args = parser.parse_args()
    print("| map | free cells | places, doorways | " + " | ".join([*STAGES, "whole run"]) + " | by ordinary offices | at four times the size | bytes a free cell |")
    print("|---|---|---|" + "---|" * (len(STAGES) + 4))
    ordinary, rows = None, []
    for name, draw, resolution_m in CASES:
        if args.names and name not in args.names and ordinary:
            continue
        (one, told), (four, told_four) = (run(args.program, draw, size, resolution_m) for size in (args.size, 2 * args.size))
        if one is None:
            print(f"| {name} | refused: {told} |", flush=True)
            continue
        ordinary = ordinary or one
        ratio = one["ns"]["whole"] / ordinary["ns"]["whole"]
        growth = f"{four['ns']['whole'] / one['ns']['whole']:.2f}" if four else f"refused: {told_four}"
        if four:
            worst = max((s for s in STAGES if one["ns"][s] > 20), key=lambda s: four["ns"][s] / one["ns"][s], default=None)
            growth += f" ({worst} {four['ns'][worst] / one['ns'][worst]:.2f})" if worst else ""
        stages = " | ".join(f"{one['ns'][s]:.0f}" for s in [*STAGES, "whole"])
        print(f"| {name} | {one['free']:,} | {one['places']:,}, {one['doors']:,} | {stages} | {ratio:.1f} | {growth} | {one['bytes']:.0f} |", flush=True)
        rows.append((name, ratio))
    if args.plot:
        args.plot.write_text(plots.bars(rows, "times"))
    slow = [name for name, ratio in rows if ratio > LIMIT]
    if slow:
        sys.exit(f"above {LIMIT:g} times the ordinary building: {', '.join(slow)}")


if __name__ == "__main__":
    main()
