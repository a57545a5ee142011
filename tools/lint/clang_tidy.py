"""Runs clang-tidy over the product's sources: clang_tidy.py ROOT BUILD.

BUILD holds compile_commands.json: ROOT/build/lint, which is configured first, or any other folder
that has one.

A compilation is checked again only if its preprocessed text, its flags or .clang-tidy changed;
BUILD/clang-tidy records the clean ones. As in the unity build, one compilation has several sources,
since clang-tidy spends its time on the headers that they share. Tests are excluded: the includes of
GoogleTest alone cost more than everything else.
"""

import hashlib
import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PROGRAM = "clang-tidy-14"
FOLDERS = ("sim", "sensors", "detectors", "controllers", "rtl", "tools", "python")
# MuJoCo indexes with int throughout and returns a plugin's data as an integer; tools/plugin
# compiles the same sources again.
OF_MUJOCO = ",-bugprone-implicit-widening-of-multiplication-result,-performance-no-int-to-ptr"
WITH_MUJOCO = ("sim/mujoco/", "tools/plugin/")
UNITY = (
    "-bugprone-suspicious-include"  # inherent to unity sources; include_rule.py finds it elsewhere
)


def commands(root, build):
    """(source, its folder, directory, compile command) of the product's own compilations."""
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        source = Path(entry["directory"], entry["file"]).resolve()
        unity = source.is_relative_to(build) and source.parent.name == "Unity"
        above = build if unity else root
        generated = any(
            f"/{target}.dir/" in str(source) for target in ("rtl_models", "nanobind-static")
        )
        if (
            source.is_relative_to(above)
            and source.relative_to(above).parts[0] in FOLDERS
            and not generated
        ):
            folder = (
                source.relative_to(above).as_posix().split("/CMakeFiles/")[0]
                if unity
                else source.relative_to(above).parent.as_posix()
            )
            yield source, folder, entry["directory"], shlex.split(entry["command"])


def fingerprint(root, directory, command):
    """Hash of all inputs of clang-tidy. Comments count: they may hold NOLINT."""
    output = command.index("-o")
    preprocess = [
        word
        for word in command[:output] + command[output + 2 :]
        if word not in ("-c", "ccache", "/usr/bin/ccache")
    ]
    text = subprocess.run(
        [*preprocess, "-E", "-C"], cwd=directory, capture_output=True, check=True
    ).stdout
    return hashlib.sha256(
        text + shlex.join(command).encode() + (root / ".clang-tidy").read_bytes()
    ).hexdigest()


def tidy(root, build, source, folder, directory, command):
    """Output of clang-tidy for a source; empty if it is clean."""
    clean = build / "clang-tidy" / fingerprint(root, directory, command)
    if clean.exists():
        return ""
    result = subprocess.run(
        [
            PROGRAM,
            "--quiet",
            f"--config-file={root / '.clang-tidy'}",
            f"--header-filter=^{root}/({'|'.join(FOLDERS)})/",
            f"--checks={UNITY}{OF_MUJOCO if f'{folder}/'.startswith(WITH_MUJOCO) else ''}",
            "--extra-arg=-Wno-unknown-warning-option",
            "-p",
            build,
            source,
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode == 0 and not result.stdout.strip():
        clean.parent.mkdir(exist_ok=True)
        clean.touch()
        return ""
    return result.stdout or result.stderr


def check_compilations(preset, check):
    """Prints the reports of all compilations of the product.

    Exits with status 1 if there are any. The folders ROOT and BUILD are the program's arguments.

    Args:
        preset: of CMake, with which ROOT/build/PRESET is configured first
        check: called with root, build and an entry of commands(); returns the report, empty if clean
    """
    if len(sys.argv) != 3:
        sys.exit(f"usage: {sys.argv[0]} ROOT BUILD")
    root, build = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    if build == root / "build" / preset:
        subprocess.run(
            ["cmake", "--preset", preset], cwd=root, stdout=subprocess.DEVNULL, check=True
        )
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        reports = list(pool.map(lambda entry: check(root, build, *entry), commands(root, build)))
    if not reports:
        sys.exit(f"{build}/compile_commands.json names no source of {root}")
    found = [report for report in reports if report]
    print("\n".join(found))
    sys.exit(f"{len(found)} of {len(reports)} sources have findings" if found else 0)


if __name__ == "__main__":
    check_compilations("lint", tidy)
