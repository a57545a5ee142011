"""Table III of the paper.

The recurrent network that the paper compares with, on the published protocol.
"""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from slipbench import evaluate
from slipbench.learning import Engine
from slipbench_studies.grid import Cell, check_only, chosen, make_dataset
from slipbench_studies.network_training import train_detector
from slipbench_studies.result import Options, Result, Table

SCENE = "scenes/papillarray/hexapod.yaml"  # the published protocol
CELLS = 200  # motions and compressions of SCENE
MANY_DRAWS = 4  # of each cell: 640 sequences for training, 160 for the test
STEPS_TIMED = 201

# Names of figures, and of the same figures in a result of `eval`.
COUNTS = ("trials", "slipping", "seen", "early", "missed", "false_alarms")
VALUES = {
    "balanced_accuracy": "balanced_slip_accuracy",
    "auc": "auc",
    "delay_s": "delay_median_s",
    "delay_p10_s": "delay_p10_s",
    "delay_p90_s": "delay_p90_s",
    "false_alarms_a_minute": "false_alarms_per_minute",
}


@dataclass(frozen=True)
class Row:
    """A network.

    Attributes:
        labels: rule of the labels
        draws: draws of each motion and compression
        recipe: name of the recipe
        text: text in the table
    """

    labels: str
    draws: int = 1
    recipe: str = "papillarray_gru"
    text: str = "GRU"


ROWS = {
    "gru_micro": Row("micro"),
    "gru_micro_640": Row("micro", MANY_DRAWS),
    "gru_latched": Row("latched"),
    "gru_latched_640": Row("latched", MANY_DRAWS),
    "gru5_latched": Row("latched", recipe="papillarray_gru5", text="five GRUs averaged"),
}


def gru_figures(result: dict[str, Any]) -> dict[str, Any]:
    """Figures of a detector for Table III.

    Args:
        result: result of slipbench.evaluate()

    Returns:
        of the test trials: trials, slipping, seen, early, missed and false_alarms; of frames, slip
        or not: balanced_accuracy and auc; of the seen trials: delay_s, delay_p10_s and delay_p90_s,
        None without any; false_alarms_a_minute
    """
    summary = result["all"]
    return {key: summary[key] for key in COUNTS} | {
        name: summary["figures"][key]["value"] for name, key in VALUES.items()
    }


def right_share(figures: dict[str, Any], early_counts: bool) -> float:
    """Share of right trials: slip seen in time, or no alarm without slip.

    Args:
        figures: of gru_figures()
        early_counts: True: early alarms count as right

    Returns:
        0 to 1
    """
    quiet = figures["trials"] - figures["slipping"] - figures["false_alarms"]
    right: int = figures["seen"] + quiet + (figures["early"] if early_counts else 0)
    return right / int(figures["trials"])


def step_time(model: str) -> float:
    """Time of a step of a network in a loop.

    Args:
        model: ONNX file

    Returns:
        s, median of STEPS_TIMED
    """
    engine = Engine(model)
    frame = np.zeros((1, engine.inputs), dtype=np.float32)
    times = []
    for _ in range(STEPS_TIMED):
        begun = time.perf_counter()
        engine.run(frame)
        times.append(time.perf_counter() - begun)
    return float(np.median(times))


def run_row(name: str, dataset: str, model: str, options: Options) -> dict[str, Any]:
    """Trains and tests the network of a row.

    Args:
        name: a key of ROWS
        dataset: sequences of the row
        model: ONNX file to write
        options: seed, progress output

    Returns:
        gru_figures(), with learnt, the number of training and validation sequences; kilobytes, the
        size of the file; step_s

    Raises:
        InputError: the training fails
    """
    row = ROWS[name]
    trained = train_detector(name, row.recipe, dataset, model, options, row.labels)
    return gru_figures(evaluate(model, dataset, labels=row.labels)) | {
        "learnt": trained.parts["learns"] + trained.parts["validates"],
        "kilobytes": 1e-3 * Path(model).stat().st_size,
        "step_s": step_time(model),
    }


