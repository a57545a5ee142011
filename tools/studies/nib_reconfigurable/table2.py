"""Table II of the nib pad's paper.

Algorithm 1 under a slowly falling normal force, and the causes of its figures.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import pandas as pd
from slipbench import Trial, parse_quantity
from slipbench._program import counted
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.nib_reconfigurable.bench import (
    LAWS,
    Signature,
    Trace,
    has_waves,
    signature_of,
)
from slipbench_studies.result import Chart, Curve, Options, RealFigure, Result, Table
from slipbench_studies.statistics import clopper_pearson, mean_sd, median

SCENE = "scenes/nib_pad/release.yaml"
DETECTOR = {"start": "6 s"}  # of the scene: flags count from this time
START = 6.0  # s, the same time
USUAL_TRIALS = 15
FEW_DRAWS = 2  # maximum number of trials per cell for every law except the scene's own
SAFE_WAY = 6e-3  # m; an earlier detection is a success in the paper

# Changes of the detector on the same trials; the scene's own detector first.
READINGS: dict[str, tuple[str, dict[str, str]]] = {
    "as_is": ("threshold 25, patience 0.5 s, F_S/F_N in counts as in equations 1, 2 and 4", {}),
    "threshold_15": ("threshold 15", {"threshold": "15"}),
    "threshold_20": ("threshold 20", {"threshold": "20"}),
    "threshold_40": ("threshold 40", {"threshold": "40"}),
    "threshold_80": ("threshold 80", {"threshold": "80"}),
    "patience_0.25": ("patience 0.25 s", {"patience": "0.25 s"}),
    "patience_1": ("patience 1 s", {"patience": "1 s"}),
    "alpha_0": ("alpha 0", {"weight": "0"}),
    "alpha_5_m_5": ("M 5, alpha 5", {"counter_max": "5", "weight": "5"}),
    "forces": ("F_S/F_N of newtons", {"ratio": "forces"}),
}


class Surface(NamedTuple):
    """A published row.

    Text, errors of all and of gross detections [N], number of safe runs, number of runs.
    """

    text: str
    all: float
    gross: float
    safe: int
    runs: int


PUBLISHED = {
    "paper": Surface("paper", 0.77, 0.55, 57, 58),
    "masonite": Surface("smooth masonite", 1.06, 1.05, 67, 74),
    "wavy_acrylic": Surface("wavy acrylic", 0.84, 0.51, 61, 61),
    "soaped_wavy_acrylic": Surface("soaped wavy acrylic", 3.44, 3.22, 62, 68),
}


def trial_of(trial: Trial) -> tuple[list[dict[str, Any]], Signature | None]:
    """Result of one trial for each of READINGS, and its signature.

    Args:
        trial: a full record of the scene

    Returns:
        rows of reading, material, required: N, pull/mu_s; force: N, true, at the detection; way: m,
        slip at the detection (NaN: no detection before the slip was over)
    """
    trace, params = Trace(trial), trial.params
    begun = trace.at(START)
    required = parse_quantity(params["controls.pull"][-1][1]) / params["friction.static"]
    rows = []
    for reading, (_, changes) in READINGS.items():
        found = trace.detection("nib_linear_slip", {**DETECTOR, **changes})
        force, way = (
            (math.nan, math.nan)
            if found is None
            else (float(trace.normal[found]), float(trace.lever[found] - trace.lever[begun]))
        )
        rows.append(
            {
                "reading": reading,
                "material": params["surface.material"],
                "required": required,
                "force": force,
                "way": way,
            }
        )
    return rows, signature_of(trace, START, has_waves(params))


def summary_of(runs: pd.DataFrame) -> dict[str, Any]:
    """Summary of runs.

    Args:
        runs: columns required, force [N], way [m]

    Returns:
        numbers of runs: runs, safe (detected before 6 mm), early (safe, at no less than the force
        that the pull requires); of the safe ones error_N, error_sd_N, gross_error_N (of those that
        are not early), slip_mm; NaN without runs
    """
    safe = runs[runs["way"] < SAFE_WAY]
    error, gross = (safe["force"] - safe["required"]).abs(), safe["force"] < safe["required"]
    mean, sd = mean_sd(error)
    return {
        "runs": len(runs),
        "safe": len(safe),
        "early": int((~gross).sum()),
        "error_N": mean,
        "error_sd_N": sd,
        "gross_error_N": mean_sd(error[gross])[0],
        "slip_mm": mean_sd(1e3 * safe["way"])[0],
    }


def _newtons(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _safe_share(s: dict[str, Any]) -> str:
    low, high = clopper_pearson(s["safe"], s["runs"])
    return f"{s['safe']} of {s['runs']} ({100 * s['safe'] / max(1, s['runs']):.1f} %; {100 * low:.0f} to {100 * high:.0f} %)"


def release_table(runs: pd.DataFrame) -> tuple[Table, list[dict[str, Any]]]:
    """The paper's table with ours, and its figures: one row per surface and one for all."""
    table = Table(
        "Algorithm 1 with the paper's M and alpha",
        [
            "",
            "error, N: paper",
            "ours",
            "gross only: paper",
            "ours",
            "before 6 mm: paper",
            "ours",
            "early",
            "slip at the detection, mm",
        ],
        note="Error: mean of |F_G,slip - F_G,req| over the runs with detection before 6 mm, F_G,req = pull/mu_s. Gross: those with F_G,slip < "
        "F_G,req; early: the others. Slip: path of the lever since the detector began to count. Shares with the 95 % interval of Clopper and"
        " Pearson.",
    )
    parts = [
        (
            row.text,
            f"{row.all:.2f}",
            f"{row.gross:.2f}",
            f"{row.safe} of {row.runs}",
            runs[runs["material"] == material],
        )
        for material, row in PUBLISHED.items()
    ]
    figures = []
    for text, error, gross, safe, some in [*parts, ("all", "-", "-", "247 of 261 (94.6 %)", runs)]:
        s = summary_of(some)
        table.rows.append(
            [
                text,
                error,
                _newtons(s["error_N"]),
                gross,
                _newtons(s["gross_error_N"]),
                safe,
                _safe_share(s),
                f"{s['early']} of {s['safe']}",
                _newtons(s["slip_mm"]),
            ]
        )
        figures.append({**s, "surface": text})
    return table, figures


