"""Number of trials, and variation in them, that training needs.

Networks trained on parts of scenes/learn, scored by the benchmark.
"""

from __future__ import annotations

import json
import math
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from slipbench import InputError
from slipbench.bin import _core
from slipbench.learning import find_recipe, train
from slipbench_studies.grid import Cell, check_only, chosen, make_dataset
from slipbench_studies.network_training import train_all
from slipbench_studies.result import Chart, Curve, Options, Result, Table

NAME = "learned/scaling"
COUNTS = (100, 300, 1000, 3000)
MORE_COUNTS = (10_000, 30_000)  # --full
USUAL_TRIALS = 1000  # for the networks without a factor, which --full adds
QUICK_PART = 4  # without --full a network takes a quarter of its recipe's steps
HEAD = ["score inside", "95 %", "median delay", "early", "alarms/min", "score outside", "95 %"]

Json = dict[str, Any]


@dataclass(frozen=True)
class Factor:
    """A quantity that a scene draws, fixed at the middle of its range.

    Attributes:
        name: name in the table
        held: its fixed values by key of the scene's sweep
        cells: cells of the scene's grid then; 0: unchanged
    """

    name: str
    held: dict[str, str]
    cells: int = 0

    @property
    def overrides(self) -> dict[str, str]:
        """Overrides for `--set`."""
        return {f"sweep.{key}": f"[{value}]" for key, value in self.held.items()}


@dataclass(frozen=True)
class Subject:
    """A type of sensor.

    Attributes:
        scene: path from the project's root
        recipe: recipe of its network
        cells: cells of the scene's grid, each with `trials` draws
        factors: factors that --full fixes, one at a time
    """

    scene: str
    recipe: str
    cells: int
    factors: list[Factor] = field(default_factory=list)


SUBJECTS = {
    "papillarray": Subject(
        "scenes/learn/papillarray.yaml",
        "slip_gru",
        24,
        [
            Factor("friction", {"friction.scale": "0.39", "friction.kinetic": "0.875"}),
            Factor("effects of friction", {"effects": "[]"}),
            Factor(
                "load and tilt",
                {
                    "motion.compression": "0.49 mm",
                    "motion.tilt.0": "0 deg",
                    "motion.tilt.1": "0 deg",
                },
            ),
            Factor(
                "start, stop, acceleration",
                {
                    "motion.start": "1.75 s",
                    "motion.stop": "0.95 s",
                    "motion.acceleration": "0.2 m/s2",
                    "motion.angular_acceleration": "1000 deg/s2",
                },
            ),
            Factor(
                "direction and pivot",
                {"motion.direction": "180 deg", "motion.pivot.0": "0 mm", "motion.pivot.1": "0 mm"},
            ),
            Factor(
                "motion: one speed, no turn",
                {"motion": "{speed: 8 mm/s}, {speed: 8 mm/s}, {speed: 0 mm/s}"},
                3,
            ),
            Factor(
                "device",
                {
                    "sensors.pad.profile": "hexapod",
                    "sensors.pad.stiffness_sd": "0",
                    "sensors.pad.edge_drop": "0.19 mm",
                    "sensors.pad.corner_drop": "0.4 mm",
                    "sensors.pad.bristles": "6",
                    "sensors.pad.bristle_spread": "0.55",
                    "sensors.pad.electronics": "typical",
                },
            ),
        ],
    ),
    "piezo_skin": Subject(
        "scenes/learn/piezo_skin.yaml",
        "piezo_slip",
        19,
        [
            Factor("friction", {"friction.scale": "0.47", "friction.kinetic": "0.875"}),
            Factor("load", {"motion.compression": "0.2 mm"}),
            Factor(
                "start and acceleration",
                {"motion.start": "2.05 s", "motion.acceleration": "0.32 m/s2"},
            ),
            Factor(
                "motion: one speed",
                {
                    "motion": "{speed: 8 mm/s, travel: 20 mm}, {speed: 2 mm/s, travel: 0.005 mm}, "
                    "{speed: 0.001 mm/s, travel: 1 mm}, {speed: 20 mm/s, clearance: 5 mm, travel: 20 mm, strokes: 10}"
                },
                4,
            ),
            Factor(
                "motors",
                {
                    "motion.vibration": "1.2",
                    "motion.idle_speed": "0 mm/s",
                    "motion.idle_start": "0 s",
                },
            ),
            Factor(
                "tip",
                {
                    "effects.0.inertia.frequency": "180 Hz",
                    "effects.0.inertia.damping": "0.1",
                    "effects.1.roughness.height": "1.6 um",
                    "effects.2.asperities.amplitude": "2 mN",
                    "effects.2.asperities.distance": "0.24 mm",
                    "sensors.pad.k_tangential": "5.5 N/mm",
                    "sensors.pad.tip_radius": "0.32 m",
                },
            ),
        ],
    ),
}


