"""Pages in a browser: pixels of every sensor's picture, where a page opens, and its policy.

check_pages.py PROGRAM
"""

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
import chromium  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
SCENES = ROOT / "scenes"

# Pressed and slid within half a second, so that some units slip.
STAGE = """slipbench: 1
duration: 0.5 s
seed: 1
motion: {{kind: stage, gap: 0.1 mm, compression: {compression}, approach_speed: 20 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}}
sensors: {{pad: {{type: {sensor}, electronics: typical}}}}
"""
# By sensor: indentation, and number of parts in the picture behind its units (0: no parts, the
# units are the picture).
SENSORS = {
    "papillarray": ("1 mm", 0),
    "nib_pad": ("0.5 mm", 36),
    "piezo_skin": ("0.25 mm", 0),
    "myrmex": ("0.5 mm", 256),
    "biotac_sp": ("1 mm", 0),
}

# Extracts the pad's picture and reports where its units and parts are and how strongly they are
# coloured.
PROBE = """(async () => {
  while (!document.querySelector('.pad-card svg .unit') || !document.querySelector('.cell button.link')) await new Promise(done => setTimeout(done, 20));
  const sb = window.slipbench, svg = document.querySelector('.pad-card svg .unit').closest('svg');
  const trial = sb.page.trials[0], sensor = sb.openingSensor(trial);
  const recording = await sb.recording(trial.index, sensor);
  const shown = document.querySelector('.cell button.link').textContent;
  const opened = [...Array(recording.units).keys()].find(unit => sb.unitName(recording.type, unit) === shown);
  const slider = document.querySelector('.player input'), opens = slider.value;
  const move = async value => {
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
    await new Promise(done => setTimeout(done, 50));
  };
  // As where a translation turns by rounding alone: the centre is a kilometre off.
  for (const column of recording.curves['labels/slip_centre'].columns) column[column.length - 1] = -1425.3209;
  await move(slider.max);
  const text = [...document.querySelectorAll('.readout div')].map(row => row.textContent);
  await move(opens);
  document.body.replaceChildren(document.getElementById('hatch').closest('svg'), svg);
  svg.style.cssText = 'position:fixed;left:0;top:0;width:800px;height:800px;background:var(--panel)';
  await new Promise(done => setTimeout(done, 50));
  const place = (node, x, y) => { const p = new DOMPoint(x, y).matrixTransform(node.getScreenCTM()); return [p.x, p.y]; };
  const parts = [...svg.querySelectorAll('path')].filter(path => path.querySelector('title')).map(path => {
    const corners = path.getAttribute('d').match(/-?[0-9.e-]+,-?[0-9.e-]+/g).map(pair => pair.split(',').map(Number));
    // A triangle has its own middle; a square's is below the unit's disc, its corner is not.
    const [x, y] = corners.length === 3 ? [0, 1].map(c => (corners[0][c] + corners[1][c] + corners[2][c]) / 3) :
                                          corners[0].map(c => 0.85 * c);
    return {at: place(path, x, y), strength: +path.style.fillOpacity};
  });
  const units = [...svg.querySelectorAll('.unit')].map((unit, i) => {
    const disc = unit.querySelector('circle');
    const beside = -0.5 * disc.r.baseVal.value;  // the middle is below the arrows
    return {at: place(unit, beside, beside), state: unit.querySelector('title').textContent.split(': ')[1]};
  });
  const frame = svg.querySelector('rect'), box = frame.getBBox();
  const ground = place(frame, box.x + box.width - 12, box.y + box.height - 12);
  return {sensor, ground, opened, touch: recording.touch_s, parts, units, text};
})()"""


def far(a, b):
    return max(abs(x - y) for x, y in zip(a, b, strict=True))


