"""How long a page takes to its first picture in headless Chromium: from the navigation until a frame with a chart has been drawn.

    python3 tests/tools/program/report/time_to_picture.py PAGE.html ...

Prints the median of five openings and the longest [s], and the file's size. It is no test: the time depends on the machine and its load."""

import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "base/page"))
from chromium import Chromium  # noqa: E402

# Two frames after a picture is there, it has been drawn. Times count from the start of the navigation.
WATCH = """(() => {
  const seen = () => document.querySelector('#page svg, #page canvas') ?
      requestAnimationFrame(() => requestAnimationFrame(() => { window.firstPicture = performance.now(); })) :
      requestAnimationFrame(seen);
  requestAnimationFrame(seen);
})();"""
ANSWER = """new Promise(done => {
  const ask = () => window.firstPicture === undefined ? setTimeout(ask, 5) : done(window.firstPicture);
  ask();
})"""

with Chromium() as browser:
    browser.look(1400)
    browser.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH)
    for page in sys.argv[1:]:
        times = []
        for _ in range(6):
            browser.open(page)
            times.append(browser.evaluate(ANSWER) / 1e3)
        times = times[1:]  # the first opening reads the disk
        print(f"{page}: {statistics.median(times):.2f} s, at most {max(times):.2f} s, {Path(page).stat().st_size / 1e6:.1f} MB", flush=True)
