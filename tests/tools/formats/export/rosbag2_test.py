"""`export --format rosbag2`: the package rosbags, which needs no ROS, reads every message back.

Arguments: the project's root, the program.
"""

import itertools
import json
import shutil
import unittest

import h5py
import numpy as np
import yaml
from _made import ExportTest, contents, export, for_each_scene, import_table, make
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

# Message definitions of the driver and the standard packages. ROS 2 compares their hashes, so these
# must be equal.
DRIVER = {
    "papillarray_interfaces/msg/PillarState": "int64 id\nfloat32 dx\nfloat32 dy\nfloat32 dz\nfloat32 fx\nfloat32 fy\nfloat32 fz\nbool in_contact\nint64 slip_state\n",
    "papillarray_interfaces/msg/SensorState": "std_msgs/Header header\nint64 tus\nPillarState[] pillars\nfloat32 gfx\nfloat32 gfy\nfloat32 gfz\nfloat32 gtx\nfloat32 gty\nfloat32 gtz\n"
    "float32 friction_est\nfloat32 target_grip_force\nbool is_sd_active\nbool is_ref_loaded\nbool is_contact\n",
}


def read(folder):
    """Returns the messages of each topic, the topics' types, and the store of those types.

    The messages are {topic: (times in ns, decoded messages, their raw bytes)}.
    """
    topics, types = {}, {}
    with AnyReader([folder]) as reader:
        for connection in reader.connections:
            topics[connection.topic] = ([], [], [])
            types[connection.topic] = connection.msgtype
        for connection, time, raw in reader.messages():
            times, messages, data = topics[connection.topic]
            assert not times or time >= times[-1], (
                f"{connection.topic}: {time} ns comes after {times[-1]} ns"
            )
            message = reader.deserialize(raw, connection.msgtype)
            times.append(time)
            messages.append(message)
            data.append(bytes(raw))
            if len(messages) <= 2:  # the serialiser of rosbags gives the same bytes
                assert bytes(reader.typestore.serialize_cdr(message, connection.msgtype)) == bytes(
                    raw
                ), connection.topic
        return topics, types, reader.typestore


def nanoseconds(t):
    return [round(1e9 * one) for one in t]


def stamps(messages):
    return [10**9 * one.header.stamp.sec + one.header.stamp.nanosec for one in messages]


