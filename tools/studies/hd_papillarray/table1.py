"""Table I of the paper.

sHDC, stHDC, gstHDC and CL-gstHDC on a new dataset of the published protocol, and the causes of the
differences.
"""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from slipbench.bin import _core
from slipbench_studies.grid import Cell, make_dataset
from slipbench_studies.result import Options, RealFigure, Result, Table

SCENE = "scenes/papillarray/hexapod.yaml"  # the published protocol
MOTIONLESS_LEFT_OUT = {
    "": None,
    "until_stop": False,
    "moving": True,
}  # True: frames before the first motion are omitted too; None: no frame is

# Encoding and context of each model; the paper's accuracy, mean and SD of its draws, %.
MODELS = {
    "sHDC": ("spatial", False),
    "stHDC": ("spatial_temporal", False),
    "gstHDC": ("graph_spatial_temporal", False),
    "CL-gstHDC": ("graph_spatial_temporal", True),
}
PUBLISHED = {
    "sHDC": (85.00, 1.15),
    "stHDC": (86.42, 1.35),
    "gstHDC": (89.86, 0.94),
    "CL-gstHDC": (91.78, 0.53),
}

WIDE_FRICTION = {"sweep.friction.scale": "{draw: lognormal, median: 1, sd: 0.3}"}
WIDE_TILT = {
    f"sweep.motion.tilt.{axis}": "{draw: normal, mean: 0 deg, sd: 2 deg, min: -4 deg, max: 4 deg}"
    for axis in (0, 1)
}
# Four draws of each motion with drawn compressions: 200 sequences again.
WIDE_PRELOAD = {
    "sweep.motion.compression": "{draw: uniform, min: 0.5 mm, max: 1.5 mm}",
    "sweep.trials": "4",
}

Draws = dict[str, Any]  # six tests of a model, as in `slipbench train-hd --json`
OfModels = dict[str, Draws]


@dataclass(frozen=True)
class Variant:
    """Settings for creating the data, the labels and the encoding.

    Attributes:
        overrides: of SCENE
        labels: rule of the labels
        keep: a key of MOTIONLESS_LEFT_OUT
        window: frames
        dimension: bits of a hypervector
        compat: implementation whose bundling is used
        ties: result of ties in a bundle
        quantiser: conversion of displacements to levels
        epochs: passes over misclassified samples; 0: the paper's single pass
        other_memories: offset of the seed of the item memories
    """

    overrides: dict[str, str] = field(default_factory=dict)
    labels: str = "paper"
    keep: str = ""
    window: int = 15
    dimension: int = 1000
    compat: str = "paper"
    ties: str = "one"
    quantiser: str = "fixed_point"
    epochs: int = 0
    other_memories: int = 0


# Differences between sequences; each variant needs its own dataset.
SCATTER = {
    "none": Variant({"friction.scale": "1"}),
    "friction 7 % (hexapod.yaml)": Variant(),
    "friction 30 %": Variant(WIDE_FRICTION),
    "friction 7 %, tilt 2 deg": Variant(WIDE_TILT),
    "friction 7 %, preload 0.5 to 1.5 mm": Variant(WIDE_PRELOAD),
    "friction 30 %, tilt 2 deg, preload 0.5 to 1.5 mm": Variant(
        WIDE_FRICTION | WIDE_TILT | WIDE_PRELOAD
    ),
}

AS_PUBLISHED, NO_REST, HAS_SLIPPED = (
    "as published",
    "without the rest after a stop",
    "labels has_slipped",
)
ONE_FRAME, FIVE_FRAMES, CORE = (
    "window 1 frame",
    "window 5 frames",
    "counts kept in the window (published core)",
)
NO_MATTER = (
    "feature exact, from 1/8 mm",
    "ties to zero",
    "D = 4000",
    "other item memories",
)  # expected to have no effect

# Variants that change one setting each.
CAUSES = {
    AS_PUBLISHED: Variant(),
    "labels strict": Variant(labels="strict"),
    "labels micro": Variant(labels="micro"),
    HAS_SLIPPED: Variant(labels="has_slipped"),
    NO_REST: Variant(keep="until_stop"),
    "moving frames alone": Variant(keep="moving"),
    NO_MATTER[0]: Variant(quantiser="exact"),
    "feature unrounded": Variant(quantiser="unrounded"),
    "retrained, 5 epochs": Variant(epochs=5),
    "retrained, 5 epochs, without the rest after a stop": Variant(epochs=5, keep="until_stop"),
    ONE_FRAME: Variant(window=1),
    FIVE_FRAMES: Variant(window=5),
    "window 30 frames": Variant(window=30),
    CORE: Variant(compat="published_core"),
    NO_MATTER[1]: Variant(ties="zero"),
    NO_MATTER[2]: Variant(dimension=4000),
    NO_MATTER[3]: Variant(other_memories=1000),
    "electronics ideal": Variant({"sensors.pad.electronics": "ideal"}),
    "stiff pillars (profile gripper)": Variant({"sensors.pad.profile": "gripper"}),
    "pillars slip as a whole (1 bristle)": Variant({"sensors.pad.bristles": "1"}),
}


