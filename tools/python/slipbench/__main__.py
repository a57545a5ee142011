"""The program `slipbench`, as a module and as the command that `pip install` makes."""

import sys

from slipbench.bin import _core


def main() -> int:
    """Runs the command line with this process's arguments; returns its exit status."""
    return _core.main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
