"""A result as a self-contained HTML page, and its charts as PNG and SVG."""

from __future__ import annotations

import base64
import glob
import html
import io
import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from slipbench import InputError
from slipbench._output import write_whole
from slipbench.bin import _core
from slipbench_studies.result import Chart, Result, Table, result_object

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GENERATOR = "slipbench reproduce"
COLOURS = (
    "#1f66ad",
    "#c2450f",
    "#0a7d66",
    "#8a4fa3",
    "#a87400",
    "#59636e",
    "#2396b8",
    "#b0396b",
)  # of theme.css, light
SIZE = (7.6, 3.3)  # inches
PLACE, FRAME = (
    0.27,
    0.9,
)  # inches: height of a chart's row, and total height above and below the rows
FORMATS = {
    "svg": {"Creator": GENERATOR, "Date": None},
    "png": {"Software": GENERATOR},
}  # metadata that identifies a chart


def draw(chart: Chart) -> Figure:
    """Draws the chart as a matplotlib figure.

    Args:
        chart: chart to draw

    Returns:
        the figure, without a window
    """
    from matplotlib.figure import Figure

    figure = Figure(
        SIZE if chart.joined else (SIZE[0], FRAME + PLACE * len(chart.places)), layout="constrained"
    )
    axes = figure.subplots()
    apart = 0.0 if chart.joined else 0.2  # separates overlapping intervals of several curves
    for k, curve in enumerate(chart.curves):
        value, low, high = np.array(curve.points, dtype=float).T
        place = np.arange(len(value)) + apart * (k - 0.5 * (len(chart.curves) - 1))
        error = np.abs([value - low, high - value])
        style: dict[str, Any] = {
            "capsize": 2,
            "markersize": 4,
            "linewidth": 1.4,
            "color": COLOURS[k % len(COLOURS)],
        }
        if chart.joined:
            axes.errorbar(place, value, yerr=error, fmt="o-", label=curve.name, **style)
        else:
            axes.errorbar(value, place, xerr=error, fmt="o", label=curve.name, **style)
    if chart.bar is not None:
        (axes.axhline if chart.joined else axes.axvline)(
            chart.bar, color="#8b949e", linestyle="--", linewidth=1, label=chart.bar_name
        )
    if chart.joined:
        axes.set(xlabel=chart.across, ylabel=chart.up)
        axes.set_xticks(range(len(chart.places)), chart.places)
        axes.grid(axis="y", color="#e9ecef")
    else:
        axes.set(
            xlabel=chart.up, ylabel=chart.across, ylim=(len(chart.places) - 0.5, -0.5)
        )  # first row at the top
        axes.set_yticks(range(len(chart.places)), chart.places)
        axes.grid(axis="x", color="#e9ecef")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(
        loc="outside upper right", ncols=len(chart.curves) + (chart.bar is not None), frameon=False
    )
    return figure


def drawn(chart: Chart, format_name: str) -> bytes:
    """The chart as a file with reproducible bytes.

    Args:
        chart: chart to draw
        format_name: "png" or "svg"

    Returns:
        content of the file
    """
    import matplotlib

    file = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": GENERATOR, "svg.fonttype": "none"}):
        draw(chart).savefig(file, format=format_name, dpi=150, metadata=FORMATS[format_name])
    return file.getvalue()


def _row(cells: Iterable[str], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"


def _section(title: str, note: str, content: str) -> str:
    paragraph = f'<p class="note">{html.escape(note)}</p>\n' if note else ""
    return f"<section><h2>{html.escape(title)}</h2>\n{paragraph}{content}</section>\n"


def _table(table: Table) -> str:
    return (
        f'<div class="scroll"><table class="plain">\n<thead>{_row(table.head, "th")}</thead>\n<tbody>\n'
        + "".join(_row(row, "td") for row in table.rows)
        + "</tbody></table></div>\n"
    )


def _list(items: Iterable[str]) -> str:
    return (
        '<ul class="plain">\n'
        + "".join(f"<li>{html.escape(item)}</li>\n" for item in items)
        + "</ul>\n"
    )


def result_page(name: str, result: Result) -> str:
    """One HTML page without external resources.

    Args:
        name: PAPER/TABLE
        result: result of that study

    Returns:
        the page
    """
    body = (
        f'<header class="plain"><p class="eyebrow">{GENERATOR} {html.escape(name)}</p>\n<h1>{html.escape(result.title)}</h1>\n'
        f'<p class="note">{html.escape(result.source)}</p>\n</header>\n'
    )
    for chart in result.charts:
        picture = base64.b64encode(drawn(chart, "svg")).decode()
        body += _section(
            chart.title,
            "",
            f'<div class="scroll"><img alt="{html.escape(chart.title)}" src="data:image/svg+xml;base64,{picture}"></div>\n',
        )
    body += "".join(_section(table.title, table.note, _table(table)) for table in result.tables)
    if result.remarks:
        body += _section("What differs, and why", "", _list(result.remarks))
    if result.setup:
        body += _section("How it was measured", "", _list(result.setup))
    return _core.compose_page(GENERATOR, f"{name} · {GENERATOR}", body)


def chart_paths(output: str, count: int) -> list[Path]:
    """The files of the charts of FILE.html: FILE-1.svg, FILE-1.png, FILE-2.svg, ..."""
    page = Path(output)
    return [page.with_name(f"{page.stem}-{k + 1}.{name}") for k in range(count) for name in FORMATS]


def check_charts(output: str) -> None:
    """Checks that files with the names of FILE.html's charts are charts.

    Args:
        output: FILE.html

    Raises:
        InputError: for the first file that is not
    """
    page = Path(output)
    for path in sorted(page.parent.glob(f"{glob.escape(page.stem)}-*")):
        is_chart = re.fullmatch(rf"{re.escape(page.stem)}-\d+\.({'|'.join(FORMATS)})", path.name)
        if is_chart and GENERATOR.encode() not in path.read_bytes()[:4096]:
            raise InputError(f"{path}: exists and is not a chart of {GENERATOR}; choose another -o")


def write(output: str, name: str, result: Result) -> list[str]:
    """Writes the page, the object of result_object() and each chart as SVG and PNG.

    Earlier files of this command are replaced.

    Args:
        output: FILE.html
        name: PAPER/TABLE
        result: result of that study

    Returns:
        the names of the files

    Raises:
        InputError: a file cannot be written, or exists with other content
    """
    paths = chart_paths(output, len(result.charts))
    check_charts(output)
    files: list[str] = _core.write_result(
        output, result_page(name, result), json.dumps(result_object(name, result))
    )
    for path in paths:
        try:
            write_whole(
                path, drawn(result.charts[int(path.stem.rsplit("-", 1)[1]) - 1], path.suffix[1:])
            )
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from error
        files.append(str(path))
    return files
