"""Trains a recipe on datasets, and writes the file of a detector that a scene can name."""

# PyTorch's layers and operators are typed only in part, depending on the release.
# mypy: disable-error-code="no-untyped-call,no-any-return,attr-defined,unused-ignore"

from __future__ import annotations

import json
import math
import numbers
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from slipbench._program import counted
from slipbench._values import index
from slipbench.bin import _core
from slipbench.learning._export import check_output, mean_answers, write_detector
from slipbench.learning._fit import (
    MASKED,
    Checkpoint,
    Floats,
    Labels,
    Report,
    balanced_accuracy,
    fit,
    history_of,
    logits_of,
    reproducible,
)
from slipbench.learning._input import Example, Examples, describe_file, fit_units, read_examples
from slipbench.learning._names import named
from slipbench.learning.recipes import Recipe, find_recipe

SLIPPING = ("incipient", "gross")
_CLIP_TOLERANCE = 1e-5  # relative to the greatest logit: rounding depends on the length of a clip


@dataclass(frozen=True)
class Trained:
    """A trained detector.

    Attributes:
        path: path of its ONNX file
        networks: the members, in evaluation mode
        description: the file's description: input, classes, threshold, alarm, and under "trained"
            its training data and figures
        validation: balanced accuracy over all classes on the validation trials, 0 to 1
        judged: figures of the test trials; None: no test trials
        parts: numbers of trials in "learns", "validates" and "judges"
        sensors: names in the scene of the sensors used for training
        own_split: True if a dataset's own split defines the test trials
        judged_from: the first dataset with test trials, and their part in its own split; empty:
            none
    """

    path: str
    networks: list[nn.Module] = field(repr=False)
    description: dict[str, Any] = field(repr=False)
    validation: float
    judged: dict[str, Any] | None
    parts: dict[str, int]
    sensors: list[str]
    own_split: bool
    judged_from: tuple[str, str]


def scale_of(features: Sequence[Floats], scaling: str) -> tuple[Floats, Floats]:
    """Offset and scale of frames: a feature x becomes (x - offset) scale.

    Args:
        features: [T, inputs] of each sequence
        scaling: "standard", "common", "range" or "none" (`Recipe`)

    Returns:
        Two arrays, [1] or [inputs]. Constant features are only shifted.

    Raises:
        InputError: an unknown scaling
    """
    if scaling == "none":
        return np.zeros(1, np.float32), np.ones(1, np.float32)
    whole = np.concatenate(features).astype(np.float64)
    if scaling == "common":
        whole = whole.reshape(-1, 1)
    elif scaling not in ("standard", "range"):
        raise _core.InputError(f"scaling: {scaling!r}; allowed: standard, common, range, none")
    least, greatest = whole.min(0), whole.max(0)
    offset, spread = (
        (least, greatest - least) if scaling == "range" else (whole.mean(0), whole.std(0))
    )
    return offset.astype(np.float32), np.where(
        greatest > least, 1 / np.where(greatest > least, spread, 1.0), 1.0
    ).astype(np.float32)


def alarms_per_minute(alarms: str | float) -> float:
    """False alarms per minute, from a number or a text such as "1/min" or "10/h".

    Raises:
        InputError: an invalid text, or a negative number
    """
    number, _, unit = (
        alarms.partition("/") if isinstance(alarms, str) else (str(float(alarms)), "", "min")
    )
    try:
        rate = float(number) / {"min": 1.0, "h": 60.0}[unit]
    except (ValueError, KeyError):
        rate = -1.0
    if not 0 <= rate < math.inf:
        raise _core.InputError(
            f"alarms: {alarms!r}; expected a rate of 0 or more with its unit, such as 1/min or 10/h"
        )
    return rate


