"""Real and synthetic recordings side by side in one HTML page: no script, no network."""

import base64
import hashlib
import html
import io
import re
from pathlib import Path

import numpy as np
import recordings as rec
from matplotlib import colormaps, rc
from matplotlib.figure import Figure
from recordings import GROUPS

KIT = Path(__file__).resolve().parents[3] / "page" / "web"
COLOURS = {"real": "#1f66ad", "synthetic": "#c2450f"}  # --s0 and --s1 of theme.css
ELECTRODE_COLOURS = colormaps["hsv"](np.arange(24) / 24)
rc("font", size=7)
rc("svg", hashsalt="slipbench")  # reproducible bytes
STYLE = """figure { display: inline-block; margin: 6px 10px 6px 0; vertical-align: top; }
figure img { background: #fff; }
figcaption { font-size: 12px; color: var(--soft); }
.out td { background: var(--band2); }"""


def composed(title, body):
    """The page of tools/page around `body` (HTML)."""
    styles = (
        "\n".join((KIT / name).read_text(encoding="utf-8") for name in ("theme.css", "page.css"))
        + STYLE
    )
    digest = base64.b64encode(hashlib.sha256(f"\n{styles}\n".encode()).digest()).decode()
    policy = (
        f"default-src 'none'; style-src-elem 'sha256-{digest}'; style-src-attr 'unsafe-inline'; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    parts = {
        "generator": "compare.py",
        "policy": policy,
        "title": html.escape(title),
        "body": body,
        "scripts": "",
        "styles": styles,
    }
    return re.sub(
        r"{{(\w+)}}",
        lambda marker: parts[marker[1]],
        (KIT / "page.html").read_text(encoding="utf-8"),
    )


def axes(size=(270, 170), **settings):
    """The axes of one drawing of the given size [px]."""
    plot = Figure(figsize=np.array(size) / 96, layout="constrained").add_subplot()
    plot.set(**settings)
    return plot


def drawn_in(plot, caption):
    """The drawing as HTML."""
    file = io.BytesIO()
    plot.figure.savefig(file, format="svg", metadata={"Date": None})
    picture = base64.b64encode(file.getvalue()).decode()
    return f'<figure><img alt="" src="data:image/svg+xml;base64,{picture}"><figcaption>{html.escape(caption)}</figcaption></figure>'


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
        for whose, recording, move in zip(COLOURS, pair, moves, strict=True):
            plot = axes(
                (540, 170),
                xlim=(0, len(move) / rec.RATE),
                ylim=(-top, top),
                xlabel="s",
                ylabel="counts from mean",
            )
            plot.set_prop_cycle(color=ELECTRODE_COLOURS)
            plot.plot(np.arange(len(move)) / rec.RATE, move, linewidth=0.8)
            parts.append(
                drawn_in(
                    plot,
                    f"{kind}, {whose}: {recording.object}, the median of its class by its most active electrode",
                )
            )
    return "".join(parts)


def by_group(real, synthetic, figure, places, middle, settings, caption):
    """One plot of `figure` per group at `places`.

    Thick lines are medians over its recordings, thin ones the quartiles.
    """
    parts = []
    for group in GROUPS:
        plot = axes(**settings)
        for whose, recordings in (("real", real), ("synthetic", synthetic)):
            values = np.array([figure(r) for r in recordings if r.kind in GROUPS[group]])
            plot.plot(places, middle(values, axis=0), color=COLOURS[whose], linewidth=1.8)
            plot.plot(
                places,
                np.percentile(values, (25, 75), axis=0).T,
                color=COLOURS[whose],
                linewidth=0.5,
            )
        parts.append(drawn_in(plot, f"{group}: {caption}"))
    return "".join(parts)


def pattern(recordings):
    """Size of the first principal component at each electrode, mean over recordings."""
    found = [np.abs(np.linalg.eigh(np.cov(rec.smoothed(r.counts).T))[1][:, -1]) for r in recordings]
    return np.mean(found, axis=0)


def patterns(real, synthetic):
    parts = []
    for kind in rec.CLASSES:
        for whose, recordings in (("real", real), ("synthetic", synthetic)):
            plot = axes(
                (250, 200),
                xlim=(-12, 12),
                ylim=(-9, 9),
                xlabel="x mm (tip to the right)",
                ylabel="z mm",
            )
            radius = 1 + 24 * pattern([r for r in recordings if r.kind == kind])  # px
            plot.scatter(
                rec.ELECTRODES[:, 0],
                rec.ELECTRODES[:, 2],
                s=(1.5 * radius) ** 2,
                linewidths=0,
                color=COLOURS[whose],
            )
            parts.append(drawn_in(plot, f"{kind}, {whose}"))
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
        lines.append(
            f"<tr{mark}><td>{html.escape(row['name'])}</td><td>{row['group']}</td><td>{row['real']:.3g}</td>"
            f"<td>{row['synthetic']:.3g}</td><td>{shown(row['kind'], row['distance'])}</td><td>{shown(row['kind'], row['dry'])}</td></tr>"
        )
    head = "".join(
        f"<th>{name}</th>" for name in ("figure", "group", "real", "synthetic", "apart", "dry run")
    )
    return f'<table class="plain"><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table>'


def drawn(real, synthetic, rows, bars):
    key = " and ".join(
        f'<b style="color:{colour}">{whose}</b>' for whose, colour in COLOURS.items()
    )
    spectra = by_group(
        real,
        synthetic,
        lambda r: rec.active_spectrum(r)[1][1:],
        rec.active_spectrum(real[0])[0][1:],
        np.median,
        {
            "xlim": (0.39, 50),
            "ylim": (0.01, 3000),
            "xscale": "log",
            "yscale": "log",
            "xlabel": "Hz",
            "ylabel": "counts²/Hz",
        },
        "spectrum of the most active electrode",
    )
    correlations = by_group(
        real,
        synthetic,
        rec.distance_correlation,
        np.mean(rec.DISTANCE_BINS, axis=1),
        np.mean,
        {
            "xlim": (0, 26),
            "ylim": (-1, 1),
            "xlabel": "mm between electrodes",
            "ylabel": "correlation",
        },
        "smoothed signals of two electrodes",
    )
    shares = by_group(
        real,
        synthetic,
        rec.components,
        (1, 2, 3),
        np.median,
        {"xlim": (1, 3), "ylim": (0, 1), "xlabel": "principal component", "ylabel": "share"},
        "variance of the smoothed signals",
    )
    return composed(
        "BioTac SP: real and synthetic",
        f"""<header class="plain"><h1>BioTac SP: real and synthetic recordings</h1>
<p class="note">{len(real)} recordings {key.split(" and ")[0]}, {len(synthetic)} {key.split(" and ")[1]}. Thick lines are medians (of correlations:
means), thin ones quartiles. The contact sites, depths and spreads of the synthetic recordings are fitted to these real ones. The page therefore
shows how well the model can be fitted, not how well it predicts.</p></header>
<section><h2>Time series, 24 electrodes in 24 colours</h2>{time_series(real, synthetic)}</section>
<section><h2>Spectra</h2>{spectra}</section>
<section><h2>Correlation against distance</h2>{correlations}</section>
<section><h2>Principal components</h2>{shares}
<p class="note">Size of the first component at each electrode, mean over the recordings of a class:</p>
{patterns(real, synthetic)}</section>
<section><h2>Distances</h2><p class="note">Shaded: outside the worst factor that the dry run reached in that row.</p>
{table(rows, bars)}</section>""",
    )
