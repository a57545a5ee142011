"""The steps that a text asks of its reader.

A block of commands begins with ```sh. The block ```sh no-run is not run. A line of a command begins
with one of PROGRAMS. A block whose first line names a file, such as ```yaml first.yaml, is the
content of that file.
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools/lint"))
from tree import project_files  # noqa: E402

FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PROGRAMS = ("./slipbench ", "build/release/bin/", "build/venv/bin/python ")
HISTORY = "CHANGELOG.md"  # names old commands


def texts(root):
    """{path: text} of every text of the project."""
    return {
        str(path): (root / path).read_text(encoding="utf-8")
        for path in project_files(root)
        if path.suffix == ".md" and path.name != HISTORY
    }


def commands(text):
    """The steps of a reader, in order.

    ("file", name, content), or ("run", command) without its comment.
    """
    for heading, content in FENCE.findall(text):
        words = heading.split()
        if len(words) == 2 and words[0] != "sh":
            yield "file", words[1], content
        elif words in ([], ["sh"]):
            for line in re.sub(r"\s*\\\n\s*", " ", content).splitlines():
                command = re.sub(r"(?:^|\s+)#\s.*", "", line).strip()
                if command.startswith(PROGRAMS):
                    yield "run", command
