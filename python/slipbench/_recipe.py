"""`python -m slipbench._recipe FILE`.

The command `describe NAME` for a recipe of `train`, started by the program.
"""

from __future__ import annotations

import inspect
import json
import re
import sys
import textwrap
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from slipbench._program import (
    catch_signals,
    counted,
    read_request,
    run_command,
    styled,
    text_width,
    write_result,
)

if TYPE_CHECKING:
    from slipbench.learning import Input, Recipe, Training

SCALINGS = {
    "standard": "each feature to mean 0 and standard deviation 1",
    "common": "all features alike, to mean 0 and standard deviation 1",
    "range": "each feature to 0 to 1",
    "none": "none: features in their units",
}
CLASSES = {
    "slip": "hold, slip",
    "kind": "stable, translation, rotation",
    "direction": "t (touch), n, e, s, w, cw, aw",
}


def frequency_text(hertz: float) -> str:
    """A frequency as "300 Hz" or "10 kHz"."""
    return f"{hertz / 1000:g} kHz" if hertz >= 1000 else f"{hertz:g} Hz"


def input_text(frames: Input) -> str:
    """Describes the input of a network."""
    picks = (
        frames.channels.items()
        if hasattr(frames.channels, "items")
        else [(name, ()) for name in frames.channels]
    )
    names = ", ".join(
        f"{counted(len(values), 'value')} of {name}" if len(values) else name
        for name, values in picks
    )
    text = f"{names} of a {frames.sensor} at {frequency_text(frames.rate)}"
    text += f", median of {frames.median}" if frames.median > 1 else ""
    text += f"; a frame of {counted(frames.window, 'sample')} every {frames.stride}"
    text += ", minus its mean" if frames.centre else ""
    band, spans = (
        f"{frequency_text(frames.low)} to {frequency_text(frames.high)}",
        ", ".join(str(span) for span in frames.spans),
    )
    text += {
        "samples": "",
        "log_psd": f", log10 of its power spectral density, {band}",
        "amplitude": f", amplitude of its spectrum, {band}",
        "levels": f", its mean, and its changes over {spans} samples, with their signs",
        "units": ", or of any sensor of three-axis units at 200 Hz or more, with windows of the same length in ms; for each unit: force, ratio, changes",
        "spreads": f", how far and how fast its values move over {spans} samples",
    }[frames.transform]
    return text + (f", as an image of {len(frames.pixels)} pixels" if len(frames.pixels) else "")


def training_text(training: Training) -> str:
    """Describes the training of a network."""
    text = (
        f"{'Adam' if training.optimiser == 'adam' else 'RMSProp'} at {training.learning_rate:g}, falling to "
        f"{training.learning_rate * training.final_rate:g}; {counted(training.steps, 'step')} of {counted(training.batch, 'clip')} of {counted(training.clip, 'answer')}; "
        f"classes {'drawn equally often' if training.balance == 'drawing' else 'weighted equally'}"
    )
    if training.onset_frames:
        text += f"; of each slip, the first {training.onset_frames} frames and every tenth later frame are used"
    if training.label_smoothing:
        text += f"; label smoothing {training.label_smoothing:g}"
    if training.patience:
        text += f"; stops after {counted(training.patience, 'validation')} without improvement"
    return text


def network_text(made: Callable[[int, int], Any]) -> str:
    """The class of a recipe's network with its arguments, and its description."""
    kind, given = (made.func, made.keywords) if isinstance(made, partial) else (made, {})
    defaults = {
        one.name: one.default
        for one in inspect.signature(kind).parameters.values()
        if one.default is not one.empty
    }
    values = ", ".join(
        f"{key}={value}"
        for key, value in {**defaults, **given}.items()
        if isinstance(value, (int, str))
    )
    return f"slipbench.learning.networks.{kind.__name__}{f'({values})' if values else ''}\n\n{inspect.getdoc(kind)}"


def facts_of(recipe: Recipe) -> dict[str, str]:
    """Properties of a recipe by heading."""
    return {
        "Input": input_text(recipe.input),
        "Scaling": SCALINGS[recipe.scaling],
        "Network": network_text(recipe.network),
        "Networks": f"{recipe.members}, whose probabilities are averaged"
        if recipe.members > 1
        else "1",
        "Classes": CLASSES[recipe.classes],
        "Training": training_text(recipe.training),
        "Labels": recipe.labels,
        "Split": recipe.split,
        "Source": recipe.source,
        "Assumed": recipe.assumed,
    }


def table_lines(rows: list[str]) -> list[str]:
    """Converts a Markdown table to aligned columns of text."""
    cells = [
        [cell.strip().strip("`") for cell in row.strip("|").split("|")]
        for row in rows
        if not re.fullmatch(r"[|\s:-]+", row)
    ]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return [
        "  "
        + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in cells
    ]


def wrapped(text: str, width: int) -> str:
    """Wraps paragraphs and tables to a width, indented by two spaces."""
    lines: list[str] = []
    for paragraph in text.split("\n\n"):
        rows = paragraph.splitlines()
        if rows[0].startswith("|"):
            lines += table_lines(rows)
        else:
            lines += textwrap.wrap(
                " ".join(paragraph.split()), width, initial_indent="  ", subsequent_indent="  "
            )
    return "\n".join(lines)


def show(recipe: Recipe, as_json: bool) -> None:
    """Prints a recipe on stdout."""
    facts = facts_of(recipe)
    if as_json:
        entry = {
            "kind": "recipe",
            "name": recipe.name,
            "summary": recipe.summary,
            **{heading.lower(): text for heading, text in facts.items()},
        }
        print(json.dumps({"name": recipe.name, "entries": [entry]}, separators=(",", ":")))
        return
    width = text_width()
    print(
        f"{styled(sys.stdout, '1;36', recipe.name)}  {styled(sys.stdout, '2', 'recipe')}\n{wrapped(recipe.summary, width)}"
    )
    for heading, text in facts.items():
        print(f"\n{styled(sys.stdout, '1', heading)}\n{wrapped(text, width)}")
    print(
        f"\n{styled(sys.stdout, '1', 'On the command line')}\n  slipbench train DATA.h5 --recipe {recipe.name} -o detector.onnx"
    )


def run(request: dict[str, Any]) -> int:
    """Prints the requested recipe, optionally as JSON; returns the exit status."""
    catch_signals()
    from slipbench.learning import find_recipe

    recipe = find_recipe(request["name"])
    return write_result(lambda: show(recipe, request["json"]))


def main(request: dict[str, Any]) -> int:
    """Runs the request; returns the exit status."""
    return run_command(
        lambda: run(request), needs=f"describe {request['name']}", interrupted=lambda: "interrupted"
    )


if __name__ == "__main__":
    sys.exit(main(read_request()))
