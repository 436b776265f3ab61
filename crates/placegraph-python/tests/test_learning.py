"""Features, training, evaluation, generated buildings, and the estimator."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg


@pytest.fixture(scope="module")
def home() -> pg.Building:
    return pg.generate(style="home", seed=3, mapping="clean", resolution=0.1)


def test_a_building_is_the_programs(program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    done = program("generate", "--style", "home", "--seed", 3, "--mapping", "clean", "--resolution", 0.1, "--out", tmp_path / "program")
    assert done.returncode == 0, done.stderr
    path = pg.generate(style="home", seed=3, mapping="clean", resolution=0.1).save(tmp_path / "package")
    (folder,) = [path.parent for path in (tmp_path / "program").rglob("map.yaml")]
    for file in ["map.yaml", "map.png", "labels.png", "rooms.png", "graph.json"]:
        assert (tmp_path / "package" / file).read_bytes() == (folder / file).read_bytes()
    assert path == str(tmp_path / "package/map.yaml")


def test_a_building_knows_its_truth(home: pg.Building, tmp_path: Path) -> None:
    assert (home.style, home.mapping) == ("home", "clean")
    free = home.map.array == 0
    assert ((home.labels > 0) == free).all() and set(np.unique(home.labels)) <= {0, 1, 2, 3, 255}
    assert (home.rooms[~free] == 0).all() and home.graph
    np.testing.assert_array_equal(pg.load_map(home.save(tmp_path)).array, home.map.array)
    with pytest.raises(ValueError, match="expected one of office, .* found .castle."):
        pg.generate(style="castle")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="0.02 to 0.2"):
        pg.generate(resolution=1.0)


def test_features_are_those_of_the_program(office: pg.OccupancyGrid, program) -> None:  # type: ignore[no-untyped-def]
    # Both pass the specks that the model passes.
    values, cells = pg.features(office, model=pg.default_model())
    names = pg.feature_names()
    assert values.shape == (len(cells), len(names)) and len(cells) == (office.array == 0).sum()
    assert (values.dtype, cells.dtype) == (np.float32, np.int64)
    assert (office.array[cells[:, 0], cells[:, 1]] == 0).all()
    for x, y in [(-18.4, 2.6), (-14.0, 1.0)]:
        said = json.loads(program("scan", "maps/office/map.yaml", "--at", f"{x},{y}", "--json").stdout)
        (row,) = np.flatnonzero((cells == office.cell_at(x, y)).all(axis=1))
        expected = np.array([said["features"][name] for name in names], np.float32)
        np.testing.assert_allclose(values[row], expected, rtol=2e-3, atol=2e-3)
        np.testing.assert_allclose(office.scan(x, y, model=pg.default_model()), said["ranges_m"])


def test_some_features_are_columns_of_all(home: pg.Building) -> None:
    everything, cells = pg.features(home.map)
    names = pg.feature_names()
    chosen = [names[40], names[3]]
    some, same_cells = pg.features(home.map, names=chosen, threads=1)
    np.testing.assert_array_equal(some, everything[:, [40, 3]])
    np.testing.assert_array_equal(cells, same_cells)
    with pytest.raises(ValueError, match="expected the name of a feature, found .A99."):
        pg.features(home.map, names=["A99"])
    sizes = [len(pg.feature_names(each)) for each in ("freiburg203", "chapter183", "old152", "lean120")]
    assert sizes == [203, 183, 152, 120] and len(names) >= 216


def test_a_trained_model_is_the_programs(home: pg.Building, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    path = Path(home.save(tmp_path))
    options = ["--features", "lean120", "--rounds", 10, "--temperature", 2, "--max-cells-per-class", 300]
    done = program("train", "--map", path, "--labels", path.with_name("labels.png"), "-o", tmp_path / "program.json", *options)
    assert done.returncode == 0, done.stderr
    model = pg.train(
        [(pg.load_map(path), home.labels)], features="lean120", rounds=10, temperature=2.0, max_cells_per_class=300
    )
    assert model.to_bytes() == (tmp_path / "program.json").read_bytes()
    labeled = pg.label(home.map, model=model)
    assert pg.evaluate(labeled, home.labels).accuracy > 0.9  # type: ignore[operator]
    assert model.record["maps"][0]["name"] == tmp_path.name


def test_classes_of_ones_own(home: pg.Building, tmp_path: Path) -> None:
    labels = np.where(home.labels == 255, 0, home.labels)
    room = home.rooms[home.labels == 2][0]
    labels[(home.rooms == room) & (labels == 2)] = 4
    classes = {"hall": "passage", "room": "place", "door": "doorway", "bath": "place"}
    model = pg.train([(home.map, labels)], classes=classes, rounds=20, temperature=1.0, max_cells_per_class=400, name="mine")
    assert [(each.name, each.role) for each in model.classes] == list(classes.items())
    result = pg.label(home.map, model=model)
    assert result.probabilities.shape[0] == 4 and result.model is model
    assert result.topology.document["model"]["name"] == "mine"
    model.save(tmp_path / "mine.json")
    np.testing.assert_array_equal(pg.label(home.map, model=tmp_path / "mine.json").labels, result.labels)


def test_what_cannot_be_learned_from_is_told(home: pg.Building) -> None:
    with pytest.raises(pg.TrainingError, match="expected labels of"):
        pg.train([(home.map, home.labels[1:])])
    with pytest.raises(pg.TrainingError, match="expected labels of 0 or 255"):
        pg.train([(home.map, np.where(home.labels == 1, 9, home.labels))])
    with pytest.raises(pg.TrainingError, match="found none of"):
        pg.train([(home.map, np.where(home.labels == 3, 0, home.labels))])
    with pytest.raises(pg.TrainingError, match="labeled free cells"):
        pg.train([])
    with pytest.raises(TypeError, match="integer type"):
        pg.train([(home.map, home.labels.astype(float))])
    with pytest.raises(pg.TrainingError, match="rounds"):
        pg.train([(home.map, home.labels)], rounds=0)
    with pytest.raises(pg.TrainingError, match="2 to 8 classes"):
        pg.train([(home.map, home.labels)], classes=["one"])
    with pytest.raises(ValueError, match="as the role of .a., found .attic."):
        pg.train([(home.map, home.labels)], classes={"a": "attic", "b": "place"})


def test_scores_are_those_of_plain_numpy(result: pg.Result, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    pillow = pytest.importorskip("PIL.Image")
    with pillow.open("maps/office/labels.png") as image:
        truth = np.asarray(image)
    scores = pg.evaluate(result, truth)
    known = (truth > 0) & (truth < 255)
    assert scores.n_cells == known.sum()
    assert scores.accuracy == pytest.approx((result.labels[known] == truth[known]).mean())
    expected = np.zeros((3, 4), int)
    np.add.at(expected, (truth[known] - 1, result.labels[known].astype(int) - 1), 1)
    np.testing.assert_array_equal(scores.confusion, expected)
    result.save(tmp_path)
    said = json.loads(program("evaluate", tmp_path / "labels.png", "maps/office/labels.png", "--json").stdout)
    assert scores.macro_f1 == said["cells"]["macro_f1"]
    assert str(scores) in program("evaluate", tmp_path / "labels.png", "maps/office/labels.png").stdout
    with pytest.raises(ValueError, match="of the shape"):
        pg.evaluate(result, truth[1:])


def test_the_estimator_passes_scikit_learns_checks() -> None:
    checks = pytest.importorskip("sklearn.utils.estimator_checks")
    checks.check_estimator(pg.PlaceClassifier(rounds=20))


def test_the_estimator_learns_as_the_library_does(home: pg.Building) -> None:
    pytest.importorskip("sklearn")
    from sklearn.model_selection import cross_val_score

    values, cells = pg.features(home.map, names=pg.feature_names("lean120"))
    classes = home.labels[cells[:, 0], cells[:, 1]]
    known = classes < 255
    x, y = values[known][::7], classes[known][::7]
    names = np.array(["", "corridor", "room", "doorway"])[y]
    estimator = pg.PlaceClassifier(rounds=30, n_jobs=1).fit(x, names)
    assert list(estimator.classes_) == ["corridor", "doorway", "room"]
    assert estimator.score(x, names) > 0.97
    assert estimator.feature_votes_.shape == (3, 120) and (estimator.feature_votes_ >= 0).all()
    p = estimator.predict_proba(x)
    np.testing.assert_allclose(p.sum(axis=1), 1)
    again = pickle.loads(pickle.dumps(estimator))
    np.testing.assert_array_equal(again.predict_proba(x), p)
    assert sorted(estimator.order_) == sorted(estimator.classes_)
    assert cross_val_score(pg.PlaceClassifier(rounds=30), x, names, cv=3).mean() > 0.8
