"""Pages of every kind in headless Chromium: wide and narrow, light and dark.

    whole_pages_test.py PROGRAM

A page fails if it writes to the console, has an empty picture, a picture without a name or with
overlapping labels, or is wider than its window. Then the files of saved charts and all trials of a
sweep are tested.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
import chromium  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
SCENES = ROOT / "scenes"
WIDTHS = (1400, 500)  # px
LARGEST = 20_000_000  # bytes of a report

# Pressed and slid within half a second, so that some units slip.
STAGE = """slipbench: 1
duration: 0.5 s
seed: 1
motion: {{kind: stage, gap: 0.1 mm, compression: {compression}, approach_speed: 20 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}}
sensors: {{pad: {{type: {sensor}, electronics: typical}}}}
"""
SENSORS = {
    "papillarray": "1 mm",
    "nib_pad": "0.5 mm",
    "piezo_skin": "0.25 mm",
    "myrmex": "0.5 mm",
    "biotac_sp": "1 mm",
}
SWEEP = STAGE.format(sensor="papillarray", compression="1 mm") + (
    "sweep: {motion.speed: [4 mm/s, 8 mm/s, 32 mm/s], friction.scale: {draw: uniform, min: 0.5, max: 0.9}, trials: 4}\n"
)
# Curves of a PapillArray at 1 kHz take some 40 kB a second if noisy, so these do not fit in full.
LONG = SWEEP.replace("duration: 0.5 s", "duration: 4 s").replace("trials: 4", "trials: 44")
MAP = """slipbench: 1
seed: 1
surface: {material: ptfe}
box: {mass: 0.2 kg}
grip: {protocol: as_recorded}
motion: {kind: lift}
sensors: {pad: {type: papillarray, rate: 100 Hz}}
detector: {type: truth}
controller: {type: step_on_slip}
sweep: {friction.scale: [0.5, 2], box.mass: [100 g, 800 g], controller.type: [step_on_slip, hold_preset], trials: 2}
"""

# Returns the page's faults, one line each. Texts of one picture may touch by a pixel, because
# letter boxes have space above and below.
FAULTS = r"""(async () => {
  const faults = [];
  const shown = node => node.getClientRects().length && getComputedStyle(node).visibility !== 'hidden';
  const named = node => ['img', 'group'].includes(node.getAttribute('role')) && (node.getAttribute('aria-label') || '').trim();
  const hidden = node => node.getAttribute('aria-hidden') === 'true';
  const about = node => node.getAttribute('aria-label') || node.querySelector('[aria-label]')?.getAttribute('aria-label') ||
      node.closest('.chart, section, div')?.textContent.trim().slice(0, 40) || node.outerHTML.slice(0, 80);
  for (const svg of document.querySelectorAll('svg')) {
    if (!named(svg) && !hidden(svg)) faults.push('no name: ' + about(svg));
  }
  for (const svg of document.querySelectorAll('svg')) {
    if (shown(svg) && svg.id !== 'hatch' && svg.clientWidth > 4 && !svg.querySelector('path, rect, line, circle, polyline')) faults.push('empty: ' + about(svg));
  }
  // The width of the letters; the label's element is wider.
  const box = text => { if (text instanceof SVGElement) return text.getBoundingClientRect(); const range = document.createRange(); range.selectNodeContents(text); return range.getBoundingClientRect(); };
  const overlap = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3;
  const groups = [...document.querySelectorAll('svg')].map(svg => [...svg.querySelectorAll('text')]);
  for (const texts of groups) {
    const boxes = texts.filter(text => shown(text) && text.textContent.trim()).map(text => [text, box(text)]);
    boxes.forEach(([one, a], i) => boxes.slice(i + 1).forEach(([other, b]) => {
      if (overlap(a, b)) faults.push('overlap: "' + one.textContent + '" and "' + other.textContent + '" in ' + about(one.closest('svg, .chart')));
    }));
  }
  if (document.documentElement.scrollWidth > innerWidth) faults.push('wider than its window: ' + document.documentElement.scrollWidth + ' px');
  return [...new Set(faults)];
})()"""
# Share of the window that differs from the page's background, and how light the background is, 0 to
# 255.
GROUND = "getComputedStyle(document.documentElement).backgroundColor.match(/[0-9]+/g).slice(0, 3).map(Number)"
# Saves a chart; returns the file's name and text, or for a picture its size and how many pixels
# differ from the first one's colour.
SAVE = r"""(async (selector, kind) => {
  const made = [], links = [];
  const make = URL.createObjectURL;
  URL.createObjectURL = blob => { made.push(blob); return make.call(URL, blob); };
  HTMLAnchorElement.prototype.click = function() { links.push(this.download); };
  const button = [...document.querySelectorAll(selector + ' .save button')].find(one => one.textContent === kind);
  button.focus();
  if (document.activeElement !== button) return 'cannot be reached by the keyboard';
  if (+getComputedStyle(button.closest('.save')).opacity !== 1) return 'has the focus and is not to be seen';
  document.activeElement.click();
  for (let i = 0; i < 200 && !links.length; ++i) await new Promise(done => setTimeout(done, 20));
  URL.createObjectURL = make;
  delete HTMLAnchorElement.prototype.click;
  if (kind !== 'PNG') return [links[0], await made[0].text()];
  const picture = await createImageBitmap(made[0]);
  const canvas = new OffscreenCanvas(picture.width, picture.height), pen = canvas.getContext('2d');
  pen.drawImage(picture, 0, 0);
  const data = new Uint32Array(pen.getImageData(0, 0, picture.width, picture.height).data.buffer);
  return [links[0], picture.width, picture.height, data.filter(pixel => pixel !== data[0]).length];
})"""


class Pages:
    def __init__(self, program, browser, folder):
        self.program, self.browser, self.folder = program, browser, folder
        self.faults = []

    def run(self, *words):
        subprocess.run(
            [self.program, *map(str, words)], check=True, cwd=self.folder, stdout=subprocess.DEVNULL
        )

    def scene(self, name, text):
        (self.folder / f"{name}.yaml").write_text(text, encoding="utf-8")
        return f"{name}.yaml"

    def report(self, verb, scene, name, *words):
        self.run(verb, scene, *words, "-o", f"{name}.h5", "--quiet")
        self.run("report", f"{name}.h5")
        return self.folder / f"{name}.html"

    def open(self, page, fragment=""):
        self.browser.open_drawn(page, fragment)
        for _ in range(3):  # frames in which waiting pictures are drawn
            self.browser.evaluate(
                "new Promise(done => requestAnimationFrame(() => setTimeout(done, 50)))"
            )

    def check(self, page, fragment=""):
        """Wide and light, narrow and dark.

        Overlaps depend on the width alone, the background on the theme alone.
        """
        for width, dark in zip(WIDTHS, (False, True), strict=True):
            self.browser.look(width, dark=dark)
            self.open(page, fragment)
            where = f"{page.name}{fragment}, {width} px, {'dark' if dark else 'light'}: "
            ground = self.browser.evaluate(GROUND)
            found = self.browser.complaints() + self.browser.evaluate(FAULTS)
            if (sum(ground) / 3 < 128) != dark:
                found.append(f"its ground is {ground}")
            self.faults += [where + fault for fault in found]
        print(f"{page.name}{fragment}", flush=True)

    def check_saved(self, page):
        """Files of a chart over time and of the pad."""
        self.browser.look(1400)
        self.open(page)
        for selector, name, figures in (
            (".grid .cell", "force-of-p", "t [s],FX [N],FY [N],FZ [N]"),
            (".pad-card", "pad", "t [s],pillar,"),
        ):
            saved = {
                kind: self.browser.evaluate(f"{SAVE}({json.dumps(selector)}, '{kind}')")
                for kind in ("CSV", "SVG", "PNG")
            }
            for kind, found in saved.items():
                assert isinstance(found, list), f"{selector} {kind}: {found}"
                assert found[0].startswith(f"papillarray-trial-0-{name}") and found[0].endswith(
                    "." + kind.lower()
                ), found[0]
            rows = saved["CSV"][1].splitlines()
            assert rows[0].startswith(figures), rows[0]
            if selector == ".grid .cell":
                # 0.5 s at 1 kHz, from 0 on.
                assert (
                    len(rows) == 501 and rows[1].startswith("0,") and rows[-1].startswith("0.499,")
                ), (len(rows), rows[1], rows[-1])
            else:
                assert len(rows) == 10, rows  # nine pillars
            drawn = self.folder / "saved.svg"
            drawn.write_text(saved["SVG"][1], encoding="utf-8")
            assert "var(--" not in saved["SVG"][1]
            assert saved["PNG"][3] > 500, f"{selector}: {saved['PNG']}"
            self.browser.open(drawn)  # well-formed, otherwise the browser shows an error
            assert (
                self.browser.evaluate("document.documentElement.tagName") == "svg"
                and not self.browser.complaints()
            )
            assert (
                self.browser.evaluate("document.querySelectorAll('path, rect, circle').length") > 5
            )
            self.open(page)

    def check_recordings(self, dataset):
        """The vendor's logs of a dataset, which have no truth.

        Their report and the page of their alarms.
        """
        self.run("export", dataset, "--format", "vendor-csv", "-o", "logs")
        self.run("import", "logs", "--format", "papillarray-csv", "-o", "recorded.h5")
        self.run("report", "recorded.h5")
        self.check(self.folder / "recorded.html")
        self.run("detect", "force_ratio", "recorded.h5", "-o", "alarms.html")
        self.check(self.folder / "alarms.html")

    def check_skins(self):
        """A gel's fields, and around those of a sphere's contact the circle by Hertz.

        Its radius is sqrt(40 mm 0.15 mm), of 16 cells of 0.37 mm on 250 px, which hides no cell.
        """
        self.check(self.report("run", SCENES / "soft_skin/flat.yaml", "flat"))
        self.check(self.report("run", SCENES / "soft_skin/sphere.yaml", "sphere"))
        contact = (40e-3 * 0.15e-3) ** 0.5 * 250 / (16 * 0.37e-3)

        def check_rings(stick):
            rings = self.browser.evaluate(
                "[...document.querySelectorAll('svg[aria-label^=\"Pressure,\"] circle')].map(ring => "
                "getComputedStyle(ring).fill === 'none' && +ring.getAttribute('r'))"
            )
            assert len(rings) == 6 and all(
                abs(ring - contact) < 0.01 * contact for ring in rings[::2]
            ), (rings, contact)
            assert all(0 < ring < contact if stick else ring == 0 for ring in rings[1::2]), rings

        check_rings(stick=True)
        turn = (
            "motion.speed=0",
            "motion.travel=inf",
            "motion.strokes=1",
            "motion.rotation=4 deg/s",
        )
        self.open(self.report("run", SCENES / "soft_skin/sphere.yaml", "turned", "--set", *turn))
        check_rings(stick=False)  # Mindlin's push does not apply to a turn

    def check_all_trials(self):
        """Every trial of a sweep opens in a page small enough for mail.

        A requested trial has all samples.
        """
        page = self.report("sweep", self.scene("long", LONG), "long")
        size = page.stat().st_size
        assert size < LARGEST, size
        self.browser.look(1400)
        self.open(page)
        assert self.browser.evaluate(
            "slipbench.page.trials.every(trial => slipbench.isEmbedded(trial.index))"
        )
        strides = [
            self.browser.evaluate(
                f"slipbench.recorded({trial}).then(({{sensors}}) => sensors[0].stride)"
            )
            for trial in (0, 66, 131)
        ]
        assert min(strides) > 1, strides
        self.browser.evaluate(
            "[...document.querySelectorAll('td button')].find(button => button.textContent === 'open').click()"
        )
        self.open(page, "#trial-131")
        assert self.browser.evaluate("document.querySelectorAll('.grid .chart').length") == 9
        self.run("report", "long.h5", "--trial", "131")
        self.open(page)
        assert (
            self.browser.evaluate("slipbench.recorded(131).then(({sensors}) => sensors[0].stride)")
            == 1
        )
        assert self.browser.evaluate("location.hash") == "#trial-131"
        print(f"long.html: 132 trials in {size / 1e6:.1f} MB, one sample in {strides}", flush=True)


def main():
    with tempfile.TemporaryDirectory() as name, chromium.Chromium() as browser:
        pages = Pages(Path(sys.argv[1]).resolve(), browser, Path(name))
        for sensor, compression in SENSORS.items():
            pages.check(
                pages.report(
                    "run",
                    pages.scene(sensor, STAGE.format(sensor=sensor, compression=compression)),
                    sensor,
                )
            )
        sweep = pages.report("sweep", pages.scene("sweep", SWEEP), "sweep")
        pages.check(sweep)
        pages.check(sweep, "#trial-7")
        pages.check(
            pages.report(
                "run",
                SCENES / "grasp/two_skins.yaml",
                "grasp",
                "--set",
                "duration=2.5 s",
                "motion.distance=10 mm",
            )
        )
        maps = pages.scene("map", MAP)
        pages.check(pages.report("sweep", maps, "map"))
        pages.check(pages.report("sweep", maps, "outcomes", "--record", "outcome"))
        pages.check(
            pages.report(
                "sweep",
                maps,
                "curve",
                "--record",
                "outcome",
                "--set",
                "sweep={friction.scale: [0.5, 1, 2], trials: 2}",
            )
        )
        pages.run("cost", SCENES / "papillarray/stage.yaml", "--budget", "1s", "-o", "cost.html")
        pages.check(pages.folder / "cost.html")
        pages.run("eval", "shear_rate", "sweep.h5", "--labels", "micro", "-o", "eval.html")
        pages.check(pages.folder / "eval.html")
        pages.check_recordings("sweep.h5")
        pages.check_skins()
        pages.check_saved(pages.folder / "papillarray.html")
        pages.check_all_trials()
        for fault in pages.faults:
            print(fault)
        return 1 if pages.faults else 0


sys.exit(main())
