"""LightGBM and scikit-learn with stumps on the examples of benches/learn.rs: one tree of two leaves per class and round.

    PLACEGRAPH_DUMP=folder cargo bench -p placegraph --bench learn -- boost
    python boosting.py folder [rounds]

Prints processor seconds, best of three, for 255 bins (LightGBM's own setting) and for as many as it can have: only
those come near to trying all thresholds. One thread; binning apart.
"""

import sys
import time
from pathlib import Path

import lightgbm
import numpy as np
import sklearn
from record import record
from sklearn.ensemble import HistGradientBoostingClassifier


def main():
    folder, rounds = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 100
    for labels_file in sorted(folder.glob("*.labels")):
        labels = np.fromfile(labels_file, dtype=np.uint8)
        values = np.fromfile(labels_file.with_suffix(".values"), dtype="<f4").reshape(-1, len(labels)).T
        n_classes = int(labels.max()) + 1
        print(f"LightGBM {lightgbm.__version__}, {labels_file.stem}: {values.shape[0]} examples x "
              f"{values.shape[1]} features, {n_classes} classes, {rounds} rounds")
        for max_bin in (255, 65535):
            parameters = dict(objective="multiclassova", num_class=n_classes, num_leaves=2, learning_rate=0.5,
                              min_data_in_leaf=1, max_bin=max_bin, min_data_in_bin=1,
                              num_threads=1, deterministic=True, force_col_wise=True, verbose=-1)
            best, binning = np.inf, np.inf
            for _ in range(3 if max_bin == 255 else 1):
                start = time.process_time()
                data = lightgbm.Dataset(values, labels, params=parameters).construct()
                binned = time.process_time()
                lightgbm.train(parameters, data, rounds)
                best, binning = min(best, time.process_time() - binned), min(binning, binned - start)
            record("boosting", f"LightGBM {lightgbm.__version__}, {max_bin} bins", len(labels), best + binning)
            print(f"  {max_bin} bins: {best:.2f} s, binning {binning:.2f} s", flush=True)
        stumps = HistGradientBoostingClassifier(max_iter=rounds, max_leaf_nodes=2, learning_rate=0.5, min_samples_leaf=1,
                                                early_stopping=False)
        start = time.process_time()
        stumps.fit(values, labels)
        seconds = time.process_time() - start
        record("boosting", f"scikit-learn {sklearn.__version__}, 255 bins", len(labels), seconds)
        print(f"scikit-learn {sklearn.__version__}, 255 bins: {seconds:.2f} s, all threads together", flush=True)


if __name__ == "__main__":
    main()
