"""Pages as a browser shows them: pixels of every kind of sensor's picture, where a page opens, and what its policy forbids.

    check_pages.py PROGRAM"""

import json
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "base/page"))
import chromium  # noqa: E402

ROOT = Path(__file__).resolve().parents[4]
SCENES = ROOT / "scenes"
SIZE = (900, 1000)  # px, of the window

# Pressed and slid within half a second, so that some units slip.
STAGE = """slipbench: 1
duration: 0.5 s
seed: 1
motion: {{kind: stage, gap: 0.1 mm, compression: {compression}, approach_speed: 20 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}}
sensors: {{pad: {{type: {sensor}, electronics: typical}}}}
"""
# By sensor: how far it is pressed in, and the parts of the picture behind its units (0: it has none, and the units are the picture).
SENSORS = {"papillarray": ("1 mm", 0), "nib_pad": ("0.5 mm", 36), "piezo_skin": ("0.25 mm", 0), "myrmex": ("0.5 mm", 256),
           "biotac_sp": ("1 mm", 0)}

# Takes the picture of the pad out of the page, and says on the console where its units and parts are and how strongly they are coloured.
PROBE = """<script>
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 0);  // without a screen there are few frames
(async () => {
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
  console.log('PROBE' + JSON.stringify({sensor, ground, opened, touch: recording.touch_s, parts, units, text}));
})();
</script>
"""


def pixels_of(path):
    """Rows of (r, g, b) of a PNG of eight bits a channel."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8 and colour in (2, 6), (depth, colour)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    each = 4 if colour == 6 else 3
    raw, rows, before = zlib.decompress(packed), [], bytearray(width * each)
    for row in range(height):
        start = row * (width * each + 1)
        method, line = raw[start], bytearray(raw[start + 1 : start + 1 + width * each])
        for i in range(len(line)):
            left = line[i - each] if i >= each else 0
            corner = before[i - each] if i >= each else 0
            up = before[i]
            if method == 4:
                guess = left + up - corner
                near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            else:
                near = {0: 0, 1: left, 2: up, 3: (left + up) // 2}[method]
            line[i] = (line[i] + near) & 255
        rows.append([tuple(line[i : i + 3]) for i in range(0, len(line), each)])
        before = line
    return rows


def browse(browser, page, *options):
    """What the browser says on stdout and stderr of a page."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--virtual-time-budget=20000",
             "--enable-logging=stderr", f"--user-data-dir={profile}", f"--window-size={SIZE[0]},{SIZE[1]}", *options, page.as_uri()],
            capture_output=True, text=True, timeout=300, check=True)
    return done.stdout, done.stderr


def far(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def refusals(log):
    return [line for line in log.splitlines() if "Content Security Policy" in line or "Refused to" in line]


class Pages:
    def __init__(self, program, browser, folder):
        self.program, self.browser, self.folder = program, browser, folder

    def run(self, *words):
        subprocess.run([self.program, *map(str, words), "--quiet"], check=True, cwd=self.folder)

    def report(self, scene, name, *settings):
        """The report of one trial."""
        words = [word for setting in settings for word in ("--set", setting)]
        self.run("run", scene, *words, "-o", f"{name}.h5")
        subprocess.run([self.program, "report", f"{name}.h5", "-o", f"{name}.html"], check=True, cwd=self.folder, stdout=subprocess.DEVNULL)
        return self.folder / f"{name}.html"

    def probe(self, page):
        """The page's pad alone, with what PROBE says of it."""
        probed = page.with_suffix(".probe.html")
        text, count = re.subn(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page.read_text(encoding="utf-8"))
        assert count == 1
        probed.write_text(text.replace("</body>", PROBE + "</body>"), encoding="utf-8")
        picture = page.with_suffix(".png")
        _, log = browse(self.browser, probed, f"--screenshot={picture}")
        found = re.search(r'PROBE(\{.*\})"?, source', log)
        assert found, log
        return json.loads(found[1].replace('\\"', '"')), pixels_of(picture)

    def check_picture(self, sensor, compression, parts):
        scene = self.folder / f"{sensor}.yaml"
        scene.write_text(STAGE.format(sensor=sensor, compression=compression), encoding="utf-8")
        found, pixels = self.probe(self.report(scene, sensor))
        colour = lambda at: pixels[round(at[1])][round(at[0])]
        ground = colour(found["ground"])
        assert len(found["parts"]) == parts, f"{sensor}: {len(found['parts'])} parts"
        strong = [part for part in found["parts"] if part["strength"] > 0.3]
        assert strong or not parts, f"{sensor}: nothing is read"
        for part in strong:
            assert far(colour(part["at"]), ground) > 40, f"{sensor}: what is read is not to be seen: {colour(part['at'])}"
        touching = [unit for unit in found["units"] if unit["state"] != "detached"]
        assert touching, f"{sensor}: no unit touches"
        if not parts:
            for unit in touching:
                assert far(colour(unit["at"]), ground) > 20, f"{sensor}: a unit that is in state {unit['state']} is not to be seen: {colour(unit['at'])} on {ground} at {unit['at']}, {found['ground']}"
        assert found["touch"][found["opened"]] is not None, f"{sensor}: opens on unit {found['opened']}, which never touches"
        print(f"{sensor}: {len(found['parts'])} parts, {len(touching)} of {len(found['units'])} units touch")

    def check_opening(self):
        """A page opens on the sensor that the detector reads, and a translation has no centre."""
        page = self.report(SCENES / "grasp" / "two_skins.yaml", "skins", "duration=2.5 s")
        assert self.probe(page)[0]["sensor"] == "pad"
        dom, log = browse(self.browser, page, "--dump-dom")
        assert "<h2>The sensor pad</h2>" in dom, log
        assert not refusals(log), refusals(log)
        text = self.probe(self.report(SCENES / "papillarray" / "stage.yaml", "stage"))[0]["text"]
        assert "slip centrenone: translation" in text, text

    def check_policy(self):
        """Pages do what they do within their policy, and nothing that is put into them runs."""
        report = self.folder / "stage.html"
        self.run("cost", SCENES / "papillarray" / "stage.yaml", "--budget", "1s", "-o", "cost.html")
        for page, drawn in ((report, "<main>"), (self.folder / "cost.html", "<svg")):
            dom, log = browse(self.browser, page, "--dump-dom")
            assert drawn in dom and "Unpacking" not in dom.split("<script")[0], f"{page.name} is not drawn: {log}"
            assert not refusals(log), refusals(log)
        broken = self.folder / "broken.html"
        evil = "<script>document.title = 'taken'</script><img src='https://example.invalid/x.png' onerror=\"document.title = 'taken'\">"
        broken.write_text(report.read_text(encoding="utf-8").replace("</body>", evil + "</body>"), encoding="utf-8")
        dom, log = browse(self.browser, broken, "--dump-dom")
        assert "<title>taken" not in dom and refusals(log), "a script that was put in has run"


def main():
    browser = chromium.program()
    with tempfile.TemporaryDirectory() as folder:
        pages = Pages(sys.argv[1], browser, Path(folder))
        for sensor, (compression, parts) in SENSORS.items():
            pages.check_picture(sensor, compression, parts)
        pages.check_opening()
        pages.check_policy()
    return 0


sys.exit(main())
