"""npz and robomimic restore all bits of every sensor and grasp; --rate is equal in all formats.

Arguments: the project's root, the program.
"""

import csv
import gzip
import subprocess
import unittest

import h5py
import numpy as np
import pandas
from _made import PROGRAM, ExportTest, contents, export, for_each_scene, held, make
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from slipbench._output import create_locked


def arrays_of(group):
    """Every array of a group of HDF5, by its path in the group."""
    arrays = {}

    def add(path, item):
        if isinstance(item, h5py.Dataset):
            arrays[path] = item[()]

    group.visititems(add)
    return arrays


class Formats(ExportTest):
    def same(self, found, expected, what):
        self.assertEqual((found.dtype, found.shape), (expected.dtype, expected.shape), what)
        self.assertEqual(
            np.ascontiguousarray(found).tobytes(), np.ascontiguousarray(expected).tobytes(), what
        )

    @for_each_scene("npz")
    def test_npz_brings_every_array_back(self, dataset, out):
        with h5py.File(dataset) as file:
            for name, demo in file["data"].items():
                expected = arrays_of(demo)
                for sensor in demo["labels"]:
                    expected |= {
                        f"labels/{sensor}/{key}": value
                        for key, value in demo["labels"][sensor].attrs.items()
                        if key != "frame"
                    }
                with np.load(out / f"{name}.npz") as archive:
                    self.assertEqual(set(archive), {*expected, "about"})
                    for path, values in expected.items():
                        self.same(archive[path], values, path)

    @for_each_scene("robomimic", "--compress")
    def test_robomimic_brings_the_latest_of_everything_back(self, dataset, out):
        with h5py.File(dataset) as file, h5py.File(out / "robomimic.hdf5") as written:
            self.assertEqual(set(written["data"]), set(file["data"]))
            for name, demo in file["data"].items():
                self.check_demo(demo, written["data"][name], written["data"].attrs)

    def check_demo(self, demo, found, about):
        channels = {
            f"{sensor}_{channel}": (
                group[f"{channel}_t" if f"{channel}_t" in group else "t"][:],
                group[channel][:],
            )
            for sensor, group in demo["sensors"].items()
            for channel in group.attrs["channels"]
        }
        states = {
            f"{sensor}_{state}": (group["t"][:], group[state][:])
            for sensor, group in demo["labels"].items()
            for state in ("state", "state_micro", "state_paper")
        }
        bodies = [
            (group["t"][:], np.concatenate([group["pose"][:], group["velocity"][:]], axis=1))
            for group in demo["truth"].values()
        ]
        clocks = [group["t"][:] for group in demo["sensors"].values()] + [bodies[0][0]]
        if "control" in demo:
            clocks.append(demo["control/t"][:])
            if "measured_position" in demo["control"]:
                channels["gripper_position"] = (
                    demo["control/t"][:],
                    demo["control/measured_position"][:],
                )
        # From the first instant with all values read until the first of them ends.
        start = max(times[0] for times in (*clocks, *(times for times, _ in channels.values())))
        rate = about["rate_hz"]
        rows = int(np.floor((min(times[-1] for times in clocks) - start + 1e-9) * rate)) + 1
        instants = start + np.arange(rows) / rate
        self.assertEqual(
            (found.attrs["num_samples"], found.attrs["num_samples"].dtype), (rows - 1, np.int64)
        )
        self.assertEqual(set(found["obs"]), set(channels))
        for key, (times, values) in channels.items():
            expected = held(times, values, instants).astype("f4")
            self.same(found["obs"][key][:], expected[:-1], key)
            self.same(found["next_obs"][key][:], expected[1:], key)
            self.assertEqual(
                (found["obs"][key].compression, found["obs"][key].shuffle), ("gzip", True)
            )
        for key, (times, values) in states.items():
            self.same(
                found[key][:], held(times, values, instants[:-1]).astype("f4").reshape(-1), key
            )
        self.same(
            found["states"][:],
            np.concatenate(
                [held(times, values, instants[:-1]) for times, values in bodies], axis=1
            ),
            "states",
        )
        scale, offset = about["action_scale"], about["action_offset"]
        if "command" in demo.get("control", {}):
            acted = held(demo["control/t"][:], demo["control/command"][:], instants[:-1])
        else:
            carriers = [body for body in demo["truth"] if body == "pad" or body in demo["sensors"]]
            acted = np.concatenate(
                [
                    held(
                        demo["truth"][body]["t"][:],
                        demo["truth"][body]["velocity"][:],
                        instants[:-1],
                    )
                    for body in carriers
                ],
                axis=1,
            )
        self.same(found["actions"][:], ((acted - offset) / scale).astype("f4"), "actions")

    def test_a_rate_takes_the_same_rows_in_every_format(self):
        """SI of a nib_pad is read at a ninth of its rate and begins later.

        It is held, and the rows begin with it.
        """
        dataset = make("nib_pad/linear.yaml")
        words = ("--rate", "100 Hz", "--trial", "1", "--sensors", "pad")
        for format in ("csv", "npz", "parquet", "mcap"):
            export(dataset, self.folder / format, "--format", format, *words)
        with h5py.File(dataset) as file:
            sensor, labels = file["data/demo_1/sensors/pad"], file["data/demo_1/labels/pad"]
            own = {channel: sensor[f"{channel}_t"][:] for channel in ("si", "fl", "fr")}
            start = max(times[0] for times in (sensor["t"][:], *own.values()))
            instants = (
                start + np.arange(int(np.floor((sensor["t"][-1] - start + 1e-9) * 100)) + 1) / 100
            )
            self.assertGreater(len(instants), 20)
            values = {channel: held(own[channel], sensor[channel][:], instants) for channel in own}
            state = held(sensor["t"][:], labels["state"][:], instants).reshape(-1)
            names = list(sensor.attrs["channel_names"])
        joined = np.concatenate([values[channel] for channel in ("si", "fl", "fr")], axis=1)
        with np.load(self.folder / "npz/demo_1.npz") as archive:
            self.same(archive["sensors/pad/t"], instants, "npz")
            self.same(archive["labels/pad/state"], state, "npz")
            for channel, expected in values.items():
                self.same(
                    archive[f"sensors/pad/{channel}"].reshape(len(instants), -1), expected, "npz"
                )
            self.assertNotIn("sensors/pad/si_t", archive)
        table = pandas.read_parquet(self.folder / "parquet/pad.parquet")
        self.same(table["t"].to_numpy(), instants, "parquet")
        self.same(table[names].to_numpy(), joined, "parquet")
        self.same(table["label_state"].to_numpy(), state, "parquet")
        with (self.folder / "csv/demo_1-pad.csv").open(newline="") as text:
            rows = list(csv.DictReader(text))
        self.assertEqual([float(row["t [s]"]) for row in rows], list(instants))
        self.same(
            np.array([[row[f"{name} [counts]"] for name in names] for row in rows], "f4"),
            joined,
            "csv",
        )
        self.assertEqual([int(row["state"]) for row in rows], list(state))
        messages = {}
        with (self.folder / "mcap/demo_1.mcap").open("rb") as recording:
            for _, channel, message, decoded in make_reader(
                recording, decoder_factories=[DecoderFactory()]
            ).iter_decoded_messages():
                messages.setdefault(channel.topic, []).append((message.log_time, decoded))
        for channel, expected in values.items():
            found = messages[f"/sensors/pad/{channel}"]
            self.assertEqual([time for time, _ in found], [round(1e9 * t) for t in instants])
            self.same(np.array([getattr(one, channel) for _, one in found], "f4"), expected, "mcap")
        self.assertEqual([one.state for _, one in messages["/labels/pad"]], list(state))

    def test_tables_can_be_compressed(self):
        dataset = make("papillarray/stage.yaml")
        for format in ("training-csv", "vendor-csv"):
            export(dataset, self.folder / "plain", "--format", format, "--trial", "0")
            export(
                dataset, self.folder / "packed", "--format", format, "--trial", "0", "--compress"
            )
        plain = {
            str(path.relative_to(self.folder / "plain")): path.read_bytes()
            for path in (self.folder / "plain").rglob("*.csv")
        }
        packed = {
            str(path.relative_to(self.folder / "packed")).removesuffix(".gz"): gzip.decompress(
                path.read_bytes()
            )
            for path in (self.folder / "packed").rglob("*.csv.gz")
        }
        self.assertEqual(len(plain), 2)
        self.assertEqual(packed, plain)

    def test_exports_at_once_are_whole_or_refused(self):
        """Four exports into one folder: each is whole or states the other; and pyarrow would take a folder a:b for an address."""
        dataset = make("papillarray/stage.yaml")
        for format in ("lerobot", "parquet"):
            with self.subTest(format=format):
                out, whole = self.folder / f"a:{format}", self.folder / f"{format}-whole"
                export(dataset, whole, "--format", format)
                command = [PROGRAM, "export", dataset, "-o", str(out), "--format", format]
                runs = [
                    subprocess.Popen(
                        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
                    )
                    for _ in range(4)
                ]
                ends = [(run.communicate()[1], run.returncode) for run in runs]
                self.assertIn(0, [status for _, status in ends], ends)
                for text, status in ends:
                    if status != 0:
                        self.assertEqual(
                            (status, text.splitlines()[-1]),
                            (
                                2,
                                f"slipbench: cannot write into {out}: another export is writing into it",
                            ),
                        )
                self.assertEqual(contents(out), contents(whole))
                out.rename(self.folder / f"{format}-done")
                out.mkdir()
                with create_locked(out / "export.partial"):
                    _, told = export(dataset, out, "--format", format, status=2)
                    self.assertIn("another export is writing into it", told)
                self.assertEqual([path.name for path in out.iterdir()], ["export.partial"])
                export(dataset, out, "--format", format)  # the file was left by a killed export
                self.assertEqual(contents(out), contents(whole))

    def test_a_file_with_content_at_the_name_of_the_lock_is_kept(self):
        dataset = make("papillarray/stage.yaml")
        for format in ("parquet", "lerobot"):
            with self.subTest(format=format):
                out = self.folder / format
                out.mkdir()
                (out / "export.partial").write_text("precious")
                _, told = export(dataset, out, "--format", format, status=2)
                self.assertIn(
                    f"{out / 'export.partial'}: would be replaced by the lock of this export, but has content; rename it",
                    told,
                )
                self.assertEqual(contents(out), {"export.partial": b"precious"})

    def test_what_a_layout_cannot_carry_is_refused_by_name(self):
        dataset = make("papillarray/stage.yaml")
        for format in ("csv", "npz", "parquet", "mcap", "vendor-csv"):
            with self.subTest(format=format):
                _, told = export(
                    dataset, self.folder / "out", "--format", format, "--rate", "1001 Hz", status=2
                )
                self.assertRegex(told, "trial 0.* 1001 Hz .*'pad'.* 1000 Hz")
        for format, reason in (
            ("training-csv", "1000 rows per second"),
            ("slip-csv", "100 rows per second"),
            ("myrmex-csv", "every image of the sensor"),
            ("grasp-csv", "one row per grasp"),
        ):
            with self.subTest(format=format):
                _, told = export(
                    dataset, self.folder / "out", "--format", format, "--rate", "10 Hz", status=2
                )
                self.assertRegex(told, f"{format}, .*{reason}")
        for format in ("parquet", "mcap", "rosbag2", "lerobot", "npz"):
            _, told = export(
                dataset, self.folder / "out", "--format", format, "--compress", status=2
            )
            self.assertRegex(told, f"{format} .*--compress.* csv")
        self.assertFalse((self.folder / "out").exists())
        (self.folder / "file").write_text("x")
        for format in ("csv", "robomimic", "parquet", "lerobot", "mcap"):
            _, told = export(dataset, self.folder / "file", "--format", format, status=2)
            self.assertIn("file: File exists", told)


if __name__ == "__main__":
    unittest.main()
