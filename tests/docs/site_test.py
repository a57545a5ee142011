"""The site of `./slipbench docs`.

Links work, nothing is loaded from elsewhere, and pages look right.
"""

import html.parser
import io
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/tools/page"), str(ROOT / "tools/lint")]
import chromium  # noqa: E402
from tree import project_files  # noqa: E402

# A text page, a page of tables and the wide Python reference.
LOOKED_AT = ("index.html", "tools/dataset/index.html", "python.html")


class Page(html.parser.HTMLParser):
    """Returns a page's anchors, and its links: (attribute, address)."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.asks, self.loads = {""}, set(), set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and tag != "meta":
                self.anchors.add(value)
            elif name == "href" and tag == "a":
                self.asks.add(value)
            elif name in ("href", "src"):
                self.loads.add(value)


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.root = Path(cls.work).resolve() / "site"
        subprocess.run(
            [
                sys.executable,
                "-m",
                "mkdocs",
                "build",
                "--quiet",
                "--config-file",
                ROOT / "docs/mkdocs.yml",
                "--site-dir",
                cls.root,
            ],
            check=True,
        )
        cls.pages = {
            path: Page(path.read_text(encoding="utf-8"))
            for path in cls.root.rglob("*.html")
            if path.name != "404.html"
        }

    def test_every_text_is_a_page_that_a_link_leads_to(self):
        texts = [
            path
            for path in project_files(ROOT)
            if path.suffix == ".md" and path.parts[0] != ".github"
        ]
        names = {
            path.with_name("index.html") if path.name == "README.md" else path.with_suffix(".html")
            for path in texts
        }
        self.assertGreater(len(names), 100)
        linked = {
            (page.parent / urllib.parse.unquote(link.partition("#")[0])).resolve()
            for page, read in self.pages.items()
            for link in read.asks
        }
        self.assertEqual(
            [name for name in names if self.root / name not in self.pages.keys() & linked], []
        )

    def test_every_link_leads_somewhere_and_nothing_comes_from_elsewhere(self):
        count, astray = 0, []
        for page, read in self.pages.items():
            for link in read.asks | read.loads:
                place, _, anchor = map(urllib.parse.unquote, link.partition("#"))
                if ":" in place and link in read.asks:
                    continue
                count += 1
                target = (page.parent / place.partition("?")[0]).resolve() if place else page
                if (
                    ":" in place
                    or not target.is_file()
                    or (
                        anchor and target in self.pages and anchor not in self.pages[target].anchors
                    )
                ):
                    astray.append(f"{page.relative_to(self.root)}: {link}")
        print(f"{len(self.pages)} pages, {count} links")
        self.assertEqual(astray, [], "\n".join(astray))
        self.assertGreater(count, 1000)

    def test_pages_look_as_they_should(self):
        for dark in (False, True):
            with chromium.Chromium() as browser:
                for width in (1400, 500):
                    for name in LOOKED_AT:
                        with self.subTest(page=name, width=width, dark=dark):
                            browser.look(width, dark=dark)
                            browser.open(self.root / name)
                            self.assertEqual(browser.complaints(), [])
                            self.assertLessEqual(
                                browser.evaluate("document.documentElement.scrollWidth"), width
                            )
                            colours = (
                                Image.open(io.BytesIO(browser.screenshot(whole=False)))
                                .convert("L")
                                .histogram()
                            )
                            ground = max(range(256), key=colours.__getitem__)
                            self.assertTrue(
                                ground < 64 if dark else ground > 224,
                                f"ground of brightness {ground}",
                            )
                            ink = sum(
                                count
                                for tone, count in enumerate(colours)
                                if abs(tone - ground) > 64
                            ) / sum(colours)
                            self.assertTrue(0.02 < ink < 0.5, f"{ink:.3f} of the picture is ink")

    def test_a_search_finds_a_page_of_files(self):
        with chromium.Chromium() as browser:
            browser.look(1400)
            browser.open(self.root / "sim/core/index.html")
            browser.evaluate("""(() => {
                const words = document.querySelector(".md-search__input");
                document.querySelector("#__search").click();
                words.focus();
                words.value = "stuck fraction";
                words.dispatchEvent(new Event("input", {bubbles: true}));
            })()""")
            end = time.monotonic() + 30
            while not (
                found := browser.evaluate(
                    "[...document.querySelectorAll('.md-search-result__link')].map((link) => link.href)"
                )
            ):
                self.assertLess(time.monotonic(), end, "nothing is found")
                time.sleep(0.1)
            self.assertTrue(
                all(urllib.parse.urlparse(link).path.startswith(str(self.root)) for link in found),
                found,
            )


if __name__ == "__main__":
    unittest.main()
