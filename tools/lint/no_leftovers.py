"""Checks that there are no markers of unfinished work, no unfilled placeholders in texts, no code
in comments, and no file over 1 MB."""

import re
from pathlib import Path

from tree import lines_of, main, project_files

# Brackets keep the patterns from matching this file.
MARKER = re.compile(r"\b(T[O]DO|FI[X]ME|X[X]X|HA[C]K)\b")
PLACEHOLDER = re.compile(
    r"@[A-Z][A-Z0-9_]*@"
)  # CMake fills such placeholders in its *.in files only
SLASH_CODE = re.compile(
    r"^\s*//(?!/).*[;{]\s*$|^\s*//\s*}|^\s*//\s*#\s*(include|define|if)\b|^\s*#\s*if\s+0\b"
)
HASH_CODE = re.compile(
    r"^\s*#\s*(import \w+|from \w+ import|def \w+\(|return\b.*\)|print\(.*\)|\w+\(.*\)|\w+ = \w+\(.*\))\s*$"
)
COMMENTED_CODE = {
    ".h": SLASH_CODE,
    ".cc": SLASH_CODE,
    ".js": SLASH_CODE,
    ".py": HASH_CODE,
    ".sh": HASH_CODE,
}
SOURCES = (*COMMENTED_CODE, ".cmake", ".css", ".sv", ".txt", ".html", ".yaml")
MAX_BYTES = 1_000_000


def check(root):
    for path in project_files(root):
        size = (Path(root) / path).stat().st_size
        if size > MAX_BYTES:
            yield f"{path}: {size} bytes, at most {MAX_BYTES} are allowed"
            continue
        if path.suffix == ".md":
            for number, line in lines_of(root, path):
                for placeholder in PLACEHOLDER.findall(line):
                    yield f"{path}:{number}: unfilled place: {placeholder}"
        if path.suffix not in SOURCES or "corpus" in path.parts:
            continue
        for number, line in lines_of(root, path):
            if MARKER.search(line):
                yield f"{path}:{number}: marker of unfinished work: {line.strip()}"
            if path.suffix in COMMENTED_CODE and COMMENTED_CODE[path.suffix].search(line):
                yield f"{path}:{number}: code in a comment: {line.strip()}"


if __name__ == "__main__":
    main(check)
