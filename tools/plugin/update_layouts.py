"""update_layouts.py [--check]: writes sim/mujoco/releases/layouts.h.

Compiles sim/mujoco/releases/layout.c with the headers of every release that
tools/setup/requirements-mujoco.in lists, and of the pinned one. Needs
`tools/setup/setup.sh python mujoco-all`. --check: writes nothing; compares the rows of the releases
that are installed, and fails if a row differs or is missing.
"""

import argparse
import ctypes
import re
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "sim/mujoco/releases"
TABLE = FOLDER / "layouts.h"
HEAD = """// Written by tools/plugin/update_layouts.py.
#pragma once

#include "sim/mujoco/releases/members.h"

namespace slipbench {

struct Release {
  const char* version;  // "3.3.7"
  SlipbenchLayout layout;
};

// The known releases, oldest first.
// clang-format off
inline constexpr Release releases[] = {
"""
TAIL = """};
// clang-format on

}  // namespace slipbench
"""
FIRST = ["version", "sleep_flag", "discrete", "mjvGeom_size", "qM"]  # of SlipbenchLayout


def listed():
    """Returns the releases by version, oldest first, each with the folder of its headers."""
    text = "".join(
        (ROOT / "tools/setup" / name).read_text(encoding="utf-8")
        for name in ("requirements-mujoco.in", "requirements.in")
    )
    versions = re.findall(r"^mujoco(?:-core)?==([\d.]+)", text, re.M)
    pinned = next((ROOT / "build/venv").glob("lib/python3*/site-packages/mujoco/include"), None)
    found = {version: ROOT / "build/mujoco" / version / "mujoco/include" for version in versions}
    return {**found, versions[-1]: pinned or found[versions[-1]]}


def layout_of(headers):
    """Returns the values of SlipbenchLayout for the release with these headers."""
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "layout.so"
        subprocess.run(
            ["cc", "-shared", "-fPIC", f"-I{headers}", "-o", library, FOLDER / "layout.c"],
            check=True,
        )
        loaded = ctypes.CDLL(str(library))
        names = ctypes.c_char * 10000
        members = names.in_dll(loaded, "slipbench_mujoco_members").value.decode().split()
        values = (ctypes.c_int * (len(FIRST) + len(members))).in_dll(
            loaded, "slipbench_mujoco_layout"
        )
        return list(values)


def row(version, values):
    numbers = textwrap.wrap(", ".join(map(str, values)), 96, break_on_hyphens=False)
    lines = "\n     ".join(numbers)
    return f'{{"{version}",\n    {{{lines}}}}},\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare the rows, write nothing")
    check = parser.parse_args().check
    releases = listed()
    rows = {
        version: row(version, layout_of(headers))
        for version, headers in releases.items()
        if headers.exists() or not check
    }
    if not check:
        TABLE.write_text(
            HEAD + "".join(rows.values()) + TAIL,
            encoding="utf-8",
        )
        return
    text = TABLE.read_text(encoding="utf-8")
    wrong = [version for version, line in rows.items() if line not in text]
    if re.findall(r'^\{"([\d.]+)"', text, re.M) != list(releases) or wrong:
        sys.exit(
            f"update_layouts.py: {TABLE} differs from the headers ({', '.join(wrong) or 'other releases'}); run tools/plugin/update_layouts.py"
        )
    print(f"compared: {', '.join(rows)}")


if __name__ == "__main__":
    main()
