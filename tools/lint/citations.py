"""Checks citations.

Each key in brackets, such as [johnson1985], is an entry of docs/references.bib; each entry is
cited; no text refers to a folder of papers or to files above the project.
"""

import re
from pathlib import Path

from tree import lines_of, main, project_files

BIBLIOGRAPHY = Path("docs/references.bib")
TEXTS = (".cc", ".cmake", ".h", ".md", ".py", ".sv", ".yaml")
ENTRY = re.compile(r"@\w+\{(\w+),")
CITATION = re.compile(r"\[([a-z]+[12]\d{3}[a-z]?)\]")
OUTSIDE = re.compile(r"(?<![\w/.])(?:papers|\.\./shared)/")


def read_entries(root):
    """Lines of the bibliography's entries by key, and a fault for each repeated key."""
    entries, faults = {}, []
    if (Path(root) / BIBLIOGRAPHY).is_file():
        for number, line in lines_of(root, BIBLIOGRAPHY):
            entry = ENTRY.match(line)
            if entry and entry[1] in entries:
                first = entries[entry[1]]
                faults.append(f"{BIBLIOGRAPHY}:{number}: {entry[1]} is already on line {first}")
            elif entry:
                entries[entry[1]] = number
    return entries, faults


def cited_lines(root):
    """Yields path, number and text of each line that may cite."""
    for path in project_files(root):
        if path.suffix in TEXTS and "corpus" not in path.parts:
            for number, line in lines_of(root, path):
                yield path, number, line


def check(root):
    entries, repeated = read_entries(root)
    yield from repeated
    cited = set()
    for path, number, line in cited_lines(root):
        keys = CITATION.findall(line)
        cited.update(keys)
        for key in keys:
            if key not in entries:
                yield f"{path}:{number}: [{key}] is not an entry of {BIBLIOGRAPHY}"
        if outside := OUTSIDE.search(line):
            yield f"{path}:{number}: {outside[0]} is not in the tree; cite an entry of {BIBLIOGRAPHY}"
    for key, number in entries.items():
        if key not in cited:
            yield f"{BIBLIOGRAPHY}:{number}: {key} is not cited"


if __name__ == "__main__":
    main(check)
