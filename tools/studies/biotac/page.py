"""Real and synthetic recordings side by side in one HTML page: no script, no network."""

import base64
import hashlib
import html
import re
from pathlib import Path

import numpy as np

import recordings as rec
from recordings import GROUPS

KIT = Path(__file__).resolve().parents[2] / "base" / "page" / "web"
COLOURS = {"real": "var(--s0)", "synthetic": "var(--s1)"}
STYLE = """figure { display: inline-block; margin: 6px 10px 6px 0; vertical-align: top; }
figcaption { font-size: 12px; color: var(--soft); }
.out td { background: var(--band2); }"""


def composed(title, body):
    """The page of tools/base/page around `body` (HTML)."""
    styles = "\n".join((KIT / name).read_text(encoding="utf-8") for name in ("theme.css", "page.css", "drawing.css")) + STYLE
    digest = base64.b64encode(hashlib.sha256(f"\n{styles}\n".encode()).digest()).decode()
    policy = (f"default-src 'none'; style-src-elem 'sha256-{digest}'; style-src-attr 'unsafe-inline'; img-src data:; "
              "base-uri 'none'; form-action 'none'")
    parts = {"generator": "compare.py", "policy": policy, "title": html.escape(title), "body": body, "scripts": "", "styles": styles}
    return re.sub(r"{{(\w+)}}", lambda marker: parts[marker[1]], (KIT / "page.html").read_text(encoding="utf-8"))


class Plot:
    """Axes of one drawing, in the units of the data; logarithmic where asked."""

    def __init__(self, x, y, size=(270, 170), log=(False, False), labels=("", "")):
        self.size, self.log = size, log
        self.low = [self._at(0, x[0]), self._at(1, y[0])]
        self.high = [self._at(0, x[1]), self._at(1, y[1])]
        self.parts = []
        for axis, ends in ((0, x), (1, y)):
            for value in self._ticks(axis, ends):
                self._tick(axis, value)
        width, height = size
        self.parts.append(f'<polyline class="mesh" points="42,6 42,{height - 34} {width - 8},{height - 34} {width - 8},6 42,6"/>')
        self._text(labels[0], f'x="{(width + 34) / 2}" y="{height - 4}"', "middle")
        self._text(labels[1], f'transform="translate(9 {(height - 34) / 2}) rotate(-90)"', "middle")

    def _at(self, axis, value):
        return np.log10(value) if self.log[axis] else value

    def _ticks(self, axis, ends):
        if self.log[axis]:
            return 10.0 ** np.arange(np.ceil(self.low[axis] - 1e-9), np.floor(self.high[axis] + 1e-9) + 1)
        step = (ends[1] - ends[0]) / 4
        unit = 10.0 ** np.floor(np.log10(step))
        step = next(unit * k for k in (1, 2, 5, 10) if unit * k >= step * 0.999)
        return np.arange(np.ceil(ends[0] / step - 1e-9), np.floor(ends[1] / step + 1e-9) + 1) * step + 0.0  # no -0

    def place(self, x, y):
        (width, height), out = self.size, []
        for axis, value, first, length in ((0, x, 42, width - 50), (1, y, height - 34, -(height - 40))):
            share = (self._at(axis, np.asarray(value, dtype=float)) - self.low[axis]) / (self.high[axis] - self.low[axis])
            out.append(first + length * np.clip(share, 0, 1))
        return out

    def _tick(self, axis, value):
        x, y = self.place(*((value, 1 if self.log[1] else 0) if axis == 0 else (1 if self.log[0] else 0, value)))
        height = self.size[1]
        place = f'x="{x:.1f}" y="{height - 21}"' if axis == 0 else f'x="38" y="{y + 3:.1f}"'
        self._text(f"{value:g}", place, "end" if axis else "middle")

    def _text(self, text, place, kind):
        self.parts.append(f'<text class="small {kind}" {place}>{html.escape(text)}</text>')

    def line(self, x, y, colour, width=1.0):
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(*self.place(x, y)))
        self.parts.append(f'<polyline points="{points}" style="color:{colour};stroke-width:{width}"/>')

    def dot(self, x, y, colour, radius=2.5):
        a, b = self.place(x, y)
        self.parts.append(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius:.2f}" style="color:{colour}"/>')

    def drawn(self, caption):
        width, height = self.size
        return (f'<figure><svg class="drawing" width="{width}" height="{height}" role="img">{"".join(self.parts)}</svg>'
                f"<figcaption>{html.escape(caption)}</figcaption></figure>")


def colour_of(electrode):
    return f"hsl({electrode * 360 / 24:.0f} 60% 45%)"


