"""Writes docs/performance.md, between its two marks, and its pictures from what was measured.

    python3 crates/placegraph/benches/page.py --run     # all benches and runs of the program, then the page
    python3 crates/placegraph/benches/page.py           # the page from what is there

Nothing but Python 3 is needed. The best of all samples counts: others may use the machine. The figures are read from
`target/criterion`, `target/peers.jsonl` (the scripts in `peers/`, run by hand) and `target/program.json`.
`PLACEGRAPH_DATA` names the folder of real maps; with `PLACEGRAPH_LARGE=1` maps of 10 and 100 M cells run too.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import plots

ROOT = Path(__file__).parents[3]
TARGET, DOCS = ROOT / "target", ROOT / "docs"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
BENCHES = ["engine", "stages", "regions", "amn", "learn", "relaxation"]
QUICK = ["--noplot", "--warm-up-time", "0.3", "--measurement-time", "1.5"]
KINDS = {"Widest": "AVX-512", "Avx2": "AVX2", "Baseline": "plain"}

# Multiplications with an addition per beam of a cell, counted in the source: the Fourier rows 24 x 10 (fourier.rs, add)
# and what is before them 60, clipped differences 50, moments 36 (two for each in f64), the rest 40.
PAIRS_PER_BEAM = 426
N_BEAMS = 360


class Measured:
    """Seconds of the best sample, and the throughput, of every benchmark: by group, function and parameter."""

    def __init__(self):
        self.rows = {}
        for file in sorted(TARGET.glob("criterion/**/new/benchmark.json")):
            bench = json.loads(file.read_text())
            sample = json.loads(file.with_name("sample.json").read_text())
            times = sorted(t / i * 1e-9 for t, i in zip(sample["times"], sample["iters"]))
            # The clock of the limits has coarse steps: their best sample would be better than the truth.
            best = times[len(times) // 2] if bench["group_id"] == "limits" else times[0]
            count = next(iter((bench["throughput"] or {"Elements": 1}).values()))
            key = (bench["group_id"], bench["function_id"], bench["value_str"])
            self.rows[key] = (best, count)
        peers = TARGET / "peers.jsonl"
        self.peers = {}
        for line in peers.read_text().splitlines() if peers.exists() else []:
            row = json.loads(line)
            self.peers[row["stage"], row["peer"], row["size"]] = row["seconds"]
        program = TARGET / "program.json"
        measured = json.loads(program.read_text()) if program.exists() else dict(maps=[], start=None)
        self.program, self.start = measured["maps"], measured["start"]

    def series(self, group, function):
        """(size, seconds, count) of all parameters of a function, by size."""
        rows = [(int(value), *row) for (g, f, value), row in self.rows.items() if (g, f) == (group, function)]
        return sorted(rows)

    def get(self, group, function, size=None):
        """(seconds, count) at a size, or of the middle one."""
        rows = self.series(group, function)
        if not rows:
            return None
        if size is not None:
            return next((row[1:] for row in rows if row[0] == size), None)
        return rows[len(rows) // 2][1:]

    def rate(self, name, kind):
        row = self.rows.get(("limits", name, kind))
        return row[1] / row[0] if row else None

    def memory(self, threads="one thread"):
        row = self.rows.get(("memory", threads, None))
        return row[1] / row[0] if row else None


def run_all():
    for bench in BENCHES:
        command = ["cargo", "bench", "-p", "placegraph", "--bench", bench, "--", *QUICK]
        subprocess.run(command, cwd=ROOT, check=True)
    subprocess.run(["cargo", "build", "--release", "-p", "placegraph-cli"], cwd=ROOT, check=True)
    run_program()


def run_program():
    """Runs `map` on maps of growing size and notes wall and processor seconds, the best, and the largest memory. Maps that are
    not run this time keep their rows."""
    maps = [("maps/office", ROOT / "maps/office/map.yaml")]
    if folder := os.environ.get("PLACEGRAPH_DATA"):
        maps.append(("fr79", Path(folder) / "eval/fr79_slam/map.yaml"))
    widths = [120, 160, 500, 1160] + ([3700, 11600] if os.environ.get("PLACEGRAPH_LARGE") else [])
    maps += [(f"tiled, {width} x {width * 3 // 4}", tiled(width)) for width in widths]
    rows = []
    for name, file in maps:
        best, peak, stages = [float("inf")] * 2, 0, {}
        for _ in range(5 if len(rows) < 6 else 1):
            out = TARGET / "program"
            subprocess.run(["rm", "-rf", out], check=True)
            command = [TARGET / "release/placegraph", "map", file, "--out", out]
            start = time.monotonic()
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode != 0:
                sys.exit(f"{command} failed")
            stages = min(stages, stages_of(out), key=lambda stages: sum(stages.values()) or float("inf"))
            best = [min(best[0], time.monotonic() - start), min(best[1], usage.ru_utime + usage.ru_stime)]
            peak = max(peak, usage.ru_maxrss * 1024)
        width, height, free = size_of(out)
        rows.append(dict(name=name, cells=width * height, free=free, wall=best[0], cpu=best[1], peak=peak,
                         stages=stages))
        print(rows[-1], flush=True)
    names = [row["name"] for row in rows]
    rows += [row for row in Measured().program if row["name"] not in names]
    (TARGET / "program.json").write_text(json.dumps(dict(maps=rows, start=start_up())))


def start_up():
    """Seconds from the start of the program to its end, when it has nothing to do."""
    def once():
        start = time.monotonic()
        subprocess.run([TARGET / "release/placegraph", "--version"], stdout=subprocess.DEVNULL, check=True)
        return time.monotonic() - start
    return min(once() for _ in range(20))


def tiled(width):
    """The map of benches/maps as a file: rooms of 90 x 70 cells with doors. Row by row: the memory of this process at the
    start of the program would count as the program's."""
    height = width * 3 // 4
    file = TARGET / f"tiled-{width}.pgm"
    with file.open("wb") as out:
        out.write(b"P5\n%d %d\n255\n" % (width, height))
        for y in reversed(range(height)):
            row = bytearray(b"\xfe") * width
            for x in range(width):
                column, line = x % 90, y % 70
                door = column == 0 and 20 <= line < 38 or line == 0 and 40 <= column < 58
                border = x in (0, width - 1) or y in (0, height - 1)
                if border or (x * 7919 + y * 104729) % 997 == 0 or (column == 0 or line == 0) and not door:
                    row[x] = 0
            out.write(row)
    yaml = file.with_suffix(".yaml")
    yaml.write_text(f"image: {file.name}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
                    "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return yaml


def size_of(out):
    """Width and height of a result's map, and the cells of its places."""
    topology = json.loads((out / "topology.json").read_text())
    grid = topology["map"]
    area = sum(place["area_m2"] for place in topology["places"])
    return grid["width"], grid["height"], round(area / grid["resolution_m"] ** 2)


def stages_of(out):
    """Milliseconds of the stages of a run."""
    return json.loads((out / "topology.json").read_text())["timings_ms"]


def cell(value, form, unit=""):
    return "not measured" if value is None else form.format(value) + unit


def brief(seconds):
    return f"{seconds:.2f} s" if seconds >= 0.1 else f"{seconds * 1e3:.0f} ms"


def per_cell(row):
    return None if row is None else row[0] / row[1] * 1e6


def ratio(slow, fast):
    return None if slow is None or fast is None else slow / fast


def of_limit(m, kind, seconds_per_cell, pairs):
    rate = m.rate("multiply and add", kind)
    return None if rate is None or seconds_per_cell is None else 100 * pairs * N_BEAMS / rate / (seconds_per_cell * 1e-6)


def bits_share(m, kind):
    row, rate = m.get("rays", f"operations, {kind}"), m.rate("bits", "Avx2" if kind == "Widest" else kind)
    return row and rate and 100 * row[1] / row[0] / rate


def targets(m):
    lines = ["| stage | target | measured | comparison, same run | share of the limit |", "|---|---|---|---|---|"]

    def add(*cells):
        lines.append("| " + " | ".join(cells) + " |")

    plain_rays = per_cell(m.get("rays", "traversal"))
    for kind, name in KINDS.items():
        own = per_cell(m.get("rays", kind))
        add(f"rays, exact, {name}", "0.5 G rays/s and core" if kind == "Widest" else "",
            cell(own and 1e-3 / own, "{:.2f}", " G rays/s"),
            cell(ratio(plain_rays, own), "{:.0f}", " times as fast as the scalar traversal"), cell(bits_share(m, kind), "{:.0f}", " % (bit operations)"))
    plain = per_cell(m.get("203 features", "plain formulas"))
    for group, pairs in [("203 features", PAIRS_PER_BEAM), ("all features", PAIRS_PER_BEAM), ("default model", None)]:
        for kind, name in KINDS.items():
            own = per_cell(m.get(group, kind))
            twin = per_cell(m.get(group, "plain formulas"))
            add(f"{group}, scans included, {name}",
                "5 µs per cell and core" if (group, kind) == ("203 features", "Widest") else "",
                cell(own, "{:.2f}", " µs per cell"), cell(ratio(twin, own), "{:.0f}", " times as fast as the plain formulas"),
                cell(of_limit(m, kind, own, pairs) if pairs else None, "{:.0f}", " % (multiply-add pairs)") if pairs else "")
    add("start-up (`placegraph --version`)", "10 ms", cell(m.start and m.start * 1e3, "{:.1f}", " ms"), "", "")
    features = per_cell(m.get("default model", "Widest"))
    for row in m.program:
        target = {"fr79": "0.5 s wall", "tiled, 120 x 90": "0.05 s wall", "tiled, 1160 x 870": "labels 2 s, all outputs 3 s wall"}
        target = target.get(row["name"], "")
        stages = row["stages"]
        labels = sum(ms for name, ms in stages.items() if name not in ["edits", "topology", "identity"])
        add(f"`map`, {row['name']}: {row['free'] / 1e3:.0f} k free cells", target,
            f"{brief(row['wall'])} wall (labels {brief(labels / 1e3)}), {brief(row['cpu'])} processor",
            ", ".join(f"{name} {brief(ms / 1e3)}" for name, ms in stages.items()),
            cell(features and 100 * features * 1e-6 * row["free"] / row["cpu"], "{:.0f}", " % is scans and features, at the speed above"))
    relaxation(m, add)
    boosting(m, add)
    expansion(m, add)
    components(m, add)
    own = min((row["peak"] for row in m.program), default=0)
    for row in m.program:
        if row["cells"] > 1e6:
            add(f"memory of `map`, {row['name']}", "40 bytes per cell in addition to the map",
                f"{row['peak'] / 2**20:.0f} MiB at {row['cells'] / 1e6:.1f} M cells: {row['peak'] / row['cells']:.0f} bytes per cell, "
                f"{(row['peak'] - own) / row['cells'] - 1:.0f} without the map and what the smallest map takes",
                "", "")
    return lines


def relaxation(m, add):
    for labels in (3, 4):
        of = {f: v for (g, f, _), v in m.rows.items() if g == f"relaxation, {labels} labels"}
        for threads, target in [("all threads", "3 times the memory bound"), ("one thread", "")]:
            row, memory = of.get(threads), m.memory(threads)
            bound = memory and row and row[1] * labels * 8 / memory
            add(f"relaxation, {labels} labels, {threads}", target,
                cell(row and row[0] / row[1] * 1e9, "{:.2f}", " ns per cell and iteration"),
                cell(ratio(per_cell(of.get("plain twin")), per_cell(row)), "{:.0f}", " times as fast as the plain twin"),
                cell(bound and row[0] / bound, "{:.1f}", " times the memory bound"))


def boosting(m, add):
    name = "rounds: 101, 65k x 203, 3 classes"
    own = m.rows.get(("boost", name, None))
    peers = [f"{peer}: {seconds / own[0]:.1f} times our time" for (stage, peer, _), seconds in m.peers.items()
             if own and stage == "boosting"]
    memory = m.memory("all threads")
    add("boosting, 65 k x 203, 101 rounds, 3 classes", "twice as fast as LightGBM with stumps", cell(own and own[0], "{:.2f}", " s"),
        "<br>".join(peers) or "not run",
        cell(own and memory and 100 * 101 * 203 * 65e3 / memory / own[0], "{:.1f}", " % (reading a byte per value and round)"))


def expansion(m, add):
    for name in ["Four, reward 40", "Eight, reward 40"]:
        for size, seconds, _ in m.series("alpha-expansion", name)[1:]:
            peers = [f"{peer}: {other / seconds:.1f} times our time" for (stage, peer, n), other in m.peers.items()
                     if (stage, n) == (f"alpha-expansion, {name}", size)]
            add(f"alpha-expansion, {size / 1e3:.0f} k nodes, {name}", "faster, energy not higher", f"{seconds:.3f} s",
                "<br>".join(peers) or "not run",
                cell(m.memory() and 100 * size * 8 / m.memory() / seconds, "{:.2g}", " % (one pass over memory)"))


def components(m, add):
    for size, seconds, _ in m.series("stages", "regions"):
        twin, other = m.get("stages", "regions, flood fill", size), m.get("stages", "regions, imageproc", size)
        peers = [f"{peer}: {other / seconds:.1f} times our time" for (stage, peer, n), other in m.peers.items()
                 if (stage, n) == ("regions", size)]
        yardsticks = [f"flood fill: {twin[0] / seconds:.1f} times our time", f"imageproc: {other[0] / seconds:.1f} times our time"]
        bound = m.memory() and size * 8 / m.memory()
        add(f"connected components, {size / 1e3:.0f} k cells", "",
            f"{seconds * 1e3:.1f} ms, {seconds / size * 1e9:.1f} ns per cell",
            "<br>".join(yardsticks + peers), cell(bound and 100 * bound / seconds, "{:.0f}", " % (one pass over memory)"))
    large = [m.rows.get(("16 M cells", name, None)) for name in ["connected", "properties", "outlines", "topological map, routes and all"]]
    if all(large):
        connected, statistics, outlines, topology = (row[0] for row in large)
        peers = [f"{peer}: {other / connected:.1f} times our time" for (stage, peer, n), other in m.peers.items()
                 if stage == "regions" and n > 4e6]
        add("connected components, statistics, polygons, 16 M cells", "1 s", f"{connected + statistics + outlines:.2f} s: components "
            f"{connected:.2f} s, statistics {statistics:.2f} s, outlines {outlines:.2f} s; with routes and everything else {connected + topology:.2f} s",
            "<br>".join(peers) or "not run",
            cell(m.memory() and 100 * 16e6 * 8 / m.memory() / connected, "{:.0f}", " % (one pass over memory)"))


def stage_table(m):
    names = sorted({f for g, f, _ in m.rows if g == "stages"})
    sizes = [size for size, *_ in m.series("stages", "regions")]
    lines = ["| stage, on all threads where it uses them | " + " | ".join(f"{size / 1e3:.0f} k cells" for size in sizes)
             + " | share of one pass over memory | comparison on the largest map |", "|---|" + "---|" * (len(sizes) + 2)]
    for name in (name for name in names if ", " not in name):
        rows = [m.get("stages", name, size) for size in sizes]
        largest = rows[-1] if rows else None
        twins = [(twin.split(", ", 1)[1], m.get("stages", twin, sizes[-1])) for twin in names if twin.startswith(name + ", ")]
        others = [f"{twin}: {ratio(row[0], largest[0]):.1f} times our time" for twin, row in twins if row and largest]
        share = m.memory() and largest and 100 * largest[1] * 8 / m.memory() / largest[0]
        lines.append(f"| {name} | " + " | ".join(cell(row and row[0] / row[1] * 1e9, "{:.1f}", " ns per cell") for row in rows)
                     + f" | {cell(share, '{:.2g}', ' %')} | {'<br>'.join(others)} |")
    return lines


def pictures(m):
    curves = {}
    for group, function, label in [("203 features", "Widest", "scans and 203 features"),
                                   ("rays", "Widest", "scans alone"), ("stages", "doorways", "doorways"),
                                   ("stages", "spaces", "spaces"), ("stages", "topology and outlines", "topology"),
                                   ("stages", "regions", "connected components"),
                                   ("stages", "overview.png", "overview.png"), ("analyze", "tiled", "analyze, all threads")]:
        curves[label] = [(size, seconds / size * 1e9) for size, seconds, _ in m.series(group, function)]
    (DOCS / "images/cost-by-size.svg").write_text(plots.lines(curves, "free cells", "ns per cell"))
    size = max([size for size, *_ in m.series("stages", "regions")][:2], default=0)
    bars = [(name, row[0] / row[1] * 1e9) for name in ["graph", "doorways", "spaces", "regions", "region statistics",
            "topology and outlines", "labels.png", "overview.png"] if (row := m.get("stages", name, size))]
    if row := m.get("default model", "Widest"):
        bars.insert(1, ("scans and features", row[0] / row[1] * 1e9))
    (DOCS / "images/time-by-stage.svg").write_text(plots.bars(bars, "ns per cell"))


def cpu_name():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return "unknown"


def main():
    if "--run" in sys.argv:
        run_all()
    if "--program" in sys.argv:
        run_program()
    m = Measured()
    pictures(m)
    rates = [f"{name} {m.rate('multiply and add', kind) * 1e-9:.0f} G" for kind, name in KINDS.items()
             if m.rate("multiply and add", kind)]
    bits = [f"{name} {m.rate('bits', kind) * 1e-9:.0f} G" for kind, name in KINDS.items() if m.rate("bits", kind)]
    memory = m.memory()
    part = [f"Measured on {time.strftime('%d %B %Y')}, {os.cpu_count()} cores of a shared {cpu_name()}. Every figure is the best of all samples.",
            f"Load average of the last 15 minutes of the run: {os.getloadavg()[2]:.0f}.",
            f"Limits of one core in the same run: {', '.join(rates)} multiply-add pairs in single precision per second; {', '.join(bits)} operations on 64-bit words per second"
            + (f"; {memory * 1e-9:.1f} GB/s read and written on one thread, {m.memory('all threads') * 1e-9:.1f} GB/s on all."
               if memory else "."), "", *targets(m), "",
            "![Cost by size](images/cost-by-size.svg)", "", "![Time by stage](images/time-by-stage.svg)", "", *stage_table(m)]
    page = DOCS / "performance.md"
    text = page.read_text()
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    page.write_text(before + BEGIN + "\n\n" + "\n".join(part) + "\n\n" + END + after)


if __name__ == "__main__":
    main()