def train(
    dataset: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    output: str | os.PathLike[str],
    recipe: str | Recipe = "slip_gru",
    network: nn.Module | Callable[[int, int], nn.Module] | None = None,
    sensor: str = "",
    labels: str | None = None,
    split: str | None = None,
    held_out: float | None = None,
    every_trial: bool = False,
    seed: int = 1,
    steps: int | None = None,
    turned: int | None = None,
    rates: tuple[float, float] | None = None,
    alarms: str | float | None = None,
    by_score: bool = False,
    specificity: float | None = None,
    resume: bool = False,
    log: str | os.PathLike[str] | None = None,
    progress: Callable[[int, Report], object] | None = None,
    reading: Callable[[int, int], object] | None = None,
    before_step: Callable[[], None] | None = None,
) -> Trained:
    """Trains a slip detector on datasets and writes its ONNX file for scenes, `eval` and `replay`.

    A dataset's own split defines training, validation and test. The state with the greatest
    balanced accuracy on the validation trials is kept. The operating point is chosen on them too:
    threshold, numbers of consecutive frames that begin and end an alarm, and the minimum length of
    an alarm.

    Args:
        dataset: path of a dataset, or several
        output: path of the file, which ends in .onnx
        recipe: name of a recipe (`RECIPES`), or a custom recipe
        network: a custom module that replaces the recipe's, or a function that creates it from the
            numbers of values per frame and of classes. It maps frames [N, T, inputs] to logits [N,
            T - history + 1, classes], where `history` is its attribute, 1 by default. A network
            with a state takes it as a second argument, None at first, and returns (logits, state),
            a tensor or a tuple of tensors. It must be causal: an answer depends only on its own and
            earlier frames.
        sensor: name of the sensor in the scene; empty: every sensor that fits
        labels: rule of the labels; None: the recipe's
        split: "trial", "material", "object" or "speed", for data without their own split; None: the
            recipe's
        held_out: share of these groups for the test, 0 to 0.5; None: 0.2
        every_trial: True: divide all trials, ignoring a dataset's own split
        seed: seed of weights and draws, 0 to 2^64 - 1
        steps: number of training steps, 1 or more; None: the recipe's
        turned: copies of each trial of an image sensor with turned images, 0 or more; None: the recipe's
        rates: Hz, range of the rates of the sensors for which the network is trained: the rate of each
            trial is drawn from it, up to that of the dataset; the file then reads recordings from
            the lower rate on; None: the recipe's rate alone
        alarms: tolerated false alarms on the validation trials, as "1/min"; None: 1/min; math.inf:
            no limit; each frame is then classified on its own, with the threshold of the greatest
            balanced accuracy
        by_score: True: choose the operating point with the greatest score of the benchmark's open
            recordings on the first dataset, instead of by `alarms`; needs the slipped distance of
            simulated trials
        specificity: with `by_score`: least share, 0 to 1, of the validation trials without slip in
            which no alarm is raised, in each dataset with 20 such trials or more; None: 0.95
        resume: True: continue from the OUTPUT.checkpoint-0 of an interrupted training
        log: folder for TensorBoard logs, which need the package tensorboard; None: no logs
        progress: called with the number of the network and a Report, after every validation
        reading: called with the numbers of trials read and of all
        before_step: called before every step; may raise, which ends the training

    Raises:
        InputError: an argument out of range, data that do not fit the recipe, a class without a
            frame, a network whose answers a loop cannot reproduce frame by frame, a loss that is
            not finite, or an output that exists and is not a detector
    """
    request = _Request(
        paths=_paths_of(dataset),
        seed=_whole_number(seed, "seed", 0, 2**64 - 1),
        steps=None if steps is None else _whole_number(steps, "steps", 1),
        turned=None if turned is None else _whole_number(turned, "turned", 0),
        held_out=_share_of(held_out),
        path=_output_of(output),
        sensor=sensor,
        every_trial=every_trial,
        split=split,
    )
    chosen = _recipe(recipe, network, labels, split, request.steps, request.turned)
    rule = _point_rule(chosen, alarms, by_score, specificity)
    if resume and not os.path.exists(f"{request.path}.checkpoint-0"):
        raise _core.InputError(
            f"{request.path}.checkpoint-0: does not exist: the training has finished, or was stopped before its first validation; train without "
            f"{named('resume', True)}"
        )
    writer = _log_writer(log)
    if chosen.input.transform == "units":
        chosen = replace(chosen, input=fit_units(chosen.input, request.paths[0], sensor))
    if rates is not None:
        chosen = replace(chosen, input=replace(chosen.input, rates=_range_of(rates)))
    data = _read(request, chosen, rule, reading)
    members, steps_taken = _fit_members(
        request,
        chosen,
        data,
        resume=resume,
        writer=writer,
        progress=progress,
        before_step=before_step,
    )
    judgement = _choose_point(chosen, rule, data, members)
    record = _record_of(request, chosen, rule, data, members, steps_taken, judgement)
    description = _write(request, chosen, data, members, judgement, record)
    return _trained(request, data, members, judgement, description)


