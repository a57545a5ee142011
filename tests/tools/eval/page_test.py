"""The page of `slipbench eval` in a browser: no script, its policy holds, nothing is loaded.

page_test.py PROGRAM
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
import chromium  # noqa: E402

# Slides of half a second at two speeds and several frictions.
SCENE = """slipbench: 1
duration: 0.5 s
seed: 3
motion: {kind: stage, gap: 0.1 mm, compression: 1 mm, approach_speed: 20 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}
sensors: {pad: {type: papillarray, rate: 1 kHz}}
sweep: {motion.speed: [8 mm/s, 32 mm/s], friction.scale: {draw: uniform, min: 0.5, max: 0.9}, trials: 6}
"""


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name, chromium.Chromium() as browser:
        folder = Path(name)
        (folder / "scene.yaml").write_text(SCENE)

        def run(*words):
            return subprocess.run(
                [program, *words], check=True, cwd=folder, capture_output=True, text=True
            ).stdout

        run("sweep", "scene.yaml", "-o", "data.h5", "--quiet")
        run("eval", "shear_rate", "data.h5", "--labels", "micro", "-o", "page.html")
        run("report", "data.h5")
        page = folder / "page.html"
        text = page.read_text()
        browser.look(1280, 2000)
        browser.open(page)
        assert not browser.complaints(), browser.complaints()
        dom = browser.dom()
        for heading in (
            "Figures",
            "Confusion matrix",
            "Curves",
            "By speed",
            "By mask",
            "Worst trials",
        ):
            assert f"<h2>{heading}</h2>" in dom, heading
        assert "<script" not in text
        assert not re.search(r"(?:src|href)=\"(?:https?:)?//", text), "it loads something"
        assert dom.count("<svg") >= 2, "a histogram and delays against speed"
        # Each of the worst trials with its states; its channels are those of the PapillArray.
        drawn = dom.count('aria-label="States over time [s]"')
        assert 0 < drawn == dom.count('aria-label="force [N], component 3 of 3 over time [s]"'), (
            drawn
        )
        # Its links lead to the report's trials.
        links = re.findall(r'href="(data\.html)#trial-(\d+)"', text)
        assert links and (folder / links[0][0]).exists(), links
        # An empty page of this size is some 8 kB.
        assert len(browser.screenshot(whole=False)) > 20_000
        browser.open(folder / links[0][0])
        assert "slipbench report" in browser.dom()
    print("the page holds")
    return 0


if __name__ == "__main__":
    sys.exit(main())
