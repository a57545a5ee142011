"""Layout of the trials in each format.

Its files, and the columns of formats whose values differ from the dataset's arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from slipbench._export.request import Request
from slipbench._export.series import Series
from slipbench.bin import _core

MILLI = 1e3
ROTATED = 12  # rows and columns of the images of myrmex-rotated, and number of rotations
VENDOR_CODES = _core.vendor_codes_text()  # of a pillar, by its vendor and the ROS driver


@dataclass(frozen=True)
class Column:
    """A column, or several columns that differ in a number or an axis.

    Attributes:
        name: name in the card: "S<s>_P<p>_DX, DY, DZ"
        pattern: regular expression of the names in the files; empty: the files do not name their
            columns
        unit: empty for a pure number or a code
        meaning: one sentence, with the meaning of codes
        type: type of its values in Croissant
    """

    name: str
    pattern: str
    unit: str
    meaning: str
    type: str = "sc:Float"


def _no_columns(_: Request) -> list[Column]:
    return []


def _any_array(_: Series) -> bool:
    return True


def _no_array(_: Series) -> bool:
    return False


def _own_shape(one: Series, _: bool) -> list[int]:
    return list(one.shape)


def _rotated_shape(one: Series, is_image: bool) -> list[int]:
    """Shape of the augmented images: rotation, row, column."""
    is_rotated = is_image and len(one.shape) == 2 and min(one.shape) >= ROTATED
    return [ROTATED] * 3 if is_rotated else list(one.shape)


@dataclass(frozen=True)
class Layout:
    """Content of the files of a format.

    Attributes:
        files: content of each file, by its name
        holds: selects the dataset's arrays in the files
        sensor: the only supported type of sensor; empty: any
        columns: columns of formats with other values
        has_labels: True if these columns or the file names state slip
        shape: shape of a sample of an array; the second argument: True for a sensor's image
        table: regular expression of the names of tables with a header, with the groups `table`,
            which distinguishes tables with different columns, and optionally `trial` and `class`;
            empty: no such tables, or Parquet
    """

    files: dict[str, str]
    holds: Callable[[Series], bool] = _any_array
    sensor: str = ""
    columns: Callable[[Request], list[Column]] = _no_columns
    has_labels: bool = False
    shape: Callable[[Series, bool], list[int]] = _own_shape
    table: str = ""


def _pillar_rule(request: Request) -> str:
    """Rule by which a pillar slips in the logs of the PapillArray."""
    [rule] = [one for one in _core.label_rules() if one.name == request.labels]
    speed = f"{MILLI * (request.label_speed or 0.0):g} mm/s"
    return f"rule {rule.name}: a pillar slips when {rule.pillar_meaning.format(speed=speed)}"


def _vendor_columns(request: Request) -> list[Column]:
    pillar = r"S\d_P\d_"
    return [
        Column("T_us", "T_us", "us", "time since the beginning of the trial", "sc:Integer"),
        Column(
            "S<s>_P<p>_DX, DY, DZ",
            pillar + "D[XYZ]",
            "mm",
            "displacement of the tip of pillar p of sensor s",
        ),
        Column("S<s>_P<p>_FX, FY, FZ", pillar + "F[XYZ]", "N", "force on pillar p"),
        Column("S<s>_GG_FX, FY, FZ", r"S\d_GG_F[XYZ]", "N", "sum of the forces on all pillars"),
        Column(
            "S<s>_GG_TX, TY, TZ",
            r"S\d_GG_T[XYZ]",
            "N mm",
            "torque of these forces about the centre pillar",
        ),
        Column("S<s>_isSDActive", r"S\d_isSDActive", "", "1: slip detection is on", "sc:Integer"),
        Column(
            "S<s>_isRefLoad", r"S\d_isRefLoad", "", "1: the centre pillar is loaded", "sc:Integer"
        ),
        Column(
            "S<s>_P<p>_isInContact",
            pillar + "isInContact",
            "",
            f"1: the reported normal force is at least {_core.vendor_contact_force:g} N",
            "sc:Integer",
        ),
        Column(
            "S<s>_P<p>_slipState",
            pillar + "slipState",
            "",
            f"the truth in the codes of the vendor: {VENDOR_CODES}; {_pillar_rule(request)}",
            "sc:Integer",
        ),
        Column(
            "S<s>_FrictionEst",
            r"S\d_FrictionEst",
            "",
            "-1: the estimator of the device is not simulated",
            "sc:Integer",
        ),
    ]


def _training_columns(request: Request) -> list[Column]:
    return [
        Column("1", "", "s", "time since the beginning of the trial"),
        Column("2 + 8 p", "", "", "contact of pillar p, 0 to 8: 0 detached, 1 touches"),
        Column("3 + 8 p", "", "", f"slip of pillar p: 0 no, 1 slips; {_pillar_rule(request)}"),
        Column("4 + 8 p to 6 + 8 p", "", "mm", "displacement of the tip of pillar p: x, y, z"),
        Column("7 + 8 p to 9 + 8 p", "", "N", "force on pillar p: x, y, z"),
    ]


def _grasp_columns(_: Request) -> list[Column]:
    return [
        Column("object", "object", "", "grasped object: shape and size in mm", "sc:Text"),
        Column(
            "slipped", "slipped", "", "0 held, 1 lost, by the key `hold` of the scene", "sc:Integer"
        ),
        Column(
            "ff_biotac_<e>, mf_biotac_<e>, th_biotac_<e>",
            r"(ff|mf|th)_biotac_\d+",
            "counts",
            "electrode e, 1 to 24, of the finger's BioTac SP in the last sample before the lift",
            "sc:Integer",
        ),
    ]


def _slip_columns(_: Request) -> list[Column]:
    return [Column("ff_e<e>", r"ff_e\d+", "counts", "electrode e, 1 to 24", "sc:Integer")]


def _image_columns(_: Request) -> list[Column]:
    return [
        Column(
            "all",
            "",
            "counts",
            "the taxels column by column, 0 to 4095: high at rest, lower under pressure",
        )
    ]


def _in_tables(one: Series) -> bool:
    return one.kind == "sensors" or (one.kind == "labels" and one.name.startswith("state"))


def _in_demonstrations(one: Series) -> bool:
    return (
        _in_tables(one)
        or one.kind == "truth"
        or (one.kind == "control" and one.name in ("command", "measured_position"))
    )


ARCHIVE = (
    "arrays of trial k under their paths: `sensors/<sensor>/<array>`, `labels/<sensor>/<array>`, `truth/<body>/<array>`, `control/<array>`; "
    "`about` is a JSON text with the units and the keys of codes"
)
LAYOUTS = {
    "csv": Layout(
        {
            "demo_<k>-<sensor>.csv": "trial k: one row per sample; `t [s]`, a column for each value as `NAME [UNIT]`, the states",
            "demo_<k>-<sensor>-<channel>.csv": "the same for a channel with separate times",
        },
        _in_tables,
        table=r"demo_(?P<trial>\d+)-(?P<table>.+)\.csv",
    ),
    "npz": Layout({"demo_<k>.npz": ARCHIVE}),
    "myrmex-rotated": Layout(
        {
            "demo_<k>.npz": f"{ARCHIVE}. The taxels of a Myrmex of 12 x 12 or more are [samples, 12, 12, 12]: sample, turn by 0 to 330 degrees "
            "in steps of 30, row, column"
        },
        shape=_rotated_shape,
    ),
    "robomimic": Layout(
        {
            "robomimic.hdf5": "`data/demo_<k>`: trial k at one rate; `obs/<sensor>_<channel>`, `next_obs`, `actions` (scaled to -1 to 1), `states` "
            "(pose and velocity of all bodies), `rewards` (1 in the last row of a successful grasp), `dones`, `<sensor>_<state>`"
        },
        _in_demonstrations,
    ),
    "parquet": Layout(
        {
            "<sensor>.parquet": "one row per sample of all trials",
            "<sensor>-<channel>.parquet": "one row per sample of a channel with separate times",
            "<sensor>-events.parquet": "one row per event",
            "body-<name>.parquet": "one row per sample of a body",
            "control.parquet": "one row per step of the loop",
            "trials.parquet": "one row per trial",
        }
    ),
    "lerobot": Layout(
        {
            "data/*/*.parquet": "one row per frame",
            "meta/info.json": "the features",
            "meta/episodes/*/*.parquet": "one row per episode, with the number of its trial",
        }
    ),
    "mcap": Layout(
        {
            "demo_<k>.mcap": "trial k: a topic for each sensor, its labels, the bodies and the loop",
            "foxglove-layout.json": "a layout for viewers",
        }
    ),
    "rosbag2": Layout(
        {
            "demo_<k>": f"trial k as a ROS 2 bag; `slip_state` of a PapillArray's message: {VENDOR_CODES}; by the rule of `--labels`, without it strict",
            "slipbench_msgs": "the package of the messages",
        }
    ),
    "vendor-csv": Layout(
        {"LOG_demo_<k>.csv": "trial k in the layout of the vendor's software, one row per sample"},
        _no_array,
        "papillarray",
        _vendor_columns,
        True,
        table=r"(?P<table>LOG)_demo_(?P<trial>\d+)\.csv",
    ),
    "training-csv": Layout(
        {
            "<move>/demo_<k>-v_<mm/s>-<slip or stop>.csv": "trial k: one row per sample at 1000 Hz, 73 columns without header; move "
            "and speed are as commanded by the scene; stop: the pad braked within 100 ms of its start"
        },
        _no_array,
        "papillarray",
        _training_columns,
        True,
    ),
    "grasp-csv": Layout(
        {"grasps.csv": "one row per grasp"},
        _no_array,
        "biotac_sp",
        _grasp_columns,
        True,
        table=r"(?P<table>grasps)\.csv",
    ),
    "slip-csv": Layout(
        {
            "<class>/<object><k>.csv": "trial k: one row per sample at 100 Hz without times; class: n towards the root of the finger, s "
            "towards its tip, "
            "e and w to its right and left, cw and aw turn, t rests"
        },
        _no_array,
        "biotac_sp",
        _slip_columns,
        True,
        table=r"(?P<class>[a-z]+)/.+\.csv",
    ),
    "myrmex-csv": Layout(
        {
            "demo_<k>-<sensor>.csv": "trial k: one image per line at the rate of the sensor, without header and times"
        },
        _no_array,
        "myrmex",
        _image_columns,
    ),
}