class Rosbag2(ExportTest):
    def same(self, found, expected, what):
        expected = expected.reshape(len(expected), -1)
        found = np.asarray(found, expected.dtype).reshape(len(found), -1)
        self.assertEqual(found.shape, expected.shape, what)
        self.assertEqual(found.tobytes(), np.ascontiguousarray(expected).tobytes(), what)

    def check_own(self, topics, topic, times, arrays):
        found, messages, _ = topics.pop(topic)
        self.assertEqual(found, nanoseconds(times), topic)
        self.assertEqual(stamps(messages), found, topic)
        for name, array in arrays.items():
            self.same(
                [np.reshape(getattr(one, name), -1) for one in messages],
                array[:],
                f"{topic}.{name}",
            )
            for word, code in json.loads(array.attrs.get("codes", "{}")).items():
                self.assertEqual(getattr(messages[0], f"{name}_{word}".upper()), code)

    def check_papillarray(self, topics, number, demo, sensor):
        """Compares the driver's message with the dataset.

        Each rule is implemented independently.
        """
        group, labels = demo["sensors"][sensor], demo["labels"][sensor]
        found, messages, _ = topics.pop(f"/hub_0/sensor_{number}")
        self.assertEqual(found, nanoseconds(group["t"]))
        self.assertEqual(stamps(messages), found)
        self.assertEqual([one.tus for one in messages], [time // 1000 for time in found])
        force, metres = group["force"][:], group["displacement"][:]
        self.assertEqual(
            {tuple(pillar.id for pillar in one.pillars) for one in messages}, {tuple(range(9))}
        )
        self.same([[[p.fx, p.fy, p.fz] for p in one.pillars] for one in messages], force, "force")
        self.same(
            [[[p.dx, p.dy, p.dz] for p in one.pillars] for one in messages],
            (1e3 * metres.astype(float)).astype("f4"),
            "displacement in mm",
        )
        self.same(
            [[p.in_contact for p in one.pillars] for one in messages],
            force[..., 2] >= 0.5,
            "contact from 0.5 N",
        )
        self.assertEqual(
            [one.is_contact for one in messages], (force[..., 2] >= 0.5).any(axis=1).tolist()
        )
        np.testing.assert_allclose(
            [[one.gfx, one.gfy, one.gfz] for one in messages],
            force.sum(axis=1, dtype=float),
            rtol=1e-6,
            atol=1e-6,
        )
        tips = (
            np.concatenate(
                [labels.attrs["unit_positions"], labels.attrs["unit_heights"][:, np.newaxis]],
                axis=1,
            )
            + metres
        )
        torque = np.cross(1e3 * (tips - tips[:, 4:5]), force).sum(axis=1)
        np.testing.assert_allclose(
            [[one.gtx, one.gty, one.gtz] for one in messages], torque, rtol=1e-5, atol=1e-4
        )  # N mm; float32 of some 10 N mm
        self.assertEqual(
            {(one.friction_est, one.target_grip_force, one.is_sd_active) for one in messages},
            {(-1.0, -1.0, True)},
        )
        states, true_force = labels["unit_state"][:], labels["force"][:].astype(float)
        for pillar in range(9):
            touched = False
            for row, message in enumerate(messages):
                state, loaded = states[row, pillar], np.hypot(*true_force[row, pillar, :2]) >= 0.05
                touched = touched or state != 0
                expected = (
                    (-1 if touched else -2)
                    if state == 0
                    else 3
                    if state == 2
                    else 2
                    if loaded
                    else 1
                )
                self.assertEqual(message.pillars[pillar].slip_state, expected, (row, pillar))
                if pillar == 4:
                    self.assertEqual(message.is_ref_loaded, bool(state != 0 and loaded))

    def check_sensor(self, topics, demo, sensor):
        group, together = demo["sensors"][sensor], {}
        for channel in group.attrs["channels"]:
            if f"{channel}_t" in group:
                self.check_own(
                    topics,
                    f"/sensors/{sensor}/{channel}",
                    group[f"{channel}_t"],
                    {channel: group[channel]},
                )
            else:
                together[channel] = group[channel]
        if together:
            self.check_own(topics, f"/sensors/{sensor}", group["t"], together)

    def check_truth(self, topics, demo, sensor):
        group = demo["labels"][sensor]
        self.check_own(
            topics,
            f"/truth/{sensor}",
            group["t"],
            {name: group[name] for name in set(group) - {"t", "events"}},
        )
        _, messages, _ = topics.pop(
            f"/truth/{sensor}/events"
        )  # has no message if no unit changes its state
        for name in ("t", "unit", "kind"):
            self.assertEqual(
                [getattr(one, name) for one in messages], group[f"events/{name}"][:].tolist(), name
            )

    def check_bodies(self, topics, demo):
        times, poses, _ = topics.pop("/truth/tf")
        for number, (body, group) in enumerate(demo["truth"].items()):
            self.assertEqual(times, nanoseconds(group["t"]))
            transforms = [one.transforms[number] for one in poses]
            self.assertEqual(
                {(one.header.frame_id, one.child_frame_id) for one in transforms}, {("world", body)}
            )
            self.assertEqual(stamps(transforms), times)
            places = [(one.transform.translation, one.transform.rotation) for one in transforms]
            self.same(
                [[at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z] for at, turn in places],
                group["pose"][:],
                body,
            )
            _, twists, _ = topics.pop(f"/truth/velocity/{body}")
            moving = [(one.twist.linear, one.twist.angular) for one in twists]
            self.same(
                [[v.x, v.y, v.z, w.x, w.y, w.z] for v, w in moving], group["velocity"][:], body
            )

    @for_each_scene("rosbag2")
    def test_every_value_comes_back(self, dataset, out):
        with h5py.File(dataset) as file:
            for name, demo in file["data"].items():
                topics, types, store = read(out / name)
                hub = 0
                for sensor, group in demo["sensors"].items():
                    if group.attrs["type"] == "papillarray":
                        self.check_papillarray(topics, hub, demo, sensor)
                        self.check_driver(types[f"/hub_0/sensor_{hub}"], store)
                        hub += 1
                    else:
                        self.check_sensor(topics, demo, sensor)
                    self.check_truth(topics, demo, sensor)
                self.check_bodies(topics, demo)
                if "control" in demo:
                    self.check_own(
                        topics,
                        "/control",
                        demo["control/t"],
                        {array: demo["control"][array] for array in set(demo["control"]) - {"t"}},
                    )
                self.assertEqual(topics, {})
                self.check_package(out, types, store)

    def check_driver(self, name, store):
        """The type has the hash of the driver's.

        ROS 2 compares it before it delivers a message.
        """
        self.assertEqual(name, "papillarray_interfaces/msg/SensorState")
        driver = get_typestore(Stores.ROS2_HUMBLE)
        for kind, text in DRIVER.items():
            driver.register(get_types_from_msg(text, kind))
        self.assertEqual(store.hash_rihs01(name), driver.hash_rihs01(name))

    def check_package(self, out, types, store):
        """slipbench_msgs holds the definitions of the bag.

        Those of ROS 2 itself have ROS 2's hashes.
        """
        package = get_typestore(Stores.ROS2_HUMBLE)
        for path in (out / "slipbench_msgs/msg").glob("*.msg"):
            package.register(
                get_types_from_msg(path.read_text(), f"slipbench_msgs/msg/{path.stem}")
            )
            self.assertIn(
                f"msg/{path.stem}.msg", (out / "slipbench_msgs/CMakeLists.txt").read_text()
            )
        for kind in types.values():
            if not kind.startswith("papillarray_interfaces"):
                self.assertEqual(store.hash_rihs01(kind), package.hash_rihs01(kind), kind)

    def test_the_file_is_whole_and_says_what_the_trial_was(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        export(dataset, out, "--format", "rosbag2")
        before = contents(out)
        self.assertEqual(
            {name for name in before if name.startswith("demo_1")},
            {"demo_1/demo_1.mcap", "demo_1/metadata.yaml"},
        )
        with (out / "demo_1/demo_1.mcap").open("rb") as recording, h5py.File(dataset) as file:
            reader = make_reader(recording, validate_crcs=True)
            summary = reader.get_summary()
            counts = {}
            for _, channel, _ in reader.iter_messages():
                counts[channel.id] = counts.get(channel.id, 0) + 1
            self.assertEqual(summary.statistics.channel_message_counts, counts)
            self.assertEqual(reader.get_header().profile, "ros2")
            self.assertEqual({(one.encoding) for one in summary.schemas.values()}, {"ros2msg"})
            for one, following in itertools.pairwise(summary.chunk_indexes):
                self.assertLessEqual(one.message_end_time, following.message_start_time)
            metadata = yaml.safe_load((out / "demo_1/metadata.yaml").read_text())
            about = metadata["rosbag2_bagfile_information"]["custom_data"]
            self.assertEqual(
                (about["trial"], about["sha256"]), ("1", file["data/demo_1"].attrs["sha256"])
            )
            # As the label `slip_velocity` is stored: of 9 pillars, x and y.
            self.assertRegex(
                about["/truth/pad slip_velocity"], r"^unit m/s; shape \[9, 2\]; values "
            )
        export(dataset, out, "--format", "rosbag2")  # replaces its own files
        self.assertEqual(contents(out), before)

    def test_the_card_explains_every_code_and_array(self):
        dataset = make("grasp/two_skins.yaml")
        out = self.folder / "out"
        export(dataset, out, "--format", "rosbag2")
        _, front, text = (out / "README.md").read_text().split("---\n", 2)
        about = yaml.safe_load(front)
        self.assertEqual(about["task_categories"], ["robotics"])
        self.assertLessEqual({"tactile-sensing", "slip-detection"}, set(about["tags"]))
        with h5py.File(dataset) as file:
            demo = file["data/demo_0"]
            self.assertIn(file.attrs["scene"].rstrip(), text)
            self.assertIn(f"`{demo.attrs['sha256']}`", text)
            self.assertNotIn(str(self.folder), text)
            arrays = {
                (f"labels of `{sensor}`", name): array
                for sensor, group in demo["labels"].items()
                for name, array in group.items()
                if name not in ("t", "events")
            }
            arrays |= {
                (f"sensor `{sensor}`", name): group[name]
                for sensor, group in demo["sensors"].items()
                for name in group.attrs["channels"]
            }
            for (owner, name), array in arrays.items():
                (line,) = [
                    line
                    for line in text.splitlines()
                    if line.startswith(f"| {owner} | `{name}` | {list(array.shape[1:])} |")
                ]
                for word, code in json.loads(array.attrs.get("codes", "{}")).items():
                    self.assertIn(f"{code} {word}", line)
                if "codes" not in array.attrs and array.attrs["unit"] != "1":
                    self.assertIn(f"| {array.attrs['unit']} |", line)
            self.assertRegex(text, r"`state` \| \[\] \| code \| .*rule strict: ")
            self.assertRegex(text, r"`state_micro` \| \[\] \| code \| .*rule micro: ")

    def test_the_rule_of_labels_decides_the_drivers_code(self):
        dataset = make("papillarray/stage.yaml")
        export(
            dataset, self.folder / "out", "--format", "rosbag2", "--labels", "micro", "--trial", "0"
        )
        topics, _, _ = read(self.folder / "out/demo_0")
        with h5py.File(dataset) as file:
            states = file["data/demo_0/labels/pad/unit_state"][:]
        found = np.array(
            [
                [pillar.slip_state == 3 for pillar in one.pillars]
                for one in topics["/hub_0/sensor_0"][1]
            ]
        )
        self.assertEqual(found.tolist(), (states >= 2).tolist())  # slip or partial
        self.assertFalse(hasattr(topics["/truth/pad"][1][0], "state"))
        self.assertTrue(hasattr(topics["/truth/pad"][1][0], "state_micro"))

    def test_only_its_own_files_are_replaced(self):
        out = self.folder / "out"
        out.mkdir()
        (out / "demo_1").mkdir()
        (out / "demo_1/metadata.yaml").write_text("my notes")
        _, said = export(make("papillarray/stage.yaml"), out, "--format", "rosbag2", status=2)
        self.assertRegex(said, "metadata.yaml.*ROS 2 bag.*another folder")
        self.assertEqual(contents(out), {"demo_1/metadata.yaml": b"my notes"})

    def test_a_folder_that_no_export_has_left_is_not_removed(self):
        """A killed export leaves rosbag2.partial/demo_0 with an .mcap and metadata.yaml."""
        out = self.folder / "out"
        scratch = out / "rosbag2.partial"
        for foreign in ("notes.txt", "demo_0/notes.txt", "demo_0/more/a.mcap", "bag/bag.mcap"):
            with self.subTest(foreign=foreign):
                path = scratch / foreign
                path.parent.mkdir(parents=True)
                path.write_text("my notes")
                _, said = export(
                    make("papillarray/stage.yaml"), out, "--format", "rosbag2", status=2
                )
                self.assertRegex(said, "rosbag2.partial: would be removed, but is not left by")
                self.assertEqual(contents(out), {f"rosbag2.partial/{foreign}": b"my notes"})
                shutil.rmtree(scratch)
        (scratch / "demo_0").mkdir(parents=True)
        for name in ("demo_0.mcap", "metadata.yaml"):
            (scratch / "demo_0" / name).touch()
        export(make("papillarray/stage.yaml"), out, "--format", "rosbag2", "--trial", "0")
        self.assertFalse(scratch.exists())

    def test_a_papillarray_in_other_units_than_the_driver_is_refused(self):
        names = [f"{kind}{k}" for kind in "fd" for k in range(27)]
        rows = "".join(",".join([f"{0.01 * k:.2f}", *["1"] * 54]) + "\n" for k in range(3))
        dataset = import_table(
            self.folder,
            "t," + ",".join(names) + "\n" + rows,
            "sensor: pad\ntype: papillarray\ntime: {column: t}\nchannels:\n"
            "  force: {unit: counts, components: 3, columns: [f0 .. f26]}\n  displacement: {unit: mm, components: 3, columns: [d0 .. d26]}\n",
        )
        _, said = export(dataset, self.folder / "out", "--format", "rosbag2", status=2)
        self.assertRegex(said, "pad.*channel force is in 'counts', but it is read in N; .*scale")

    def test_a_papillarray_with_other_channels_than_the_driver_has_its_own_message(self):
        dataset = import_table(
            self.folder,
            "t,x,y,z,d\n0,0.1,0,2.4,0.33\n0.01,0.2,0,2.5,0.34\n",
            "sensor: a\ntype: papillarray\ntime: {column: t}\n"
            "channels: {force: {unit: N, components: 3, columns: [x, y, z]}, depth: {unit: m, scale: 1e-3, columns: [d]}}\n",
        )
        export(dataset, self.folder / "out", "--format", "rosbag2")
        topics, types, _ = read(self.folder / "out/demo_0")
        self.assertEqual(types, {"/sensors/a": "slipbench_msgs/msg/Papillarray"})
        with h5py.File(dataset) as file:
            group = file["data/demo_0/sensors/a"]
            self.check_own(
                topics, "/sensors/a", group["t"], {"force": group["force"], "depth": group["depth"]}
            )


if __name__ == "__main__":
    unittest.main()
