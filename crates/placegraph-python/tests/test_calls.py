"""Errors, threads, the GIL, Ctrl-C, forks."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg


def test_a_missing_file_is_told_as_python_tells_it(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="cannot read the file") as info:
        pg.load_map(tmp_path / "none.yaml")
    assert isinstance(info.value, pg.FileError) and isinstance(info.value, OSError)
    assert (info.value.errno, info.value.filename) == (errno.ENOENT, str(tmp_path / "none.yaml"))
    (tmp_path / "map.yaml").write_text(
        "image: none.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with pytest.raises(pg.MissingFileError, match="none.png") as info:
        pg.load_map(tmp_path / "map.yaml")
    assert info.value.filename == str(tmp_path / "none.png")
    with pytest.raises(pg.MissingFileError, match="could not read"):
        pg.load_model(tmp_path / "none.json")
    with pytest.raises(pg.MissingFileError, match="could not read"):
        pg.Topology.load(tmp_path / "none.json")


def test_what_is_no_map_model_or_topology_is_a_value_error(tmp_path: Path) -> None:
    file = tmp_path / "file.yaml"
    file.write_text("image: [")
    for read, error in [(pg.load_map, pg.MapError), (pg.load_model, pg.ModelError), (pg.Topology.load, pg.TopologyError)]:
        with pytest.raises(error) as info:
            read(file)
        assert isinstance(info.value, ValueError) and isinstance(info.value, pg.Error)
    (tmp_path / "edits.toml").write_text("[[edit]]\naction = 'paint'\n")
    with pytest.raises(pg.EditError, match="expected an edit file"):
        pg.label(pg.OccupancyGrid([[0]], resolution=0.05), edits=tmp_path / "edits.toml")


def test_texts_are_the_programs(program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "map.png").write_bytes(b"\x89PNG\r\n\x1a\nno")
    for read in [lambda path: pg.load_map(path), lambda path: pg.load_map(path, resolution=0.05)]:
        with pytest.raises(pg.MapError) as info:
            read(tmp_path / "map.png")
    said = program("info", tmp_path / "map.png", "--resolution", "0.05")
    assert said.returncode == 2 and str(info.value) in said.stderr


@pytest.mark.parametrize("threads", [0, -1, 100_000])
def test_nonsense_numbers_of_threads_are_refused(office: pg.OccupancyGrid, threads: int) -> None:
    with pytest.raises((ValueError, OverflowError)):
        pg.label(office, threads=threads)


def test_any_number_of_threads_gives_the_same_bits(office: pg.OccupancyGrid, result: pg.Result) -> None:
    for threads in (1, 3):
        again = pg.label(office, threads=threads)
        np.testing.assert_array_equal(again.probabilities, result.probabilities)
        assert again.topology.to_json() == result.topology.to_json()


def test_the_gil_is_released_meanwhile(office: pg.OccupancyGrid) -> None:
    array = np.tile(office.array, (2, 2))
    big = pg.OccupancyGrid(array, resolution=office.resolution)
    ticks, done = [0], threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    before, started = ticks[0], time.monotonic()
    pg.label(big, threads=1)
    took, counted = time.monotonic() - started, ticks[0] - before
    done.set()
    thread.join()
    # Held, the GIL would let the other thread run at the beginning and at the end only.
    assert counted > 20 * took, (counted, took)


def test_many_threads_label_at_once(office: pg.OccupancyGrid, result: pg.Result) -> None:
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: pg.label(office, threads=2).labels, range(16)))
    assert all((labels == result.labels).all() for labels in found)


def run(code: str, *, timeout: float = 120) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=timeout, check=False
    )


def test_ctrl_c_ends_a_long_call() -> None:
    code = """
        import numpy as np, os, signal, threading, time, placegraph as pg
        # A shell that starts tests in the background leaves the signal ignored.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        office = pg.load_map("maps/office/map.yaml")
        big = pg.OccupancyGrid(np.tile(office.array, (12, 12)), resolution=0.05)
        threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
        started = time.monotonic()
        try:
            pg.label(big, threads=1)
        except KeyboardInterrupt:
            print("interrupted after", time.monotonic() - started)
        print(pg.label(office).labels.max())
    """
    done = run(code)
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.split("\n")[:2]
    assert first.startswith("interrupted after") and float(first.split()[-1]) < 5.0, done.stdout
    assert second == "3"


def test_a_forked_process_labels_too() -> None:
    code = """
        import multiprocessing, placegraph as pg
        office = pg.load_map("maps/office/map.yaml")
        expected = pg.label(office).topology.to_json()
        def work(_):
            return pg.label(office).topology.to_json()
        with multiprocessing.get_context("fork").Pool(2) as pool:
            assert pool.map(work, range(4)) == [expected] * 4
    """
    done = run(code)
    assert done.returncode == 0, done.stderr


def test_a_panic_is_an_exception_that_asks_for_a_report() -> None:
    # No map is known that makes the library panic; a list that asks for a tenth class of two does.
    from placegraph import _native

    x = np.zeros((4, 1), np.float32)
    y = np.array([0, 0, 1, 1], np.uint8)
    x[:, 0] = y
    order, stumps = _native.fit_list(x, y, 2, 3, 1.0, None)
    with pytest.raises(pg.InternalError, match="this is a bug in placegraph, please report it .* at .*rs:"):
        _native.list_probabilities(x, [order[0], 9], stumps, 1.0, None)
    assert issubclass(pg.InternalError, RuntimeError)
    assert _native.list_probabilities(x, order, stumps, 1.0, None).argmax(axis=1).tolist() == y.tolist()


def test_importing_takes_no_time_and_no_other_package() -> None:
    code = """
        import sys, time, numpy
        started = time.perf_counter()
        import placegraph
        took = time.perf_counter() - started
        loaded = {name.partition(".")[0] for name in sys.modules}
        print(took, loaded & {"pandas", "geopandas", "networkx", "sklearn", "matplotlib", "pyarrow", "ray", "dask"})
    """
    done = run(code)
    took, loaded = done.stdout.split(" ", 1)
    assert float(took) < 0.3 and loaded.strip() == "set()", done.stdout + done.stderr


def test_a_program_killed_by_ctrl_c_ends_at_once() -> None:
    process = subprocess.Popen([sys.executable, "-m", "placegraph", "generate", "--count", "1000", "--out", os.devnull + "x"],
                               stderr=subprocess.PIPE, stdout=subprocess.PIPE)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode in (-signal.SIGINT, 2)
