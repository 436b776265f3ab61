"""The package gives the bytes of the program that cargo built, and of the program inside the wheel."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg
from conftest import ROOT, files_of

FORMATS = list(pg.export_formats())


def maps() -> list[Path]:
    """The shipped maps, and with PLACEGRAPH_DATA those of the evaluation: PLACEGRAPH_N_MAPS of them, by default 3."""
    shipped = [ROOT / "maps/office/map.yaml", ROOT / "maps/home/map.yaml"]
    data = os.environ.get("PLACEGRAPH_DATA")
    if data is None:
        return shipped
    found = sorted(Path(data, "eval").glob("**/map.yaml"), key=lambda path: (path.with_suffix(".png").stat().st_size if path.with_suffix(".png").exists() else 0, path))
    return shipped + found[: int(os.environ.get("PLACEGRAPH_N_MAPS", "3"))]


@pytest.mark.parametrize("path", maps(), ids=lambda path: path.parent.name)
def test_a_saved_result_is_that_of_the_program(path: Path, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    wanted = [*FORMATS]
    done = program("map", path, "--out", tmp_path / "program", "--export", ",".join(wanted), "--stages", "--probabilities")
    assert done.returncode in (0, 1), done.stderr
    result = pg.label(path)
    written = result.save(tmp_path / "package", export=wanted, stages=True, probabilities=True)
    ours, theirs = files_of(tmp_path / "package"), files_of(tmp_path / "program")
    assert sorted(ours) == sorted(theirs) == sorted(Path(name).name for name in written)
    assert [name for name in ours if ours[name] != theirs[name]] == []
    labels = np.load(tmp_path / "program/probabilities.npy")
    np.testing.assert_array_equal(result.probabilities, labels)
    pillow = pytest.importorskip("PIL.Image")
    with pillow.open(tmp_path / "program/labels.png") as image:
        np.testing.assert_array_equal(result.labels, np.asarray(image))
    with pillow.open(tmp_path / "program/regions.png") as image:
        np.testing.assert_array_equal(result.regions, np.asarray(image))


@pytest.mark.parametrize("name", FORMATS)
def test_an_export_is_that_of_the_program(name: str, result: pg.Result, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    result.save(tmp_path / "result")
    (tmp_path / "program").mkdir()
    (tmp_path / "package").mkdir()
    picture = ["--map", ROOT / "maps/office/map.yaml"] if name == "report" else []
    done = program("export", tmp_path / "result/topology.json", "--to", name, "--output", tmp_path / "program", *picture)
    assert done.returncode == 0, done.stderr
    paths = result.export(name, tmp_path / "package")
    theirs = files_of(tmp_path / "program")
    assert sorted(Path(path).name for path in paths) == sorted(theirs)
    if name not in ("report", "mcap"):
        # The report of a result in memory also shows probabilities; a recording holds the document, which lists files once they
        # are written.
        assert files_of(tmp_path / "package") == theirs


def test_export_to_a_file_and_what_cannot_be(result: pg.Result, tmp_path: Path) -> None:
    assert result.export("dot", tmp_path / "my.dot") == [str(tmp_path / "my.dot")]
    assert "\ngraph " in (tmp_path / "my.dot").read_text()
    with pytest.raises(ValueError, match="expected one of nav2, .* found .dxf2."):
        result.export("dxf2", tmp_path / "x")
    with pytest.raises(pg.ExportError, match="yaml"):
        result.export("nav2-speed", tmp_path / "speed.png")
    assert not (tmp_path / "speed.png").exists()
    with pytest.raises(pg.FileError) as info:
        (tmp_path / "file").write_text("")
        result.save(tmp_path / "file/below")
    assert isinstance(info.value, OSError)


def test_previous_and_edits_leave_the_programs_bytes(program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    path = ROOT / "maps/home/map.yaml"
    first = pg.label(path)
    first.save(tmp_path / "first")
    edits = tmp_path / "edits.toml"
    x, y = first.places[0].anchor
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{x}, {y}]\nname = "den"\n')
    previous = tmp_path / "first/topology.json"
    done = program("map", path, "--out", tmp_path / "program", "--previous", previous, "--edits", edits)
    assert done.returncode == 0, done.stderr
    pg.label(path, previous=previous, edits=edits).save(tmp_path / "package")
    assert files_of(tmp_path / "package") == files_of(tmp_path / "program")


def test_the_program_inside_is_the_same(program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    command = Path(sys.executable).parent / "placegraph"
    for arguments in [["--version"], ["features"], ["info", "maps/home/map.yaml", "--json"], ["info", "none.yaml"], ["nonsense"]]:
        inside = subprocess.run([command, *arguments], capture_output=True, text=True, check=False)
        outside = program(*arguments)
        assert (inside.returncode, inside.stdout, inside.stderr) == (outside.returncode, outside.stdout, outside.stderr)
    for name, run in [("inside", [command]), ("outside", [os.environ["PLACEGRAPH_PROGRAM"]])]:
        done = subprocess.run([*run, "map", "maps/home/map.yaml", "--out", tmp_path / name], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert files_of(tmp_path / "inside") == files_of(tmp_path / "outside")
