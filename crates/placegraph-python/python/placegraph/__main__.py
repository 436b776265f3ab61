"""``python -m placegraph`` is the command ``placegraph``."""

import sys

from ._program import main

sys.exit(main())
