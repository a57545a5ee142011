"""Every command in a text's block ```sh ends with exit status 0.

Arguments: the project's root, the folder of the built programs, and the texts (default: all). The
steps of a text run in order, in a temporary folder with the scenes, the program as ./slipbench and
build/; files shown in the text are written there first.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from steps import commands, texts

ROOT, BINARIES = (Path(argument).resolve() for argument in sys.argv[1:3])
ONLY = sys.argv[3:]


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


chosen = {path: text for path, text in texts(ROOT).items() if not ONLY or path in ONLY}
if missing := set(ONLY) - set(chosen):
    sys.exit(f"no such texts: {', '.join(missing)}")
failed = [f"{path}: {failure}" for path, text in chosen.items() for failure in failures(text)]
print("\n".join(failed))
sys.exit(f"{len(failed)} commands failed" if failed else 0)
