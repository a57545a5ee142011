"""Every command in a text's block ```sh ends with exit status 0.

Arguments: the project's root, the folder of the built programs, and the texts (default: all). The
steps of a text run in order, in a temporary folder with the scenes, the program as ./slipbench and
build/; files shown in the text are written there first.

A block of commands begins with ```sh. The block ```sh no-run is not run. A line of a command begins
with one of PROGRAMS. A block whose first line names a file, such as ```yaml first.yaml, is the
content of that file.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT, BINARIES = (Path(argument).resolve() for argument in sys.argv[1:3])
ONLY = sys.argv[3:]
sys.path.insert(0, str(ROOT / "tools/lint"))
from tree import project_files  # noqa: E402

FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PROGRAMS = ("./slipbench ", "build/release/bin/", "build/venv/bin/python ")
HISTORY = "CHANGELOG.md"  # names old commands


def texts():
    """{path: text} of every text of the project."""
    return {
        str(path): (ROOT / path).read_text(encoding="utf-8")
        for path in project_files(ROOT)
        if path.suffix == ".md" and path.name != HISTORY
    }


def commands(text):
    """The steps of a reader, in order: ("file", name, content), or ("run", command) without its
    comment."""
    for heading, content in FENCE.findall(text):
        words = heading.split()
        if len(words) == 2 and words[0] != "sh":
            yield "file", words[1], content
        elif words in ([], ["sh"]):
            for line in re.sub(r"\s*\\\n\s*", " ", content).splitlines():
                command = re.sub(r"(?:^|\s+)#\s.*", "", line).strip()
                if command.startswith(PROGRAMS):
                    yield "run", command


def make_folder(folder):
    shutil.copytree(ROOT / "scenes", folder / "scenes")
    (folder / "slipbench").symlink_to(BINARIES / "slipbench")
    (folder / "build/release").mkdir(parents=True)
    (folder / "build/release/bin").symlink_to(BINARIES)
    (folder / "build/release/python").symlink_to(BINARIES.parent / "python")
    (folder / "build/venv").symlink_to(sys.prefix)


def failures(text):
    """Yields the text's failing commands, each with its output."""
    steps = list(commands(text))
    if not any(step[0] == "run" for step in steps):
        return
    with tempfile.TemporaryDirectory() as name:
        make_folder(Path(name))
        for kind, *step in steps:
            if kind == "file":
                (Path(name) / step[0]).write_text(step[1], encoding="utf-8")
                continue
            done = subprocess.run(
                ["bash", "-c", step[0]],
                cwd=name,
                capture_output=True,
                text=True,
                check=False,
                timeout=300,
                env={**os.environ, "PYTHONPATH": "build/release/python"},
            )
            print(f"{done.returncode} {step[0]}", flush=True)
            if done.returncode != 0:
                yield f"{step[0]}\n{done.stdout}{done.stderr}"


chosen = {path: text for path, text in texts().items() if not ONLY or path in ONLY}
if missing := set(ONLY) - set(chosen):
    sys.exit(f"no such texts: {', '.join(missing)}")
failed = [f"{path}: {failure}" for path, text in chosen.items() for failure in failures(text)]
print("\n".join(failed))
sys.exit(f"{len(failed)} commands failed" if failed else 0)