def middle_one(recordings, kind):
    """The recording of a class whose most active electrode is the median one."""
    of = sorted((r for r in recordings if r.kind == kind), key=lambda r: rec.spreads(r)[1])
    return of[len(of) // 2]


def time_series(real, synthetic):
    parts = []
    for kind in rec.CLASSES:
        pair = [middle_one(recordings, kind) for recordings in (real, synthetic)]
        moves = [r.counts - r.counts.mean(0) for r in pair]
        top = max(np.abs(m).max() for m in moves)
        for whose, recording, move in zip(COLOURS, pair, moves):
            plot = Plot((0, len(move) / rec.RATE), (-top, top), (540, 170), labels=("s", "counts from mean"))
            for electrode in range(24):
                plot.line(np.arange(len(move)) / rec.RATE, move[:, electrode], colour_of(electrode), 0.8)
            parts.append(plot.drawn(f"{kind}, {whose}: {recording.object}, the median of its class by its most active electrode"))
    return "".join(parts)


def by_group(real, synthetic, figure, places, middle, axes, caption):
    """A plot a group of `figure` at `places`: thick lines are the middles over its recordings, thin ones the quartiles."""
    parts = []
    for group in GROUPS:
        plot = Plot(**axes)
        for whose, recordings in (("real", real), ("synthetic", synthetic)):
            values = np.array([figure(r) for r in recordings if r.kind in GROUPS[group]])
            plot.line(places, middle(values, axis=0), COLOURS[whose], 1.8)
            for share in (25, 75):
                plot.line(places, np.percentile(values, share, axis=0), COLOURS[whose], 0.5)
        parts.append(plot.drawn(f"{group}: {caption}"))
    return "".join(parts)


def pattern(recordings):
    """Size of the first principal component at each electrode, mean over recordings."""
    found = [np.abs(np.linalg.eigh(np.cov(rec.smoothed(r.counts).T))[1][:, -1]) for r in recordings]
    return np.mean(found, axis=0)


def patterns(real, synthetic):
    parts = []
    for kind in rec.CLASSES:
        for whose, recordings in (("real", real), ("synthetic", synthetic)):
            plot = Plot((-12, 12), (-9, 9), (250, 200), labels=("x mm (tip to the right)", "z mm"))
            for place, size in zip(rec.ELECTRODES, pattern([r for r in recordings if r.kind == kind])):
                plot.dot(place[0], place[2], COLOURS[whose], 1 + 24 * size)
            parts.append(plot.drawn(f"{kind}, {whose}"))
    return "".join(parts)


def shown(kind, distance):
    """A distance as text: a factor, or a difference."""
    if not np.isfinite(distance):
        return "-"
    return f"x{np.exp(distance):.2f}" if kind == "ratio" else f"{distance:.2f}"


def table(rows, bars):
    lines = []
    for row in rows:
        mark = ' class="out"' if row["distance"] > bars[row["name"]] else ""
        lines.append(f"<tr{mark}><td>{html.escape(row['name'])}</td><td>{row['group']}</td><td>{row['real']:.3g}</td>"
                     f"<td>{row['synthetic']:.3g}</td><td>{shown(row['kind'], row['distance'])}</td><td>{shown(row['kind'], row['dry'])}</td></tr>")
    head = "".join(f"<th>{name}</th>" for name in ("figure", "group", "real", "synthetic", "apart", "dry run"))
    return f'<table class="plain"><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table>'


def drawn(real, synthetic, rows, bars):
    key = " and ".join(f'<b style="color:{colour}">{whose}</b>' for whose, colour in COLOURS.items())
    spectra = by_group(real, synthetic, lambda r: rec.active_spectrum(r)[1][1:], rec.active_spectrum(real[0])[0][1:], np.median,
                       {"x": (0.39, 50), "y": (0.01, 3000), "log": (True, True), "labels": ("Hz", "counts²/Hz")},
                       "spectrum of the most active electrode")
    correlations = by_group(real, synthetic, rec.distance_correlation, np.mean(rec.DISTANCE_BINS, axis=1), np.mean,
                            {"x": (0, 26), "y": (-1, 1), "labels": ("mm between electrodes", "correlation")},
                            "smoothed signals of two electrodes")
    shares = by_group(real, synthetic, rec.components, (1, 2, 3), np.median,
                      {"x": (1, 3), "y": (0, 1), "labels": ("principal component", "share")}, "variance of the smoothed signals")
    return composed("BioTac SP: real and synthetic", f"""<header class="plain"><h1>BioTac SP: real and synthetic recordings</h1>
<p class="note">{len(real)} recordings {key.split(" and ")[0]}, {len(synthetic)} {key.split(" and ")[1]}. Thick lines are medians (of correlations:
means), thin ones quartiles. The contact sites, depths and spreads of the synthetic ones were read from these same real ones: this shows how well
the model can be made to agree, not how well it foretells.</p></header>
<section><h2>Time series, 24 electrodes in 24 colours</h2>{time_series(real, synthetic)}</section>
<section><h2>Spectra</h2>{spectra}</section>
<section><h2>Correlation against distance</h2>{correlations}</section>
<section><h2>Principal components</h2>{shares}
<p class="note">Size of the first component at each electrode, mean over the recordings of a class:</p>
{patterns(real, synthetic)}</section>
<section><h2>Distances</h2><p class="note">Shaded: outside the worst factor that the dry run reached in that row.</p>
{table(rows, bars)}</section>""")