def frames_table() -> Table:
    """The table of frames, with the paper's rows."""
    return Table(
        "Slip or not",
        [
            "detector",
            "label",
            "sequences learnt",
            "balanced accuracy, %",
            "AUC",
            "trials right, %",
            "with early ones",
            "size, kB",
            "a step, us",
        ],
        [
            ["paper: GRU", "incipient or not", "-", "-", "-", "95.6", "-", "1468", "25000 (GPU)"],
            [
                "paper: CL-gstHDC, accuracy of three classes",
                "paper",
                "-",
                "-",
                "-",
                "-",
                "91.8 of frames",
                "0.375",
                "5985; 0.42 (FPGA)",
            ],
        ],
        "Correct trials: slip is reported at or after the true first slip, or is not reported in a trial without slip. With early ones: reports before the "
        "first slip count as correct, too. The paper does not state when an early report is correct.",
    )


def events_table() -> Table:
    """The table of events, empty."""
    return Table(
        "By event",
        [
            "detector",
            "label",
            "trials that slip",
            "seen",
            "early",
            "missed",
            "delay, ms: median",
            "10 to 90 %",
            "false alarms: trials",
            "a minute of stick",
        ],
        note="Delay: from the true first slip, of the trials seen. Early: reported before it.",
    )


def decimals(value: float | None, digits: int, scale: float = 1.0, none: str = "-") -> str:
    """A figure for the tables; `none` for None."""
    return none if value is None else f"{scale * value:.{digits}f}"


def frames_row(row: Row, figures: dict[str, Any]) -> list[str]:
    """A row of frames_table()."""
    return [
        row.text,
        row.labels,
        str(figures["learnt"]),
        decimals(figures["balanced_accuracy"], 1, 100.0),
        decimals(figures["auc"], 3, none="nan"),
        *(decimals(right_share(figures, early), 1, 100.0) for early in (False, True)),
        decimals(figures["kilobytes"], 0),
        decimals(figures["step_s"], 0, 1e6),
    ]


def events_row(row: Row, figures: dict[str, Any]) -> list[str]:
    """A row of events_table()."""
    delay, low, high = (
        decimals(figures[key], 0, 1e3) for key in ("delay_s", "delay_p10_s", "delay_p90_s")
    )
    return [
        f"{row.text}, {figures['learnt']} learnt",
        row.labels,
        *(str(figures[key]) for key in ("slipping", "seen", "early", "missed")),
        delay,
        f"{low} to {high}",
        f"{figures['false_alarms']} of {figures['trials'] - figures['slipping']}",
        decimals(figures["false_alarms_a_minute"], 1, none="nan"),
    ]


def study(options: Options) -> Result:
    """hd-papillarray/table3.

    Args:
        options: only, seed, jobs

    Returns:
        accuracy, delay and alarms of the network by its labels and the number of sequences

    Raises:
        InputError: for an unknown name of --only, or a trial that cannot run
    """
    check_only(options.only, list(ROWS))
    frames, events, figures = frames_table(), events_table(), dict[str, Any]()
    with tempfile.TemporaryDirectory() as folder:
        for name in chosen(list(ROWS), options.only):
            row = ROWS[name]
            dataset = Path(folder) / f"hexapod{row.draws}.h5"
            if not dataset.exists():
                make_dataset(
                    str(dataset), Cell("hexapod.yaml", SCENE, draws=row.draws), options, "sequences"
                )
            figures[name] = run_row(name, str(dataset), str(Path(folder) / f"{name}.onnx"), options)
            frames.rows.append(frames_row(row, figures[name]))
            events.rows.append(events_row(row, figures[name]))
    return Result(
        title="The recurrent network on the published protocol",
        source='Table III, offline evaluation, of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray '
        'Tactile Sensor"',
        figures=figures,
        tables=[frames, events],
        setup=[
            f"{SCENE}, seed {options.draws_seed}: {CELLS} sequences, or {CELLS * MANY_DRAWS} of them with {MANY_DRAWS} draws. A fifth is for the test; a fifth of the rest selects the state and the threshold.",
            "The network is the published one (recipe papillarray_gru): 25 Hz, tangential forces of the eight outer pillars. Labels: micro, a part of a "
            "pillar slips; latched, it has slipped and still touches.",
        ],
        remarks=[
            "CL-gstHDC on the same sequences is hd-papillarray/table1.",
            "After braking, the pad sticks under the shear of its slip. By the rule micro these frames are hold, although they look like slip. So latched "
            "is the easier label, and it is closest to the published one, which marks the first slip of a pillar.",
            "Most early reports occur in slow motions: a frame of 40 ms is then close to the first slip long before the slip.",
        ],
    )
