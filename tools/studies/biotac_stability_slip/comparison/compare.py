"""Compares recordings of a real BioTac SP with synthetic ones: a table of distances and a page.

usage: compare.py REAL SYNTHETIC [-o PAGE.html]

REAL and SYNTHETIC are folders in the layout of recordings.py (`slipbench export FILE.h5 --format
dos-csv -o SYNTHETIC`).
"""

import argparse
import sys
from collections import Counter

import numpy as np
import page
import recordings as rec
from recordings import GROUPS, BadInput

# Name of each figure, distance as ratio or difference, summary over recordings, figure of a
# recording. The last column holds synthetic and real of the dry run in the specification
# (BIOTAC.md, section 1), in the order of GROUPS; None: not given.
FIGURES = [
    ("mean count", "ratio", np.median, lambda r: rec.levels(r)[0], None),
    ("mean count, lowest", "ratio", np.median, lambda r: rec.levels(r)[1], None),
    (
        "SD, median electrode",
        "ratio",
        np.median,
        lambda r: rec.spreads(r)[0],
        [(10.3, 9.2), (6.2, 9.0), (9.0, 9.6), (4.3, 4.5)],
    ),
    (
        "SD, most active electrode",
        "ratio",
        np.median,
        lambda r: rec.spreads(r)[1],
        [(49, 66), (73, 55), (56, 39), (6.0, 7.1)],
    ),
    (
        "first-difference SD",
        "ratio",
        np.median,
        lambda r: rec.step_figures(r)[0],
        [(5.11, 5.11), (5.01, 5.33), (5.23, 5.07), (4.84, 4.78)],
    ),
    (
        "repeated rows",
        "ratio",
        np.median,
        lambda r: rec.step_figures(r)[1],
        [(0.34, 0.34), (0.34, 0.34), (0.34, 0.34), (0.35, 0.35)],
    ),
    (
        "peak to peak, max",
        "ratio",
        np.median,
        lambda r: rec.extremes(r)[0],
        [(252, 351), (404, 388), (268, 220), (52, 65)],
    ),
    (
        "slope [1/s], max",
        "ratio",
        np.median,
        lambda r: rec.extremes(r)[1],
        [(745, 759), (1074, 960), (786, 467), (98, 112)],
    ),
]
_BANDS = [
    [(27, 27), (34, 32), (36, 23), (2.3, 3.4)],
    [(5.7, 7.8), (9.3, 12.7), (7.5, 6.5), (1.6, 2.1)],
    [(2.9, 3.6), (3.4, 6.6), (3.3, 3.4), (1.8, 2.3)],
    [(2.3, 2.6), (2.6, 3.1), (2.4, 2.5), (2.3, 2.4)],
    [(2.3, 2.3), (2.5, 2.6), (2.5, 2.5), (2.2, 2.5)],
    [(1.8, 1.6), (1.9, 1.9), (1.7, 1.7), (1.6, 1.9)],
]
_CORRELATIONS = [
    [(0.77, 0.71), (0.74, 0.76), (0.47, 0.82), (0.40, 0.42)],
    [(0.66, 0.59), (0.61, 0.56), (0.69, 0.58), (0.34, 0.39)],
    [(0.50, 0.44), (0.61, 0.51), (0.54, 0.42), (0.31, 0.29)],
    [(0.25, 0.12), (0.33, 0.21), (0.32, 0.14), (0.15, 0.12)],
    [(-0.14, -0.17), (0.08, 0.00), (-0.04, -0.19), (0.05, -0.10)],
    [(-0.41, -0.34), (-0.18, -0.11), (-0.36, -0.35), (-0.02, -0.28)],
    [(-0.56, -0.73), (-0.55, -0.38), (-0.60, -0.30), (-0.07, -0.61)],
]
_COMPONENTS = [
    [(0.74, 0.88), (0.88, 0.90), (0.75, 0.77), (0.68, 0.73)],
    [(0.19, 0.10), (0.09, 0.07), (0.18, 0.17), (0.12, 0.14)],
    [(0.03, 0.02), (0.01, 0.01), (0.04, 0.03), (0.05, 0.02)],
]
_NET = [[(6, 8.5), (6, 8), (5, 7.5), (0, 1)], [(6, 8), (2, 4), (5, 6), (0, 1)]]
FIGURES += [
    (f"band {low:g}-{high:g} Hz", "ratio", np.median, lambda r, k=k: rec.band_rms(r)[k], _BANDS[k])
    for k, (low, high) in enumerate(rec.BANDS)
]
FIGURES += [
    (
        f"correlation {low:g}-{high:g} mm",
        "difference",
        np.mean,
        lambda r, k=k: rec.distance_correlation(r)[k],
        _CORRELATIONS[k],
    )
    for k, (low, high) in enumerate(rec.DISTANCE_BINS)
]
FIGURES += [
    (
        f"share of PC{k + 1}",
        "difference",
        np.median,
        lambda r, k=k: rec.components(r)[k],
        _COMPONENTS[k],
    )
    for k in range(3)
]
FIGURES += [
    (
        f"electrodes that {way} > 20",
        "difference",
        np.median,
        lambda r, k=k: rec.net_change(r)[k],
        _NET[k],
    )
    for k, way in enumerate(("rise", "fall"))
]


