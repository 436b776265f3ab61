"""``placegraph fleet``: many maps into a GeoParquet data set, from the shell."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from ..errors import Error


def main(arguments: Sequence[str]) -> int:
    """Runs the command: 0 if all maps have results, 1 if some do not, 2 if the run could not be made."""
    args = _parser().parse_args(arguments)
    try:
        from . import label_maps
    except ModuleNotFoundError as error:
        print(f"error: {error}: pip install 'placegraph[geo]'", file=sys.stderr)
        return 2
    try:
        summary = label_maps(
            list(_found(args.maps)),
            args.out,
            engine=args.engine,
            model=args.model,
            previous=args.previous,
            workers=args.workers,
            on_part=_tell,
        )
    except (Error, ImportError, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(summary)
    return 1 if summary.failed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="placegraph fleet", description="Labels many maps into a GeoParquet data set: docs/fleet.md."
    )
    parser.add_argument("maps", nargs="+", metavar="MAP", help="maps, URLs of maps, or folders to search for map.yaml files")
    parser.add_argument("-o", "--out", required=True, metavar="DIR", help="folder of the data set")
    parser.add_argument("--engine", choices=("local", "ray", "dask"), default="local", help="where the work is done [local]")
    parser.add_argument("--model", metavar="FILE", help="model to label with [the one inside the program]")
    parser.add_argument("--previous", metavar="DIR", help="keep the numbers and names of this earlier data set")
    parser.add_argument("--workers", type=int, metavar="N", help="maps that are labeled at a time [one a core]")
    return parser


def _found(maps: Sequence[str]) -> Iterator[str]:
    for path in maps:
        if not os.path.isdir(path):
            yield path
            continue
        for folder, folders, files in os.walk(path):
            folders.sort()
            yield from (os.path.join(folder, name) for name in sorted(files) if name == "map.yaml")


def _tell(rows: list[dict[str, Any]]) -> None:
    for row in rows:
        why = f": {row['error']}" if row["status"] == "failed" else ""
        print(f"{row['site']}: {row['status']}{why}", file=sys.stderr)
