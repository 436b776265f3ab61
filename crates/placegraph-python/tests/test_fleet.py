"""Many maps into a GeoParquet data set, and the questions of docs/fleet.md."""

from __future__ import annotations

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg
from conftest import ROOT, files_of

pq = pytest.importorskip("pyarrow.parquet")
from placegraph import fleet  # noqa: E402
from placegraph.fleet._worker import Task  # noqa: E402


@pytest.fixture(scope="module")
def sites(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("sites")
    found = {}
    for index in range(6):
        building = pg.generate(style="home", seed=5, index=index, mapping="clean", resolution=0.1)
        found[f"site{index}"] = building.save(folder / f"site{index}")
    (folder / "broken").mkdir()
    (folder / "broken/map.yaml").write_text("image: [")
    return found | {"broken": str(folder / "broken/map.yaml")}


@pytest.fixture(scope="module")
def dataset(sites: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("data") / "first"
    summary = fleet.label_maps(sites, out, maps_per_part=2)
    assert (summary.n_labeled, summary.n_kept, list(summary.failed)) == (6, 0, ["broken"])
    return out


def rows(out: Path, table: str) -> list[dict[str, object]]:
    found = [row for path in sorted((out / table).glob("*.parquet")) for row in pq.read_table(path).to_pylist()]
    return found


def test_rows_are_those_of_the_results(sites: dict[str, str], dataset: Path) -> None:
    maps = {row["site"]: row for row in rows(dataset, "maps")}
    assert set(maps) == set(sites) and len(rows(dataset, "maps")) == len(sites)
    assert "line 1" in maps["broken"]["error"] and maps["broken"]["status"] == "failed"
    for site, path in sites.items():
        if site == "broken":
            continue
        result = pg.label(path)
        assert maps[site]["topology"] == result.topology.to_json()
        assert maps[site]["map_hash"] == result.map.hash
        places = [row for row in rows(dataset, "places") if row["site"] == site]
        assert [row["name"] for row in places] == [place.name for place in result.places]
        assert {row["key"] for row in places} == {maps[site]["key"]}
        doorways = [row for row in rows(dataset, "doorways") if row["site"] == site]
        assert [row["width_m"] for row in doorways] == [doorway.width_m for doorway in result.doorways]
        assert sum(row["site"] == site for row in rows(dataset, "connections")) == len(result.connections)


def test_geopandas_pyarrow_and_duckdb_open_it(dataset: Path) -> None:
    geopandas = pytest.importorskip("geopandas")
    places = geopandas.read_parquet(dataset / "places")
    assert places.crs.to_epsg() == 3857 and places.geometry.is_valid.all()
    np.testing.assert_allclose(places.geometry.area, places["area_m2"], rtol=1e-9)
    ways = geopandas.read_parquet(dataset / "connections")
    known = ways["length_m"].notna() & ways.geometry.notna()
    np.testing.assert_allclose(ways.geometry[known].length, ways["length_m"][known], atol=1e-3)
    doors = geopandas.read_parquet(dataset / "doorways")
    np.testing.assert_allclose(doors.geometry.length, doors["width_m"], atol=0.15)
    maps = geopandas.read_parquet(dataset / "maps").set_index("key")
    assert places.geometry.within(maps.geometry[places["key"]].set_axis(places.index).buffer(1e-6)).all()
    for table in ("maps", "places", "doorways", "connections"):
        for path in (dataset / table).glob("*.parquet"):
            geo = json.loads(pq.read_schema(path).metadata[b"geo"])
            assert geo["version"] == "1.1.0" and geo["columns"]["geometry"]["crs"]["id"]["code"] == 3857
    duckdb = pytest.importorskip("duckdb")
    ((n,),) = duckdb.sql(f"SELECT count(*) FROM read_parquet('{dataset}/places/*.parquet')").fetchall()
    assert n == len(places)


def test_duckdb_reads_the_geometry(dataset: Path) -> None:
    duckdb = pytest.importorskip("duckdb")
    # The extension from the package index: DuckDB's own server is not always to be had.
    pytest.importorskip("duckdb_extension_spatial")
    from duckdb_extensions import import_extension

    import_extension("spatial")
    connection = duckdb.connect()
    connection.load_extension("spatial")
    query = "SELECT ST_Area(geometry), area_m2, ST_GeometryType(geometry)::VARCHAR FROM read_parquet(?)"
    for area, area_m2, kind in connection.execute(query, [f"{dataset}/places/*.parquet"]).fetchall():
        assert area == pytest.approx(area_m2, rel=1e-9) and kind in ("POLYGON", "MULTIPOLYGON")
    query = "SELECT max(abs(ST_Length(geometry) - length_m)) FROM read_parquet(?) WHERE length_m IS NOT NULL AND geometry IS NOT NULL"
    ((farthest,),) = connection.execute(query, [f"{dataset}/connections/*.parquet"]).fetchall()
    assert farthest < 1e-3


def test_what_is_done_is_not_done_again(sites: dict[str, str], dataset: Path) -> None:
    before = files_of(dataset)
    summary = fleet.label_maps(sites, dataset, maps_per_part=3)
    assert (summary.n_labeled, summary.n_kept, len(summary.failed)) == (0, 6, 1)
    assert files_of(dataset) == before


def test_a_run_that_was_ended_is_completed(sites: dict[str, str], dataset: Path, tmp_path: Path) -> None:
    fleet.label_maps(sites, tmp_path, maps_per_part=2)
    whole = files_of(tmp_path)
    # As if the last part were not vouched for, and a file half written.
    last = sorted((tmp_path / "maps").glob("part-*.parquet"))[0]
    last.unlink()
    (tmp_path / "places/.part-half").write_text("half")
    (tmp_path / "latest.parquet").unlink()
    fleet.label_maps(sites, tmp_path, maps_per_part=2)
    assert files_of(tmp_path) == whole


@pytest.mark.parametrize("workers", [1, 3])
def test_bytes_do_not_depend_on_workers(sites: dict[str, str], dataset: Path, tmp_path: Path, workers: int) -> None:
    fleet.label_maps(sites, tmp_path, maps_per_part=2, workers=workers)
    assert files_of(tmp_path) == files_of(dataset)


def changed(sites: dict[str, str], folder: Path) -> dict[str, str]:
    """The sites a week later: in the first one the free cells of a doorway are walls."""
    path = Path(sites["site0"])
    result = pg.label(path)
    doorway = result.doorways[0]
    pillow = pytest.importorskip("PIL.Image")
    with pillow.open(path.with_name("map.png")) as image:
        gray = np.array(image)
    gray[result.regions == doorway.id] = 0
    folder.mkdir()
    pillow.fromarray(gray).save(folder / "map.png")
    (folder / "map.yaml").write_text(path.read_text())
    return sites | {"site0": str(folder / "map.yaml")}


@pytest.fixture(scope="module")
def later(sites: dict[str, str], dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("later")
    fleet.label_maps(changed(sites, folder / "site0"), folder / "data", previous=dataset)
    return folder / "data"


def test_names_are_carried_from_the_previous_run(sites: dict[str, str], dataset: Path, later: Path) -> None:
    def names(out: Path, site: str) -> set[object]:
        return {row["name"] for row in rows(out, "places") if row["site"] == site}

    for site in sites:
        if site not in ("site0", "broken"):
            assert names(later, site) == names(dataset, site)
    gone = pg.label(sites["site0"]).doorways[0].name
    assert gone in names(dataset, "site0") - names(later, "site0")
    with pytest.raises(FileNotFoundError, match="latest.parquet"):
        fleet.label_maps(sites, later.parent / "x", previous=later.parent)


QUERIES = re.findall(r"```sql\n(.*?)```", (ROOT / "docs/fleet.md").read_text(), re.DOTALL)


def test_the_page_has_ten_questions() -> None:
    assert len(QUERIES) == 10


@pytest.mark.parametrize("number", range(len(QUERIES)))
def test_the_questions_of_the_page_have_answers(number: int, dataset: Path, later: Path) -> None:
    duckdb = pytest.importorskip("duckdb")
    query = QUERIES[number]
    known = {"now": str(later), "before": str(dataset)}
    answer = duckdb.execute(query, {name: value for name, value in known.items() if "$" + name in query}).fetchall()
    columns = [each[0] for each in duckdb.description()]
    if number == 0:
        expected = {row["class"] for row in rows(later, "places")}
        assert {row[0] for row in answer} == expected and columns == ["class", "n", "area_m2"]
    if number == 2:
        assert [row[0] for row in answer] == ["broken"]
    if number == 3:
        assert [row[0] for row in answer] == ["site0"] and answer[0][1]
    if number in (1, 8):
        assert answer


def test_the_worker_pickles_and_works_on_batches(sites: dict[str, str], dataset: Path, tmp_path: Path) -> None:
    worker = fleet.LabelMaps(tmp_path)
    again = pickle.loads(pickle.dumps(worker))
    assert len(pickle.dumps(worker)) < 2_000_000
    answer = again({"map": np.array(list(sites.values())), "site": np.array(list(sites))})
    assert list(answer["site"]) == list(sites)
    assert list(answer["status"]) == ["labeled"] * 6 + ["failed"]
    assert {row["key"] for row in rows(tmp_path, "maps")} == {row["key"] for row in rows(dataset, "maps")}
    assert worker.label([Task("here", f"file://{sites['site1']}")])[0]["status"] == "labeled"


def test_urls_are_read_through_fsspec(sites: dict[str, str], tmp_path: Path) -> None:
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    source = Path(sites["site2"]).parent
    for name in ("map.yaml", "map.png"):
        memory.pipe_file(f"/far/site2/{name}", (source / name).read_bytes())
    summary = fleet.label_maps(["memory://far/site2/map.yaml", "memory://far/none/map.yaml"], tmp_path)
    assert summary.n_labeled == 1 and list(summary.failed) == ["none"]
    (row,) = [row for row in rows(tmp_path, "maps") if row["site"] == "site2"]
    assert row["map_hash"] == pg.load_map(sites["site2"]).hash


def test_what_is_no_run_is_refused(sites: dict[str, str], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected engine to be one of local, ray, dask, found 'spark'"):
        fleet.label_maps(sites, tmp_path, engine="spark")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="would both be the site 'map2'"):
        fleet.label_maps(["a/map2.yaml", "b/map2.yaml"], tmp_path)
    with pytest.raises(TypeError, match="found one path"):
        fleet.label_maps("a/map.yaml", tmp_path)
    with pytest.raises(ValueError, match="at least 1 worker"):
        fleet.label_maps(sites, tmp_path, workers=0)
    assert list(tmp_path.iterdir()) == []


def test_the_command(sites: dict[str, str], dataset: Path, tmp_path: Path) -> None:
    folder = Path(sites["site0"]).parent.parent
    command = [sys.executable, "-m", "placegraph", "fleet", str(folder), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    assert done.stdout.startswith("6 labeled, 0 kept, 1 failed")
    assert "site0: labeled" in done.stderr and "broken: failed: " in done.stderr
    assert {row["key"] for row in rows(tmp_path / "out", "places")} == {row["key"] for row in rows(dataset, "places")}
    none = subprocess.run([*command[:4], str(tmp_path / "none"), "--out", str(tmp_path / "o"), "--model", "none"],
                          capture_output=True, text=True, check=False)
    assert none.returncode == 2 and none.stderr.startswith("error: could not read none")
