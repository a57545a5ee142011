"""`python -m slipbench._import REQUEST`: started by the program. Exit status 2 for bad input, with
its message."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path

from slipbench import InputError
from slipbench._import.block import nearest, read_map
from slipbench._import.limits import memory_limit, source_limit
from slipbench._program import Interrupt, run_command, write_result
from slipbench.bin import _core

MAPS = Path(__file__).parent / "maps"


@dataclass(frozen=True)
class Request:
    """Request of the program, from JSON.

    Attributes:
        sources: files and folders
        map: YAML file, or the name of a map of the program
        output: dataset to write; empty: only check the sources
        seed: seed of the split
        rate: Hz, resampling rate; None: as recorded
        json: True: print one JSON object on stdout
        install: command that installs the readers' requirements
    """

    sources: list[str]
    map: str
    output: str
    seed: int
    rate: float | None
    json: bool
    install: str


def map_path(name: str) -> str:
    """Path of a map: a file, or a map of the program by its name. Raises InputError if neither
    exists."""
    if Path(name).is_file():
        return name
    own = MAPS / f"{name}.yaml"
    if Path(name).name == name and own.is_file():
        return str(own)
    raise InputError(
        f"--map {name}: no such file, and not an included map{nearest(name, sorted(path.stem for path in MAPS.glob('*.yaml')))}"
    )


def run(request: Request) -> int:
    """Imports the recordings and prints the result; returns the exit status."""
    interrupt = Interrupt("stopping; nothing is kept")
    from slipbench._import.recordings import Importer, Map

    map = Map(read_map(map_path(request.map)))
    files = map.files(request.sources)
    if not files:
        raise InputError(
            f"{', '.join(request.sources)}: contains only tables of labels; expected recordings"
        )
    writer = _core.MappedImport(
        request.sources,
        request.map,
        request.output,
        request.seed,
        request.rate,
        "object" if map.object else "trial",
    )
    if "note" in map.block:
        writer.warn(map.block.node.path, map.block.need("note"))
    importer = Importer(map, writer)
    for file in files:
        interrupt.check()
        with memory_limit(file.path, source_limit()):
            importer.add(file)
    interrupt.check()
    writer.finish(len(files))
    return write_result(lambda: writer.print(request.json))


def main(text: str) -> int:
    """Runs the request; returns the exit status."""
    request = Request(**json.loads(text))
    return run_command(
        lambda: run(request), needs="import --map", install=request.install, target=request.output
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
