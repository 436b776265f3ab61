"""Alpha-expansion by PyMaxflow on the problems of benches/amn.rs (testkit::networks::smooth_problem).

    python -m venv env && env/bin/pip install -r requirements.txt && env/bin/python alpha_expansion.py

Prints the score (higher is better), the processor time of the best of three runs, and the part of it inside max-flow.
"""

import sys
import time

import maxflow
import numpy as np
from record import record


def hash64(index):
    z = (index + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def smooth_unaries(width, height, n_labels):
    theta = np.empty((height, width, n_labels))
    for k in range(n_labels):
        index = np.arange(k * width * height, (k + 1) * width * height, dtype=np.uint64)
        noise = np.pad((hash64(index) >> np.uint64(40)).reshape(height, width), 2)
        total = sum(noise[v : v + height, u : u + width] for v in range(5) for u in range(5))
        theta[..., k] = (total * np.uint64(40) >> np.uint64(24)).astype(float)
    return theta


STEPS = {4: [(0, 1), (1, 0)], 8: [(0, 1), (1, -1), (1, 0), (1, 1)]}
STRUCTURES = {(0, 1): [[0, 0, 0], [0, 0, 1], [0, 0, 0]], (1, 0): [[0, 0, 0], [0, 0, 0], [0, 1, 0]],
              (1, 1): [[0, 0, 0], [0, 0, 0], [0, 0, 1]], (1, -1): [[0, 0, 0], [0, 0, 0], [1, 0, 0]]}


def pairs(array, step):
    """The two ends of all edges in direction `step`, as views."""
    dy, dx = step
    h, w = array.shape[:2]
    if dx >= 0:
        return array[: h - dy, : w - dx], array[dy:, dx:]
    return array[: h - dy, -dx:], array[dy:, : w + dx]


def score(theta, reward, labels, connectivity):
    nodes = np.take_along_axis(theta, labels[..., None], axis=2).sum()
    return nodes + reward * sum((a == b).sum() for a, b in (pairs(labels, s) for s in STEPS[connectivity]))


def expand(theta, reward, connectivity):
    """Potts with one reward: energy -theta + reward [differ]; expansion moves until none changes a label."""
    h, w, n_labels = theta.shape
    labels = theta.argmax(axis=2)
    seconds, unchanged, alpha = 0.0, 0, 0
    while unchanged < n_labels:
        graph = maxflow.Graph[float](h * w, h * w * len(STEPS[connectivity]))
        nodes = graph.add_grid_nodes((h, w))
        excess = theta[..., alpha] - np.take_along_axis(theta, labels[..., None], axis=2)[..., 0]
        fixed = labels == alpha
        for step in STEPS[connectivity]:
            p, q = pairs(labels, step)
            stay = np.where((p == q) & (p != alpha), reward, 0.0)
            free = (p != alpha) & (q != alpha)
            capacity = np.zeros((h, w))
            first, second = pairs(capacity, step)
            first[...] = np.where(free, (stay + reward) / 2, 0.0)
            graph.add_grid_edges(nodes, capacity, structure=np.array(STRUCTURES[step]), symmetric=True)
            ends = pairs(excess, step)
            half = np.where(free, (reward - stay) / 2, 0.0)
            ends[0][...] += half + np.where((q == alpha) & (p != alpha), reward, 0.0)
            ends[1][...] += half + np.where((p == alpha) & (q != alpha), reward, 0.0)
        excess[fixed] = 0.0
        graph.add_grid_tedges(nodes, np.maximum(excess, 0.0), np.maximum(-excess, 0.0))
        start = time.process_time()
        graph.maxflow()
        seconds += time.process_time() - start
        # A node that is free either way stays, as with us.
        change = ~graph.get_grid_segments(nodes) & ~fixed & (labels != alpha)
        before = score(theta, reward, labels, connectivity)
        candidate = np.where(change, alpha, labels)
        improved = score(theta, reward, candidate, connectivity) > before
        labels = candidate if improved else labels
        unchanged = 1 if improved else unchanged + 1
        alpha = (alpha + 1) % n_labels
    return labels, seconds


def main():
    sides = [int(a) for a in sys.argv[1:]] or [100, 361, 1000]
    print(f"PyMaxflow {maxflow.__version__}")
    for side in sides:
        theta = smooth_unaries(side, side, 3)
        for connectivity in (4, 8):
            for reward in (10.0, 40.0):
                best = (np.inf, np.inf)
                for _ in range(3):
                    start = time.process_time()
                    labels, inside = expand(theta, reward, connectivity)
                    best = min(best, (time.process_time() - start, inside))
                name = f"{'Four' if connectivity == 4 else 'Eight'}, reward {reward:g}"
                for part, seconds in (("", best[0]), (", max-flow alone", best[1])):
                    record(f"alpha-expansion, {name}", f"PyMaxflow {maxflow.__version__}{part}", side * side, seconds)
                print(f"{side}x{side} {connectivity}-connected reward {reward:g}: score "
                      f"{score(theta, reward, labels, connectivity):.0f}  total {best[0]:.3f} s  "
                      f"max-flow {best[1]:.3f} s", end="")
                if connectivity == 4:
                    binary = reward * (1 - np.eye(3))
                    start = time.process_time()
                    own = maxflow.aexpansion_grid(-theta, binary, labels=theta.argmax(axis=2))
                    seconds = time.process_time() - start
                    record(f"alpha-expansion, {name}", f"PyMaxflow {maxflow.__version__}, its aexpansion_grid", side * side,
                           seconds)
                    print(f"  aexpansion_grid: score {score(theta, reward, own, 4):.0f}  {seconds:.3f} s", end="")
                print(flush=True)


if __name__ == "__main__":
    main()