class Pages:
    def __init__(self, program, browser, folder):
        self.program, self.browser, self.folder = program, browser, folder

    def run(self, *words):
        subprocess.run([self.program, *map(str, words), "--quiet"], check=True, cwd=self.folder)

    def report(self, scene, name, *settings):
        """Returns the report of one trial."""
        words = [word for setting in settings for word in ("--set", setting)]
        self.run("run", scene, *words, "-o", f"{name}.h5")
        subprocess.run(
            [self.program, "report", f"{name}.h5", "-o", f"{name}.html"],
            check=True,
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
        )
        return self.folder / f"{name}.html"

    def probe(self, page):
        """Returns the result of PROBE for the page's pad, and its picture."""
        self.browser.open_drawn(page)
        return self.browser.evaluate(PROBE), Image.open(
            io.BytesIO(self.browser.screenshot(whole=False))
        ).convert("RGB")

    def check_picture(self, sensor, compression, parts):
        scene = self.folder / f"{sensor}.yaml"
        scene.write_text(STAGE.format(sensor=sensor, compression=compression), encoding="utf-8")
        found, picture = self.probe(self.report(scene, sensor))

        def colour(at):
            return picture.getpixel((round(at[0]), round(at[1])))

        ground = colour(found["ground"])
        assert len(found["parts"]) == parts, f"{sensor}: {len(found['parts'])} parts"
        strong = [part for part in found["parts"] if part["strength"] > 0.3]
        assert strong or not parts, f"{sensor}: nothing is read"
        for part in strong:
            assert far(colour(part["at"]), ground) > 40, (
                f"{sensor}: what is read is not to be seen: {colour(part['at'])}"
            )
        touching = [unit for unit in found["units"] if unit["state"] != "detached"]
        assert touching, f"{sensor}: no unit touches"
        if not parts:
            for unit in touching:
                assert far(colour(unit["at"]), ground) > 20, (
                    f"{sensor}: a unit that is in state {unit['state']} is not to be seen: {colour(unit['at'])} on {ground} at {unit['at']}, {found['ground']}"
                )
        assert found["touch"][found["opened"]] is not None, (
            f"{sensor}: opens on unit {found['opened']}, which never touches"
        )
        print(
            f"{sensor}: {len(found['parts'])} parts, {len(touching)} of {len(found['units'])} units touch"
        )

    def check_opening(self):
        """A page opens on the sensor that the detector reads, and a translation has no centre."""
        page = self.report(
            SCENES / "grasp" / "two_skins.yaml", "skins", "duration=2.5 s", "motion.distance=10 mm"
        )
        assert self.probe(page)[0]["sensor"] == "pad"
        self.browser.open_drawn(page)
        assert "<h2>The sensor pad</h2>" in self.browser.dom()
        assert not self.browser.complaints(), self.browser.complaints()
        text = self.probe(self.report(SCENES / "papillarray" / "stage.yaml", "stage"))[0]["text"]
        assert "slip centrenone: translation" in text, text

    def check_policy(self):
        """Pages work within their policy, and nothing put into them is executed."""
        report = self.folder / "stage.html"
        self.run("cost", SCENES / "papillarray" / "stage.yaml", "--budget", "1s", "-o", "cost.html")
        for page, drawn in ((report, "<main>"), (self.folder / "cost.html", "<svg")):
            self.browser.open_drawn(page)
            assert drawn in self.browser.dom(), f"{page.name} is not drawn"
            assert not self.browser.complaints(), self.browser.complaints()
        broken = self.folder / "broken.html"
        evil = "<script>document.title = 'taken'</script><img src='https://example.invalid/x.png' onerror=\"document.title = 'taken'\">"
        broken.write_text(
            report.read_text(encoding="utf-8").replace("</body>", evil + "</body>"),
            encoding="utf-8",
        )
        self.browser.open_drawn(broken)
        assert "<title>taken" not in self.browser.dom() and self.browser.complaints(), (
            "a script that was put in has run"
        )


def main():
    with tempfile.TemporaryDirectory() as folder, chromium.Chromium() as browser:
        browser.look(900)
        pages = Pages(sys.argv[1], browser, Path(folder))
        for sensor, (compression, parts) in SENSORS.items():
            pages.check_picture(sensor, compression, parts)
        pages.check_opening()
        pages.check_policy()
    return 0


sys.exit(main())
