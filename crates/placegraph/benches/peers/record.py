"""Where peers leave their times, for `benches/page.py`: a line of JSON each in `target/peers.jsonl`."""

import json
from pathlib import Path

FILE = Path(__file__).parents[4] / "target" / "peers.jsonl"


def record(stage, peer, size, seconds):
    """`stage` and `size` are those of our bench; the latest line of a stage, peer and size counts."""
    FILE.parent.mkdir(exist_ok=True)
    with FILE.open("a") as file:
        print(json.dumps({"stage": stage, "peer": peer, "size": size, "seconds": seconds}), file=file)
