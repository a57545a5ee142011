"""Measures the time to a page's first picture in headless Chromium.

    python3 tests/tools/report/time_to_picture.py PAGE.html ...

Prints the median and the longest time [s] of five openings, from the navigation until a frame with
a chart is drawn, and the file's size. This is not a test, because the time depends on the machine
and its load.
"""

import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
from chromium import Chromium  # noqa: E402

# A picture is drawn two frames after it appears. Times count from the start of the navigation.
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
        print(
            f"{page}: {statistics.median(times):.2f} s, at most {max(times):.2f} s, {Path(page).stat().st_size / 1e6:.1f} MB",
            flush=True,
        )
