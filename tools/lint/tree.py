"""Lists the project's files and reports findings; shared by the checks of this folder."""

import subprocess
import sys
from pathlib import Path


def project_files(root):
    """Paths of the project's files relative to root, sorted: files that git tracks or would track.

    Outside git, all except build/ and hidden files.
    """
    listed = subprocess.run(
        [
            "git",
            "-c",
            "safe.directory=*",
            "-C",
            root,
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode == 0:
        names = [Path(name) for name in listed.stdout.split("\0") if name]
    else:
        names = [path.relative_to(root) for path in Path(root).rglob("*")]
        names = [
            name
            for name in names
            if name.parts[0] != "build" and not any(part.startswith(".") for part in name.parts)
        ]
    return sorted({name for name in names if (Path(root) / name).is_file()})


def lines_of(root, path):
    """Numbered lines of a text file, without line ends."""
    return enumerate((Path(root) / path).read_text(encoding="utf-8").splitlines(), start=1)


def main(check):
    """Runs check(root), which yields findings as text, for the root on the command line.

    Exits with 1 if there are any.
    """
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} ROOT")
    findings = list(check(sys.argv[1]))
    for finding in findings:
        print(finding)
    sys.exit(f"{len(findings)} findings" if findings else 0)
