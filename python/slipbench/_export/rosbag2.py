"""ROS 2 bags: one folder per trial, with an MCAP file and metadata.yaml, for `ros2 bag play` and
`rosbags`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipbench import Arrays, Dataset, InputError, StoredTrial
from slipbench._data import check_units
from slipbench._export.card import CARDS, check_card, without_folders, write_card
from slipbench._export.cdr import Messages
from slipbench._export.mcap_rows import MAGIC, Topic, write_mcap
from slipbench._export.meanings import LABELS, codes_of
from slipbench._export.request import Output, Progress, Request, split_of
from slipbench._export.series import Series, body_series, control_series, sensor_at

PACKAGE = "slipbench_msgs"
NOTICE = "# Written by slipbench: a message of the package slipbench_msgs.\n"
BREAK = "=" * 80 + "\n"
# Types of ROS 2 (packages builtin_interfaces, std_msgs, geometry_msgs, tf2_msgs), from their public
# definitions.
STANDARD = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    "geometry_msgs/Transform": "Vector3 translation\nQuaternion rotation\n",
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\nTransform transform\n",
    "geometry_msgs/Twist": "Vector3 linear\nVector3 angular\n",
}
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
# PILLAR_STATE in CDR; `align` adds the padding after in_contact.
PILLAR_TYPE = np.dtype(
    [
        ("id", "<i8"),
        ("displacement", "<f4", 3),
        ("force", "<f4", 3),
        ("in_contact", "u1"),
        ("slip_state", "<i8"),
    ],
    align=True,
)
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
PILLARS, CENTRE = 9, 4
CONTACT_FORCE = 0.5  # N, reported normal force from which the vendor's software reports contact
LOADED_FORCE = (
    0.05  # N, true tangential force from which a pillar counts as loaded; the device's resolution
)
LABEL_SPEED = 1e-4  # m/s, tip speed from which a pillar slips by the rule paper
UNIT_DETACHED, UNIT_SLIP, UNIT_PARTIAL = 0, 2, 3
UNKNOWN, UNTOUCHED, CONTACT_LOST, CONTACT, LOADED, SLIPPED = 0, -2, -1, 1, 2, 3
ALLOWED = "use --format parquet, which accepts any name"


def ros_name(name: str) -> str:
    """`name` with characters that ROS 2 does not allow replaced by "_". Allowed: a lower-case
    letter, then lower-case letters, digits and single "_"."""
    plain = re.sub("_+", "_", re.sub("[^a-z0-9_]", "_", name.lower())).strip("_")
    if not plain:
        raise InputError(f"{name!r} has no letter or digit for a ROS 2 name; {ALLOWED}")
    return plain if plain[0].isalpha() else f"x_{plain}"


def _camel(words: str) -> str:
    return "".join(word.capitalize() for word in ros_name(words).split("_"))


def _definition(text: str, *used: str) -> str:
    """A definition followed by those of the types that it uses, in the encoding ros2msg."""
    return text + "".join(f"{BREAK}MSG: {name}\n{STANDARD[name]}" for name in used)


TF = _definition(
    "geometry_msgs/TransformStamped[] transforms\n",
    "geometry_msgs/TransformStamped",
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/Transform",
    "geometry_msgs/Vector3",
    "geometry_msgs/Quaternion",
)
TWIST = _definition(
    "std_msgs/Header header\nTwist twist\n",
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/Twist",
    "geometry_msgs/Vector3",
)
SENSOR = f"{_definition(SENSOR_STATE, 'std_msgs/Header', 'builtin_interfaces/Time')}{BREAK}MSG: papillarray_interfaces/PillarState\n{PILLAR_STATE}"


class Types:
    """The message types of the package slipbench_msgs used by an export.

    Attributes:
        texts: definition of each type, by name
    """

    def __init__(self) -> None:
        self.texts: dict[str, str] = {}

    def name(self, wanted: str, text: str) -> str:
        """Full name of the type with this definition: `wanted`, with a number if another type has
        that name."""
        name, number = wanted, 1
        while self.texts.setdefault(name, text) != text:
            number += 1
            name = f"{wanted}{number}"
        return f"{PACKAGE}/msg/{name}"


def _unit(unit: str) -> str:
    return "dimensionless" if unit in ("", "1") else unit


def _fields(series: list[Series]) -> str:
    """Definition of messages with a header and these series as fields, with their units and
    codes."""
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


def _times(t: NDArray[np.float64], what: str) -> NDArray[np.uint64]:
    """Nanoseconds, ascending."""
    times = np.round(t * 1e9)
    if np.any(times < 0) or np.any(np.diff(times) < 0):
        raise InputError(
            f"{what}: the times do not ascend from 0, as a bag requires; use --format parquet"
        )
    return times.astype(np.uint64)


def _about(series: list[Series]) -> dict[str, str]:
    """Metadata of a channel: unit, shape and value names of each field."""
    return {
        ros_name(
            one.name
        ): f"unit {_unit(one.unit)}; shape {list(one.shape)}; values {', '.join(one.columns)}"
        for one in series
    }


def _own(topic: str, wanted: str, series: list[Series], frame: str, types: Types) -> Topic:
    """A topic of slipbench_msgs with these series, which share their times, as fields."""
    text = _fields(series)
    times = _times(series[0].t, topic)
    messages = Messages(len(times))
    messages.header(times, frame)
    for one in series:
        kind = {"f": "<f4", "u": "u1"}[one.values.dtype.kind]
        if one.shape:
            messages.sequence(one.values, kind)
        else:
            messages.numbers(one.values, kind)
    return Topic(
        topic,
        types.name(wanted, text),
        _definition(text, "std_msgs/Header", "builtin_interfaces/Time"),
        times,
        messages,
        _about(series),
    )


def _slipping(labels: dict[str, Series], rule: str | None) -> NDArray[np.bool_]:
    """[T, 9] slip of each pillar by the rule."""
    states = labels["unit_state"].values
    if rule == "paper":
        velocity = labels["slip_velocity"].values.reshape(len(states), PILLARS, 2).astype(float)
        return np.asarray(
            (states != UNIT_DETACHED) & (np.hypot(velocity[..., 0], velocity[..., 1]) > LABEL_SPEED)
        )
    return np.asarray((states == UNIT_SLIP) | ((states == UNIT_PARTIAL) & (rule == "micro")))


def _slip_states(
    labels: dict[str, Series], rule: str | None, count: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Returns the driver's code of each pillar [T, 9], from the truth, and [T] True if the centre
    pillar is loaded."""
    if "unit_state" not in labels:
        return np.full((count, PILLARS), UNKNOWN), np.zeros(count, bool)
    touching = labels["unit_state"].values != UNIT_DETACHED
    tangential = labels["force"].values.reshape(count, PILLARS, 3)[..., :2].astype(float)
    loaded = touching & (np.hypot(tangential[..., 0], tangential[..., 1]) >= LOADED_FORCE)
    touched = np.logical_or.accumulate(touching, axis=0)
    states = np.select(
        [~touching & touched, ~touching, _slipping(labels, rule), loaded],
        [CONTACT_LOST, UNTOUCHED, SLIPPED, LOADED],
        CONTACT,
    )
    return states, loaded[:, CENTRE]


