"""croissant.json of an export: its files and columns in MLCommons' vocabulary Croissant 1.0."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

# As the specification prints it; readers expect all of these terms.
CONTEXT: dict[str, Any] = {
    "@language": "en", "@vocab": "https://schema.org/", "citeAs": "cr:citeAs", "column": "cr:column", "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/", "rai": "http://mlcommons.org/croissant/RAI/", "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"}, "dct": "http://purl.org/dc/terms/", "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract", "field": "cr:field", "fileProperty": "cr:fileProperty", "fileObject": "cr:fileObject", "fileSet": "cr:fileSet",
    "format": "cr:format", "includes": "cr:includes", "isLiveDataset": "cr:isLiveDataset", "jsonPath": "cr:jsonPath", "key": "cr:key", "md5": "cr:md5",
    "parentField": "cr:parentField", "path": "cr:path", "recordSet": "cr:recordSet", "references": "cr:references", "regex": "cr:regex",
    "repeated": "cr:repeated", "replace": "cr:replace", "samplingRate": "cr:samplingRate", "sc": "https://schema.org/", "separator": "cr:separator", "source": "cr:source",
    "subField": "cr:subField", "transform": "cr:transform"}
BEGINNING = '{\n "@context": {\n  "@language": "en",'
FORMATS = {".parquet": "application/x-parquet", ".mcap": "application/octet-stream", ".json": "application/json", ".yaml": "application/yaml",
           ".csv": "text/csv", ".xml": "application/xml", ".md": "text/markdown"}
File = tuple[str, str]  # name in the export, and the path that has its content


def _digest(path: str) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _file_object(name: str, path: str) -> dict[str, Any]:
    suffix = name[name.rfind("."):] if "." in name else ""
    return {"@type": "cr:FileObject", "@id": name, "name": name, "contentUrl": name, "encodingFormat": FORMATS.get(suffix, "text/plain"), "sha256": _digest(path)}


def _data_type(kind: pa.DataType) -> str:
    if pa.types.is_boolean(kind):
        return "sc:Boolean"
    if pa.types.is_integer(kind):
        return "sc:Integer"
    return "sc:Float" if pa.types.is_floating(kind) else "sc:Text"


def _described(field: pa.Field) -> str:
    """A column's unit and the key of its codes."""
    about = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
    unit = about.get("unit", "")
    codes = ", ".join(f"{code} {word}" for word, code in json.loads(about.get("codes", "{}")).items())
    return codes or ("" if unit in ("", "1") else f"unit {unit}")


def _record_set(name: str, path: str) -> dict[str, Any]:
    """The columns of a Parquet file."""
    table = name.removesuffix(".parquet")
    fields = []
    for field in pq.read_schema(path):
        one = {"@type": "cr:Field", "@id": f"{table}/{field.name}", "name": field.name, "dataType": _data_type(field.type),
               "source": {"fileObject": {"@id": name}, "extract": {"column": field.name}}}
        described = _described(field)
        fields.append(one | ({"description": described} if described else {}))
    return {"@type": "cr:RecordSet", "@id": table, "name": table, "field": fields}


def croissant_text(*, name: str, description: str, version: str, licence: str, citation: str, keywords: list[str], files: Iterable[File], tables: bool) -> str:
    """croissant.json of an export.

    Args:
        name: of the data set
        description: one sentence
        version: MAJOR.MINOR.PATCH
        licence: of the data; empty: none is stated
        citation: how to cite the data
        keywords: of the data
        files: all files of the export
        tables: whether Parquet files are tables, described column by column

    Returns:
        JSON that begins with BEGINNING.
    """
    files = sorted(files)
    about: dict[str, Any] = {"@context": CONTEXT, "@type": "sc:Dataset", "conformsTo": "http://mlcommons.org/croissant/1.0", "name": name, "description": description,
                             "version": version, "citeAs": citation, "keywords": keywords}
    if licence:
        about["license"] = licence
    about["distribution"] = [_file_object(*file) for file in files]
    if tables:
        about["recordSet"] = [_record_set(*file) for file in files if file[0].endswith(".parquet")]
    return json.dumps(about, indent=1, ensure_ascii=False) + "\n"
