"""`export --format parquet`: pandas and pyarrow read the dataset's values back bit-exactly.

Arguments: the project's root, the program.
"""

import hashlib
import json
import os
import unittest

import h5py
import numpy as np
import pandas
import pyarrow.parquet
from _made import ExportTest, contents, export, for_each_scene, make


def same(found, expected, what):
    found = np.ascontiguousarray(found)
    assert found.dtype == expected.dtype, f"{what}: {found.dtype}, expected {expected.dtype}"
    assert found.tobytes() == np.ascontiguousarray(expected).tobytes(), what


def check_sensor(out, name, number, demo):
    """Compares the files' values for a trial and sensor with the dataset.

    Returns the names of the columns and files compared.
    """
    table = pandas.read_parquet(out / f"{name}.parquet").query("trial == @number")
    sensor, seen, files = (
        demo["sensors"][name],
        {"trial", "t"},
        {f"{name}.parquet", f"{name}-events.parquet"},
    )
    same(table["t"], sensor["t"][:], name)
    names = list(sensor.attrs["channel_names"])
    for channel in sensor.attrs["channels"]:
        values = sensor[channel][:].reshape(len(sensor[channel]), -1)
        own, part, names = names[: values.shape[1]], table, names[values.shape[1] :]
        if len(values) != len(table):
            files.add(f"{name}-{channel}.parquet")
            part = pandas.read_parquet(out / f"{name}-{channel}.parquet").query("trial == @number")
            same(part["t"], sensor[f"{channel}_t"][:], channel)
        else:
            seen.update(own)
            if f"{channel}_t" in table:
                seen.add(f"{channel}_t")
                same(table[f"{channel}_t"], sensor[f"{channel}_t"][:], channel)
        same(part[own].to_numpy(), values, f"{name}/{channel}")
    labels = demo["labels"][name]
    for label in set(labels) - {"t", "events"}:
        values = labels[label][:].reshape(len(labels[label]), -1)
        name_of = f"label_{label}"
        columns = (
            [name_of]
            if name_of in table
            else [column for column in table if column.startswith(f"{name_of}_")]
        )
        seen.update(columns)
        same(table[columns].to_numpy(), values, f"{name}/{label}")
    assert seen == set(table), seen ^ set(table)
    events = pandas.read_parquet(out / f"{name}-events.parquet").query("trial == @number")
    for column in ("t", "unit", "kind"):
        same(events[column], labels[f"events/{column}"][:], f"{name}/events/{column}")
    return files


