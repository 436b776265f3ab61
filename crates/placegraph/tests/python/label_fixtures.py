"""Writes the label files of crates/placegraph/tests/formats/label_files with the tools that users label with.

    pip install labelme==6.3.1 pycocotools==2.0.11 geopandas rasterio pillow
    QT_QPA_PLATFORM=offscreen python3 crates/placegraph/tests/python/label_fixtures.py

Every file holds the same shapes, drawn on a map of 48 x 36 cells of 0.5 m whose lower left corner stands at (-3, 2). Next to each
stands what the tool's own rasterizer makes of it: 0 none, 1 corridor, 2 room, 3 doorway.
"""

import base64
import io
import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image

OUT = Path(__file__).resolve().parents[1] / "formats" / "label_files"
WIDTH, HEIGHT, RESOLUTION_M, ORIGIN = 48, 36, 0.5, (-3.0, 2.0)
CLASSES = {"corridor": 1, "room": 2, "doorway": 3}
COLORS = {"background": (0, 0, 0), "corridor": (250, 50, 83), "room": (51, 221, 255), "doorway": (42, 125, 209)}

# Pixels from the upper left corner, y down. A hall with a slanted wall, a rectangle on it, a door on both.
HALL = [(3.2, 4.1), (30.7, 2.4), (41.3, 17.9), (28.6, 31.2), (4.4, 27.8)]
ROOM = [(10.0, 8.0), (25.0, 8.0), (25.0, 20.0), (10.0, 20.0)]
DOOR = [(24.3, 11.2), (27.1, 11.9), (26.4, 15.3), (23.8, 14.6)]
SHAPES = [("corridor", HALL), ("room", ROOM), ("doorway", DOOR)]


def save(name: str, labels: np.ndarray) -> None:
    Image.fromarray(labels.astype(np.uint8)).save(OUT / name)


def labelme() -> None:
    from labelme import utils
    from labelme._label_file import write_label_file

    mask = np.zeros((6, 9), bool)
    mask[1:5, 2:8] = True
    picture = io.BytesIO()
    Image.fromarray(mask.astype(np.uint8)).save(picture, "PNG")
    shape = lambda label, points, kind: dict(
        label=label, points=[list(p) for p in points], group_id=None, description="", shape_type=kind, flags={}, mask=None
    )
    shapes = [shape("corridor", HALL, "polygon"), shape("room", [ROOM[0], ROOM[2]], "rectangle"),
              shape("doorway", DOOR, "polygon"), shape("doorway", [(40.0, 30.0), (43.0, 30.0)], "circle")]
    stamp = shape("room", [(36, 2), (44, 7)], "mask")
    stamp["mask"] = mask
    shapes.append(stamp)
    labels, _ = utils.shapes_to_label((HEIGHT, WIDTH), shapes, {"_background_": 0, **CLASSES})
    save("labelme.png", labels)
    stamp["mask"] = base64.b64encode(picture.getvalue()).decode()
    write_label_file(str(OUT / "labelme.json"), shapes=shapes, image_path="map.pgm", image_height=HEIGHT, image_width=WIDTH)


def coco() -> None:
    from pycocotools import mask as masks
    from pycocotools.coco import COCO

    room = np.zeros((HEIGHT, WIDTH), np.uint8, order="F")
    room[8:20, 10:25] = 1
    packed = masks.encode(room)
    flat = lambda points: [c for p in points for c in p]
    door = np.zeros((HEIGHT, WIDTH), np.uint8)
    door[11:15, 24:27] = 1
    counts, last, n = [], 0, 0
    for v in door.flatten(order="F"):
        if v != last:
            counts.append(n)
            last, n = v, 0
        n += 1
    counts.append(n)
    segmentations = [[flat(HALL)], {"size": packed["size"], "counts": packed["counts"].decode()},
                     {"size": [HEIGHT, WIDTH], "counts": counts}]
    annotations = [
        dict(id=k + 1, image_id=7, category_id=c, segmentation=s, area=0, bbox=[0, 0, 1, 1], iscrowd=int(isinstance(s, dict)))
        for k, (c, s) in enumerate(zip((10, 20, 30), segmentations))
    ]
    file = dict(images=[dict(id=7, width=WIDTH, height=HEIGHT, file_name="maps/office.png"),
                        dict(id=8, width=5, height=5, file_name="other.png")],
                categories=[dict(id=10 * k, name=name) for name, k in CLASSES.items()], annotations=annotations)
    (OUT / "coco.json").write_text(json.dumps(file) + "\n")
    read = COCO(str(OUT / "coco.json"))
    labels = np.zeros((HEIGHT, WIDTH), np.uint8)
    for annotation in read.loadAnns(read.getAnnIds(imgIds=[7])):
        labels[read.annToMask(annotation) > 0] = annotation["category_id"] // 10
    save("coco.png", labels)


