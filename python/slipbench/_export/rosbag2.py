"""ROS 2 bags, written by the package rosbags.

One folder per trial, with an MCAP file and metadata.yaml, for `ros2 bag play`.
"""

from __future__ import annotations

import heapq
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from slipbench import Arrays, Dataset, InputError, StoredTrial
from slipbench._data import check_units
from slipbench._export.card import CARDS, check_card, without_folders, write_card
from slipbench._export.meanings import LABELS, codes_of
from slipbench._export.request import Output, Progress, Request, split_of
from slipbench._export.series import Series, body_series, control_series, sensor_at
from slipbench.bin import _core

PACKAGE = "slipbench_msgs"
NOTICE = "# Written by slipbench: a message of the package slipbench_msgs.\n"
# The driver's messages, from its documentation (papillarray_interfaces/README_zh.md of
# langxin11/contactile-papillarray-ros2) and the vendor's manual PTSROS_2.0_MAN_MAR23, tables 7.2
# and 7.3.
PILLAR_STATE = """int64 id
float32 dx  # mm, tip's displacement
float32 dy
float32 dz
float32 fx  # N
float32 fy
float32 fz
bool in_contact
int64 slip_state  # -2 not in contact at the start, -1 lost contact, 1 in contact, 2 tangentially loaded, 3 slipped; 0 unknown
"""
SENSOR_STATE = """std_msgs/Header header
int64 tus  # us, the sensor's time
PillarState[] pillars
float32 gfx  # N, of all pillars
float32 gfy
float32 gfz
float32 gtx  # N mm, about the displaced tip of the centre pillar
float32 gty
float32 gtz
float32 friction_est  # -1: not estimated
float32 target_grip_force  # N, -1: not estimated
bool is_sd_active
bool is_ref_loaded
bool is_contact
"""
DRIVER = "papillarray_interfaces/msg/"
HEADER, TIME = "std_msgs/msg/Header", "builtin_interfaces/msg/Time"
FORMAT: Final = 8  # version of the bag, the oldest that rosbags writes
MAGIC = b"\x89MCAP0\r\n"
PILLARS, CENTRE = _core.pillars, _core.middle_pillar
ALLOWED = "use --format parquet, which accepts any name"


def ros_name(name: str) -> str:
    """`name` with characters that ROS 2 does not allow replaced by "_".

    Allowed: a lower-case letter, then lower-case letters, digits and single "_".
    """
    plain = re.sub("_+", "_", re.sub("[^a-z0-9_]", "_", name.lower())).strip("_")
    if not plain:
        raise InputError(f"{name!r} has no letter or digit for a ROS 2 name; {ALLOWED}")
    return plain if plain[0].isalpha() else f"x_{plain}"


def _camel(words: str) -> str:
    return "".join(word.capitalize() for word in ros_name(words).split("_"))


class Types:
    """The message types of an export.

    Attributes:
        texts: definition of each type of the package slipbench_msgs, by name
    """

    def __init__(self) -> None:
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._definitions: dict[str, str] = {}  # with comments, which the store drops
        self.texts: dict[str, str] = {}
        self._register(f"{DRIVER}PillarState", PILLAR_STATE)
        self._register(f"{DRIVER}SensorState", SENSOR_STATE)

    def _register(self, name: str, text: str) -> None:
        self._store.register(get_types_from_msg(text, name))
        self._definitions[name] = text

    def name(self, wanted: str, text: str) -> str:
        """Full name of the type of slipbench_msgs with this definition.

        `wanted`, with a number if another type has that name.
        """
        name, number = wanted, 1
        while self.texts.get(name, text) != text:
            number += 1
            name = f"{wanted}{number}"
        full = f"{PACKAGE}/msg/{name}"
        if name not in self.texts:
            self.texts[name] = text
            self._register(full, text)
        return full

    def message(self, name: str, *values: Any) -> Any:
        """A message of the type `name` with these values of its fields, in order."""
        return self._store.types[name](*values)

    def header(self, time: int, frame: str) -> Any:
        """std_msgs/Header. `time`: ns."""
        return self.message(HEADER, self.message(TIME, *divmod(time, 10**9)), frame)

    def add(self, bag: Writer, topic: Topic) -> Any:
        """Adds a topic to a bag; returns rosbags' connection."""
        generated, _ = self._store.generate_msgdef(topic.type, ros_version=2)
        own = self._definitions.get(topic.type)
        if own is not None:
            _, separator, used = generated.partition("=" * 80 + "\n")
            generated = own + separator + used
        return bag.add_connection(
            topic.name, topic.type, msgdef=generated, rihs01=self._store.hash_rihs01(topic.type)
        )

    def encoded(self, topic: Topic, connection: Any) -> Iterator[tuple[int, int, Any, Any]]:
        """Time in ns, number, connection and encoded message, for each message of a topic.

        The number is that of the connection.
        """
        for time, message in zip(topic.times, topic.messages, strict=True):
            yield time, connection.id, connection, self._store.serialize_cdr(message, topic.type)


