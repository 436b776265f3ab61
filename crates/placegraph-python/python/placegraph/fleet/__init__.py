"""Many maps: labeled on one machine, on Ray or on Dask, into a GeoParquet data set (docs/fleet.md).

Needs PyArrow, which the extras ``[geo]``, ``[ray]`` and ``[dask]`` bring.
"""

from ._run import Summary, label_maps
from ._worker import LabelMaps

__all__ = ["LabelMaps", "Summary", "label_maps"]
