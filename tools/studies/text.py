"""A result as text for a terminal."""

from __future__ import annotations

import os
import sys
import textwrap

from slipbench._program import text_width, watched
from slipbench_studies.result import Result, Table

BOLD, DIM, HEADING = "1", "2", "1;36"


def wrapped(text: str, width: int) -> str:
    """The text wrapped at spaces, indented by two."""
    return (
        textwrap.fill(
            text,
            width,
            initial_indent="  ",
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
        + "\n"
    )


def table_text(table: Table, dim: str = "{}") -> str:
    """The lines of a table, with right-aligned columns except the first.

    Args:
        table: table to show
        dim: format of the head

    Returns:
        lines, indented by two spaces
    """
    rows = [table.head, *table.rows]
    widths = [max(len(row[column]) for row in rows) for column in range(len(table.head))]
    lines = [
        "  "
        + "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    return "\n".join([dim.format(lines[0].rstrip()), *(line.rstrip() for line in lines[1:])]) + "\n"


def result_text(result: Result, colour: bool, width: int) -> str:
    """A whole result as text.

    Args:
        result: result to show
        colour: True: mark up for a terminal
        width: columns

    Returns:
        the text, which ends with a line end
    """

    def marked(text: str, code: str) -> str:
        return f"\033[{code}m{text}\033[0m" if colour else text

    text = marked(result.title, BOLD) + "\n" + wrapped(result.source, width)
    for table in result.tables:
        text += f"\n{marked(table.title, HEADING)}\n" + table_text(table, marked("{}", DIM))
        text += wrapped(table.note, width) if table.note else ""
    for title, lines in (
        ("What differs, and why", result.remarks),
        ("How it was measured", result.setup),
    ):
        if lines:
            text += f"\n{marked(title, HEADING)}\n" + "".join(
                wrapped(line, width) for line in lines
            )
    return text


def show(result: Result) -> None:
    """Prints a result on stdout, in colour on a terminal (no-color.org)."""
    sys.stdout.write(
        result_text(result, watched(sys.stdout) and not os.environ.get("NO_COLOR"), text_width())
    )
