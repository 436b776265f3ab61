"""The command ``placegraph``."""

from __future__ import annotations

import signal
import sys

from . import _native


def main() -> int:
    """Runs the program, or ``placegraph fleet``, and returns its exit status."""
    if sys.argv[1:2] == ["fleet"]:
        from .fleet import _program

        return _program.main(sys.argv[2:])
    # Ctrl-C ends the program at once, as it does without Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.run_program(["placegraph", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
