"""`export --format mcap`: two independent readers find every message with bit-exact values.

The first is the package mcap, whose records the writer uses, with Google's protobuf; the second is
pybag, which shares no code with it. Arguments: the project's root, the program.
"""

import itertools
import json
import unittest

import h5py
import numpy as np
import pybag.mcap.record_reader
from _made import SCENES, ExportTest, contents, export, for_each_scene, make
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

LAYOUT, CARDS = "foxglove-layout.json", ("README.md", "croissant.json")


def read(path):
    """Returns {topic: (log times in ns, decoded messages)} and the topics' channels.

    Checks every sum, and the order in the file.
    """
    topics, channels, last = {}, {}, 0
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for channel in reader.get_summary().channels.values():
            channels[channel.topic] = channel
            topics[channel.topic] = ([], [])
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            assert message.log_time == message.publish_time >= last, (
                f"{path}: {channel.topic} at {message.log_time} ns comes after {last} ns"
            )
            last = message.log_time
            times, messages = topics[channel.topic]
            assert not times or message.log_time > times[-1], (
                f"{channel.topic}: {message.log_time} ns comes after {times[-1]} ns"
            )
            times.append(message.log_time)
            messages.append(decoded)
        counts = reader.get_summary().statistics.channel_message_counts
        assert counts == {
            channels[topic].id: len(times) for topic, (times, _) in topics.items() if times
        }
    return topics, channels


def nanoseconds(t):
    return [round(1e9 * one) for one in t]


def values(messages, name, dtype):
    return np.array([np.reshape(getattr(message, name), -1) for message in messages]).astype(dtype)


