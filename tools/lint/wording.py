"""Checks texts, strings and comments for wording that most readers must read twice, and names what to
write instead.

ANYWHERE holds patterns for any line of a text or source, OPENINGS those for the beginning of a
comment or docstring. A line that continues a comment may begin with any word.
"""

import re

from tree import lines_of, main, project_files

ANYWHERE = {
    # "there is none" is plain, also with a line break after "there".
    r"(?<=\w )(?<!there )is none\b": "say what is wrong: is not, there is no, must be",
    r"\ballowed: that\b": "name what is allowed",
    r"\b(?:is|are|was|were|being|be) told\b": "gets, knows, reports, distinguishes",
    r"\bworked out\b": "computed",
    r"\bto the (?:last )?bit\b": "bit-identical",
    r"\blest\b": "so that ... not",
    r"\bstands? ahead\b": "is offset",
    r"\bhouse\b": "project",
}
OPENINGS = {
    "Of": "begin with the subject or a verb",
    "What": "begin with a verb, such as Returns or Holds",
    "Whether": "True if, Returns true if",
}
SLASHES, HASH = r"// ", r"# "
COMMENT = {".h": SLASHES, ".cc": SLASHES, ".js": SLASHES, ".py": rf"(?:{HASH}|\"\"\")", ".sh": HASH, ".cmake": HASH, ".txt": HASH}
CHECKED = (*COMMENT, ".md", ".yaml")
# The changelog is history; the other two files hold the patterns.
UNCHECKED = ("CHANGELOG.md", "tools/lint/wording.py", "tests/style/checks_test.py")


def check(root):
    anywhere = [(re.compile(pattern), instead) for pattern, instead in ANYWHERE.items()]
    words = "|".join(OPENINGS)
    for path in project_files(root):
        if path.suffix not in CHECKED or path.as_posix() in UNCHECKED or "corpus" in path.parts:
            continue
        marker = COMMENT.get(path.suffix)
        whole = re.compile(rf"^\s*{marker}")
        opening = re.compile(rf"(?:^\s*|\S  ){marker}({words}) ")
        previous = ""
        for number, line in lines_of(root, path):
            for pattern, instead in anywhere:
                if found := pattern.search(line):
                    yield f"{path}:{number}: '{found[0]}'; write instead: {instead}"
            found = opening.search(line) if marker else None
            if found and not (whole.match(line) and whole.match(previous)):
                yield f"{path}:{number}: a comment begins with '{found[1]}'; {OPENINGS[found[1]]}"
            previous = line


if __name__ == "__main__":
    main(check)
