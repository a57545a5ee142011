"""Lists the warnings and errors of clang 16 in the product's sources: clang_warnings.py ROOT BUILD.
BUILD holds compile_commands.json: ROOT/build/clang, which is configured first, or any other folder
that has one.

The sources are only parsed, which takes a fifth of the time of a build. Tests are excluded: they
would double the time, and users do not compile them.
"""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from clang_tidy import commands

PROGRAM = "clang++-16"


def warnings(directory, command):
    """Output of clang for a source; empty if there is no warning."""
    output = command.index("-o")
    words = [word for word in command[:output] + command[output + 2:] if word not in ("ccache", "/usr/bin/ccache")]
    result = subprocess.run([PROGRAM, *words[1:], "-fsyntax-only"], cwd=directory, capture_output=True, text=True, check=False)
    return result.stderr or ("" if result.returncode == 0 else f"{words[-1]}: status {result.returncode}\n")


def main():
    if len(sys.argv) != 3:
        sys.exit(f"usage: {sys.argv[0]} ROOT BUILD")
    root, build = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    if build == root / "build" / "clang":
        subprocess.run(["cmake", "--preset", "clang"], cwd=root, stdout=subprocess.DEVNULL, check=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        reports = list(pool.map(lambda entry: warnings(*entry[2:]), commands(root, build)))
    if not reports:
        sys.exit(f"{build}/compile_commands.json names no source of {root}")
    found = [report for report in reports if report]
    print("\n".join(found))
    sys.exit(f"{len(found)} of {len(reports)} sources have warnings" if found else 0)


if __name__ == "__main__":
    main()
