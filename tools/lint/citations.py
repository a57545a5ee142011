"""Checks citations: each key in brackets, such as [johnson1985], is an entry of docs/references.bib;
each entry is cited; no text refers to a folder of papers or to files above the project."""

import re
from pathlib import Path

from tree import lines_of, main, project_files

BIBLIOGRAPHY = Path("docs/references.bib")
TEXTS = (".cc", ".cmake", ".h", ".md", ".py", ".sv", ".yaml")
ENTRY = re.compile(r"@\w+\{(\w+),")
CITATION = re.compile(r"\[([a-z]+[12]\d{3}[a-z]?)\]")
OUTSIDE = re.compile(r"(?<![\w/.])(?:papers|\.\./shared)/")


def check(root):
    entries = {}
    if (Path(root) / BIBLIOGRAPHY).is_file():
        for number, line in lines_of(root, BIBLIOGRAPHY):
            entry = ENTRY.match(line)
            if entry and entry[1] in entries:
                yield f"{BIBLIOGRAPHY}:{number}: {entry[1]} is already on line {entries[entry[1]]}"
            elif entry:
                entries[entry[1]] = number
    cited = set()
    for path in project_files(root):
        if path.suffix not in TEXTS or "corpus" in path.parts:
            continue
        for number, line in lines_of(root, path):
            keys = CITATION.findall(line)
            cited.update(keys)
            for key in keys:
                if key not in entries:
                    yield f"{path}:{number}: [{key}] is not an entry of {BIBLIOGRAPHY}"
            outside = OUTSIDE.search(line)
            if outside:
                yield f"{path}:{number}: {outside[0]} is not in the tree; cite an entry of {BIBLIOGRAPHY}"
    for key, number in entries.items():
        if key not in cited:
            yield f"{BIBLIOGRAPHY}:{number}: {key} is not cited"


if __name__ == "__main__":
    main(check)
