"""Hooks of mkdocs.yml: add the project's texts and pictures from their folders, the sources that texts
link to, and the C++ and Python references. Texts are written for GitHub; `on_page_markdown` converts
the syntax that Python-Markdown reads differently."""

import functools
import json
import os
import re
import sys
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tools/lint"), str(ROOT / "docs/reference")]
import headers  # noqa: E402
import reference  # noqa: E402
from readmes import LINK, anchor  # noqa: E402
from tree import project_files  # noqa: E402

PAGE, PICTURE = ".md", (".png", ".svg")
LANGUAGES = {".h": "cpp", ".cc": "cpp", ".py": "python", ".yaml": "yaml", ".txt": "cmake"}
PYTHON = "python.md"
FORMS = ".github"  # templates of issues and pull requests, not pages
TEX = {
    r"\\frac\{([^}]*)\}\{([^}]*)\}": r"(\1)/(\2)",
    r"\\text\{([^}]*)\}": r"\1",
    r"\\cdot": "·",
    r"\\mu ?": "μ ",
    r"\\ge": "≥",
    r"\\,|\s": " ",
}


@functools.cache
def ours():
    """The project's texts and pictures."""
    return [
        path
        for path in project_files(ROOT)
        if path.suffix in (PAGE, *PICTURE) and path.parts[0] != FORMS
    ]


def page_of(target, path):
    """Page to which a link from the text `path` to `target` leads: the target, the README.md of a folder, or the page of a source."""
    place, hash_sign, rest = target.partition("#")
    if not place or ":" in place or Path(place).suffix in (PAGE, *PICTURE):
        return target
    folder = (ROOT / path).parent / place
    return (
        (f"{place}/README.md" if (folder / "README.md").exists() else f"{place}.md")
        + hash_sign
        + rest
    )


def linked(text, path):
    """The text `path`, with links that lead to pages of the site."""
    return LINK.sub(lambda link: link[0].replace(link[1], page_of(link[1], path)), text)


def formula(tex):
    """Converts a formula of a notebook to text without TeX."""
    return f"`{functools.reduce(lambda text, rule: re.sub(*rule, text), TEX.items(), tex).strip()}`"


def source(path):
    """Page of a source, of all sources in a folder, or of the cells of a notebook."""
    parts = [f"# {path.relative_to(ROOT)}"]
    for file in sorted(path.iterdir()) if path.is_dir() else [path]:
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".ipynb":
            cells = json.loads(text)["cells"]
            texts = [(cell["cell_type"], "".join(cell["source"])) for cell in cells]
            return "\n\n".join(
                linked(
                    re.sub(r"\$+([^$]+)\$+", lambda found: formula(found[1]), body),
                    path.relative_to(ROOT),
                )
                if kind == "markdown"
                else f"```python\n{body}\n```"
                for kind, body in texts
            )
        parts.append(
            f'```{LANGUAGES.get(file.suffix, "text")} title="{file.name}"\n{text.rstrip()}\n```'
        )
    return "\n\n".join(parts)


@functools.cache
def made():
    """{page: its Markdown} for the pages without a file in the project."""
    pages = {
        f"{folder}/headers.md": headers.page(ROOT, folder) for folder in headers.folders(ROOT)
    } | {PYTHON: reference.page()}
    for path in [path for path in project_files(ROOT) if path.suffix in (PAGE, ".ipynb")]:
        for target in LINK.findall((ROOT / path).read_text(encoding="utf-8")):
            page, place = page_of(target, path).partition("#")[0], target.partition("#")[0]
            if page != place and not page.endswith("README.md"):
                file = Path(os.path.normpath(ROOT / path.parent / place))
                pages[f"{file.relative_to(ROOT)}.md"] = source(file)
    return pages


def named(nav):
    """Pages in a part of `nav`."""
    if isinstance(nav, str):
        return {nav}
    return set().union(*map(named, nav.values() if isinstance(nav, dict) else nav))


def on_config(config):
    config.mdx_configs["toc"] = {
        "slugify": lambda text, _: anchor(text),
        "permalink": True,
        "toc_depth": "2-4",
    }
    config.nav[-1]["Reference"] += [
        {"Python": PYTHON},
        {"C++": [{f"{folder}": f"{folder}/headers.md"} for folder in headers.folders(ROOT)]},
    ]
    rest = {}
    for path in sorted(
        {path.as_posix() for path in ours() if path.suffix == PAGE}
        | made().keys() - named(config.nav)
    ):
        if path not in named(config.nav):
            rest.setdefault(path.split("/")[0] if "/" in path else "project", []).append(
                {path.removesuffix("/README.md").removesuffix(".md"): path}
            )
    config.nav.append({"All folders": [{folder: pages} for folder, pages in rest.items()]})
    return config


def on_nav(nav, config, files):
    nav.homepage = next(page for page in nav.pages if page.url == "index.html")
    return nav


def on_files(files, config):
    files.remove(files.get_file_from_path("README.md"))  # README.md of the folder `web`
    for path in ours():
        files.append(File(path.as_posix(), str(ROOT), config.site_dir, config.use_directory_urls))
    for path, text in made().items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown, page, config, files):
    if page.file.src_uri in made():
        return markdown
    markdown = re.sub(
        r"^```(\w+) no-run$", r"```\1", linked(markdown, page.file.src_uri), flags=re.MULTILINE
    )
    markdown = re.sub(r"^```(\w+) (\S+)$", r'```\1 title="\2"', markdown, flags=re.MULTILINE)
    # In GitHub's Markdown a list or a table may follow a line of text directly.
    return re.sub(
        r"^(?![-*|#] ?|\d+\. |```)(\S.*)\n(?=[-*] |1\. |\|)",
        r"\1\n\n",
        markdown,
        flags=re.MULTILINE,
    )
