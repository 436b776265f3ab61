"""run_on_cluster.py ENGINE SITES.json OUT: labels the sites on a cluster of two nodes, and loses one of them if asked to."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from pathlib import Path

from placegraph import fleet


def main(engine: str, sites: Path, out: Path) -> None:
    maps = json.loads(sites.read_text())
    is_lost = threading.Event()

    def lose(node_lost: object) -> None:
        """Takes the second node away once the first part is done."""
        while not list(out.glob("maps/part-*.parquet")):
            time.sleep(0.02)
        node_lost()  # type: ignore[operator]
        is_lost.set()

    if engine.startswith("ray"):
        import ray
        from ray.cluster_utils import Cluster

        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
        second = cluster.add_node(num_cpus=1)
        ray.init(address=cluster.address, log_to_driver=False)
        cluster.wait_for_nodes()
        thread = threading.Thread(target=lose, args=(lambda: cluster.remove_node(second, allow_graceful=False),))
        end = ray.shutdown
    else:
        from distributed import Client, LocalCluster

        cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
        client = Client(cluster)
        thread = threading.Thread(target=lose, args=(lambda: os.kill(cluster.workers[1].pid, signal.SIGKILL),))
        end = client.close
    if engine.endswith("lost"):
        thread.start()
    started = time.monotonic()
    summary = fleet.label_maps(maps, out, engine=engine.partition("-")[0], maps_per_part=2)  # type: ignore[arg-type]
    print(f"{summary}: {time.monotonic() - started:.2f} s")
    assert summary.n_labeled == len(maps), summary
    if engine.endswith("lost"):
        thread.join()
        assert is_lost.is_set()
    end()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