class Ablation:
    """Runs variants one after the other. Consecutive variants with the same data share a dataset.

    Args:
        options: data, seed, jobs, progress output
        folder: folder for datasets
    """

    def __init__(self, options: Options, folder: str) -> None:
        self._options, self._path, self._made_of = (
            options,
            options.data or str(Path(folder) / "hexapod.h5"),
            Variant(),
        )
        self._sequences: Any = None

    @property
    def sequences(self) -> Any:
        """The sequences of the last variant."""
        return self._sequences

    def run(self, name: str, variant: Variant, by_frame: bool = False) -> list[OfModels]:
        """Runs the four models with a variant.

        Args:
            name: name of the variant
            variant: what to do
            by_frame: True: split by frame too

        Returns:
            the draws of each model, split by sequence and, with `by_frame`, by frame

        Raises:
            InputError: if a trial fails, or if the data are unsuitable for training
            KeyboardInterrupt: after Ctrl-C
        """
        self._options.say(name)
        self._read(variant)
        seed, found = self._options.draws_seed, list[OfModels]()
        for model, (encoding, context_driven) in MODELS.items():
            draws = self._sequences.cross_validate(
                encoding=encoding,
                context_driven=context_driven,
                window=variant.window,
                dimension=variant.dimension,
                compat=variant.compat,
                ties=variant.ties,
                quantiser=variant.quantiser,
                epochs=variant.epochs,
                memories_seed=seed + variant.other_memories,
                seed=seed,
                by_frame=by_frame,
                jobs=self._options.jobs,
            )
            for k, text in enumerate(draws):
                found += [{}] * (k == len(found))
                found[k] = found[k] | {model: json.loads(text)}
        return found

    def _read(self, variant: Variant) -> None:
        """Creates and reads the dataset of a variant, unless it is loaded."""
        made_of = Variant(variant.overrides, variant.labels, variant.keep)
        if self._sequences is not None and made_of == self._made_of:
            return
        if not self._options.data and (
            self._sequences is None or variant.overrides != self._made_of.overrides
        ):
            Path(self._path).unlink(missing_ok=True)
            make_dataset(self._path, Cell("hexapod.yaml", SCENE, variant.overrides), self._options)
        self._made_of = made_of
        self._sequences = _core.HdSequences(self._path, variant.labels)
        before = MOTIONLESS_LEFT_OUT[variant.keep]
        if before is not None:
            self._sequences.leave_out_motionless(before)


def percent(share: float | None, digits: int = 2) -> str:
    """A share for the tables; "-" without a value."""
    return "-" if share is None or math.isnan(share) else f"{100.0 * share:.{digits}f}"


def mean_text(figure: dict[str, float | None]) -> str:
    """Mean and SD of draws for the tables."""
    mean, sd = (
        math.nan if figure[key] is None else 100.0 * float(figure[key] or 0.0)
        for key in ("mean", "sd")
    )
    return f"{mean:.2f} +- {sd:.2f}"


def milliseconds(seconds: float | None) -> str:
    """A time for the tables; "-" without a value."""
    return "-" if seconds is None else f"{1e3 * seconds:.0f}"


def main_table(by_sequence: OfModels, by_frame: OfModels) -> Table:
    """Accuracy of the models with the paper's.

    Args:
        by_sequence: draws by sequence
        by_frame: draws by frame
    """
    table = Table(
        "Recall of slip, balanced accuracy and the paper's accuracy, in %: mean +- SD of five draws",
        [
            "model",
            "recall of slip",
            "balanced accuracy",
            "moving: balanced",
            "accuracy: paper",
            "accuracy: ours",
            "by frame: balanced",
            "by frame: accuracy",
        ],
        note="By sequence unless marked by frame. By sequence: no sequence is in both training and test. By frame: frames of one sequence are in both, "
        "which improves the figures of every detector. Recall of slip: share of the slipping frames that are classified as incipient or gross; by the "
        "paper's rule the pad moves in all of them. Balanced: mean of the recalls. Moving: frames in which the pad slides or turns; in the others the "
        "pad is at rest and cannot slip.",
    )
    for model, (mean, sd) in PUBLISHED.items():
        ours, frames = by_sequence[model], by_frame[model]
        table.rows.append(
            [
                model,
                *(
                    mean_text(ours[key])
                    for key in ("recall_of_slip", "balanced_accuracy", "moving_balanced_accuracy")
                ),
                f"{mean:.2f} +- {sd:.2f}",
                mean_text(ours["accuracy"]),
                mean_text(frames["balanced_accuracy"]),
                mean_text(frames["accuracy"]),
            ]
        )
    sequences, frames = by_sequence["sHDC"]["pooled"], by_frame["sHDC"]["pooled"]
    table.rows.append(
        [
            "best constant answer",
            "-",
            percent(sequences["all"]["constant_balanced_accuracy"]),
            percent(sequences["moving"]["constant_balanced_accuracy"]),
            "-",
            percent(sequences["all"]["constant_accuracy"]),
            percent(frames["all"]["constant_balanced_accuracy"]),
            percent(frames["all"]["constant_accuracy"]),
        ]
    )
    return table