def _torque(
    force: NDArray[np.float64], displacement: NDArray[np.float64], labels: Arrays | None
) -> NDArray[np.float64]:
    """[T, 3] N mm about the displaced tip of the centre pillar; NaN if the positions of the pillars
    are unknown."""
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
    newtons = force.reshape(count, PILLARS, 3)
    metres = displacement.reshape(count, PILLARS, 3).astype(float)
    states, reference = _slip_states({one.name: one for one in labels}, rule, count)
    contact = newtons[..., 2] >= CONTACT_FORCE
    messages = Messages(count)
    messages.header(times, f"hub_0/sensor_{number}")
    messages.numbers(times // np.uint64(1000), "<i8")
    messages.numbers(PILLARS, "<u4")
    pillars = np.zeros((count, PILLARS), PILLAR_TYPE)
    pillars["id"] = np.arange(PILLARS)
    pillars["displacement"] = 1e3 * metres
    pillars["force"] = newtons
    pillars["in_contact"] = contact
    pillars["slip_state"] = states
    messages.structures(pillars)
    messages.numbers(newtons.sum(axis=1, dtype=float), "<f4")
    messages.numbers(_torque(newtons.astype(float), metres, group), "<f4")
    messages.numbers(-1.0, "<f4")
    messages.numbers(-1.0, "<f4")
    messages.numbers(bool(labels) and bool(np.any(states)), "u1")
    messages.numbers(reference, "u1")
    messages.numbers(contact.any(axis=1), "u1")
    return Topic(
        topic, "papillarray_interfaces/msg/SensorState", SENSOR, times, messages, {"sensor": sensor}
    )


def _sensor_topics(
    sensor: str, kind: str, channels: list[Series], own_times: set[str], types: Types
) -> Iterator[Topic]:
    """One topic for all channels with common times; channels with their own times have separate
    topics."""
    topic, together = f"/sensors/{ros_name(sensor)}", []
    for one in channels:
        if one.name in own_times:
            yield _own(
                f"{topic}/{ros_name(one.name)}", _camel(f"{kind}_{one.name}"), [one], sensor, types
            )
        else:
            together.append(one)
    if together:
        yield _own(topic, _camel(kind), together, sensor, types)


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
    times = _times(t, topic)
    messages = Messages(len(times))
    messages.header(times, sensor)
    messages.numbers(kind, "u1")
    messages.numbers(unit, "<u4")
    messages.numbers(t, "<f8")
    return Topic(
        topic,
        types.name("Event", text),
        _definition(text, "std_msgs/Header", "builtin_interfaces/Time"),
        times,
        messages,
    )


def _body_topics(trial: StoredTrial) -> Iterator[Topic]:
    """Poses of all bodies in the frame `world`, then the velocity of each."""
    series = list(body_series(trial))
    poses, velocities = (
        [one for one in series if one.name == name] for name in ("pose", "velocity")
    )
    if not poses:
        return
    times = _times(poses[0].t, "/truth/tf")
    messages = Messages(len(times))
    messages.numbers(len(poses), "<u4")
    for one in poses:
        messages.header(times, "world")
        messages.text(one.owner)
        messages.numbers(one.values[:, [0, 1, 2, 4, 5, 6, 3]], "<f8")  # position, then x, y, z, w
    yield Topic("/truth/tf", "tf2_msgs/msg/TFMessage", TF, times, messages)
    for one in velocities:
        messages = Messages(len(times))
        messages.header(times, "world")
        messages.numbers(one.values, "<f8")
        yield Topic(
            f"/truth/velocity/{ros_name(one.owner)}",
            "geometry_msgs/msg/TwistStamped",
            TWIST,
            times,
            messages,
        )


def _topics(number: int, trial: StoredTrial, request: Request, types: Types) -> Iterator[Topic]:
    hub = 0
    for sensor in request.sensors:
        group = trial.sensors[sensor]
        channels, labels = sensor_at(number, trial, sensor, request.labels, request.rate)
        truth = trial.labels.get(sensor)
        if group.attrs["type"] == "papillarray" and _is_of_the_driver(channels):
            yield _sensor_state(hub, sensor, channels, labels, truth, request.labels)
            hub += 1
        else:
            own = {
                one.name for one in channels if request.rate is None and f"{one.name}_t" in group
            }
            yield from _sensor_topics(sensor, str(group.attrs["type"]), channels, own, types)
        if labels:
            yield _own(f"/truth/{ros_name(sensor)}", "Labels", labels, sensor, types)
        if truth is not None and "events" in truth:
            yield _events(sensor, trial.labels[sensor]["events"], types)
    yield from _body_topics(trial)
    if trial.control is not None:
        yield _own("/control", "Control", list(control_series(trial)), "", types)


def _checked(topics: list[Topic]) -> list[Topic]:
    names = [topic.name for topic in topics]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"two sensors or channels would have the topic {name}: their names differ in characters that ROS 2 does not allow; {ALLOWED}"
            )
    return topics


