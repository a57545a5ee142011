"""Every C++ file is laid out as .clang-format says. `clang_format.py ROOT --fix` rewrites the files instead."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tree import HAS_CLANG_14, main, project_files

PROGRAM = "clang-format-14"


def sources(root):
    return [path for path in project_files(root) if path.suffix in (".h", ".cc")]


def run(root, path, *options):
    return subprocess.run([PROGRAM, "--style=file", *options, path], cwd=root, capture_output=True, text=True, check=True).stdout


def check(root):
    def faulty(path):
        return run(root, path) != (Path(root) / path).read_text(encoding="utf-8")

    paths = sources(root)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for path, fault in zip(paths, pool.map(faulty, paths)):
            if fault:
                yield f"{path}: not as .clang-format says; mend with: tools/lint/clang_format.py . --fix"


if __name__ == "__main__":
    if not HAS_CLANG_14:
        print(f"Layout is checked on Debian 12, which has {PROGRAM}: not here")
        sys.exit(77)
    if sys.argv[2:] == ["--fix"]:
        for source in sources(sys.argv[1]):
            run(sys.argv[1], source, "-i")
    else:
        main(check)
