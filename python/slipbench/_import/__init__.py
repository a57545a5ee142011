"""Readers of `slipbench import --map`."""

from __future__ import annotations

from pathlib import Path

from slipbench.bin import _core

MAPS = Path(__file__).parent / "maps"


def map_path(name: str) -> str:
    """Path of a map: a file, or a map of the program by its name.

    Raises InputError if neither exists.
    """
    if Path(name).is_file():
        return name
    own = MAPS / f"{name}.yaml"
    if Path(name).name == name and own.is_file():
        return str(own)
    from slipbench._import.block import nearest

    names = sorted(path.stem for path in MAPS.glob("*.yaml"))
    raise _core.InputError(
        f"--map {name}: no such file, and not an included map{nearest(name, names)}"
    )


def read_mapped(options: _core.ImportOptions, interrupt: _core.Interrupt) -> _core.MappedImport:
    """Imports recordings as a map describes them.

    Args:
        options: with a map
        interrupt: its check() is called before each source

    Returns:
        The finished import, with its summary.

    Raises:
        InputError: as import_recordings(); no dataset remains
        ModuleNotFoundError: a reader needs a package that is not installed
        KeyboardInterrupt: after a signal before the dataset is complete; no dataset remains
    """
    from slipbench._import.block import read_map
    from slipbench._import.limits import memory_limit, source_limit
    from slipbench._import.recordings import Importer, Map

    map = Map(read_map(map_path(options.map)))
    files = map.files(options.sources)
    if not files:
        raise _core.InputError(
            f"{', '.join(options.sources)}: contains only tables of labels; expected recordings"
        )
    writer = _core.MappedImport(options, "object" if map.object else "trial")
    if "note" in map.block:
        writer.warn(map.block.node.path, map.block.need("note"))
    importer = Importer(map, writer)
    for file in files:
        interrupt.check()
        with memory_limit(file.path, source_limit()):
            importer.add(file)
    interrupt.check()
    writer.finish(len(files))
    return writer