def apart(kind, synthetic, real):
    """Distance of two figures: |ln ratio| or |difference|."""
    return abs(np.log(synthetic / real)) if kind == "ratio" else abs(synthetic - real)


def of_group(recordings, group):
    return [r for r in recordings if r.kind in GROUPS[group]]


def scatter(kind, how, real, synthetic, random):
    """Standard error of the (log) ratio or difference.

    From 200 bootstrap samples of the recordings.
    """
    found = []
    for _ in range(200):
        a, b = (how(random.choice(values, len(values))) for values in (synthetic, real))
        found.append(np.log(a / b) if kind == "ratio" and a > 0 and b > 0 else a - b)
    return np.std(found)


def compared(real, synthetic):
    """One row per figure and group.

    Name, group, kind, real, synthetic, distance, its standard error, distance of the dry run.
    """
    random = np.random.default_rng(1)
    rows = []
    for name, kind, how, figure, dry_run in FIGURES:
        for group, dry in zip(GROUPS, dry_run or [None] * len(GROUPS), strict=True):
            a, b = (
                np.array([figure(r) for r in of_group(kin, group)], dtype=float)
                for kin in (real, synthetic)
            )
            rows.append(
                {
                    "name": name,
                    "group": group,
                    "kind": kind,
                    "real": how(a),
                    "synthetic": how(b),
                    "distance": apart(kind, how(b), how(a)),
                    "error": scatter(kind, how, a, b, random),
                    "dry": np.nan if dry is None else apart(kind, *dry),
                }
            )
    return rows


def bars(rows):
    """By figure: the dry run's worst distance, but at least the rounding of its table's two digits.

    NaN: not given.
    """
    return {
        row["name"]: max(
            [r["dry"] for r in rows if r["name"] == row["name"]]
            + [0.02 if row["kind"] == "ratio" else 0.01]
        )
        if np.isfinite(row["dry"])
        else np.nan
        for row in rows
    }


def print_table(rows):
    print(f"{'':32}{'real':>8}{'synth.':>9}{'apart':>8}{'+-':>8}{'dry run':>9}{'its worst':>11}")
    worst = bars(rows)
    for row in rows:
        mark = "  OUTSIDE" if row["distance"] > worst[row["name"]] else ""
        mark = "  nearer" if row["distance"] < row["dry"] else mark
        print(
            f"{row['name']:26}{row['group']:6}{row['real']:8.3g}{row['synthetic']:9.3g}{page.shown(row['kind'], row['distance']):>8}"
            f"{page.shown(row['kind'], row['error']):>8}{page.shown(row['kind'], row['dry']):>9}{page.shown(row['kind'], worst[row['name']]):>11}{mark}"
        )
    return [row for row in rows if row["distance"] > worst[row["name"]]]


