"""Writes the reference of the package slipbench, one HTML file made from its docstrings: reference.py FILE.html."""

import importlib
import pkgutil
import re
import sys
from pathlib import Path

import pdoc

import slipbench


def page() -> str:
    """The reference as HTML."""
    pdoc.render.configure(docformat="google", search=False, show_source=False, template_directory=Path(__file__).parent)
    names = [module.name for module in pkgutil.iter_modules(slipbench.__path__) if not module.name.startswith("_")]
    pdoc.render.env.globals["others"] = [pdoc.doc.Module(importlib.import_module(f"slipbench.{name}")) for name in sorted(names)]
    first = pdoc.doc.Module(slipbench)
    html = pdoc.render.html_module(first, {"slipbench": first})
    # numpy.ndarray[tuple[typing.Any, ...], numpy.dtype[numpy.float32]] is what numpy makes of NDArray[float32].
    words = "numpy|.|ndarray|[|tuple|[|typing|.|Any|,|...|],|numpy|.|dtype|[".split("|")
    tags = r"(?:\s|<[^>]+>)*"
    array = tags.join(map(re.escape, words)) + rf"{tags}(?:numpy{tags}\.{tags})?((?:\w|\.|{tags})+?){tags}\]\]"
    return re.sub(array, lambda found: f"NDArray[{re.sub(tags, '', found[1])}]", html)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8")
