"""The public sets of recordings that the study knows.

How their files are found and imported, and what is known of slip in them.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

CLASSES = ("n", "e", "s", "w", "cw", "aw", "t")  # folders of BioTacSP-DoS
Params = Mapping[str, Any]


def _first_line(path: Path) -> str:
    with path.open(encoding="utf-8", errors="replace") as lines:
        return lines.readline()


def _folders_with(folder: Path, pattern: str, title: str, every: Sequence[str] = ()) -> list[Path]:
    """Folders below `folder`, or itself, with a file that matches `pattern`.

    The file's first line has `title`, and the folders have the files or folders `every`.
    """
    found = sorted(
        {
            path.parent
            for path in folder.rglob(pattern)
            if path.is_file() and title in _first_line(path)
        }
    )
    return [one for one in found if all((one / name).exists() for name in every)]


def _direction_sets(folder: Path) -> list[Path]:
    return sorted(
        {one.parent for one in _folders_with(folder, "*.csv", "ff_e1,") if one.name in CLASSES}
    )


def _bags_of(message: str) -> Callable[[Path], list[Path]]:
    def find(folder: Path) -> list[Path]:
        from slipbench import InputError
        from slipbench._import.bags import Bag

        found = []
        for path in sorted(folder.rglob("*.bag")):
            bag = None
            try:
                bag = Bag(str(path), {})
                bag.find("", message)
                found.append(path)
            except InputError as error:
                if bag is None:
                    raise InputError(
                        f"reproduce: {error}; repair the bag, or move it out of the folder"
                    ) from error
                # A bag of other messages.
            finally:
                if bag is not None:
                    bag.close()
        return found

    return find


def _file_stem(params: Params, _: list[Path]) -> str:
    return re.sub(r"_finger[12]$", "", Path(str(params["file"])).stem)


def _named_object(params: Params, _: list[Path]) -> str:
    return str(params.get("object", ""))


def _box_of(params: Params, folders: list[Path]) -> str:
    """The box of a recording of uskin_boxes, by the table next to its files; empty without it."""
    from slipbench import InputError

    wanted = int(re.sub(r"\D", "", _file_stem(params, folders)))
    for folder in folders:
        table = folder / "recordings.csv"
        if not table.is_file():
            continue
        rows = list(
            csv.DictReader(table.read_text(encoding="utf-8-sig", errors="replace").splitlines())
        )
        for line, row in enumerate(rows, start=2):
            number, box = row.get("recording"), row.get("object")
            if number is None or box is None or not number.strip().isdecimal():
                raise InputError(
                    f"{table}:{line}: expected the columns recording, a number, and object, separated by commas"
                )
            if int(number) == wanted:
                return box.strip()
        raise InputError(f"{table}: has no row for recording {wanted}, of {params['file']}")
    return ""


@dataclass(frozen=True)
class RealSet:
    """A public set of recordings.

    Attributes:
        name: name on the page
        repository: owner/name on GitHub
        sensor: type of its sensor, as in a scene
        find: files and folders of the set below a folder; empty: it is not there
        format: its format of `slipbench import`; empty: `map` reads it
        map: the included map that reads it
        layout: what is looked for, for the reader of the page
        known: what is known of slip
        recording: recording of a trial, by its params; fingers of one recording have the same
        object: object of a trial, by its params and the folders found; empty: unknown
    """

    name: str
    repository: str
    sensor: str
    find: Callable[[Path], list[Path]]
    layout: str
    known: str
    format: str = ""
    map: str = ""
    recording: Callable[[Params, list[Path]], str] = _file_stem
    object: Callable[[Params, list[Path]], str] = _named_object


def _file(params: Params, _: list[Path]) -> str:
    return str(params["file"])


SETS = (
    RealSet(
        "biotacsp-dos",
        "yayaneath/BioTacSP-DoS",
        "biotac_sp",
        _direction_sets,
        layout="folders n, e, s, w, cw, aw and t with OBJECT<number>.csv",
        known="by recording: the finger slips throughout, or touches throughout (t)",
        format="biotacsp-dos",
        recording=_file,
    ),
    RealSet(
        "uskin-boxes",
        "imanlab/tactile_prediction_flat_dataset",
        "magnetic_skin",
        lambda folder: _folders_with(folder, "r*_finger*.csv", "x0,y0,z0,"),
        layout="r<number>_finger<number>.csv with the column state",
        known="by sample, from a marker on the box that a camera sees; unknown for most samples",
        map="uskin_boxes",
        object=_box_of,
    ),
    RealSet(
        "uskin-flat",
        "yinzhaodong/tactile_prediction",
        "magnetic_skin",
        lambda folder: _folders_with(folder, "r*.csv", "t0_x,t0_y,t0_z,", ("labels.csv",)),
        layout="r<number>.csv and labels.csv",
        known="by recording: that the box does not slip in it, or that it slips at an unknown time",
        map="uskin_flat",
    ),
    RealSet(
        "biotac-slide",
        "dexrob/BioTac_slide_20_50",
        "biotac_sp",
        lambda folder: _folders_with(folder, "*_bio.csv", "pac22,ele1,"),
        layout="mat<number>_<number>_bio.csv",
        known="by recording: the finger slides in each",
        map="biotac_slide",
        recording=_file,
    ),
    RealSet(
        "fabric-slide",
        "wngfra/FabricSlide",
        "taxels",
        lambda folder: _folders_with(folder, "*.csv", "proximity1, "),
        layout="tables with the columns proximity1 and channel1 to channel16",
        known="not known by sample: the finger slides from an unknown time on",
        map="fabric_slide",
        recording=_file,
    ),
    RealSet(
        "papillarray-bags",
        "kylemathenia/Contactile_Data_Viz",
        "papillarray",
        _bags_of("SensorState"),
        layout="bags of ROS 1 with messages SensorState",
        known="not known",
        map="papillarray_ros",
        recording=_file,
    ),
    RealSet(
        "weiss-bags",
        "",
        "taxels",
        _bags_of("TactileSensor"),
        layout="bags of ROS 1 with messages TactileSensor",
        known="not known",
        map="weiss_ros",
        recording=_file,
    ),
)