@dataclass(frozen=True)
class Topic:
    """A topic of a bag.

    Attributes:
        name: name of the topic
        type: full name of the messages' type
        times: of the messages [ns], ascending
        messages: objects of rosbags
        about: unit, shape and value names of each field
    """

    name: str
    type: str
    times: list[int]
    messages: Iterable[Any]
    about: dict[str, str] = field(default_factory=dict)


def _unit(unit: str) -> str:
    return "dimensionless" if unit in ("", "1") else unit


def _fields(series: list[Series]) -> str:
    """Definition of messages with a header and these series as fields.

    With their units and codes.
    """
    names = [ros_name(one.name) for one in series]
    for name in names:
        if names.count(name) > 1 or name == "header":
            raise InputError(
                f"two arrays would be called {name} in a ROS 2 message: {', '.join(one.name for one in series)}; {ALLOWED}"
            )
    lines = [NOTICE, "std_msgs/Header header\n"]
    for name, one in zip(names, series, strict=True):
        codes = codes_of(one)
        kind = {"f": "float32", "u": "uint8"}[one.values.dtype.kind]
        meaning = LABELS.get(one.name) if one.kind in ("labels", "control") else None
        lines.append(f"\n# {meaning or one.name} [{'code' if codes else _unit(one.unit)}]\n")
        lines += [f"{kind} {name.upper()}_{word.upper()}={code}\n" for word, code in codes.items()]
        lines.append(f"{kind}{'[]' if one.shape else ''} {name}\n")
    return "".join(lines)


def _times(t: NDArray[np.float64], what: str) -> list[int]:
    """Nanoseconds, ascending."""
    times = np.round(t * 1e9)
    if np.any(times < 0) or np.any(np.diff(times) < 0):
        raise InputError(
            f"{what}: the times do not ascend from 0, as a bag requires; use --format parquet"
        )
    return times.astype(np.int64).tolist()  # type: ignore[no-any-return]


def _about(series: list[Series]) -> dict[str, str]:
    """Unit, shape and value names of each field."""
    return {
        ros_name(
            one.name
        ): f"unit {_unit(one.unit)}; shape {list(one.shape)}; values {', '.join(one.columns)}"
        for one in series
    }


def _series_topic(topic: str, wanted: str, series: list[Series], frame: str, types: Types) -> Topic:
    """A topic of slipbench_msgs with these series, which share their times, as fields."""
    name, times = types.name(wanted, _fields(series)), _times(series[0].t, topic)
    columns: list[Any] = []
    for one in series:
        values = np.ascontiguousarray(one.values, {"f": "f4", "u": "u1"}[one.values.dtype.kind])
        columns.append(values.reshape(len(times), -1) if one.shape else values.ravel().tolist())
    messages = (
        types.message(name, types.header(time, frame), *row)
        for time, *row in zip(times, *columns, strict=True)
    )
    return Topic(topic, name, times, messages, _about(series))


