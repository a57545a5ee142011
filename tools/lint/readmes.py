"""What the texts say of the tree is true: every folder of sources has a README.md, and in every text (README.md, RESULTS.md and the like)

- a relative link leads to a file, and its anchor to a heading;
- a name in backticks or a path from the root that looks like a file (its beginning is a folder of the tree, or its end one of CODE) is one;
  `*` and `{a,b}` mean what they mean in a shell, a name in capitals (SCENE.yaml) stands for any;
- a function (`name()`), a member (`Class::name`) or a name of several words (`TwoWords`, `two_words`) in backticks is a word of the sources.

A block of commands is one of ```sh; `commands()` collects its lines, which start with one of PROGRAMS, and tests/style runs them.
The block ```sh no-run is not run. A fence stands at the line's begin. A block whose first line names a file, as ```yaml first.yaml, is what that file holds.

README.md of the root, the door, has at most DOOR_LINES lines of at most DOOR_COLUMNS; rows of tables, code and lines that are one link may be longer.
"""

import fnmatch
import os
import re
from pathlib import Path

from tree import main, project_files

SOURCES = (".h", ".cc", ".py", ".sh", ".cmake", ".txt", ".js", ".css", ".sv", ".yaml")
CODE = (".h", ".cc", ".py", ".js", ".yaml", ".sv", ".sh", ".cmake")
DOOR = Path("README.md")
DOOR_LINES, DOOR_COLUMNS = 130, 100
HISTORY = "CHANGELOG.md"  # names what was there at its time
FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE_SPAN = re.compile(r"`([^`]+)`")
LINK = re.compile(r"\]\(([^)\s]+)(?: \"[^\"]*\")?\)")
OTHER_LINK = re.compile(r"^ *\[[^\]]+\]: |<(?:img|a) ", re.MULTILINE)
INDENTED_FENCE = re.compile(r"^ +```", re.MULTILINE)
SHELLS = ("bash", "console", "shell", "zsh")
PATH = re.compile(r"[\w.*{},-]+(/[\w.*{},-]+)*/?")
FUNCTION = re.compile(r"(?:\w+(?:::|\.|->))*~?(\w+)\(\)")
MEMBER = re.compile(r"(?:\w+::)+(\w+)")
NAME = re.compile(r"(~?(?:[A-Z][a-z0-9]+){2,}|[a-z0-9]+(?:_[a-z0-9]+)+)")
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]{2,}(?=\.(?!md)|_|/|$)")
BINARIES = "build/release/bin/"
PROGRAMS = ("./slipbench ", BINARIES, "build/venv/bin/python ")
UNCHECKED = re.compile(r"^(?: {4,}\./| *)slipbench (?:run|sweep|check|report|export|import|train|eval|cost|reproduce|bench|doctor|list|describe)\b.*", re.MULTILINE)


def explained(folder, files):
    """Whether a folder has a README.md or needs none of its own: what mirrors a source folder, a scene and a classifier do not."""
    if folder / "README.md" in files:
        return True
    if folder.parts[0] == "tests" and len(folder.parts) > 1:
        mirrored = Path(*folder.parts[1:])
        if any(path.is_relative_to(mirrored) for path in files):
            return True
        return len(folder.parts) > 2 and explained(folder.parent, files)
    if folder / "model.txt" in files:
        return explained(folder.parent, files)
    return folder.parts[0] == "scenes" and len(folder.parts) > 1 and explained(folder.parent, files)


def texts(root):
    """(path, text) of every text that is checked."""
    for path in project_files(root):
        if path.suffix == ".md" and path.name != HISTORY:
            yield path, (Path(root) / path).read_text(encoding="utf-8")


def blocks(text):
    """(words after the backticks, content) of the code blocks."""
    return [(words.split(), content) for words, content in FENCE.findall(text)]


def lines_of_commands(content):
    """The commands of a block, without comments, each on one line."""
    joined = re.sub(r"\s*\\\n\s*", " ", content)
    return [line for line in (re.sub(r"(?:^|\s+)#\s.*", "", line).strip() for line in joined.splitlines()) if line]


def commands(text):
    """The steps that a reader takes, in order: ("file", name, content), or ("run", command) with its comment cut off."""
    for words, content in blocks(text):
        if len(words) == 2 and words[0] != "sh":
            yield "file", words[1], content
        elif words in ([], ["sh"]):
            for command in lines_of_commands(content):
                if command.startswith(PROGRAMS):
                    yield "run", command


def anchor(heading):
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def headings(text):
    """The anchors of a text's headings."""
    return {anchor(line.lstrip("#")) for line in FENCE.sub("", text).splitlines() if line.startswith("#")}


def expand(name):
    """The names that braces stand for."""
    braces = re.search(r"\{([^{}]*)\}", name)
    if not braces:
        return [name]
    return [other for part in braces[1].split(",") for other in expand(name[:braces.start()] + part + name[braces.end():])]