@dataclass(frozen=True)
class Task:
    """A network to train and to score.

    Attributes:
        subject: a key of SUBJECTS
        without: the fixed factor; None: everything varies
        trials: requested number of trials
    """

    subject: str
    without: Factor | None
    trials: int


def tasks_of(subjects: list[str], options: Options) -> list[Task]:
    """Returns the networks of a run.

    Args:
        subjects: keys of SUBJECTS
        options: trials, full

    Returns:
        for each subject one per number of trials, then with options.full one per factor
    """
    counts = (options.trials,) if options.trials else COUNTS + (MORE_COUNTS if options.full else ())
    tasks = []
    for subject in subjects:
        tasks += [Task(subject, None, count) for count in counts]
        if options.full:
            tasks += [
                Task(subject, factor, options.trials or USUAL_TRIALS)
                for factor in SUBJECTS[subject].factors
            ]
    return tasks


def given_row(board: Json, domain: str) -> Json:
    """The row of the given network in a board's public recordings of a domain.

    Args:
        board: output of `slipbench benchmark --json`
        domain: "inside" or "outside" the training domain of the shipped networks

    Returns:
        that row

    Raises:
        InputError: if there is no such row
    """
    for one in board["sets"]:
        for row in one["rows"] if one.get("domain") == domain else ():
            if row["kind"] == "given":
                return dict(row)
    raise InputError(
        f"reproduce: {NAME}: the board has no row of the network in its recordings {domain}"
    )


def figures_of(board: Json) -> Json:
    """Figures of the given network on a board.

    Args:
        board: output of `slipbench benchmark --json`

    Returns:
        inside and outside: [value, low, high] of the score in points; inside: delay_median_s, early
        as a share of the slips, and false_alarms_per_minute, of time without slip; None if
        undefined

    Raises:
        InputError: as given_row()
    """
    inside, outside = given_row(board, "inside"), given_row(board, "outside")

    def score(row: Json) -> list[float | None]:
        return [
            None if row["score"][key] is None else 100.0 * row["score"][key]
            for key in ("value", "low", "high")
        ]

    summary = inside["figures"]
    return {
        "inside": score(inside),
        "outside": score(outside),
        "delay_median_s": summary["figures"]["delay_median_s"]["value"],
        "early": summary["early"] / max(1, summary["slipping"]),
        "false_alarms_per_minute": inside["false_alarms_per_minute"],
    }