class Mcap(ExportTest):
    def same(self, found, expected, what):
        expected = expected.reshape(len(expected), -1)
        self.assertEqual(found.reshape(len(found), -1).shape, expected.shape, what)
        self.assertEqual(
            np.ascontiguousarray(found).tobytes(), np.ascontiguousarray(expected).tobytes(), what
        )

    def check_own(self, topics, channels, topic, times, arrays):
        """Checks that a topic of our own type has these arrays as fields.

        Compares their units and shapes.
        """
        found, messages = topics.pop(topic)
        self.assertEqual(found, nanoseconds(times), topic)
        self.assertEqual(
            {field.name for field in messages[0].DESCRIPTOR.fields}, set(arrays), topic
        )
        for name, array in arrays.items():
            self.same(values(messages, name, array.dtype), array[:], f"{topic}.{name}")
            about = json.loads(channels[topic].metadata[name])
            self.assertEqual(
                (about["unit"], about["shape"]), (array.attrs["unit"], list(array.shape[1:]))
            )
            self.assertEqual(len(about["names"]), np.prod(array.shape[1:], dtype=int))
            if "codes" in array.attrs:
                kind = messages[0].DESCRIPTOR.fields_by_name[name].enum_type
                # The words of an enum shared by several arrays begin with the first one's name.
                words = {
                    word.upper(): code for word, code in json.loads(array.attrs["codes"]).items()
                }
                prefix = kind.values[0].name.removesuffix(next(iter(words)))
                self.assertEqual(
                    {one.name: one.number for one in kind.values},
                    {prefix + word: code for word, code in words.items()},
                )

    def check_sensor(self, topics, channels, demo, sensor):
        group, together = demo["sensors"][sensor], {}
        for channel in group.attrs["channels"]:
            topic, array = f"/sensors/{sensor}/{channel}", group[channel]
            own = f"{channel}_t"
            if (group.attrs["type"], channel) in (
                ("myrmex", "taxels"),
                ("biotac_sp", "electrodes"),
            ):
                found, messages = topics.pop(topic)
                self.assertEqual(found, nanoseconds(group[own if own in group else "t"]))
                self.assertEqual(found, [message.timestamp.ToNanoseconds() for message in messages])
                self.same(
                    np.array([np.frombuffer(message.data, "<f4") for message in messages]),
                    array[:],
                    topic,
                )
                self.assertEqual({message.column_count for message in messages}, {array.shape[-1]})
                self.assertEqual(
                    {(message.row_stride, message.cell_stride) for message in messages},
                    {(4 * array.shape[-1], 4)},
                )
                self.assertEqual(
                    [(one.name, one.offset, one.type) for one in messages[0].fields],
                    [("counts", 0, 7)],
                )  # 7: FLOAT32
                self.assertIn(messages[0].frame_id, demo["truth"])
                if array.ndim == 3:
                    self.check_places(
                        messages[0], array.shape[1:], demo["labels"][sensor].attrs["unit_positions"]
                    )
            elif own in group:
                self.check_own(topics, channels, topic, group[own], {channel: array})
            else:
                together[channel] = array
        if together:
            self.check_own(topics, channels, f"/sensors/{sensor}", group["t"], together)

    def check_places(self, grid, shape, places):
        """Returns the middle of cell (row, column) after the pose's half turn about x.

        X stays, y changes its sign.
        """
        self.assertEqual([getattr(grid.pose.orientation, axis) for axis in "xyzw"], [1, 0, 0, 0])
        row, column = np.indices(shape).reshape(2, -1)
        x = grid.pose.position.x + (column + 0.5) * grid.cell_size.x
        y = grid.pose.position.y - (row + 0.5) * grid.cell_size.y
        np.testing.assert_allclose(np.stack([x, y], axis=1), places, atol=1e-12)

    def check_labels(self, topics, channels, demo, sensor):
        group = demo["labels"][sensor]
        self.check_own(
            topics,
            channels,
            f"/labels/{sensor}",
            group["t"],
            {name: group[name] for name in set(group) - {"t", "events"}},
        )
        about = channels[f"/labels/{sensor}"].metadata
        for name in ("unit_positions", "onset_time_s", "k_normal"):
            told = np.array(json.loads(about[name]), dtype=float)  # null becomes NaN
            np.testing.assert_array_equal(told, group.attrs[name])
        found, messages = topics.pop(f"/labels/{sensor}/events")
        events = [one for message in messages for one in message.events]
        for name in ("t", "unit", "kind"):
            expected = group[f"events/{name}"][:]
            self.assertEqual(
                np.array([getattr(one, name) for one in events], expected.dtype).tobytes(),
                expected.tobytes(),
                name,
            )
        for time, message in zip(found, messages, strict=True):
            self.assertEqual({round(1e9 * one.t) for one in message.events}, {time})

    def check_bodies(self, topics, demo):
        poses, velocities = topics.pop("/poses"), topics.pop("/velocities")
        for number, (body, group) in enumerate(demo["truth"].items()):
            self.assertEqual(poses[0], nanoseconds(group["t"]))
            self.assertEqual(velocities[0], poses[0])
            transforms = [message.transforms[number] for message in poses[1]]
            self.assertEqual(
                {(one.parent_frame_id, one.child_frame_id) for one in transforms}, {("world", body)}
            )
            self.assertEqual([one.timestamp.ToNanoseconds() for one in transforms], poses[0])
            found = [
                [
                    one.translation.x,
                    one.translation.y,
                    one.translation.z,
                    one.rotation.w,
                    one.rotation.x,
                    one.rotation.y,
                    one.rotation.z,
                ]
                for one in transforms
            ]
            self.same(np.array(found, "f4"), group["pose"][:], body)
            moving = [message.velocities[number] for message in velocities[1]]
            self.assertEqual({one.body for one in moving}, {body})
            self.same(
                np.array([[*one.linear, *one.angular] for one in moving], "f4"),
                group["velocity"][:],
                body,
            )

    @for_each_scene("mcap")
    def test_every_value_comes_back(self, dataset, out):
        with h5py.File(dataset) as file:
            self.assertEqual(
                set(contents(out)), {LAYOUT, *CARDS, *(f"{name}.mcap" for name in file["data"])}
            )
            for name, demo in file["data"].items():
                topics, channels = read(out / f"{name}.mcap")
                for sensor in demo["sensors"]:
                    self.check_sensor(topics, channels, demo, sensor)
                    self.check_labels(topics, channels, demo, sensor)
                self.check_bodies(topics, demo)
                if "control" in demo:
                    self.check_own(
                        topics,
                        channels,
                        "/control",
                        demo["control/t"],
                        {array: demo["control"][array] for array in set(demo["control"]) - {"t"}},
                    )
                self.assertEqual(topics, {})

    def test_a_second_reader_finds_the_same_messages_by_the_indexes(self):
        for scene in ("grasp/two_skins.yaml", "myrmex/slip.yaml"):
            with self.subTest(scene=scene):
                export(make(scene), self.folder / "out", "--format", "mcap")
                path = self.folder / "out/demo_0.mcap"
                with path.open("rb") as file:
                    expected = [
                        (channel.topic, schema.name, message.log_time, message.data)
                        for schema, channel, message in make_reader(file).iter_messages(
                            log_time_order=False
                        )
                    ]
                with pybag.mcap.record_reader.McapRecordReaderFactory.from_file(
                    path, enable_crc_check=True
                ) as reader:
                    names = {
                        number: (channel.topic, reader.get_schema(channel.schema_id).name)
                        for number, channel in reader.get_channels().items()
                    }
                    found = [
                        (*names[message.channel_id], message.log_time, bytes(message.data))
                        for message in reader.get_messages()
                    ]
                    self.assertEqual(len(found), reader.get_statistics().message_count)
                    self.assertEqual(sorted(found), sorted(expected))
                    chunks = reader.get_chunk_indexes()
                    self.assertGreater(len(chunks), 1)
                    for one, following in itertools.pairwise(chunks):
                        self.assertLessEqual(one.message_end_time, following.message_start_time)
                    # Using only the index: the last message of a topic.
                    index = chunks[-1]
                    for number, of_chunk in reader.get_message_indexes(index).items():
                        last = max(record[0] for record in of_chunk.records)
                        self.assertEqual(
                            last,
                            max(
                                time for topic, _, time, _ in expected if topic == names[number][0]
                            ),
                        )

    def test_the_file_says_what_the_trial_was_and_is_compressed(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        told, progress = export(dataset, out, "--format", "mcap")
        self.assertRegex(
            told, r"^written: 6 files, [\d.]+ [kM]B, in .*/out\n$"
        )  # three trials, the layout, the card and croissant.json
        self.assertRegex(progress, r"^3 trials, about [\d.]+ [kM]B\n3/3 trials \(100 %\), .* s\n$")
        with h5py.File(dataset) as file, (out / "demo_1.mcap").open("rb") as recording:
            demo = file["data/demo_1"]
            reader = make_reader(recording)
            (metadata,) = reader.iter_metadata()
            about = metadata.metadata
            self.assertEqual(
                (metadata.name, about["trial"], about["sha256"], about["scene"]),
                ("slipbench", "1", demo.attrs["sha256"], file.attrs["scene"]),
            )
            self.assertEqual(
                [json.loads(about[name]) for name in ("params", "outcome")],
                [json.loads(demo.attrs[name]) for name in ("params", "outcome")],
            )
            self.assertIn("demo_1", list(file[f"mask/{about['split']}"].asstr()))
            channel = next(
                one for one in reader.get_summary().channels.values() if one.topic == "/sensors/pad"
            )
            self.assertEqual(
                (channel.metadata["type"], float(channel.metadata["rate_hz"])),
                ("papillarray", 1000.0),
            )
            self.assertEqual(
                json.loads(channel.metadata["force"])["names"][:3], ["P0_FX", "P0_FY", "P0_FZ"]
            )
            recording.seek(0)
            chunks = [
                record
                for record in StreamReader(recording, emit_chunks=True).records
                if isinstance(record, Chunk)
            ]
            self.assertEqual({chunk.compression for chunk in chunks}, {"zstd"})
        before = contents(out)
        export(dataset, out, "--format", "mcap")  # replaces its own files
        self.assertEqual(contents(out), before)

    def test_the_layout_shows_topics_that_are_there(self):
        for scene in SCENES:
            with self.subTest(scene=scene):
                out = self.folder / scene.replace("/", "_")
                export(make(scene), out, "--format", "mcap", "--trial", "0")
                layout = json.loads((out / LAYOUT).read_text())
                topics, _ = read(out / "demo_0.mcap")

                def panels(node):
                    return (
                        {node}
                        if isinstance(node, str)
                        else panels(node["first"]) | panels(node["second"])
                    )

                self.assertEqual(panels(layout["layout"]), set(layout["configById"]))
                self.assertIn("/poses", layout["configById"]["3D!scene"]["topics"])
                for panel in layout["configById"].values():
                    self.assertLessEqual(set(panel.get("topics", {})), set(topics))
                    for path in panel.get("paths", []):
                        topic, _, field = path["value"].rpartition(".")
                        name, _, index = field.partition("[")
                        value = getattr(topics[topic][1][0], name)
                        self.assertGreater(
                            len(value), int(index.rstrip("]"))
                        ) if index else self.assertNotIsInstance(value, (list, str))

    def test_the_options_choose(self):
        both = make("grasp/two_skins.yaml")
        export(
            both,
            self.folder / "out",
            "--format",
            "mcap",
            "--sensors",
            "skin",
            "--labels",
            "micro",
            "--trial",
            "1",
        )
        self.assertEqual(set(contents(self.folder / "out")), {LAYOUT, *CARDS, "demo_1.mcap"})
        topics, _ = read(self.folder / "out/demo_1.mcap")
        self.assertEqual(
            set(topics),
            {
                "/poses",
                "/velocities",
                "/control",
                "/sensors/skin",
                "/labels/skin",
                "/labels/skin/events",
            },
        )
        fields = {field.name for field in topics["/labels/skin"][1][0].DESCRIPTOR.fields}
        self.assertEqual({name for name in fields if name.startswith("state")}, {"state_micro"})

    def test_nothing_but_its_own_is_replaced(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        out.mkdir()
        (out / "demo_1.mcap").write_text("my notes")
        _, told = export(dataset, out, "--format", "mcap", status=2)
        self.assertRegex(told, "demo_1.mcap.*MCAP.*another folder")
        self.assertEqual(contents(out), {"demo_1.mcap": b"my notes"})


if __name__ == "__main__":
    unittest.main()