def _metadata(file: str, topics: list[Topic]) -> str:
    """metadata.yaml of version 5, the oldest with a list of files; later versions of rosbag2 read
    it too."""
    filled = [topic.times for topic in topics if len(topic.times)]
    start, end = min(int(times[0]) for times in filled), max(int(times[-1]) for times in filled)
    count = sum(map(len, filled))
    listed = "".join(
        f"    - topic_metadata:\n        name: {topic.name}\n        type: {topic.type}\n        serialization_format: cdr\n"
        f'        offered_qos_profiles: ""\n      message_count: {len(topic.times)}\n'
        for topic in topics
    )
    return (
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
        f"  duration:\n    nanoseconds: {end - start}\n  starting_time:\n    nanoseconds_since_epoch: {start}\n"
        f"  message_count: {count}\n  topics_with_message_count:\n{listed}"
        f'  compression_format: ""\n  compression_mode: ""\n  relative_file_paths:\n    - {file}\n'
        f"  files:\n    - path: {file}\n      starting_time:\n        nanoseconds_since_epoch: {start}\n"
        f"      duration:\n        nanoseconds: {end - start}\n      message_count: {count}\n"
    )


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


def _write_trial(
    number: int,
    trial: StoredTrial,
    data: Dataset,
    request: Request,
    types: Types,
    output: Output,
    about: dict[str, str],
) -> int:
    """Writes demo_<k>/ and returns its size in bytes."""
    folder = f"demo_{number}"
    file = f"{folder}_0.mcap"
    topics = _checked(list(_topics(number, trial, request, types)))
    with output.create(f"{folder}/{file}") as stream:
        write_mcap(stream, topics, "ros2", f"slipbench {data.version}", ("ros2msg", "cdr"), about)
        size = stream.tell()
    output.write(f"{folder}/metadata.yaml", _metadata(file, topics))
    return size


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes a bag for each trial, the package of their messages and a card; returns the file
    names."""
    parts, types = split_of(data), Types()
    check_card(request)
    with Output(request.out, "a file of a ROS 2 bag by slipbench", *BEGINNINGS) as output:
        written = 0
        for done, number in enumerate(request.trials, 1):
            trial = data[number]
            about: dict[str, Any] = {
                "trial": number,
                "seed": trial.seed,
                "sha256": trial.sha256,
                "split": parts.get(number, ""),
                "command": without_folders(data.command),
                "scene": data.scene,
            }
            written += _write_trial(
                number,
                trial,
                data,
                request,
                types,
                output,
                {key: str(value) for key, value in about.items()},
            )
            progress.update(done, written)
        if types.texts:
            for name, text in _package(types, data.version):
                output.write(name, text)
        write_card(data, request, output)
        progress.check()
        return output.publish()
