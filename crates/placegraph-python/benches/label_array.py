"""Processor time of labeling an array of a million cells, beside the program on the same map. One thread, in turns.

    pip install WHEEL pillow
    python crates/placegraph-python/benches/label_array.py target/release/placegraph MAP.pgm [RUNS]

The package is to take no longer than the program plus 5 %: more would be copies that nobody needs. Wheel and program must
be built from the same source, both with --release.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

import placegraph as pg


def of_program(program: str, path: str, out: Path) -> float:
    """Seconds of a whole `map`: reading, labeling, writing."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "map", path, "--resolution", "0.05", "--out", out], check=True, capture_output=True,
                   env=os.environ | {"RAYON_NUM_THREADS": "1"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_package(array: np.ndarray, out: Path) -> tuple[float, float]:
    """Seconds from an array to arrays, and to the same files."""
    started = time.process_time()
    result = pg.label(pg.OccupancyGrid(array, resolution=0.05), threads=1)
    assert result.labels.shape == result.regions.shape == array.shape
    labeled = time.process_time()
    result.save(out)
    return labeled - started, time.process_time() - started


def main(program: str, path: str, n_runs: int) -> None:
    gray = np.asarray(Image.open(path).convert("L"))
    array = np.where(gray > 250, 0, 100).astype(np.int8)
    times = []
    with tempfile.TemporaryDirectory() as folder:
        for n in range(n_runs):
            times.append((of_program(program, path, Path(folder, f"program{n}")), *of_package(array, Path(folder, f"package{n}"))))
    program_s, arrays_s, files_s = (min(column) for column in zip(*times))
    print(f"{array.size} cells: program {program_s:.2f} s, package to arrays {arrays_s:.2f} s ({arrays_s / program_s:.2f} x), "
          f"to files {files_s:.2f} s ({files_s / program_s:.2f} x)")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 5)
