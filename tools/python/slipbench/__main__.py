"""The program `slipbench`, as a module and as the command that `pip install` makes."""

import os
import sys

from slipbench.bin import _core


def main() -> int:
    """Runs the command line with this process's arguments; returns its exit status."""
    os.environ.setdefault("SLIPBENCH", f"{sys.executable} -m slipbench")  # how scripts that `cluster` writes start it again
    os.environ.setdefault("SLIPBENCH_PYTHON", sys.executable)  # what commands that are done in Python are started with
    return _core.main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