def _slip_states(
    labels: dict[str, Series], rule: str | None, count: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Returns the driver's code of each pillar [T, 9], and the loads of the centre pillar [T].

    The codes follow from the truth. A load is True if the centre pillar is loaded.
    """
    if "unit_state" not in labels:
        return np.full((count, PILLARS), _core.vendor_state_unknown), np.zeros(count, bool)
    states, loaded = _core.vendor_states(
        labels["unit_state"].values.astype(np.uint8, copy=False),
        labels["slip_velocity"].values.astype(np.float32, copy=False),
        labels["force"].values.astype(np.float32, copy=False),
        rule or "strict",
    )
    return states, loaded.astype(bool)


def _torque(
    force: NDArray[np.float64], displacement: NDArray[np.float64], labels: Arrays | None
) -> NDArray[np.float64]:
    """[T, 3] N mm about the displaced tip of the centre pillar.

    NaN if the positions of the pillars are unknown.
    """
    if labels is None or "unit_positions" not in labels.attrs:
        return np.full((len(force), 3), np.nan)
    tips = (
        np.column_stack([labels.attrs["unit_positions"], labels.attrs["unit_heights"]])
        + displacement
    )
    x, y, z = np.moveaxis(1e3 * (tips - tips[:, [CENTRE]]), -1, 0)
    fx, fy, fz = np.moveaxis(force, -1, 0)
    return np.stack(
        [
            (y * fz - z * fy).sum(axis=1),
            (z * fx - x * fz).sum(axis=1),
            (x * fy - y * fx).sum(axis=1),
        ],
        axis=1,
    )


def _is_of_the_driver(channels: list[Series]) -> bool:
    """True if the channels are exactly those published by the PapillArray's driver."""
    return {one.name: one.shape for one in channels} == dict.fromkeys(
        ("force", "displacement"), (PILLARS, 3)
    )


def _sensor_state(
    number: int,
    sensor: str,
    channels: list[Series],
    labels: list[Series],
    group: Arrays | None,
    rule: str | None,
    types: Types,
) -> Topic:
    """A PapillArray's topic in the driver's format; `number`: number of the sensor at its hub."""
    values = {one.name: one for one in channels}
    check_units(
        f"sensor {sensor}: the message of the PapillArray's driver",
        {one.name: one.unit for one in channels},
        {"force": "N", "displacement": "m"},
    )
    force, displacement = (values[name].values for name in ("force", "displacement"))
    topic, count = f"/hub_0/sensor_{number}", len(force)
    times = _times(values["force"].t, topic)
    newtons: Any = force.reshape(count, PILLARS, 3)
    metres = displacement.reshape(count, PILLARS, 3).astype(float)
    states, reference = _slip_states({one.name: one for one in labels}, rule, count)
    contact = newtons[..., 2] >= _core.vendor_contact_force
    pillars = zip(
        (1e3 * metres).astype(np.float32).tolist(),
        newtons.tolist(),
        contact.tolist(),
        states.tolist(),
        strict=True,
    )
    sums = np.concatenate(
        [newtons.sum(axis=1, dtype=float), _torque(newtons.astype(float), metres, group)], axis=1
    )
    active = bool(labels) and bool(np.any(states))

    def messages() -> Iterator[Any]:
        for time, of_pillars, total, loaded in zip(
            times, pillars, sums.tolist(), reference.tolist(), strict=True
        ):
            each = [
                types.message(f"{DRIVER}PillarState", pillar, *moved, *pushed, touches, state)
                for pillar, (moved, pushed, touches, state) in enumerate(
                    zip(*of_pillars, strict=True)
                )
            ]
            header = types.header(time, f"hub_0/sensor_{number}")
            yield types.message(
                f"{DRIVER}SensorState",
                *(header, time // 1000, each, *total, -1.0, -1.0),
                *(active, loaded, any(of_pillars[2])),
            )

    return Topic(topic, f"{DRIVER}SensorState", times, messages(), {"sensor": sensor})


def _sensor_topics(
    sensor: str, kind: str, channels: list[Series], own_times: set[str], types: Types
) -> Iterator[Topic]:
    """One topic for all channels with common times.

    Channels with their own times have separate topics.
    """
    topic, together = f"/sensors/{ros_name(sensor)}", []
    for one in channels:
        if one.name in own_times:
            yield _series_topic(
                f"{topic}/{ros_name(one.name)}", _camel(f"{kind}_{one.name}"), [one], sensor, types
            )
        else:
            together.append(one)
    if together:
        yield _series_topic(topic, _camel(kind), together, sensor, types)


def _events(sensor: str, events: Arrays, types: Types) -> Topic:
    """One message for each change of a unit's contact state."""
    topic = f"/truth/{ros_name(sensor)}/events"
    t, unit, kind = (events[name][:] for name in ("t", "unit", "kind"))
    key = Series(
        "labels", sensor, "kind", "1", str(events["kind"].attrs["codes"]), ("kind",), (), t, kind
    )
    text = (
        _fields([key])
        + "\n# number of the unit\nuint32 unit\n\n# exact time, resolved inside the time step [s]\nfloat64 t\n"
    )
    times, name = _times(t, topic), types.name("Event", text)
    messages = (
        types.message(name, types.header(time, sensor), *row)
        for time, *row in zip(times, kind.tolist(), unit.tolist(), t.tolist(), strict=True)
    )
    return Topic(topic, name, times, messages)


def _transforms(times: list[int], poses: list[Series], types: Types) -> Iterator[Any]:
    """Messages with the poses of all bodies in the frame `world`."""
    of = "geometry_msgs/msg/"
    rows = [one.values.astype(float).tolist() for one in poses]
    for time, *places in zip(times, *rows, strict=True):
        header = types.header(time, "world")
        yield types.message(
            "tf2_msgs/msg/TFMessage",
            [
                types.message(
                    f"{of}TransformStamped",
                    header,
                    one.owner,
                    types.message(
                        f"{of}Transform",
                        types.message(f"{of}Vector3", x, y, z),
                        types.message(f"{of}Quaternion", qx, qy, qz, qw),
                    ),
                )
                for one, (x, y, z, qw, qx, qy, qz) in zip(poses, places, strict=True)
            ],
        )


def _twists(times: list[int], velocity: Series, types: Types) -> Iterator[Any]:
    """Messages with the velocity of a body in the frame `world`."""
    of = "geometry_msgs/msg/"
    for time, row in zip(times, velocity.values.astype(float).tolist(), strict=True):
        linear, angular = (types.message(f"{of}Vector3", *part) for part in (row[:3], row[3:]))
        twist = types.message(f"{of}Twist", linear, angular)
        yield types.message(f"{of}TwistStamped", types.header(time, "world"), twist)


def _body_topics(trial: StoredTrial, types: Types) -> Iterator[Topic]:
    """Poses of all bodies, then the velocity of each."""
    series = list(body_series(trial))
    poses, velocities = (
        [one for one in series if one.name == name] for name in ("pose", "velocity")
    )
    if not poses:
        return
    times = _times(poses[0].t, "/truth/tf")
    yield Topic("/truth/tf", "tf2_msgs/msg/TFMessage", times, _transforms(times, poses, types))
    for one in velocities:
        yield Topic(
            f"/truth/velocity/{ros_name(one.owner)}",
            "geometry_msgs/msg/TwistStamped",
            times,
            _twists(times, one, types),
        )


def _topics(number: int, trial: StoredTrial, request: Request, types: Types) -> Iterator[Topic]:
    hub = 0
    for sensor in request.sensors:
        group = trial.sensors[sensor]
        channels, labels = sensor_at(number, trial, sensor, request.labels, request.rate)
        truth = trial.labels.get(sensor)
        if group.attrs["type"] == "papillarray" and _is_of_the_driver(channels):
            yield _sensor_state(hub, sensor, channels, labels, truth, request.labels, types)
            hub += 1
        else:
            own = {
                one.name for one in channels if request.rate is None and f"{one.name}_t" in group
            }
            yield from _sensor_topics(sensor, str(group.attrs["type"]), channels, own, types)
        if labels:
            yield _series_topic(f"/truth/{ros_name(sensor)}", "Labels", labels, sensor, types)
        if truth is not None and "events" in truth:
            yield _events(sensor, trial.labels[sensor]["events"], types)
    yield from _body_topics(trial, types)
    if trial.control is not None:
        yield _series_topic("/control", "Control", list(control_series(trial)), "", types)


def _checked(topics: list[Topic]) -> list[Topic]:
    names = [topic.name for topic in topics]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"two sensors or channels would have the topic {name}: their names differ in characters that ROS 2 does not allow; {ALLOWED}"
            )
    return topics


XML = '<?xml version="1.0"?>\n<!-- Written by slipbench. -->\n'
CMAKE = "# Written by slipbench: the package slipbench_msgs.\n"


def _package(types: Types, version: str) -> Iterator[tuple[str, str]]:
    """The files of the package slipbench_msgs for `colcon build`."""
    names = sorted(types.texts)
    yield (
        f"{PACKAGE}/package.xml",
        (
            f'{XML}<package format="3">\n  <name>{PACKAGE}</name>\n  <version>{version}</version>\n'
            "  <description>Messages of recordings that slipbench has exported</description>\n"
            '  <maintainer email="nobody@example.com">slipbench</maintainer>\n  <license>MIT</license>\n'
            "  <buildtool_depend>ament_cmake</buildtool_depend>\n  <buildtool_depend>rosidl_default_generators</buildtool_depend>\n"
            "  <depend>std_msgs</depend>\n  <exec_depend>rosidl_default_runtime</exec_depend>\n"
            "  <member_of_group>rosidl_interface_packages</member_of_group>\n  <export>\n    <build_type>ament_cmake</build_type>\n  </export>\n</package>\n"
        ),
    )
    yield (
        f"{PACKAGE}/CMakeLists.txt",
        (
            f"{CMAKE}cmake_minimum_required(VERSION 3.8)\nproject({PACKAGE})\nfind_package(ament_cmake REQUIRED)\n"
            "find_package(rosidl_default_generators REQUIRED)\nfind_package(std_msgs REQUIRED)\n"
            f"rosidl_generate_interfaces(${{PROJECT_NAME}}\n  {' '.join(f'msg/{name}.msg' for name in names)}\n  DEPENDENCIES std_msgs)\n"
            "ament_export_dependencies(rosidl_default_runtime)\nament_package()\n"
        ),
    )
    for name in names:
        yield f"{PACKAGE}/msg/{name}.msg", types.texts[name]


BEGINNINGS = (
    MAGIC,
    b"rosbag2_bagfile_information:",
    NOTICE.encode(),
    XML.encode(),
    CMAKE.encode(),
    *CARDS,
)


def _is_left(path: Path) -> bool:
    """True if a killed export may have left `path` in the folder of _scratch()."""
    bag = re.fullmatch(r"demo_\d+", path.name)
    return (
        bag is not None
        and path.is_dir()
        and not path.is_symlink()
        and {one.name for one in path.iterdir()} <= {f"{path.name}.mcap", "metadata.yaml"}
    )


@contextmanager
def _scratch(folder: Path) -> Iterator[Path]:
    """A folder in which rosbags writes a bag: it opens files under their own names.

    Raises InputError if the folder exists with other content than that of a killed export.
    """
    scratch = folder / "rosbag2.partial"
    if scratch.is_symlink() or (
        scratch.exists() and not (scratch.is_dir() and all(map(_is_left, scratch.iterdir())))
    ):
        raise InputError(
            f"{scratch}: would be removed, but is not left by a killed export; choose another --output"
        )
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    try:
        yield scratch
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _write_bag(bag: Path, topics: list[Topic], types: Types, about: dict[str, str]) -> None:
    """Writes the bag `bag`, with the messages in the order of their times."""
    writer = Writer(bag, version=FORMAT, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    for key, text in about.items():
        writer.set_custom_data(key, text)
    with writer:
        encoded = [types.encoded(topic, types.add(writer, topic)) for topic in topics]
        for time, _, connection, data in heapq.merge(*encoded):
            writer.write(connection, time, data)


def _about_trial(number: int, trial: StoredTrial, part: str, data: Dataset) -> dict[str, str]:
    """Describes a trial in the metadata of its bag."""
    return {
        "trial": str(number),
        "seed": str(trial.seed),
        "sha256": trial.sha256,
        "split": part,
        "command": without_folders(data.command),
        "scene": data.scene,
    }


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes a bag for each trial, the package of their messages and a card.

    Returns the file names.
    """
    parts, types = split_of(data), Types()
    check_card(request)
    with (
        Output(request.out, "a file of a ROS 2 bag by slipbench", *BEGINNINGS) as output,
        _scratch(Path(request.out)) as scratch,
    ):
        written = 0
        for done, number in enumerate(request.trials, 1):
            trial = data[number]
            topics = _checked(list(_topics(number, trial, request, types)))
            about = _about_trial(number, trial, parts.get(number, ""), data)
            about |= {
                f"{topic.name} {key}": text for topic in topics for key, text in topic.about.items()
            }
            bag = scratch / f"demo_{number}"
            names = [f"{bag.name}/{bag.name}.mcap", f"{bag.name}/metadata.yaml"]
            files = [output.create(name) for name in names]
            _write_bag(bag, topics, types, about)
            for name, file in zip(names, files, strict=True):
                with file, (scratch / name).open("rb") as made:
                    shutil.copyfileobj(made, file)
                    written += file.tell()
            shutil.rmtree(bag)
            progress.update(done, written)
        for name, text in _package(types, data.version) if types.texts else ():
            output.write(name, text)
        write_card(data, request, output)
        progress.check()
        return output.publish()