def _surfaces_row(text: str, runs: pd.DataFrame) -> list[str]:
    parts = [*(runs[runs["material"] == material] for material in PUBLISHED), runs]
    return [
        text,
        *(
            f"{_newtons(s['error_N'])}, {s['safe']}/{s['runs']}, {s['early']} early"
            for s in map(summary_of, parts)
        ),
    ]


def signature_rows(
    law: str, found: list[Signature | None]
) -> tuple[list[list[str]], list[dict[str, Any]]]:
    """Medians of the signatures under one law.

    Rows of the table and their figures, flat plates first.

    Args:
        law: text of the law
        found: signature of each trial; None: no sufficiently long slip

    Returns:
        two rows of text and two of figures, with medians if there are slips
    """
    rows, figures = [], []
    for wavy in (False, True):
        slips = pd.DataFrame(
            [one.__dict__ for one in found if one is not None and one.wavy == wavy]
        )
        middle = (
            {name: median(slips[name]) for name in ("share", "below", "above", "time")}
            if len(slips)
            else {}
        )
        texts = [
            f"{middle[name]:.{digits}f}" if middle else "-"
            for name, digits in (("share", 3), ("below", 1), ("above", 1), ("time", 2))
        ]
        rows.append([law, "wavy" if wavy else "flat", str(len(slips)), *texts])
        medians = (
            {
                "share": middle["share"],
                "below_counts": middle["below"],
                "above_counts": middle["above"],
                "time_s": middle["time"],
            }
            if middle
            else {}
        )
        figures.append({"law": law, "wavy": wavy, "slips": len(slips), **medians})
    return rows, figures