@dataclass(frozen=True)
class _Request:
    """Checked arguments of `train`, but for the recipe and the operating point.

    Attributes:
        held_out: share of the groups for the test; None: not given
        split: property that separates them; None: not given
    """

    paths: list[str]
    seed: int
    steps: int | None
    turned: int | None
    held_out: float | None
    path: str
    sensor: str
    every_trial: bool
    split: str | None

    @property
    def share(self) -> float:
        """Share of the groups for the test."""
        return 0.2 if self.held_out is None else self.held_out


@dataclass(frozen=True)
class _PointRule:
    """How the operating point is chosen.

    Attributes:
        by_score: by the score of open recordings
        alarms: tolerated false alarms per minute; None: by the score, or frame by frame
        specificity: least share of trials without slip and without an alarm, with `by_score`
    """

    by_score: bool
    alarms: float | None
    specificity: float

    @property
    def measure(self) -> str:
        """What the point is best by, as in `_core.best_point`."""
        if self.by_score:
            return "score"
        return "accuracy" if self.alarms is None else "alarms"


@dataclass(frozen=True)
class _Data:
    """The trials in their parts, and the scaled frames [T, inputs] with labels [T] of each."""

    examples: Examples
    learns: list[Example]
    validates: list[Example]
    judges: list[Example]
    offset: Floats
    scale: Floats
    scaled: list[list[tuple[Floats, Labels]]]
    own_split: bool


@dataclass(frozen=True)
class _Judgement:
    """The operating point, and what it does on the validation and the test trials.

    Attributes:
        accuracy: balanced accuracy over all classes, of validation and test
        at_point: counts of the validation trials, if the point was chosen by score
        counts: counts of the test trials; None: no test trials
    """

    point: dict[str, Any]
    accuracy: list[float]
    at_point: dict[str, Any] | None
    counts: dict[str, Any] | None

    @property
    def alarm(self) -> dict[str, int]:
        """Frames that begin and end an alarm, and its least length."""
        return {key: self.point[key] for key in ("on", "off", "least")}