def delay_table(draws: OfModels) -> Table:
    """Recalls and delays.

    Args:
        draws: by sequence
    """
    table = Table(
        "By sequence: recall in %, and delay from the true onset to the first frame classified as slip, in ms",
        [
            "model",
            "non-slip",
            "incipient",
            "gross",
            "delay, quartiles",
            "median",
            "seen",
            "early",
            "missed",
            "false alarms",
        ],
        note="Tests of the five draws together. Onset: a first part of a pillar slips, resolved within the step. Seen: no frame before the onset is "
        "classified as slip, and one after it is; the delays are of these sequences. Early: a frame before the onset is classified as slip. False "
        "alarms: of the sequences that never slip.",
    )
    for model, one in draws.items():
        recall, delay = one["pooled"]["all"]["recall"], one["pooled"]["delay"]
        seconds = delay["delay_s"]
        table.rows.append(
            [
                model,
                *(percent(recall[key]) for key in ("non_slip", "incipient", "gross")),
                f"{milliseconds(seconds['lower_quartile'])} to {milliseconds(seconds['upper_quartile'])}",
                milliseconds(seconds["median"]),
                f"{delay['noticed']} of {delay['slipping']}",
                str(delay["early"]),
                str(delay["missed"]),
                f"{delay['false_alarms']} of {delay['sequences'] - delay['slipping']}",
            ]
        )
    return table


def confusion_table(draws: Draws) -> Table:
    """Classes by the label that the detector reports.

    Args:
        draws: of CL-gstHDC by sequence
    """
    table = Table(
        "Confusion of CL-gstHDC by sequence: share of the true class in %",
        ["true", "called non-slip", "called incipient", "called gross", "frames"],
    )
    for name, key in (("non-slip", "non_slip"), ("incipient", "incipient"), ("gross", "gross")):
        called = draws["pooled"]["all"]["called"][key]
        frames = sum(called.values())
        shares = (
            called[one] / frames if frames else math.nan
            for one in ("non_slip", "incipient", "gross")
        )
        table.rows.append([name, *(percent(share) for share in shares), str(frames)])
    return table


def variants_table(title: str, variants: dict[str, OfModels]) -> Table:
    """Balanced accuracy and accuracy of each model under each variant.

    Args:
        title: title of the table
        variants: draws by sequence
    """
    measures = {"balanced": "balanced_accuracy", "accuracy": "accuracy"}
    return Table(
        title,
        ["", *(f"{model}: {text}" for text in measures for model in MODELS)],
        [
            [name, *(mean_text(draws[model][key]) for key in measures.values() for model in MODELS)]
            for name, draws in variants.items()
        ],
        "Balanced accuracy, and the paper's measure, accuracy, in %.",
    )


