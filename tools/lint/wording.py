"""Checks texts, messages and comments for wording that most readers must read twice, and names what
to write instead.

ANYWHERE holds patterns for any line of a text or source, MESSAGES those for strings in sources, and
OPENINGS those for the beginning of a comment or docstring. A line that continues a comment may
begin with any word.
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
MESSAGES = {
    r"(?<![Tt]here )\b(?:is|are) no (?!longer\b|more\b)": "is not a, has no, must be",
    r"\ballowed: (?:it|these|those|them|one that|none that|as many|both|the same|at most that|up to that)\b": "name what is allowed",
    r"\b(?:gone|goes|go|went) wrong\b": "diverges, fails",
    r"\b(?:stands?|stood) (?:beside|in|there)\b": "is",
    r"\bgoes? on with\b": "continues",
    r"\bfor want of\b": "without, because ... is missing",
    r"\bleft aside\b": "ignored",
    r"\bneeded: ": "expected",
}
OPENINGS = {
    "Of": "begin with the subject or a verb",
    "What": "begin with a verb, such as Returns or Holds",
    "Whether": "True if, Returns true if",
}
SLASHES, HASH = r"// ", r"# "
COMMENT = {
    ".h": SLASHES,
    ".cc": SLASHES,
    ".js": SLASHES,
    ".py": rf"(?:{HASH}|\"\"\")",
    ".sh": HASH,
    ".cmake": HASH,
    ".txt": HASH,
}
LITERAL = re.compile(r'"(?:[^"\\]|\\.)*"|(?<!\w)\'(?:[^\'\\]|\\.)*\'')
WITH_MESSAGES = (".h", ".cc", ".js", ".py")
CHECKED = (*COMMENT, ".md", ".yaml")
# The changelog is history; the other two files hold the patterns.
UNCHECKED = ("CHANGELOG.md", "tools/lint/wording.py", "tests/style/checks_test.py")


def compiled(patterns):
    return [(re.compile(pattern), instead) for pattern, instead in patterns.items()]


def check(root):
    anywhere, messages = compiled(ANYWHERE), compiled(MESSAGES)
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
            literals = (
                LITERAL.findall(line)
                if path.suffix in WITH_MESSAGES and not whole.match(line)
                else []
            )
            for pattern, instead in messages:
                if found := next(filter(None, map(pattern.search, literals)), None):
                    yield f"{path}:{number}: a message says '{found[0].strip()}'; write instead: {instead}"
            found = opening.search(line) if marker else None
            if found and not (whole.match(line) and whole.match(previous)):
                yield f"{path}:{number}: a comment begins with '{found[1]}'; {OPENINGS[found[1]]}"
            previous = line


if __name__ == "__main__":
    main(check)
