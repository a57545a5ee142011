"""Checks subjects of commits: `area: imperative summary`, at most 72 characters, in plain words.

The argument is the project's root, for the commits of the current branch, or a file with the
message of a commit. Checks at most 50 commits, and none before the last tag. Checks nothing outside
git.
"""

import re
import subprocess
import sys
from pathlib import Path

from tree import main
from wording import ANYWHERE

LONGEST = 72  # characters
MOST = 50  # commits
SHAPE = re.compile(r"[a-z][\w./+-]*: (?P<verb>\S+).*(?<!\.)")
# Such as "added" or "fixing"; the listed words are no participles.
PARTICIPLE = re.compile(
    r"(?!(?:embed|feed|need|seed|shed|speed|bring|ring|string)$)[a-z]+(?:ed|ing)"
)
# Git writes these itself.
GENERATED = ("Merge ", "Revert ", "fixup! ", "squash! ")


def findings_of(subject):
    if subject.startswith(GENERATED):
        return
    if len(subject) > LONGEST:
        yield f"{len(subject)} characters; allowed: {LONGEST}"
    shape = SHAPE.fullmatch(subject)
    if not shape:
        yield "expected 'area: imperative summary', such as 'cli: report unknown options'"
    elif PARTICIPLE.fullmatch(shape["verb"]):
        yield f"'{shape['verb']}' is not an imperative"
    for pattern, instead in ANYWHERE.items():
        if found := re.search(pattern, subject):
            yield f"'{found[0]}'; write instead: {instead}"


def git(root, *arguments):
    return subprocess.run(
        ["git", "-c", "safe.directory=*", "-C", root, *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def subjects(root):
    """(name, subject) of the commits to check."""
    if Path(root).is_file():
        lines = [
            line
            for line in Path(root).read_text(encoding="utf-8").splitlines()
            if not line.startswith("#")
        ]
        return [("message", next((line for line in lines if line.strip()), ""))]
    tag = git(root, "describe", "--tags", "--abbrev=0")
    span = [f"{tag.stdout.strip()}..HEAD"] if tag.returncode == 0 else []
    log = git(root, "log", f"--max-count={MOST}", "--no-merges", "--format=%h %s", *span)
    if log.returncode != 0:
        print("no git history; commits are not checked", file=sys.stderr)
    return [tuple(line.split(" ", 1)) for line in log.stdout.splitlines()]


def check(root):
    for name, subject in subjects(root):
        for finding in findings_of(subject):
            yield f"{name}: {subject}: {finding}"


if __name__ == "__main__":
    main(check)