def geojson() -> None:
    import geopandas
    from rasterio.features import rasterize
    from rasterio.transform import from_origin
    from shapely.geometry import Polygon

    at = lambda p: (ORIGIN[0] + p[0] * RESOLUTION_M, ORIGIN[1] + (HEIGHT - p[1]) * RESOLUTION_M)
    polygons = [Polygon([at(p) for p in points], [[at(p) for p in ROOM]] if name == "corridor" else None)
                for name, points in SHAPES]
    names = [name for name, _ in SHAPES]
    frame = geopandas.GeoDataFrame({"class": names}, geometry=polygons, crs="EPSG:3857")
    (OUT / "regions.geojson").unlink(missing_ok=True)
    frame.to_file(OUT / "regions.geojson", driver="GeoJSON")
    transform = from_origin(ORIGIN[0], ORIGIN[1] + HEIGHT * RESOLUTION_M, RESOLUTION_M, RESOLUTION_M)
    labels = rasterize([(p, CLASSES[n]) for p, n in zip(polygons, names)], (HEIGHT, WIDTH), transform=transform)
    save("regions.png", labels)
    # As QGIS saves it unless asked otherwise.
    frame.set_crs("EPSG:3857").to_crs("EPSG:4326").iloc[[2]].to_file(OUT / "degrees.geojson", driver="GeoJSON")


def segmentation_mask() -> None:
    """The folder of CVAT's export "Segmentation mask 1.1", which is Pascal VOC's."""
    import rasterio.features
    from shapely.geometry import Polygon

    folder = OUT / "segmentation_mask"
    (folder / "SegmentationClass").mkdir(parents=True, exist_ok=True)
    lines = [f"{name}:{r},{g},{b}::" for name, (r, g, b) in COLORS.items()]
    (folder / "labelmap.txt").write_text("\n".join(["# label:color_rgb:parts:actions", *lines]) + "\n")
    labels = rasterio.features.rasterize([(Polygon(points), CLASSES[name]) for name, points in SHAPES], (HEIGHT, WIDTH))
    palette = np.array(list(COLORS.values()), np.uint8)
    Image.fromarray(palette[labels]).save(folder / "SegmentationClass" / "map.png")
    save("segmentation_mask.png", labels)


def pictures() -> None:
    """One drawing as painters save it."""
    numbers = np.zeros((4, 6), np.uint8)
    numbers[1, 1:5], numbers[2, 1:3], numbers[2, 3], numbers[3, 0] = 1, 2, 3, 255
    save("gray.png", numbers)
    colors = np.array([(0, 0, 0), (86, 156, 214), (244, 200, 120), (206, 68, 84)], np.uint8)
    colors = np.vstack([colors, np.full((252, 3), 255, np.uint8)])
    Image.fromarray(colors[numbers]).save(OUT / "rgb.png")
    alpha = np.where(numbers > 0, 255, 0).astype(np.uint8)
    # A transparent pixel may have any color.
    hidden = np.where(alpha[..., None] > 0, colors[numbers], 77)
    Image.fromarray(np.dstack([hidden, alpha]).astype(np.uint8)).save(OUT / "rgba.png")
    palette = Image.fromarray(numbers, "P")
    palette.putpalette(colors.flatten().tolist())
    palette.save(OUT / "palette_by_color.png")
    # Pascal VOC's colors: only the places in the palette are meant.
    voc = []
    for k in range(256):
        r = g = b = 0
        c = k
        for j in range(8):
            r |= (c >> 0 & 1) << 7 - j
            g |= (c >> 1 & 1) << 7 - j
            b |= (c >> 2 & 1) << 7 - j
            c >>= 3
        voc.append([r, g, b])
    palette.putpalette(np.array(voc, np.uint8).flatten().tolist())
    palette.save(OUT / "palette_by_place.png")
    Image.fromarray(numbers.astype(np.uint16)).save(OUT / "gray16.png")
    Image.fromarray((numbers.astype(np.uint32) * 257).astype(np.uint16)).save(OUT / "gray16_widened.png")


if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    for make in (labelme, coco, geojson, segmentation_mask, pictures):
        if len(sys.argv) < 2 or make.__name__ in sys.argv[1:]:
            make()
