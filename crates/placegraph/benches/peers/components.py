"""Connected components by OpenCV and SciPy on the labels of benches/stages.rs and benches/regions.rs.

    PLACEGRAPH_DUMP=folder cargo bench -p placegraph --bench stages --bench regions
    python components.py folder

Both know only two colors, so each class is looked at alone, as one has to. Prints processor seconds, best of three,
on one thread, with the number of components: eight neighbors.
"""

import sys
import time
from pathlib import Path

import cv2
import numpy as np
from record import record
from scipy import ndimage

N_CLASSES = 3
EIGHT = np.ones((3, 3))


def opencv(image):
    return cv2.connectedComponentsWithStats(image, connectivity=8, ltype=cv2.CV_32S)[0] - 1


def scipy(image):
    labels, n = ndimage.label(image, structure=EIGHT)
    np.bincount(labels.ravel(), minlength=n + 1)
    return n


def main():
    cv2.setNumThreads(1)
    for file in sorted(Path(sys.argv[1]).glob("*.cells")):
        width, height = (int(side) for side in file.stem.split("x"))
        cells = np.fromfile(file, dtype=np.uint8).reshape(height, width)
        n_free = int((cells > 0).sum())
        for name, run in [(f"OpenCV {cv2.__version__}", opencv), ("SciPy", scipy)]:
            best, n = np.inf, 0
            for _ in range(3):
                start = time.process_time()
                n = sum(run((cells == k + 1).astype(np.uint8)) for k in range(N_CLASSES))
                best = min(best, time.process_time() - start)
            record("regions", name, n_free, best)
            print(f"{width}x{height}, {name}: {n} components, {best:.4f} s", flush=True)


if __name__ == "__main__":
    main()
