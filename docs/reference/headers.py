"""The C++ reference: a page of each library's headers, from the comments above their declarations."""

import re

from tree import project_files

BENCH = (
    "sim/",
    "sensors/",
    "detectors/",
    "controllers/",
    "tools/dataset/",
    "tools/files/",
    "tools/page/",
    "tools/statistics/",
    "tools/workers/",
)  # headers for other projects
COMMENT = r"(?:^//.*\n)"
CODE = r"^(?:template <.*\n)?(?!namespace\b|extern \"C\" {)(?:#define |[^\s/}#]).*\n(?:(?!^(?://|\w|#)).*\n)*"
DECLARATION = re.compile(f"({COMMENT}*)({CODE})|({COMMENT}+)", re.MULTILINE)
TYPE = re.compile(r"^(?:template <.*>\s*)?(?:class|struct|enum class) (\w+)")


def folders(root):
    """Folders of the installed headers, except those that only the program uses."""
    return sorted(
        {
            path.parent.as_posix()
            for path in project_files(root)
            if path.suffix == ".h" and path.as_posix().startswith(BENCH)
        }
    )


def prose(comment):
    """Converts a comment to Markdown. An indented line continues a list item, or is a formula, which is kept unchanged."""
    made, kind = [], "text"
    for line in re.sub(r"^// ?", "", comment, flags=re.MULTILINE).splitlines():
        inside = line.startswith("  ")
        before, kind = (
            kind,
            "list"
            if line.startswith("- ") or (inside and kind == "list")
            else "law"
            if inside
            else "text",
        )
        if kind != before:
            made.append("")
        escaped = re.sub(r"(`[^`]*`)|([*_<\[])", lambda found: found[1] or "\\" + found[2], line)
        made.append(f"  {line}" if kind == "law" else escaped)
    return "\n".join(made)


def declarations(text):
    """Yields (comment, code without private parts) for each declaration in the namespace."""
    for comment, code, alone in DECLARATION.findall(text):
        yield (
            comment or alone,
            re.sub(
                r"\n^ private:\n.*?(?=^\};|^ public:|^ protected:)|\n+^\}  // namespace.*",
                "",
                code.rstrip(),
                flags=re.MULTILINE | re.DOTALL,
            ),
        )


def page(root, folder):
    """Page of the headers of a folder, as Markdown."""
    parts = [f"---\nsearch: {{boost: 0.2}}\n---\n# {folder}: headers"]
    if (root / folder / "README.md").exists():
        parts.append(f"[What {folder} is](README.md)")
    for path in sorted((root / folder).glob("*.h")):
        head, _, body = path.read_text(encoding="utf-8").partition("#pragma once\n")
        parts += [f"## {path.name}", prose(head)]
        inside = re.search(
            r"^namespace slipbench[^{]*\{\n(.*)^\}  // namespace slipbench",
            body,
            re.MULTILINE | re.DOTALL,
        )
        for comment, code in declarations(inside[1] if inside else body):  # plugin_abi.h is C
            found = TYPE.match(code)
            if not comment and not found and parts[-1].endswith("\n```"):
                parts[-1] = f"{parts[-1][:-3]}{code}\n```"
                continue
            parts += [
                f"### {found[1]}" if found else "",
                prose(comment),
                f"```cpp\n{code}\n```" if code else "",
            ]
    return "\n\n".join(part for part in parts if part)