def _paths_of(dataset: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> list[str]:
    """The paths of one dataset or of several. Raises InputError for none."""
    paths = [
        os.fspath(one)
        for one in ([dataset] if isinstance(dataset, (str, os.PathLike)) else dataset)
    ]
    if not paths:
        raise _core.InputError(
            "dataset: expected the path of a dataset, or a list of paths, found an empty list"
        )
    return paths


def _share_of(held_out: float | None) -> float | None:
    """A share for the test, or None. Raises InputError outside of 0 to 0.5."""
    if held_out is None:
        return None
    if not (isinstance(held_out, numbers.Real) and 0 <= held_out <= 0.5):
        raise _core.InputError(f"held_out: expected a number from 0 to 0.5, found {held_out!r}")
    return float(held_out)


def _output_of(output: str | os.PathLike[str]) -> str:
    """The path of the file. Raises InputError for another ending and for files of others."""
    path = os.fspath(output)
    if not path.endswith(".onnx"):
        raise _core.InputError(
            f"output: {path}: a network is an ONNX file, whose name must end with .onnx"
        )
    check_output(path)
    return path


def _point_rule(
    chosen: Recipe, alarms: str | float | None, by_score: bool, specificity: float | None
) -> _PointRule:
    """The rule that the arguments ask for.

    Raises InputError for arguments that exclude or need one another, and for those that the recipe
    does not allow.
    """
    if by_score and alarms is not None:
        raise _core.InputError(
            f"{named('by_score', True)} and {named('alarms', alarms)} cannot be combined"
        )
    if specificity is not None and not by_score:
        raise _core.InputError(
            f"{named('specificity', specificity)} needs {named('by_score', True)}"
        )
    if specificity is not None and not (
        isinstance(specificity, numbers.Real) and 0 <= specificity <= 1
    ):
        raise _core.InputError(f"specificity: expected a number from 0 to 1, found {specificity!r}")
    wanted = 0.95 if specificity is None else float(specificity)
    if by_score:
        if chosen.labels == "recorded":
            raise _core.InputError(
                f"{named('by_score', True)} needs simulated trials, which record the slipped distance; with {named('labels', 'recorded')} use "
                f"{named('alarms')}"
            )
        _check_whole_recordings(chosen, "by_score", True)
        return _PointRule(True, None, wanted)
    if alarms == math.inf or (alarms is None and chosen.at_most > 0):
        return _PointRule(False, None, wanted)
    if alarms is not None:
        _check_whole_recordings(chosen, "alarms", alarms)
    return _PointRule(False, alarms_per_minute("1/min" if alarms is None else alarms), wanted)


def _check_whole_recordings(chosen: Recipe, argument: str, given: Any) -> None:
    """Raises InputError if the recipe trains on single frames, which have no alarms."""
    if chosen.at_most > 0:
        raise _core.InputError(
            f"{named(argument, given)}: is evaluated on whole recordings, but {chosen.name} trains on frames drawn from them; "
            f"leave {named(argument)} out"
        )


def _read(
    request: _Request,
    chosen: Recipe,
    rule: _PointRule,
    reading: Callable[[int, int], object] | None,
) -> _Data:
    """Reads the trials of the datasets, divides them and scales their frames."""
    examples = read_examples(
        request.paths,
        chosen.input,
        labels=chosen.labels,
        classes=chosen.classes,
        sensor=request.sensor,
        turned=chosen.turned,
        at_most=chosen.at_most,
        seed=request.seed,
        split=chosen.split,
        held_out=request.share,
        divide_anew=request.every_trial,
        progress=reading,
    )
    own_split = any(one.own_part for one in examples.all) and not request.every_trial
    if own_split:
        _check_undivided(request, examples)
    learns, validates, judges = (examples.part(part) for part in ("learns", "validates", "judges"))
    if not learns:
        raise _core.InputError(
            f"{', '.join(request.paths)}: the part train of the dataset's own split has no trial; {named('every_trial', True)} divides all trials anew"
        )
    if rule.by_score:
        _check_scored(validates, chosen.input.period)
    offset, scale = scale_of([one.features for one in learns], chosen.scaling)
    scaled = [
        [((one.features - offset) * scale, one.labels) for one in part]
        for part in (learns, validates, judges)
    ]
    return _Data(examples, learns, validates, judges, offset, scale, scaled, own_split)


def _check_undivided(request: _Request, examples: Examples) -> None:
    """Raises InputError if another split is asked for than that of the dataset."""
    if (request.split, request.held_out) == (None, None):
        return
    divided = request.paths[next(one.dataset for one in examples.all if one.own_part)]
    asked = (
        named("split", request.split)
        if request.split is not None
        else named("held_out", request.held_out)
    )
    raise _core.InputError(
        f"{divided}: the split of the dataset determines the trials for training and test; with {asked} also give "
        f"{named('every_trial', True)}, "
        "which divides all trials anew"
    )


def _check_scored(validates: list[Example], period: float) -> None:
    """Raises InputError unless a validation trial has a slip that counts in the score."""
    no_alarm = [_scored_series(np.zeros(len(one.labels)), one, 0) for one in validates]
    if _core.counts_at(no_alarm, period, 1.0, 1, 1, 1)["slips"] == 0:
        raise _core.InputError(
            f"{named('by_score', True)}: no validation trial of the first dataset slips by 0.05 mm or more with a known slipped distance; use "
            f"{named('alarms')}"
        )


def _new_module(chosen: Recipe, examples: Examples, seed: int) -> nn.Module:
    """A network of the recipe, whose first weights follow from the seed."""
    with reproducible(seed):
        module = chosen.network(examples.inputs, len(examples.classes))
    if not isinstance(module, nn.Module):
        raise _core.InputError(
            f"network: expected a function that returns a torch.nn.Module, but it returned {type(module).__name__}"
        )
    return module


def _check_first(request: _Request, data: _Data, module: nn.Module) -> None:
    """Raises InputError if the frames lack a class, or if the network does not fit them."""
    examples = data.examples
    for part, name in ((data.learns, "to learn from"), (data.validates, "that choose the state")):
        _check_classes(request.paths, name, part, examples.classes, history_of(module))
    _check_module(module, examples.inputs, len(examples.classes))


def _fit_members(
    request: _Request,
    chosen: Recipe,
    data: _Data,
    *,
    resume: bool,
    writer: Any,
    progress: Callable[[int, Report], object] | None,
    before_step: Callable[[], None] | None,
) -> tuple[list[nn.Module], list[int]]:
    """Fits the recipe's networks, and returns them with the steps of their best states."""
    examples = data.examples
    members, fitted_steps = [], []
    for member in range(chosen.members):
        own_seed = (request.seed + member) % 2**64
        module = _new_module(chosen, examples, own_seed)
        if member == 0:
            _check_first(request, data, module)
        checkpoint = Checkpoint(
            f"{request.path}.checkpoint-{member}",
            _identity(
                chosen,
                module,
                examples,
                request.sensor,
                request.every_trial,
                request.share,
                request.seed,
                member,
            ),
            resume,
        )

        def report(now: Report, member: int = member) -> None:
            if writer is not None:
                writer.add_scalar(f"loss/{member}", now.loss, now.step)
                writer.add_scalar(f"validation/{member}", now.validation, now.step)
            if progress is not None:
                progress(member, now)

        done = fit(
            module,
            data.scaled[0],
            data.scaled[1],
            chosen.training,
            classes=len(examples.classes),
            seed=own_seed,
            checkpoint=checkpoint,
            before_step=before_step,
            report=report,
        )
        members.append(module)
        fitted_steps.append(done.best_step)
    if writer is not None:
        writer.close()
    return members, fitted_steps


def _choose_point(
    chosen: Recipe, rule: _PointRule, data: _Data, members: list[nn.Module]
) -> _Judgement:
    """Chooses the operating point on the validation trials, and counts on the test trials."""
    before = history_of(members[0]) - 1
    period = chosen.input.period
    probabilities = [
        [_probabilities(members, features) for features, _ in part] for part in data.scaled[1:]
    ]
    truth = [[labels[before:] for _, labels in part] for part in data.scaled[1:]]
    accuracy = [
        balanced_accuracy([one.argmax(1).astype(np.uint8) for one in part], of)
        for part, of in zip(probabilities, truth, strict=True)
    ]
    slip = np.array([state in SLIPPING for _, state in data.examples.classes])
    series = [
        [_series(one, labels, slip) for one, labels in zip(part, of, strict=True)]
        for part, of in zip(probabilities, truth, strict=True)
    ]
    validation = series[0]
    if rule.by_score:
        validation = [
            _scored_series(probability, one, before)
            for (probability, *_), one in zip(series[0], data.validates, strict=True)
        ]
    limit = rule.specificity if rule.by_score else rule.alarms or 0.0
    judgement = _Judgement(
        _core.best_point(validation, period, rule.measure, limit), accuracy, None, None
    )
    threshold = judgement.point["threshold"]
    return replace(
        judgement,
        at_point=_core.counts_at(validation, period, threshold, **judgement.alarm)
        if rule.by_score
        else None,
        counts=_core.counts_at(series[1], period, threshold, **judgement.alarm)
        if data.judges
        else None,
    )


def _judged(counts: dict[str, Any], accuracy: float) -> dict[str, Any]:
    """The figures of the test trials; `accuracy`: balanced accuracy of all classes."""
    cells = ("slip_called_slip", "slip_called_hold", "hold_called_slip", "hold_called_hold")
    return {
        "balanced_accuracy": _or_none(counts["balanced_accuracy"]),
        "f1": _or_none(counts["f1"]),
        **{key: counts[key] for key in cells},
        "alarms_per_minute": _or_none(counts["alarms_per_minute"]),
        "all_classes_balanced_accuracy": _or_none(accuracy),
    }


def _record_of(
    request: _Request,
    chosen: Recipe,
    rule: _PointRule,
    data: _Data,
    members: list[nn.Module],
    steps_taken: list[int],
    judgement: _Judgement,
) -> dict[str, Any]:
    """What the file says about its training and its figures."""
    validation = {
        "balanced_accuracy": judgement.accuracy[0],
        "alarms_per_minute": _or_none(judgement.point["alarms_per_minute"]),
    }
    if judgement.at_point is not None:
        validation |= {
            "score": _or_none(judgement.at_point["score"]),
            "specificity": _or_none(judgement.at_point["specificity"]),
            "specificity_asked": rule.specificity,
        }
    record: dict[str, Any] = {
        "recipe": chosen.name,
        "labels": chosen.labels,
        "command": data.examples.command,
        "data_sha256": data.examples.sha256,
        "sensor": request.sensor,
        "split": chosen.split,
        "held_out": request.share,
        "seed": request.seed,
        "alarms_asked_per_minute": rule.alarms,
        "by_score": rule.by_score,
        "trials_learnt": _trials(data.learns),
        "trials_validated": _trials(data.validates),
        "trials_judged": _trials(data.judges),
        "sha256_seen": sorted({one.sha256 for one in data.learns + data.validates} - {""}),
        "frames": sum(len(one.labels) for one in data.learns),
        "parameters": sum(one.numel() for one in members[0].parameters()),
        "steps": steps_taken,
        "validation": validation,
        "libraries": f"torch {torch.__version__}",
    }
    if data.own_split:
        record["dataset_split"] = True
    if judgement.counts is not None:
        record["judged"] = _judged(judgement.counts, judgement.accuracy[1])
    return record


def _write(
    request: _Request,
    chosen: Recipe,
    data: _Data,
    members: list[nn.Module],
    judgement: _Judgement,
    record: dict[str, Any],
) -> dict[str, Any]:
    """Writes the detector's file, removes the checkpoints, and returns the file's description."""
    description = describe_file(
        replace(chosen.input, units=data.examples.units),
        data.examples.classes,
        threshold=judgement.point["threshold"],
        alarm=judgement.alarm,
        trained=record,
    )
    description["input"] |= {"offset": data.offset.tolist(), "scale": data.scale.tolist()}
    write_detector(request.path, members, data.examples.inputs, description, data.scaled[1][0][0])
    for member in range(chosen.members):
        Path(f"{request.path}.checkpoint-{member}").unlink(missing_ok=True)
    return description


def _trained(
    request: _Request,
    data: _Data,
    members: list[nn.Module],
    judgement: _Judgement,
    description: dict[str, Any],
) -> Trained:
    """The result of `train`."""
    judged_from = ("", "")
    if data.judges:
        first = data.judges[0]
        judged_from = (request.paths[first.dataset], first.own_part if data.own_split else "")
    return Trained(
        request.path,
        members,
        description,
        judgement.accuracy[0],
        description["trained"].get("judged"),
        {
            "learns": len(_trials(data.learns)),
            "validates": len(_trials(data.validates)),
            "judges": len(_trials(data.judges)),
        },
        list(dict.fromkeys(one.sensor for one in data.examples.all)),
        data.own_split,
        judged_from,
    )


def _whole_number(value: Any, key: str, least: int, most: int | None = None) -> int:
    """A whole number of Python or numpy.

    Raises InputError, naming `key`, for anything else and outside of `least` to `most`.
    """
    number = index(value, key)
    if number < least or (most is not None and number > most):
        raise _core.InputError(
            f"{key}: expected {f'{least} or more' if most is None else f'{least} to {most}'}, found {number}"
        )
    return number


def _range_of(rates: Any) -> tuple[float, float]:
    """A range of rates in Hz. Raises InputError for anything else."""
    try:
        low, high = (float(one) for one in rates)
    except (TypeError, ValueError):
        low = high = math.nan
    if not 0 < low <= high < math.inf:
        raise _core.InputError(
            f"{named('rates', rates)}: expected the lowest and the highest rate in Hz, above 0"
        )
    return low, high


def _recipe(
    recipe: str | Recipe,
    network: nn.Module | Callable[[int, int], nn.Module] | None,
    labels: str | None,
    split: str | None,
    steps: int | None,
    turned: int | None,
) -> Recipe:
    """The recipe with the requested changes."""
    chosen = find_recipe(recipe) if isinstance(recipe, str) else recipe
    if not isinstance(chosen, Recipe):
        raise _core.InputError(
            f"recipe: expected the name of a recipe or a slipbench.learning.Recipe, found {type(chosen).__name__} {chosen!r}"
        )
    if isinstance(network, nn.Module):
        module = network
        chosen = replace(chosen, network=lambda inputs, classes: module, members=1)
    elif network is not None:
        if not callable(network):
            raise _core.InputError(
                f"network: expected a torch.nn.Module or a function that makes one, found {type(network).__name__} {network!r}"
            )
        chosen = replace(chosen, network=network)
    if steps is not None:
        every = max(1, chosen.training.validate_every * steps // chosen.training.steps)
        chosen = replace(
            chosen, training=replace(chosen.training, steps=steps, validate_every=every)
        )
    channels = list(chosen.input.channels)  # empty: all, whose first the core checks
    if turned and channels and not _core.is_image(chosen.input.sensor, channels[0]):
        raise _core.InputError(
            f"{named('turned', turned)}: is for images, and {chosen.name} reads none of a {chosen.input.sensor}; allowed: 0"
        )
    return replace(
        chosen,
        labels=labels or chosen.labels,
        split=split or chosen.split,
        turned=chosen.turned if turned is None else turned,
    )


def _log_writer(log: str | os.PathLike[str] | None) -> Any:
    if log is None:
        return None
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError as error:
        raise _core.InputError(
            f"log: needs the Python package {error.name or 'tensorboard'}; install it: pip install tensorboard"
        ) from error
    return SummaryWriter(os.fspath(log))


def _check_classes(
    paths: Sequence[str],
    part: str,
    examples: Sequence[Example],
    classes: Sequence[tuple[str, str]],
    history: int,
) -> None:
    for one in examples:
        if len(one.labels) < history:
            raise _core.InputError(
                f"{', '.join(paths)}: trial {one.trial}: {counted(len(one.labels), 'frame')}, but an answer needs {history}"
            )
    labels = np.concatenate([one.labels[history - 1 :] for one in examples])
    counts = [int(np.sum(labels == one)) for one in range(len(classes))]
    if 0 in counts:
        text = ", ".join(
            f"{count} {name}" for count, (name, _) in zip(counts, classes, strict=True)
        )
        raise _core.InputError(
            f"{', '.join(paths)}: the trials {part} have a class without a frame: {text}; use more trials, or another {named('seed')} or {named('split')}"
        )


def _check_module(module: nn.Module, inputs: int, classes: int) -> None:
    """Raises InputError for a module that a loop could not run frame by frame.

    Its logits must be [N, T - history + 1, classes], and its answers the same frame by frame.
    """
    history, name = history_of(module), type(module).__name__
    frames = torch.randn(2, history + 2, inputs, generator=torch.Generator().manual_seed(1))
    changed = frames.clone()
    changed[:, -1] += 1.0
    module.eval()
    with torch.no_grad():
        logits = _checked_answer(_answer_of(module, name, frames), name)[0]
        if tuple(logits.shape) != (2, 3, classes):
            raise _core.InputError(
                f"network: {name} returns logits {list(logits.shape)} for frames {list(frames.shape)}; expected [2, 3, {classes}], an "
                f"answer for each frame from number `history` on, an attribute of the module, here {history}"
            )
        tolerance = _CLIP_TOLERANCE * float(logits.abs().max())
        if not torch.allclose(
            logits_of(module(changed))[:, :-1], logits[:, :-1], rtol=0.0, atol=tolerance
        ):
            raise _core.InputError(
                f"network: {name} is not causal: its earlier answers change with the last frame; an answer may depend on its own and "
                "earlier frames only, so use no bidirectional layers and pad convolutions in time at the beginning only"
            )
        stepped, state = [], None
        for first in range(3):
            clip = frames[:, first : first + history]
            answer, state = _checked_answer(
                _answer_of(module, name, clip, *(() if state is None else (state,))), name
            )
            stepped.append(answer)
        if not torch.allclose(torch.cat(stepped, 1), logits, rtol=0.0, atol=tolerance):
            raise _core.InputError(
                f"network: {name} answers differently when it is run frame by frame, as a loop runs it; return (logits, state) and take "
                "that state as the second argument, or set the attribute `history` to the number of frames that an answer depends on"
            )


def _answer_of(module: nn.Module, name: str, *arguments: Any) -> Any:
    """Runs the module.

    Raises InputError with PyTorch's message if its layers do not fit the frames.
    """
    try:
        return module(*arguments)
    except (RuntimeError, TypeError) as error:
        raise _core.InputError(
            f"network: {name} does not take frames {list(arguments[0].shape)}{' and its state' if len(arguments) > 1 else ''}: "
            f"{str(error).splitlines()[0]}"
        ) from error


def _checked_answer(answer: Any, name: str) -> tuple[Tensor, Any]:
    """Logits and state, None without one. Raises InputError for any other result of a module."""
    if isinstance(answer, Tensor):
        return answer, None
    if isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Tensor):
        parts = answer[1] if isinstance(answer[1], tuple) else (answer[1],)
        if all(isinstance(part, Tensor) for part in parts):
            return answer[0], answer[1]
    raise _core.InputError(
        f"network: {name} returns a {type(answer).__name__}; expected a tensor of logits, or (logits, state) with a state that is a tensor or "
        "a tuple of tensors"
    )


def _identity(
    recipe: Recipe,
    module: nn.Module,
    examples: Examples,
    sensor: str,
    every_trial: bool,
    held_out: float,
    seed: int,
    member: int,
) -> str:
    """Everything that the weights depend on; a checkpoint with another value is rejected."""
    training = {key: value for key, value in vars(recipe.training).items() if key != "augment"}
    return json.dumps(
        {
            "recipe": recipe.name,
            "network": str(module),
            "data": examples.sha256,
            "sensor": sensor,
            "labels": recipe.labels,
            "split": recipe.split,
            "all": every_trial,
            "held_out": held_out,
            "seed": seed,
            "member": member,
            "turned": recipe.turned,
            "rates": recipe.input.rates,
            "training": training,
            "torch": torch.__version__,
        }
    )


def _probabilities(members: Sequence[nn.Module], features: Floats) -> Floats:
    """Mean probability of each class, [T', classes]."""
    answers = mean_answers(members, features).astype(np.float64)
    if len(members) > 1:
        return answers  # type: ignore[return-value]
    answers = np.exp(answers - answers.max(1, keepdims=True))
    return answers / answers.sum(1, keepdims=True)


def _series(probabilities: Floats, labels: Labels, slip: Any) -> tuple[Any, Labels, Any, int, bool]:
    """Probability of slip, and truth 1, 0 or MASKED, of each frame, for `_core.counts_at`."""
    truth = np.where(labels == MASKED, MASKED, slip[np.minimum(labels, len(slip) - 1)]).astype(
        np.uint8
    )
    return (
        np.ascontiguousarray(probabilities[:, slip].sum(1), np.float64),
        truth,
        np.zeros(0),
        0,
        False,
    )


def _scored_series(
    probability: Any, example: Example, before: int
) -> tuple[Any, Labels, Any, int, bool]:
    """As `_series`, by the truth of the score. `before`: number of first frames without an answer."""
    scored = (
        example.scored if len(example.scored) else np.full(len(example.labels), MASKED, np.uint8)
    )
    return (
        probability,
        np.ascontiguousarray(scored[before:]),
        np.ascontiguousarray(example.path[before:]),
        example.dataset,
        example.holds,
    )


def _trials(examples: Sequence[Example]) -> list[int]:
    return list(dict.fromkeys(one.trial for one in examples))


def _or_none(value: float) -> float | None:
    return None if math.isnan(value) else value
