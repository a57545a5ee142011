"""Every shell script passes shellcheck."""

import subprocess
from pathlib import Path

from tree import main, project_files


def is_script(root, path):
    with (Path(root) / path).open("rb") as file:
        first = file.readline()
    return first.startswith(b"#!") and (b"bash" in first or first.rstrip().endswith(b"sh"))


def check(root):
    scripts = [path for path in project_files(root) if is_script(root, path)]
    result = subprocess.run(["shellcheck", "--external-sources", "--format=gcc", *scripts], cwd=root, capture_output=True, text=True, check=False)
    yield from (result.stdout + result.stderr).splitlines()


if __name__ == "__main__":
    main(check)
