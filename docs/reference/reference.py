"""Generates the reference of the package slipbench as Markdown from its docstrings.

A page of the site (docs). `python reference.py` prints it.
"""

import importlib
import pkgutil
import re
from collections.abc import Iterator

import pdoc.doc
import pdoc.docstrings
import slipbench

# Representation of NDArray[float32] by numpy.
ARRAY = re.compile(
    r"numpy\.ndarray\[tuple\[typing\.Any, \.\.\.\], numpy\.dtype\[(?:numpy\.|typing\.)?(\w+)\]\]"
)


def is_public(doc: pdoc.doc.Doc) -> bool:
    """True for documented public objects.

    The attributes of a class are in its docstring; a constructor is public if it has a docstring.
    """
    return bool(doc.docstring) and (doc.name == "__init__" or not doc.name.startswith("_"))


def declaration(doc: pdoc.doc.Doc) -> str:
    """Declaration as in the source: `def run(self, ...) -> Trial`; a dataclass with its fields."""
    if isinstance(doc, pdoc.doc.Function):
        text = "\n".join([*doc.decorators, f"{doc.funcdef} {doc.name}{doc.signature}"])
    elif isinstance(doc, pdoc.doc.Class):
        text = f"class {doc.name}{doc.members['__init__'].signature_without_self if doc.decorators else ''}"
    else:
        text = f"{doc.name}{doc.annotation_str}"
    return ARRAY.sub(r"NDArray[\1]", text)


def entries(doc: pdoc.doc.Doc, level: int) -> Iterator[str]:
    """Yields the lines of a name and of its members."""
    yield f"{'#' * level} {doc.qualname or doc.modulename} {{#{doc.fullname}}}"
    if doc.kind != "module":
        yield f"```python\n{declaration(doc)}\n```"
    yield re.sub(
        r"^#{6} (.+):$",
        r"**\1**\n",
        pdoc.docstrings.convert(doc.docstring, "google", None),
        flags=re.MULTILINE,
    )
    for member in getattr(doc, "own_members", []):
        if is_public(member):
            yield from entries(member, level + 1)


def page() -> str:
    """The whole page."""
    names = sorted(
        module.name
        for module in pkgutil.iter_modules(slipbench.__path__)
        if not module.name.startswith("_")
    )
    modules = [slipbench, *(importlib.import_module(f"slipbench.{name}") for name in names)]
    parts = [part for module in modules for part in entries(pdoc.doc.Module(module), 2)]
    return "\n\n".join([f"# Python, version {slipbench.__version__}", *parts])


if __name__ == "__main__":
    print(page())