def train_and_score(task: Task, options: Options) -> Json:
    """Simulates the trials of a task, trains its network and scores it by the benchmark.

    Args:
        task: task to run
        options: seed, full

    Returns:
        as figures_of(), with "trials"

    Raises:
        InputError: a trial, the training or the benchmark fails
        KeyboardInterrupt: after Ctrl-C
    """
    options = replace(options, jobs=1)  # other tasks run at the same time
    subject, without = SUBJECTS[task.subject], task.without
    cells = without.cells if without is not None and without.cells else subject.cells
    recipe = replace(
        find_recipe(subject.recipe), members=1
    )  # measures the effect of data, not of several networks
    if not options.full:
        recipe = replace(
            recipe, training=replace(recipe.training, steps=recipe.training.steps // QUICK_PART)
        )
    with tempfile.TemporaryDirectory() as folder:
        dataset, file = str(Path(folder) / "learn.h5"), str(Path(folder) / "slip.onnx")
        make_dataset(
            dataset,
            Cell(
                task.subject,
                subject.scene,
                without.overrides if without is not None else {},
                max(1, task.trials // cells),
            ),
            options,
        )
        trained = train(
            dataset,
            output=file,
            recipe=recipe,
            every_trial=True,
            seed=options.draws_seed,
            by_score=True,
        )
        Path(dataset).unlink()
        board = json.loads(_core.benchmark(file, task.subject, 1))
    return {"trials": sum(trained.parts.values())} | figures_of(board)


def row_of(name: str, one: Json) -> list[str]:
    """A row of the tables."""
    number = {
        key: math.nan if one[key] is None else one[key]
        for key in ("delay_median_s", "early", "false_alarms_per_minute")
    }

    def score(domain: str) -> list[str]:
        value, low, high = (math.nan if part is None else part for part in one[domain])
        return [f"{value:.1f}", f"{low:.1f} to {high:.1f}"]

    return [
        name,
        *score("inside"),
        f"{1e3 * number['delay_median_s']:.0f} ms",
        f"{100.0 * number['early']:.0f} %",
        f"{number['false_alarms_per_minute']:.1f}",
        *score("outside"),
    ]


def add_subject(result: Result, subject: str, tasks: list[Task], found: list[Json]) -> None:
    """Adds the figures of a sensor: by the number of trials, and by the fixed factor.

    Args:
        result: target
        subject: a key of SUBJECTS
        tasks: tasks of all sensors
        found: results of train_and_score() for each
    """
    counts = Table(f"{subject}: by the number of trials", ["trials", *HEAD])
    factors = Table(
        f"{subject}: without a factor",
        ["held", *HEAD],
        note=f"Some {tasks[-1].trials} trials each; the named factor is fixed to one value of its range.",
    )
    chart = Chart(
        f"{subject} on slip-4",
        "trials learnt from",
        "score on slip-4, of 100",
        [],
        [Curve("inside", []), Curve("outside", [])],
        0.0,
        "never slip",
    )
    result.figures[subject] = []
    for task, one in zip(tasks, found, strict=True):
        if task.subject != subject:
            continue
        name = str(one["trials"]) if task.without is None else task.without.name
        (counts if task.without is None else factors).rows.append(row_of(name, one))
        result.figures[subject].append(
            {
                "trials": one["trials"],
                "without": None if task.without is None else name,
                "inside": one["inside"][0],
                "outside": one["outside"][0],
                **{key: one[key] for key in ("delay_median_s", "early", "false_alarms_per_minute")},
            }
        )
        if task.without is None:
            chart.places.append(name)
            for curve in chart.curves:
                value, low, high = (math.nan if part is None else part for part in one[curve.name])
                curve.points.append((value, low, high))
    if len(chart.places) > 1:
        result.charts.append(chart)
    result.tables += [counts, factors] if factors.rows else [counts]


def study(options: Options) -> Result:
    """learned/scaling.

    Args:
        options: trials, only, full, seed, jobs, output, resume

    Returns:
        the score of a network by its number of training trials, and with options.full by the fixed
        factor

    Raises:
        InputError: for an unknown name of --only, a trial that cannot run, or saved networks of
            another run
    """
    check_only(options.only, list(SUBJECTS))
    subjects = chosen(list(SUBJECTS), options.only)
    tasks = tasks_of(subjects, options)
    found = train_all(
        NAME,
        [task.subject for task in tasks],
        options,
        lambda k: train_and_score(tasks[k], options),
    )
    result = Result(
        title="Performance of a slip detector against the number of training trials",
        source="Not from a paper: networks trained on parts of scenes/learn, evaluated on the open recordings of slip-4.",
        figures={},
        setup=[
            f"Seed {options.draws_seed} of trials and of training; the operating point by --score.",
            "As many steps as the recipe has."
            if options.full
            else "A quarter of the recipe's steps. --full: all steps, more trials, and networks with one factor of the scene fixed.",
            "Intervals show the scatter of the judged recordings, not of repeated training.",
        ],
        remarks=["The training has no grasps, so the results do not apply to loops."],
    )
    for subject in subjects:
        add_subject(result, subject, tasks, found)
    return result