class Parquet(ExportTest):
    @for_each_scene("parquet")
    def test_every_value_comes_back(self, dataset, out):
        files = {"trials.parquet"}
        with h5py.File(dataset) as file:
            for name, demo in file["data"].items():
                number = int(name.removeprefix("demo_"))
                for sensor in demo["sensors"]:
                    files |= check_sensor(out, sensor, number, demo)
                for body, group in demo["truth"].items():
                    files.add(f"body-{body}.parquet")
                    table = pandas.read_parquet(out / f"body-{body}.parquet").query(
                        "trial == @number"
                    )
                    same(table["t"], group["t"][:], body)
                    same(
                        table[
                            [column for column in table if column.startswith("pose_")]
                        ].to_numpy(),
                        group["pose"][:],
                        body,
                    )
                    same(
                        table[
                            [column for column in table if column.startswith("velocity_")]
                        ].to_numpy(),
                        group["velocity"][:],
                        body,
                    )
                if "control" in demo:
                    files.add("control.parquet")
                    table = pandas.read_parquet(out / "control.parquet").query("trial == @number")
                    for array in demo["control"]:
                        columns = [
                            column
                            for column in table
                            if column == array or column.startswith(f"{array}_")
                        ]
                        same(
                            table[columns].to_numpy().reshape(demo["control"][array].shape),
                            demo["control"][array][:],
                            array,
                        )
            self.assertEqual(set(contents(out)), files | {"README.md", "croissant.json"})
            trials = pandas.read_parquet(out / "trials.parquet")
            self.assertEqual(
                [f"demo_{number}" for number in trials["trial"]],
                sorted(file["data"], key=lambda demo: int(demo[5:])),
            )
            for part in ("train", "valid", "test"):
                self.assertEqual(
                    [f"demo_{number}" for number in trials.query("split == @part")["trial"]],
                    list(file[f"mask/{part}"].asstr()),
                )
            outcome = [
                json.loads(demo.attrs["outcome"])["first_slip_time_s"]
                for demo in file["data"].values()
            ]
            if None not in outcome:
                self.assertEqual(list(trials["first_slip_time_s"]), outcome)

    def test_two_runs_write_the_same_bytes_and_tell_how_much(self):
        dataset = make("papillarray/stage.yaml")
        told, progress = export(dataset, self.folder / "a", "--format", "parquet")
        # Sensor, events, pad, surface, trials.
        self.assertRegex(told, r"^written: 7 files, [\d.]+ [kM]B, in .*/a\n$")
        self.assertRegex(progress, r"^3 trials, about [\d.]+ [kM]B\n3/3 trials \(100 %\), .* s\n$")
        before = contents(self.folder / "a")
        told, progress = export(
            dataset, self.folder / "a", "--format", "parquet", "--json"
        )  # replaces its own files
        self.assertEqual(
            sorted(json.loads(told)["files"]),
            sorted(str(self.folder / "a" / name) for name in before),
        )
        self.assertEqual(progress, "")
        self.assertEqual(contents(self.folder / "a"), before)

    def test_rows_at_a_rate_are_the_latest_and_the_options_choose(self):
        dataset = make("papillarray/stage.yaml")
        export(
            dataset,
            self.folder / "a",
            "--format",
            "parquet",
            "--rate",
            "300 Hz",
            "--labels",
            "micro",
            "--trial",
            "1",
        )
        table = pandas.read_parquet(self.folder / "a/pad.parquet")
        self.assertEqual(set(table["trial"]), {1})
        self.assertEqual(
            [name for name in table if name.startswith("label_state")], ["label_state_micro"]
        )
        with h5py.File(dataset) as file:
            sensor, labels = file["data/demo_1/sensors/pad"], file["data/demo_1/labels/pad"]
            # The sensor reads at 0, 1, 2, ... ms; row k is at k/300 s, whose latest sample is the
            # floor of 1000 k/300.
            rows = 10 * np.arange(len(table)) // 3
            self.assertEqual(len(table), (len(sensor["t"]) - 1) * 3 // 10 + 1)
            same(
                table[[f"P{k}_F{axis}" for k in range(9) for axis in "XYZ"]].to_numpy(),
                sensor["force"][:][rows].reshape(-1, 27),
                "force",
            )
            same(table["label_state_micro"], labels["state_micro"][:][rows], "state_micro")
            members = [int(name.removeprefix("demo_")) for name in file["mask/train"].asstr()]
        export(dataset, self.folder / "b", "--format", "parquet", "--split", "train")
        self.assertEqual(
            list(pandas.read_parquet(self.folder / "b/trials.parquet")["trial"]), members
        )
        self.assertLess(len(members), 3)
        both = make("grasp/two_skins.yaml")
        with h5py.File(both) as file:
            first, *others = sorted(file["data/demo_0/sensors"])
        export(both, self.folder / "c", "--format", "parquet", "--sensors", first)
        self.assertTrue((self.folder / f"c/{first}.parquet").exists())
        for other in others:
            self.assertFalse((self.folder / f"c/{other}.parquet").exists())

    def test_columns_have_units_and_floats_lie_byte_by_byte(self):
        dataset = make("papillarray/stage.yaml")
        export(dataset, self.folder / "a", "--format", "parquet")
        file = pyarrow.parquet.ParquetFile(self.folder / "a/pad.parquet")
        self.assertEqual(file.schema_arrow.field("P0_FX").metadata[b"unit"], b"N")
        self.assertEqual(
            json.loads(file.schema_arrow.field("label_state").metadata[b"codes"]),
            {"no_contact": 0, "non_slip": 1, "incipient": 2, "gross": 3},
        )
        self.assertEqual(file.num_row_groups, 3)  # one per trial
        column = file.metadata.row_group(0).column(file.schema_arrow.get_field_index("P0_FX"))
        self.assertEqual(
            (column.compression, set(column.encodings)), ("ZSTD", {"BYTE_STREAM_SPLIT", "RLE"})
        )

    def test_what_cannot_be_is_refused_and_nothing_is_left(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        for words, names in (
            (["--rate", "0.1 Hz"], "trial 0.* 0.1 Hz.*--rate"),
            (["--rate", "2 kHz"], "trial 0.* 2000 Hz .*'pad'.* 1000 Hz"),
            (["--sensors", "padd"], "sensor 'padd'.*'pad'"),
            (["--split", "tests"], "split 'tests'.*'test'"),
            (["--labels", "has_slipped"], "'has_slipped'.*--labels.*strict"),
        ):
            with self.subTest(words=words):
                _, told = export(dataset, out, "--format", "parquet", *words, status=2)
                self.assertRegex(told, names)
                self.assertEqual(told.count("\n"), 1)
                self.assertFalse(out.exists())
        out.mkdir()
        (out / "pad.parquet").write_text("my notes")
        _, told = export(dataset, out, "--format", "parquet", status=2)
        self.assertRegex(told, "pad.parquet.*Parquet.*another folder")
        self.assertEqual(contents(out), {"pad.parquet": b"my notes"})

    def test_a_python_without_arrow_says_how_to_install_it(self):
        dataset = make("papillarray/stage.yaml")
        (self.folder / "pyarrow.py").write_text(
            "raise ModuleNotFoundError('No module named pyarrow', name='pyarrow')\n"
        )
        os.environ["PYTHONPATH"] = str(self.folder)
        self.addCleanup(os.environ.pop, "PYTHONPATH")
        _, told = export(dataset, self.folder / "out", "--format", "parquet", status=2)
        self.assertIn("needs the Python package pyarrow", told)
        self.assertIn("install it: tools/setup/setup.sh build python test-python", told)
        self.assertFalse((self.folder / "out").exists())

    def test_the_origin_is_in_every_file_and_every_column_has_a_type(self):
        dataset, out = make("papillarray/stage.yaml"), self.folder / "out"
        export(dataset, out, "--format", "parquet")
        with h5py.File(dataset) as file:
            digests = "".join(f"{file[f'data/demo_{k}'].attrs['sha256']}\n" for k in range(3))
            scene, seed = file.attrs["scene"], str(file.attrs["seed"])
        for path in out.glob("*.parquet"):
            schema = pyarrow.parquet.read_schema(path)
            self.assertEqual(schema.metadata[b"scene"].decode(), scene)
            self.assertEqual(schema.metadata[b"seed"].decode(), seed)
            self.assertEqual(
                schema.metadata[b"trials_sha256"].decode(),
                hashlib.sha256(digests.encode()).hexdigest(),
            )
            self.assertNotIn(b" /", schema.metadata[b"command"])
            self.assertFalse([field.name for field in schema if pyarrow.types.is_null(field.type)])


if __name__ == "__main__":
    unittest.main()
