"""croissant.json of an export.

Its files and columns in the vocabulary Croissant 1.0 of MLCommons.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from glob import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyarrow as pa

# As in the specification; readers expect all of these terms.
CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileProperty": "cr:fileProperty",
    "fileObject": "cr:fileObject",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
BEGINNING = '{\n "@context": {\n  "@language": "en",'
FORMATS = {
    ".parquet": "application/x-parquet",
    ".mcap": "application/octet-stream",
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".csv": "text/csv",
    ".gz": "application/gzip",
    ".hdf5": "application/x-hdf5",
    ".npz": "application/zip",
    ".xml": "application/xml",
    ".md": "text/markdown",
}
File = tuple[str, str]  # name in the export, and path of the content


@dataclass(frozen=True)
class Column:
    """A column of a table.

    `type`: type of its values, such as "sc:Float"; `repeated`: True for several values per row.
    """

    name: str
    type: str
    description: str
    repeated: bool = False


@dataclass(frozen=True)
class Table:
    """Files with the same columns.

    Attributes:
        name: name of the table
        files: names of the files
        columns: in order
        encoding: MIME type if there can be several files; empty: a single file
        named: fields in the files' names: column name, and its type, description, and regular
            expression with one group
    """

    name: str
    files: list[str]
    columns: list[Column]
    encoding: str = ""
    named: dict[str, tuple[str, str, str]] = field(default_factory=dict)


def _digest(path: str) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _file_object(name: str, path: str) -> dict[str, Any]:
    suffix = name[name.rfind(".") :] if "." in name else ""
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": name,
        "encodingFormat": FORMATS.get(suffix, "text/plain"),
        "sha256": _digest(path),
    }


def _data_type(kind: pa.DataType) -> str:
    import pyarrow as pa

    if pa.types.is_fixed_size_list(kind) or pa.types.is_list(kind):
        return _data_type(kind.value_type)
    if pa.types.is_boolean(kind):
        return "sc:Boolean"
    if pa.types.is_integer(kind):
        return "sc:Integer"
    return "sc:Float" if pa.types.is_floating(kind) else "sc:Text"


def _described(field: pa.Field) -> str:
    """A column's unit or codes."""
    about = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
    unit = about.get("unit", "")
    codes = ", ".join(
        f"{code} {word}" for word, code in json.loads(about.get("codes", "{}")).items()
    )
    return codes or ("" if unit in ("", "1") else f"unit {unit}")


def parquet_columns(path: str) -> list[Column]:
    """The columns of a Parquet file."""
    import pyarrow.parquet as pq  # only needed for formats written with it

    with open(path, "rb") as file:  # pyarrow takes some names, such as a:b.parquet, for addresses
        schema = pq.read_schema(file)
    return [
        Column(field.name, _data_type(field.type), _described(field), field.type.num_fields > 0)
        for field in schema
    ]


def _field_of(table: Table, number: int, column: Column, source: dict[str, Any]) -> dict[str, Any]:
    """`number`: number of the column.

    Replaces its name in the identifier if the name has other characters than identifiers allow.
    """
    name = column.name if re.fullmatch(r"[\w.-]+", column.name) else f"column-{number}"
    about: dict[str, Any] = {
        "@type": "cr:Field",
        "@id": f"{table.name}/{name}",
        "name": column.name,
        "dataType": column.type,
        "source": source,
    }
    if column.description:
        about["description"] = column.description
    if column.repeated:
        about["repeated"] = True
    return about


def _record_set(table: Table) -> dict[str, Any]:
    of = (
        {"fileSet": {"@id": f"{table.name}-files"}}
        if table.encoding
        else {"fileObject": {"@id": table.files[0]}}
    )
    fields = [
        _field_of(
            table,
            0,
            Column(name, kind, description),
            of | {"extract": {"fileProperty": "fullpath"}, "transform": {"regex": regex}},
        )
        for name, (kind, description, regex) in table.named.items()
    ]
    fields += [
        _field_of(table, number, column, of | {"extract": {"column": column.name}})
        for number, column in enumerate(table.columns, 1)
    ]
    return {"@type": "cr:RecordSet", "@id": table.name, "name": table.name, "field": fields}


def _file_set(table: Table) -> dict[str, Any]:
    return {
        "@type": "cr:FileSet",
        "@id": f"{table.name}-files",
        "name": f"{table.name}-files",
        "encodingFormat": table.encoding,
        "includes": [escape(name) for name in table.files],
    }


def croissant_text(
    *,
    name: str,
    description: str,
    version: str,
    licence: str,
    citation: str,
    keywords: list[str],
    files: Iterable[File],
    tables: Iterable[Table],
) -> str:
    """croissant.json of an export.

    Args:
        name: name of the data set
        description: one sentence
        version: MAJOR.MINOR.PATCH
        licence: licence of the data; empty: not stated
        citation: citation of the data
        keywords: keywords of the data
        files: all files of the export
        tables: tables described column by column

    Returns:
        JSON that begins with BEGINNING.
    """
    files = sorted(files)
    about: dict[str, Any] = {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": name,
        "description": description,
        "version": version,
        "citeAs": citation,
        "keywords": keywords,
    }
    if licence:
        about["license"] = licence
    tables = list(tables)
    about["distribution"] = [
        *(_file_object(*file) for file in files),
        *(_file_set(table) for table in tables if table.encoding),
    ]
    if tables:
        about["recordSet"] = [_record_set(table) for table in tables]
    return json.dumps(about, indent=1, ensure_ascii=False) + "\n"