def remarks_on(causes: dict[str, OfModels], by_frame: OfModels) -> list[str]:
    """Remarks with the numbers of the current run.

    Args:
        causes: draws of each cause, by sequence
        by_frame: draws of the published settings, by frame
    """

    def mean(name: str, model: str) -> float:
        value = causes[name][model]["accuracy"]["mean"]
        return math.nan if value is None else float(value)

    def texts(model: str, names: Iterable[str]) -> list[str]:
        return [percent(mean(name, model)) for name in names]

    spatial, best = "sHDC", "CL-gstHDC"
    leads = sum(
        all(mean(name, model) <= mean(name, spatial) for model in MODELS) for name in causes
    )
    change = max(
        abs(mean(name, model) - mean(AS_PUBLISHED, model)) for name in NO_MATTER for model in MODELS
    )
    by_frame_text = {
        model: percent(by_frame[model]["accuracy"]["mean"]) for model in (spatial, best)
    }
    published, no_rest, has_slipped = zip(
        texts(spatial, (AS_PUBLISHED, NO_REST, HAS_SLIPPED)),
        texts(best, (AS_PUBLISHED, NO_REST, HAS_SLIPPED)),
        strict=True,
    )
    one, five, fifteen, core = texts(best, (ONE_FRAME, FIVE_FRAMES, AS_PUBLISHED, CORE))
    strict, micro = texts(best, ("labels strict", "labels micro"))
    return [
        f"Order: in the paper sHDC < stHDC < gstHDC < CL-gstHDC. Here sHDC is best, or equal to the best, in {leads} of {len(causes)} rows of that table. By frame, where "
        f"the training set contains neighbours of the test frames, it has {by_frame_text[spatial]} %, and CL-gstHDC has {by_frame_text[best]} %.",
        "Physics and labels: a pad that stops after a slip keeps its displacements, so rest looks like a steady slip, while its label is non-slip. Without "
        f"these frames sHDC changes from {published[0]} to {no_rest[0]} % and CL-gstHDC from {published[1]} to {no_rest[1]} %. If a pillar that has slipped keeps its label, as in the paper's "
        f"wording of its classes, they reach {has_slipped[0]} and {has_slipped[1]} %. The paper does not state whether its sequences contain such frames.",
        "Encoder: the temporal product multiplies similarities. If each frame has the similarity s to the training frames, s^15 remains (0.9: 0.21), so a "
        f"window is recognised only if each of its frames is nearly the same. CL-gstHDC has {one} % with one frame, {five} % with 5, {fifteen} % with 15; and {core} % "
        "with the bundling of the published core, whose counts continue from frame to frame.",
        f"Labels: CL-gstHDC has {fifteen} % by the paper's rule, {strict} % if a pillar counts once it slips as a whole, {micro} % if it counts once a part of it slips. "
        "The paper does not give the threshold of its rule; 0.1 mm/s is assumed.",
        f"No cause: fixed point instead of the exact ratio, the rule for ties, D and the item memories change no model by more than {100.0 * change:.2f} points.",
    ]


def setup_lines(options: Options, ablation: Ablation, draw: dict[str, Any]) -> list[str]:
    """Setup of the measurement.

    Args:
        options: data, seed
        ablation: after its first variant
        draw: draw number 1 of a model by sequence
    """
    seed = options.draws_seed
    return [
        f"Data: {options.data}, made by: {ablation.sequences.command}"
        if options.data
        else f"Data: a new dataset of {SCENE}, seed {seed}.",
        f"{len(ablation.sequences)} sequences, PapillArray at 100 Hz (every tenth sample), labels by the paper's rule, D = 1000, N = 15, ties to one, fixed point. Frames in "
        "contact after a whole window of frames are used for training and test, the same frames for every model.",
        f"Six draws, seed {seed}: the training set has as many sequences of each compression and speed as there are, drawn with replacement; sequences that are"
        f" never drawn are the test set. Draw 0 is reserved for choices (none was made), the other five give mean and SD. In draw 1 the training set has {draw['training']}"
        f" sequences, {draw['distinct']} of them distinct, and the test set has {draw['tested']}.",
    ]


def study(options: Options) -> Result:
    """hd-papillarray/table1.

    Args:
        options: data, seed, jobs

    Returns:
        accuracy and delay of the four models, and their causes; for given data, without the parts
        that need new data

    Raises:
        InputError: if a trial fails, or if the data are unsuitable for training
        KeyboardInterrupt: after Ctrl-C
    """
    with tempfile.TemporaryDirectory() as folder:
        ablation = Ablation(options, folder)
        by_sequence, by_frame = ablation.run("ablation", Variant(), by_frame=True)
        setup = setup_lines(options, ablation, by_sequence["sHDC"]["draws"][1])

        def run_all(variants: dict[str, Variant]) -> dict[str, OfModels]:
            return {name: ablation.run(name, variant)[0] for name, variant in variants.items()}

        causes = run_all(
            {
                name: variant
                for name, variant in CAUSES.items()
                if not (options.data and variant.overrides)
            }
        )
        scatter = {} if options.data else run_all(SCATTER)
    tables = [
        main_table(by_sequence, by_frame),
        delay_table(by_sequence),
        confusion_table(by_sequence["CL-gstHDC"]),
        variants_table("Causes: one setting changed at a time, by sequence", causes),
    ]
    if scatter:
        tables.append(
            variants_table(
                "Scatter between sequences: trained and tested on data with scatter, by sequence",
                scatter,
            )
        )
    return Result(
        title="Ablation of the hyperdimensional slip detector",
        source='Table I and section IV of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor"',
        figures={"by_sequence": by_sequence, "by_frame": by_frame, "causes": causes}
        | ({"scatter": scatter} if scatter else {}),
        setup=setup,
        tables=tables,
        remarks=remarks_on(causes, by_frame),
        real=[
            RealFigure(
                f"{model} trained on recordings, correctly classified frames, %",
                mean,
                100.0 * float(by_sequence[model]["accuracy"]["mean"]),
                "ours was trained on hexapod.yaml, which is fitted",
            )
            for model, (mean, _) in PUBLISHED.items()
        ],
    )
