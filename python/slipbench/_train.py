"""`python -m slipbench._train FILE`: the command `train --recipe NAME`, started by the program.

Exit status 2 for bad input, with its message.
"""

from __future__ import annotations

import json
import math
import os
import shlex
import shutil
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from slipbench._program import (
    counted,
    interruptible,
    printable,
    read_request,
    run_command,
    say,
    styled,
    write_result,
)
from slipbench.bin import _core

if TYPE_CHECKING:
    from slipbench.learning import Report, Trained

BAR_PERIOD = 0.1  # s, between redraws


@dataclass(frozen=True)
class Request:
    """Request of the program, from JSON. The program has checked all values.

    Attributes:
        datasets: paths
        recipe: name of the recipe
        labels: rule of the labels; None: the recipe's
        split: property that differs between training and test; None: not given
        held_out: share of its groups for the test; None: not given
        sensor: name in the scene; empty: every sensor that fits
        all: True: ignore a dataset's own split
        seed: for weights and draws
        steps: number of training steps; None: the recipe's
        turned: number of copies with turned images; None: the recipe's
        rates: Hz, lowest and highest rate of the sensors; None: the recipe's rate alone
        alarms: tolerated false alarms per minute; None: not given
        by_score: True: choose the operating point with the greatest score
        specificity: with `by_score`: least share of trials without slip that raise no alarm; None:
            not given
        output: path of the ONNX file
        resume: True: continue an interrupted training
        json: True: print one JSON object on stdout
    """

    datasets: list[str]
    recipe: str
    output: str
    labels: str | None = None
    split: str | None = None
    held_out: float | None = None
    sensor: str = ""
    all: bool = False
    seed: int = 1
    steps: int | None = None
    turned: int | None = None
    rates: list[float] | None = None
    alarms: float | None = None
    by_score: bool = False
    specificity: float | None = None
    resume: bool = False
    json: bool = False


def clock_text(seconds: float) -> str:
    """A duration as "12 s", "3:05" or "1:02:03"."""
    whole = max(round(seconds), 0)
    if whole < 60:
        return f"{whole} s"
    return (
        f"{whole // 60}:{whole % 60:02}"
        if whole < 3600
        else f"{whole // 3600}:{whole // 60 % 60:02}:{whole % 60:02}"
    )


def share_text(share: float | None) -> str:
    """A share as "98.1 %"; "-" for None or NaN."""
    return "-" if share is None or math.isnan(share) else f"{100 * share:.1f} %"


