"""Tests tools/studies/biotac_stability_slip/comparison on recordings with closed-form figures."""

import base64
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

TOOLS = (
    Path(__file__).resolve().parents[4]
    / "tools"
    / "studies"
    / "biotac_stability_slip"
    / "comparison"
)
sys.path.insert(0, str(TOOLS))

import recordings as rec  # noqa: E402


def near(found, expected, tolerance):
    assert np.all(np.abs(np.asarray(found) - expected) <= tolerance), (found, expected, tolerance)


def recording(counts, kind="n"):
    return rec.Recording(kind, "glass7.csv", np.asarray(counts, dtype=float))


# 25 periods of 4 rows each: 0, 1, 0, -1, a sine of 25 Hz with amplitude a, on one electrode of 24.
def check_sine():
    t, a = np.arange(300), 40.0
    counts = np.full((300, 24), 3000.0)
    counts[:, 6] += a * np.sin(0.5 * np.pi * t)
    sine = recording(counts)
    assert sine.object == "glass" and rec.most_active(sine.counts) == 6
    # a/sqrt 2, except the subtracted straight line, whose share is of the order of (periods)^-2
    near(rec.spreads(sine)[1], a / np.sqrt(2), 0.01)
    near(rec.spreads(sine)[0], 0.0, 1e-9)
    near(rec.extremes(sine)[0], 2 * a, 1e-9)
    # steps of a, in all rows: the other 23 electrodes always repeat, this one never does
    near(rec.step_figures(sine), [0.0, 23 / 24], 1e-12)
    # 25 Hz is bin 64 of 256, and a Hann window has 2/3 of its power there and the rest in the two
    # neighbours: all within 20 to 35 Hz
    bands = rec.band_rms(sine)
    near(bands[4], a / np.sqrt(2), 0.02)
    near(
        bands[:4] + bands[5:], 0.0, 0.05
    )  # the subtracted line: 6 a/(75 pi), +-0.5 at its ends, a tenth of it above 0.5 Hz


# Electrodes with z > 0 rise by a ramp while those with z < 0 fall: correlation 1 within a side, -1
# across, one component.
def check_sides():
    ramp = np.linspace(0.0, 100.0, 300)[:, None]
    side = np.sign(rec.ELECTRODES[:, 2])
    side[side == 0] = 1.0
    both = recording(3000.0 + ramp * side)
    near(rec.components(both), [1.0, 0.0, 0.0], 1e-12)
    signs = np.outer(side, side)[np.triu_indices(24, 1)]
    distance = np.linalg.norm(rec.ELECTRODES[:, None] - rec.ELECTRODES[None], axis=2)[
        np.triu_indices(24, 1)
    ]
    near(
        rec.distance_correlation(both),
        [signs[(distance >= low) & (distance < high)].mean() for low, high in rec.DISTANCE_BINS],
        1e-9,
    )
    near(
        rec.net_change(both), [(side > 0).sum(), (side < 0).sum()], 0
    )  # by 93 counts, more than 20
    # far from the mirrored ends a smoothed ramp equals the ramp: 100 counts in 299 rows of 10 ms
    near(rec.extremes(both)[1], 100.0 / 2.99, 1e-6)
    near(rec.spreads(both)[1], 0.0, 1e-9)


def write(folder, scale, seed):
    random = np.random.default_rng(seed)
    for kind in rec.CLASSES:
        (folder / kind).mkdir(parents=True)
        for k in range(3):
            noise = random.normal(0.0, 4.0, (280, 24))
            slow = np.cumsum(random.normal(0.0, 0.0 if kind == "t" else scale, (280, 24)), axis=0)
            rows = np.rint(3000 + noise + slow).astype(int)
            text = (
                "\n".join([",".join(rec.COLUMNS)] + [",".join(map(str, row)) for row in rows])
                + "\n"
            )
            (folder / kind / f"glass{k}.csv").write_text(text, encoding="ascii")


def run(*words):
    return subprocess.run(
        [sys.executable, *map(str, words)], capture_output=True, text=True, check=False
    )


# Equal recordings have distance 0; a page is drawn; an invalid folder is refused by name.
def check_programs(folder):
    write(folder / "a", 3.0, 1)
    same = run(TOOLS / "compare.py", folder / "a", folder / "a", "-o", folder / "page.html")
    assert same.returncode == 0, same.stderr
    assert "Real: 21 recordings; glass 21" in same.stdout
    rows = [
        line.split()
        for line in same.stdout.splitlines()
        if line.startswith("SD, median electrode ")
    ]
    assert len(rows) == 4 and all("x1.00" in row for row in rows), rows
    assert "outside the dry run's worst factor of their row: 0 of 96" in same.stdout
    page = (folder / "page.html").read_text(encoding="utf-8")
    assert (
        page.count("<img") == 7 * 2 + 3 * 4 + 7 * 2 and "<script" not in page and "://" not in page
    )
    assert b"<!-- counts from mean -->" in base64.b64decode(
        page.split("svg+xml;base64,")[1].split('"')[0]
    )
    again = run(TOOLS / "compare.py", folder / "a", folder / "a")
    assert same.stdout.startswith(again.stdout)  # except the line about the page
    write(folder / "b", 3.0, 2)
    (folder / "b" / "e" / "glass0.csv").write_text("a,b\n1,2\n", encoding="ascii")
    for words, message in (
        ((folder / "none", folder / "a"), "none/n: contains no CSV file"),
        ((folder / "a", folder / "b"), "e/glass0.csv:1: columns a,b"),
    ):
        refused = run(TOOLS / "compare.py", *words)
        assert (
            refused.returncode == 2
            and message in refused.stderr
            and "Traceback" not in refused.stderr
        ), refused.stderr


check_sine()
check_sides()
with tempfile.TemporaryDirectory() as temporary:
    check_programs(Path(temporary))
print("as expected")