class Tree:
    def __init__(self, root):
        self.root = Path(root)
        files = project_files(root)
        self.paths = {path.as_posix() for path in files} | {parent.as_posix() for path in files for parent in path.parents}
        self.folders = {part for path in files for part in path.parent.parts}
        self.top = "|".join(sorted({re.escape(path.parts[0]) for path in files if len(path.parts) > 1}))
        self.words = {path.stem for path in files} | self.folders
        for path in files:
            if path.suffix in (*SOURCES, ".xml", ".in"):
                for word in re.findall(r"\w+", (self.root / path).read_text(encoding="utf-8", errors="replace")):
                    self.words.update((word, word.strip("_")))
        self.words |= {name[:end.start()] for name in self.words for end in re.finditer("_", name)}  # as ctest -R takes them

    def holds(self, name, folder):
        """Whether `name`, with or without its extension, is the end of some path, or leads from `folder` to one."""
        if name.startswith("../"):
            name = os.path.normpath(folder / name)
        return all(any(fnmatch.fnmatch("/" + path, "*/" + end + tail) for path in self.paths for tail in ("", ".*"))
                   for end in expand(name.rstrip("/")))

    def missing(self, word, folder, own):
        """Whether a word in backticks names something that is not there; `own`: files that the text itself makes."""
        function = FUNCTION.fullmatch(word) or MEMBER.fullmatch(word) or NAME.fullmatch(word)
        if function:
            return re.sub(r"_t(est)?$", "", function[1]) not in self.words  # NAME_test is a program, NAME_t a time
        if word.startswith(BINARIES):
            return word.removeprefix(BINARIES).removesuffix("_test") not in self.words
        if not PATH.fullmatch(word) or word in own or PLACEHOLDER.search(word):
            return False
        return (word.endswith(CODE) or ("/" in word and word.split("/")[0] in self.folders)) and not self.holds(word, folder)


def check_text(root, tree, path, text):
    own = {step[1] for step in commands(text) if step[0] == "file"}
    prose = FENCE.sub(lambda block: "\n" * block[0].count("\n"), text)
    plain = CODE_SPAN.sub(lambda span: re.sub(r"[^\n]", " ", span[0]), prose)

    def place(match):
        return f"{path}:{prose.count(chr(10), 0, match.start()) + 1}"

    for link in LINK.finditer(plain):
        target, _, anchor = link[1].partition("#")
        if ":" in target:
            continue
        file = (Path(root) / path).parent / target if target else Path(root) / path
        if not file.exists():
            yield f"{place(link)}: {link[1]} leads nowhere"
        elif anchor and anchor not in headings(file.read_text(encoding="utf-8")):
            yield f"{place(link)}: {link[1]}: no such heading"
    for span in CODE_SPAN.finditer(prose):
        for word in span[1].split():
            if tree.missing(word, path.parent, own):
                yield f"{place(span)}: `{word}` is not in the tree"
    for name in re.finditer(rf"(?<![\w/.(])(?:{tree.top})/[\w./-]*\w", LINK.sub(lambda link: " " * len(link[0]), plain)):
        if not tree.holds(name[0], path.parent):
            yield f"{place(name)}: {name[0]} is not in the tree"
    for other in OTHER_LINK.finditer(plain):
        yield f"{place(other)}: allowed for a link: [text](where)"
    if INDENTED_FENCE.search(text):
        yield f"{path}: a fence stands at the line's begin"
    for words, content in blocks(text):
        if words and words[0] in SHELLS:
            yield f"{path}: a block of commands is ```sh or ```sh no-run, found ```{words[0]}"
        for line in lines_of_commands(content) if words == ["sh"] else ():
            if not line.startswith(PROGRAMS):
                yield f"{path}: a command that is run begins with one of {', '.join(PROGRAMS)}; found '{line}'; allowed: ```sh no-run"
    for command in UNCHECKED.finditer(text):
        yield f"{path}: a command for a reader begins with ./slipbench and stands in a block ```sh: {command[0].strip()}"


def check_size(path, text):
    """Whether the door is short."""
    lines = text.splitlines()
    if len(lines) > DOOR_LINES:
        yield f"{path}: {len(lines)} lines; allowed: {DOOR_LINES}"
    for number, line in enumerate(FENCE.sub(lambda block: "\n" * block[0].count("\n"), text).splitlines(), 1):
        if len(line) > DOOR_COLUMNS and not line.startswith("|") and not re.fullmatch(r"\S+|[-*]? *!?\[[^\]]*\]\(\S+\)", line):
            yield f"{path}:{number}: {len(line)} columns; allowed: {DOOR_COLUMNS}"


def check(root):
    files = set(project_files(root))
    for folder in sorted({path.parent for path in files if path.suffix in SOURCES and path.parent != Path(".")}):
        if not folder.parts[0].startswith(".") and not explained(folder, files):
            yield f"{folder}: no README.md"
    tree = Tree(root)
    for path, text in texts(root):
        yield from check_text(root, tree, path, text)
        if path == DOOR:
            yield from check_size(path, text)


if __name__ == "__main__":
    main(check)