class ProgressReporter:
    """Writes the progress of a training to stderr."""

    def __init__(self, request: Request, interrupt: _core.Interrupt, members: int) -> None:
        self._interrupt, self._quiet, self._members = interrupt, request.json, members
        self._bar = sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and not self._quiet
        self._drawn = 0.0
        self.write_line(f"reading {', '.join(request.datasets)}")

    def write_line(self, text: str) -> None:
        """Writes a line, unless JSON was requested."""
        if not self._quiet:
            say(f"slipbench: {printable(text)}\n")

    def show_read(self, done: int, trials: int) -> None:
        """Draws a bar on a terminal. Raises KeyboardInterrupt after a signal."""
        self._interrupt.check()
        now = time.monotonic()
        if not self._bar or (done < trials and now - self._drawn < BAR_PERIOD):
            return
        self._drawn, width = now, min(30, shutil.get_terminal_size().columns // 3)
        filled = width * done // trials
        end = "\r\033[K" if done == trials else ""
        say(f"\r\033[K[{'#' * filled}{'-' * (width - filled)}] {done}/{trials}{end}")

    def show_validation(self, member: int, report: Report) -> None:
        """Writes a line for each validation, with the remaining time."""
        text = "" if self._members == 1 else f"network {member + 1}/{self._members}, "
        text += f"step {report.step}/{report.steps}, loss {report.loss:.4f}"
        if not math.isnan(report.validation):
            text += (
                f", validation {share_text(report.validation)}{' (best)' if report.best else ''}"
            )
        if report.step < report.steps:
            text += f", ETA {clock_text(report.seconds * (report.steps - report.step))}"
        self.write_line(text)


def figures_text(trained: Trained) -> str:
    """Table of the figures."""
    judged = trained.judged
    rows = [("", "held-out trials" if judged else "validation")]
    if judged:
        alarms = judged["alarms_per_minute"]
        rows += [
            ("balanced accuracy, all classes", share_text(judged["all_classes_balanced_accuracy"])),
            ("balanced accuracy, slip or no slip", share_text(judged["balanced_accuracy"])),
            ("F1 of slip", share_text(judged["f1"])),
            ("false alarms per minute of hold", "nan" if alarms is None else f"{alarms:.1f}"),
        ]
    else:
        rows.append(("balanced accuracy, all classes", share_text(trained.validation)))
    widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
    lines = [f"  {name:<{widths[0]}}  {value:>{widths[1]}}" for name, value in rows]
    return "\n".join([styled(sys.stdout, "2", lines[0]), *lines[1:]])


def score_text(validation: dict[str, Any]) -> str:
    """Score and specificity on the validation trials."""
    score, specificity, asked = (
        validation["score"],
        validation["specificity"],
        validation["specificity_asked"],
    )
    text = f"  validation: score {'nan' if score is None else f'{100 * score:.1f}'}, specificity {share_text(specificity)}"
    if specificity is None:
        return text + ": no dataset has 10 validation trials without slip"
    return text + (
        f", less than the {share_text(asked)} of --specificity" if specificity < asked else ""
    )


def next_text(request: Request, trained: Trained) -> str:
    """Command that evaluates the trained detector on data outside of its training."""
    rule: str = trained.description["trained"]["labels"]
    judged = {one.name: one.evaluated_by for one in _core.label_rules()}[rule]
    options = f" --sensor {shlex.quote(printable(trained.sensors[0]))} --labels {judged}"
    command = f"{styled(sys.stdout, '2', 'next:')} {os.environ.get('SLIPBENCH_CALLED_AS', 'slipbench')} eval {shlex.quote(request.output)} "
    data, part = trained.judged_from
    if data:
        return command + shlex.quote(data) + options + (f" --split {part}" if part else "")
    return f"{command}NEW.h5{options}  # NEW.h5: trials outside the training, such as a sweep with another --seed"


def print_summary(request: Request, trained: Trained) -> None:
    """Prints the result of a training."""
    described = trained.description
    facts, alarm, parts = described["trained"], described["alarm"], trained.parts
    rate = facts["validation"]["alarms_per_minute"]
    print(styled(sys.stdout, "1;36", f"{facts['recipe']}, labels {facts['labels']}"))
    print(figures_text(trained))
    split = " by the dataset's split" if trained.own_split else ""
    print(
        f"  {counted(parts['learns'], 'trial')} for training, {parts['validates']} for validation, {parts['judges']} for the test{split}; "
        f"{counted(facts['frames'], 'frame')}, {counted(facts['parameters'], 'parameter')}, state of step {facts['steps'][-1]}"
    )
    print(
        f"  operating point: slip after {counted(alarm['on'], 'consecutive frame')} with a probability of {described['threshold']:.3f} or more, "
        f"for at least {alarm['least']}, until {counted(alarm['off'], 'consecutive frame')} below"
    )
    print(
        f"  validation: {share_text(trained.validation)} balanced accuracy, {'nan' if rate is None else f'{rate:.1f}'} false alarms per minute of hold"
    )
    if facts["by_score"]:
        print(score_text(facts["validation"]))
    print(styled(sys.stdout, "32", "written:"), printable(request.output))
    print(next_text(request, trained))


def run(request: Request) -> int:
    """Trains a network and prints its figures; returns the exit status."""
    from slipbench.learning import (
        find_recipe,
        train,
    )  # reports a missing PyTorch before reading data
    from slipbench.learning._names import naming_options

    notice = "stopping; the state of the last validation is kept"
    with interruptible(notice) as interrupt, naming_options():
        reporter = ProgressReporter(request, interrupt, find_recipe(request.recipe).members)
        trained = train(
            request.datasets,
            output=request.output,
            recipe=request.recipe,
            sensor=request.sensor,
            labels=request.labels,
            split=request.split,
            held_out=request.held_out,
            every_trial=request.all,
            seed=request.seed,
            steps=request.steps,
            turned=request.turned,
            rates=None if request.rates is None else (request.rates[0], request.rates[1]),
            alarms=request.alarms,
            by_score=request.by_score,
            specificity=request.specificity,
            resume=request.resume,
            progress=reporter.show_validation,
            reading=reporter.show_read,
            before_step=interrupt.check,
        )
    return write_result(lambda: print_trained(request, trained))


def print_trained(request: Request, trained: Trained) -> None:
    """Prints the result of a training, or with --json one JSON object."""
    if not request.json:
        print_summary(request, trained)
        return
    described = trained.description
    summary: dict[str, Any] = described["trained"] | {
        "output": request.output,
        "threshold": described["threshold"],
        "alarm": described["alarm"],
    }
    print(json.dumps(summary, separators=(",", ":")))


def interrupted_text(request: Request) -> str:
    """States what an interrupted training has kept."""
    if os.path.exists(f"{request.output}.checkpoint-0"):
        return f"interrupted: kept in {request.output}.checkpoint-0; continue by the same command with --resume"
    return "interrupted; nothing is kept"


def main(request: Request) -> int:
    """Runs the request; returns the exit status."""
    return run_command(
        lambda: run(request),
        needs=f"train --recipe {request.recipe}",
        target=request.output,
        interrupted=lambda: interrupted_text(request),
    )


if __name__ == "__main__":
    sys.exit(main(Request(**read_request())))
