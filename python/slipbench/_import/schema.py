"""`python -m slipbench._import.schema REQUEST`: the JSON Schema of import maps.

Started by `slipbench schema map`.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from slipbench._import.block import LARGEST
from slipbench._import.keys import BLOCKS, Key
from slipbench._program import catch_signals, run_command, write_result

_TEXT: dict[str, Any] = {"type": ["string", "number", "boolean"], "not": {"const": ""}}
_WHOLE: dict[str, Any] = {"type": "integer", "minimum": 1, "maximum": LARGEST}
# A number that YAML 1.1 reads as text, such as 1e-3.
_DECIMAL = r"(?=[0.]*[1-9])(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
_NUMBER: dict[str, Any] = {
    "anyOf": [
        {"type": "number", "not": {"const": 0}},
        {"type": "string", "pattern": f"^[+-]?{_DECIMAL}$"},
    ]
}
# A number, or a number and a unit that are separated by a blank.
_FACTOR: dict[str, Any] = {
    "anyOf": [
        {"type": "number", "not": {"const": 0}},
        {"type": "string", "pattern": rf"^[+-]?{_DECIMAL}([ ]+[^\s].*)?$"},
    ]
}
_KINDS: dict[str, dict[str, Any]] = {
    "text": _TEXT,
    "name": {"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$"},
    "number": _NUMBER,
    "factors": {"anyOf": [*_FACTOR["anyOf"], {"type": "array", "minItems": 1, "items": _FACTOR}]},
    "integer": _WHOLE,
    "boolean": {"type": "boolean"},
    "texts": {"type": "array", "minItems": 1, "items": _TEXT},
    "lines": {"anyOf": [_WHOLE, {"type": "array", "items": _WHOLE}]},
    "rate": {
        "anyOf": [
            {"type": "number", "exclusiveMinimum": 0},
            {"type": "string", "pattern": rf"^\+?{_DECIMAL}[ \t]*(Hz|kHz|MHz)?$"},
        ]
    },
    "duration": {
        "anyOf": [
            {"type": "number", "exclusiveMinimum": 0},
            {"type": "string", "pattern": rf"^\+?{_DECIMAL}[ \t]*(s|ms|us|min|h|days?)?$"},
        ]
    },
    "words": {"type": "object", "minProperties": 1, "additionalProperties": _TEXT},
}
_OF_SENSOR = ("type", "channels", "topic", "message", "each", "frame")
_PLACES: list[dict[str, Any]] = [
    {"required": [key]} for key in ("column", "value", "folder", "file", "table")
]
# Alternatives of a block: exactly one is required.
_NEEDED: dict[str, list[dict[str, Any]]] = {
    "map": [
        {"required": ["sensor", "type", "channels"], "properties": {"sensors": False}},
        {"required": ["sensors"], "properties": dict.fromkeys(("sensor", *_OF_SENSOR), False)},
    ],
    "sensor": [{"required": ["type", "channels"]}],
    "time": [{"required": ["column"]}, {"required": ["rate"]}],
    "state": _PLACES,
    "object": _PLACES,
}


def _schema(key: Key) -> dict[str, Any]:
    """The schema of one key, with its description and default."""
    if key.kind == "block":
        schema: dict[str, Any] = {"$ref": f"#/$defs/{key.block}"}
    elif key.kind == "blocks":
        schema = {
            "type": "object",
            "minProperties": 1,
            "propertyNames": _KINDS["name"],
            "additionalProperties": {"$ref": f"#/$defs/{key.block}"},
        }
    elif key.choices:
        schema = {"enum": list(key.choices)}
    else:
        schema = _KINDS[key.kind]
    default = f" Default: {key.default}." if key.default else ""
    return {"description": key.description + default, **schema}


def _block(name: str) -> dict[str, Any]:
    keys = BLOCKS[name]
    schema: dict[str, Any] = {
        "type": "object",
        "properties": {key.name: _schema(key) for key in keys},
        "additionalProperties": False,
    }
    if required := [key.name for key in keys if key.required]:
        schema["required"] = required
    if name in _NEEDED:
        schema["oneOf"] = _NEEDED[name]
    return schema


def map_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of import maps, generated from the keys in BLOCKS."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "slipbench import map",
        "description": "Made by `slipbench schema map`.",
        **_block("map"),
        "$defs": {name: _block(name) for name in BLOCKS if name != "map"},
    }


def main() -> int:
    """Prints the schema; returns the exit status."""
    catch_signals()
    return write_result(lambda: print(json.dumps(map_schema(), indent=1)))


if __name__ == "__main__":
    sys.exit(run_command(main))
