"""What documentation shows is run: documentation strings, docs/python.md, docs/fleet.md, the notebooks."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
import shutil
from pathlib import Path

import pytest

import placegraph as pg
from conftest import ROOT


def modules() -> list[str]:
    found = pkgutil.walk_packages(pg.__path__, "placegraph.")
    return ["placegraph", *(each.name for each in found if not each.name.endswith(("_native", "__main__")))]


@pytest.mark.parametrize("name", modules())
def test_documentation_strings(name: str) -> None:
    try:
        module = importlib.import_module(name)
    except ModuleNotFoundError as error:
        pytest.skip(str(error))
    failed, _ = doctest.testmod(module)
    assert failed == 0


def test_everything_public_is_documented_and_there() -> None:
    for name in pg.__all__:
        if name in ("PlaceClassifier", "fleet"):
            continue
        assert getattr(pg, name).__doc__, name
    assert pg.__version__ == re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1]  # type: ignore[index]


def blocks(page: str) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / page).read_text(), re.DOTALL | re.MULTILINE)


def test_the_manual_runs(tmp_path: Path) -> None:
    for package in ("matplotlib", "geopandas", "networkx", "sklearn"):
        pytest.importorskip(package)
    scope: dict[str, object] = {}
    found = blocks("python.md")
    assert len(found) > 5
    for block in found:
        exec(compile(block.replace('"/tmp/', f'"{tmp_path}/'), "docs/python.md", "exec"), scope)
    assert (tmp_path / "office/route_graph.geojson").exists() and (tmp_path / "office.png").stat().st_size > 10_000


def test_the_page_on_fleets_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("geopandas")
    monkeypatch.chdir(tmp_path)
    for site, source in [("berlin", "office"), ("paris", "home")]:
        shutil.copytree(ROOT / "maps" / source, tmp_path / "sites" / site)
    scope: dict[str, object] = {}
    for block in blocks("fleet.md"):
        exec(compile(block, "docs/fleet.md", "exec"), scope)
    assert scope["summary"].n_labeled == 2  # type: ignore[attr-defined]


@pytest.mark.parametrize("path", sorted((ROOT / "docs/notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_a_figure(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbclient = pytest.importorskip("nbclient")
    for package in ("ipykernel", "matplotlib", "geopandas", "duckdb", "sklearn"):
        pytest.importorskip(package)
    import nbformat

    # Ray asks the network for its address: test_clusters.py runs it where there is none.
    monkeypatch.setenv("PLACEGRAPH_NOTEBOOK_ENGINE", "local")
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(ROOT)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
