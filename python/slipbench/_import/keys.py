"""The keys of a map, declared once: they define the checks of maps and their JSON Schema."""

from __future__ import annotations

from dataclasses import dataclass

from slipbench.bin import _core

STATES = _core.pad_states()
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}


@dataclass(frozen=True)
class Key:
    """One key of a block of the map.

    Attributes:
        name: name in the file
        kind: "text"; "name" (letters, digits and "_"); "number"; "factors" (a number, or a number with a
            unit such as "0.01 N", or a list of them); "integer" (1 or more); "boolean"; "duration" ("1 day", "500 ms");
            "texts" (a list); "lines" (a number of lines, or a list of line numbers); "rate" ("100
            Hz"); "words" (texts by texts); "block" (the keys of `block`); "blocks" (such blocks,
            each under a name)
        default: value without the key, for the documentation; empty: none
        description: one sentence
        choices: allowed values of a text; empty: any
        block: name of the block in BLOCKS, for the kinds "block" and "blocks"
        required: True if the block needs the key
    """

    name: str
    kind: str
    default: str
    description: str
    choices: tuple[str, ...] = ()
    block: str = ""
    required: bool = False


_SENSOR = (
    Key(
        "type",
        "text",
        "",
        "type of the sensor, as in a scene: papillarray, taxels, or a custom type",
    ),
    Key("frame", "text", "as recorded", "a sentence that defines the axes"),
    Key(
        "time",
        "block",
        "of a bag: when a message was received",
        "the times of the samples",
        block="time",
    ),
    Key("channels", "blocks", "", "the channels by their names", block="channel"),
    Key(
        "state",
        "block",
        "no labels",
        "the label of each sample: no contact, non-slip, incipient or gross slip",
        block="state",
    ),
    Key("topic", "text", "the only one", "topic of a bag or of an MCAP file"),
    Key(
        "message",
        "text",
        "",
        "type of message in a bag; each topic of this type is a separate sensor",
    ),
    Key(
        "each",
        "text",
        "",
        "list in a message, each item of which is a separate sensor; columns are fields of an item",
    ),
)
_PLACES = (
    Key("column", "text", "", "title of the column"),
    Key("value", "text", "", "one value for all recordings"),
    Key(
        "folder",
        "integer",
        "",
        "name of a folder above the file: 1 is the folder of the file, 2 the folder above it",
    ),
    Key(
        "file", "text", "", "regular expression for the file's name, whose first group is the value"
    ),
    Key("table", "block", "", "a table with one row per file", block="table"),
)
BLOCKS: dict[str, tuple[Key, ...]] = {
    "map": (
        Key("sensor", "name", "", "name of the only sensor, whose keys are on the same level"),
        Key("sensors", "blocks", "", "several sensors by their names", block="sensor"),
        Key(
            "files",
            "text",
            "all of a kind",
            "pattern for the names of the files that are read in folders, such as '*_bio.csv'; files given by name are always read",
        ),
        Key(
            "note",
            "text",
            "none",
            "sentence that import prints as a warning, such as an assumption of the map",
        ),
        *_SENSOR,
        Key(
            "object",
            "block",
            "no objects",
            "name of the object; recordings of an object stay in one part of the split",
            block="object",
        ),
        Key(
            "separator",
            "text",
            "found",
            "between the cells: a character, tab, or blanks (any number of spaces and tabs)",
        ),
        Key("decimal", "text", "found", "the decimal mark", choices=(".", ",")),
        Key("thousands", "text", "none", "the mark between thousands", choices=(",", ".", "'")),
        Key(
            "header",
            "boolean",
            "true",
            "true: the first line contains titles; false: the columns are called 1, 2, 3",
        ),
        Key("skip", "lines", "none", "lines to skip: the first N, or a list of line numbers"),
        Key(
            "comment",
            "text",
            "#",
            "text at the beginning of lines to skip; none: all lines are read",
        ),
        Key(
            "definitions",
            "texts",
            "those in the bag",
            "of a bag of ROS 2 without definitions of its messages: .msg files, or folders that have them as "
            "PACKAGE/msg/NAME.msg, next to the map",
        ),
        Key(
            "missing",
            "text",
            "refuse",
            "empty cells, NaN and NA: refuse the file; gap: leave out the sample; nan: keep NaN",
            choices=("refuse", "gap", "nan"),
        ),
    ),
    "sensor": _SENSOR,
    "time": (
        Key(
            "column",
            "text",
            "",
            "title of the column: numbers, ISO 8601, or a time of day as 12:30:00.5",
        ),
        Key("unit", "text", "s", "unit of a column of numbers", choices=tuple(TIME_UNITS)),
        Key(
            "scale",
            "number",
            "1",
            "length of the column's unit in seconds, where `unit` has no name for it",
        ),
        Key(
            "format",
            "text",
            "ISO 8601",
            "format of a date or a time of day, for Python's strptime: '%d.%m.%Y %H:%M:%S.%f'",
        ),
        Key(
            "nanoseconds",
            "text",
            "",
            "title of a column of nanoseconds beyond the whole seconds of `column`, as ROS has them",
        ),
        Key(
            "wrap",
            "duration",
            "none",
            "period after which the times start again: 1 day for times of day, 4294.967296 s for a counter of 32 bits in us",
        ),
        Key("rate", "rate", "", "rate of samples without times, such as 100 Hz"),
    ),
    "channel": (
        Key(
            "unit",
            "text",
            "",
            "unit of a cell times `scale`; the dataset has the SI unit if it is a known one, such as mN, mm, kPa or deg",
            required=True,
        ),
        Key(
            "scale",
            "factors",
            "1",
            "factor from a cell to `unit`, or with a unit, such as 0.01 N: what 1 `unit` of a cell is; or a list with one for each component",
        ),
        Key(
            "baseline",
            "duration",
            "none",
            "time at the beginning of each recording without contact, such as 0.2 s; the mean of each value in that time is subtracted",
        ),
        Key(
            "components",
            "integer",
            "1, or the number of titles with *",
            "components of a unit, such as 3 of a force",
        ),
        Key(
            "columns",
            "texts",
            "",
            "titles; 'A .. B' means A, B and all between them; * matches a number, and several titles with * alternate",
            required=True,
        ),
    ),
    "state": (
        *_PLACES,
        Key(
            "values",
            "words",
            "0 to 3, or their names",
            f"the state of each text that is found: {', '.join(STATES)}, 0 to 3, or {_core.unknown_state_name}, which eval and train leave out",
        ),
        Key("rule", "text", "", "a sentence that defines the labels", required=True),
    ),
    "object": _PLACES,
    "table": (
        Key("path", "text", "", "file name, next to the recordings or to the map", required=True),
        Key("file", "text", "file", "title of the column of file names"),
        Key("column", "text", "", "title of the column of values", required=True),
    ),
}