def study(options: Options) -> Result:
    """nib-reconfigurable/table2.

    Args:
        options: trials, seed, jobs

    Returns:
        the table, the same for other friction laws and other readings, and signatures
    """
    trials = options.trials or USUAL_TRIALS
    cells = [
        Cell(law.text, SCENE, draws=trials if k == 0 else min(trials, FEW_DRAWS), change=law.change)
        for k, law in enumerate(LAWS.values())
    ]
    found = run_grid(cells, options, lambda _, trial: trial_of(trial))
    runs = [pd.DataFrame([row for rows, _ in of_law for row in rows]) for of_law in found]
    as_is = [of_law[of_law["reading"] == "as_is"] for of_law in runs]
    head = [*(row.text for row in PUBLISHED.values()), "all"]
    laws = Table(
        "The same under other friction",
        ["law", *head],
        note=f"Mean error [N], runs with detection before 6 mm, early ones. The first row has {counted(trials, 'run')} per cell, the others up to {FEW_DRAWS}.",
    )
    readings = Table("The same trials read otherwise", ["detector", *head], note="As above.")
    signature = Table(
        "Energy of the linear mode below 8 Hz while the pad slips",
        [
            "law",
            "plates",
            "slips that last",
            "share below 8 Hz",
            "below, counts rms",
            "above",
            "time of the slip, s",
        ],
        note="Medians over slips, for C_N - C_S in windows of 0.5 s, minus the least-squares line, Hamming, which lie wholly between 0.3 and "
        "10 mm of the lever; shorter slips are omitted. The noise of the converter alone has a share of 0.05 and 1.7 counts above 8 Hz.",
    )
    figures: dict[str, Any] = {"signature": [], "laws": {}}
    for k, (name, law) in enumerate(LAWS.items()):
        rows, numbers = signature_rows(law.text, [one for _, one in found[k]])
        signature.rows += rows
        figures["signature"] += numbers
        laws.rows.append(_surfaces_row(law.text, as_is[k]))
        figures["laws"][name] = summary_of(as_is[k])
    release, figures["table"] = release_table(as_is[0])
    figures["readings"] = {}
    for name, (text, _) in READINGS.items():
        of_reading = runs[0][runs[0]["reading"] == name]
        readings.rows.append(_surfaces_row(text, of_reading))
        figures["readings"][name] = summary_of(of_reading)
    real, ours, theirs = [], [], []
    for surface, numbers in zip(PUBLISHED.values(), figures["table"], strict=False):
        share, published = (
            100.0 * numbers["safe"] / numbers["runs"],
            100.0 * surface.safe / surface.runs,
        )
        real.append(
            RealFigure(
                f"force at which slip is detected, error on {surface.text}, N",
                surface.all,
                numbers["error_N"],
                "friction and its patches assumed",
            )
        )
        real.append(
            RealFigure(f"slips detected before 6 mm on {surface.text}, %", published, share)
        )
        error = numbers["error_N"]
        sd = 0.0 if math.isnan(numbers["error_sd_N"]) else numbers["error_sd_N"]
        ours.append((error, error - sd, error + sd))
        theirs.append((surface.all, surface.all, surface.all))
    return Result(
        title="Slip detected while the grasp is slowly released",
        source='Table II and section V of "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation"',
        figures=figures,
        setup=[
            f"{SCENE}, seed {options.draws_seed}, {counted(trials, 'run')} of each of its surfaces and pulls.",
            "Paper: M 9, alpha 10, windows of 500 ms every 100 ms, 0.03 mm/s. Not in the paper, assumed: SLIP_THRES 25 counts (a bound of the noise: "
            "detectors/nib/README.md), TIME_THRES 0.5 s, mu_s of all plates except the soaped one (changed once in a dry run, when the published errors "
            "were known), the patches and waves of the plates, masses and damping of the lever.",
            "F_S/F_N is a ratio of counts, as in equations 1, 2 and 4; a ratio of newtons, which the text of the paper would allow, is a separate row.",
            "The soaped plate is pulled with up to 1 N: 5 N would need 71 N of grasp.",
        ],
        charts=[
            Chart(
                "Error of the force at which slip is detected",
                "",
                "error of the force, N (mean and SD)",
                head[:-1],
                [Curve("ours", ours), Curve("paper", theirs)],
                joined=False,
            )
        ],
        tables=[release, laws, readings, signature],
        real=real,
    )