def print_summary(rows, outside):
    print(
        "\nDistance by figure: mean and worst over the groups, here and in the dry run (|ln ratio|, or |difference|)"
    )
    for name in dict.fromkeys(row["name"] for row in rows):
        of = [row for row in rows if row["name"] == name]
        here, dry = [r["distance"] for r in of], [r["dry"] for r in of]
        beside = (
            f"{np.mean(dry):6.2f}{np.max(dry):7.2f}" if np.isfinite(dry).all() else "     -      -"
        )
        print(f"  {name:28}{np.mean(here):6.2f}{np.max(here):7.2f}   {beside}")
    for kind, what in (
        ("ratio", "ratios"),
        ("difference", "differences but the counted electrodes"),
    ):
        print(f"Root mean square over all {what}, by group, here (dry run):", end="")
        for group in GROUPS:
            of = [
                r
                for r in rows
                if r["group"] == group
                and r["kind"] == kind
                and np.isfinite(r["dry"])
                and not r["name"].startswith("electrodes")
            ]
            here, dry = (np.sqrt(np.mean([r[key] ** 2 for r in of])) for key in ("distance", "dry"))
            print(f"  {group} {here:.2f} ({dry:.2f})", end="")
        print()
    print(
        f"Cells outside the dry run's worst factor of their row: {len(outside)} of "
        f"{sum(np.isfinite(r['dry']) for r in rows)}; nearer than the dry run's own cell: "
        f"{sum(r['distance'] < r['dry'] for r in rows)}"
    )
    for row in outside:
        print(f"  {row['name']}, {row['group']}: {page.shown(row['kind'], row['distance'])}")


def print_windows(real, synthetic):
    print("\nMost active electrode in windows of 0.5 s, detrended SD: 5, 25, 50, 75, 95 %")
    for what, kinds in (("slip", rec.CLASSES[:-1]), ("touch", ("t",))):
        for whose, recordings in (("real", real), ("synthetic", synthetic)):
            found = [
                rec.detrended(w).std(0).max()
                for r in recordings
                if r.kind in kinds
                for w in rec.windows(r.counts)
            ]
            print(
                f"  {what:6}{whose:10}",
                "  ".join(f"{q:.1f}" for q in np.percentile(found, [5, 25, 50, 75, 95])),
            )
    for whose, recordings in (("real", real), ("synthetic", synthetic)):
        counts = np.concatenate([r.counts for r in recordings])
        print(f"Counts, {whose}: lowest {counts.min():.0f}, highest {counts.max():.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("real", help="folder of the real recordings")
    parser.add_argument("synthetic", help="folder of the synthetic ones")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="draw both side by side")
    options = parser.parse_args()
    try:
        real, synthetic = rec.read_folder(options.real), rec.read_folder(options.synthetic)
    except (BadInput, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    for whose, recordings in (("Real", real), ("Synthetic", synthetic)):
        objects = Counter(r.object for r in recordings)
        print(
            f"{whose}: {len(recordings)} recordings;",
            ", ".join(f"{name} {count}" for name, count in sorted(objects.items())),
        )
    rows = compared(real, synthetic)
    outside = print_table(rows)
    print_summary(rows, outside)
    print_windows(real, synthetic)
    print(
        "\nThe contact sites, depths and spreads of scenes/biotac_sp/slip.yaml are fitted to these real recordings. The table therefore shows\nhow "
        "well the model can be fitted, not how well it predicts."
    )
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(page.drawn(real, synthetic, rows, bars(rows)))
        print(f"wrote {options.output}")


if __name__ == "__main__":
    main()
