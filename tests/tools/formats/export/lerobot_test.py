"""`export --format lerobot`: the layout of LeRobotDataset v3.0, with bit-exact values.

It is read by pandas and pyarrow; real_lerobot_test.py uses lerobot itself. Arguments: the project's
root, the program.
"""

import json
import subprocess
import unittest

import h5py
import numpy as np
import pandas
import pyarrow.parquet
from _made import PROGRAM, ROOT, ExportTest, contents, export, for_each_scene, held, make

COUNTS = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
STATS = ["min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"]
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def read(folder):
    """Returns what a reader finds by meta/info.json alone.

    Info, the table of frames, the table of episodes.
    """
    info = json.loads((folder / "meta/info.json").read_text())
    episodes = pandas.read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet")
    places = dict.fromkeys(
        zip(episodes["data/chunk_index"], episodes["data/file_index"], strict=True)
    )
    paths = [
        folder / info["data_path"].format(chunk_index=chunk, file_index=file)
        for chunk, file in places
    ]
    assert sorted(paths) == sorted(folder.glob("data/*/*.parquet"))
    return (
        info,
        pyarrow.concat_tables([pyarrow.parquet.read_table(path) for path in paths]),
        episodes,
    )


def values_of(table, info, feature):
    """Returns [frames, values per frame]."""
    column = table[feature].combine_chunks()
    width = info["features"][feature]["shape"][0]
    assert (column.type.list_size if width > 1 else 1) == width, feature
    return (
        (column.flatten() if width > 1 else column)
        .to_numpy(zero_copy_only=False)
        .reshape(-1, width)
    )


def arrays(demo, sensors):
    """Yields (feature, times, values) of the dataset.

    Every channel, label, body and array of the loop.
    """
    for sensor in sensors:
        group = demo["sensors"][sensor]
        for channel in group.attrs["channels"]:
            yield (
                f"observation.{sensor}.{channel}",
                group[f"{channel}_t" if f"{channel}_t" in group else "t"][:],
                group[channel][:],
            )
        labels = demo["labels"][sensor]
        for name in set(labels) - {"t", "events"}:
            yield f"labels.{sensor}.{name}", labels["t"][:], labels[name][:]
    for body, group in demo["truth"].items():
        for name in ("pose", "velocity"):
            yield f"truth.{body}.{name}", group["t"][:], group[name][:]
    for name in set(demo.get("control", {})) - {"t"}:
        yield f"control.{name}", demo["control/t"][:], demo["control"][name][:]


class LeRobot(ExportTest):
    def check_layout(self, info, table, episodes, rate):
        """Checks the relations of the three, for any sensors."""
        self.assertEqual(
            (info["codebase_version"], info["fps"], info["video_path"], info["chunks_size"]),
            ("v3.0", rate, None, 1000),
        )
        self.assertEqual(
            (info["total_episodes"], info["total_frames"], info["total_tasks"]),
            (len(episodes), len(table), 1),
        )
        self.assertEqual(set(table.column_names), set(info["features"]))
        for name, kind in COUNTS.items():
            self.assertEqual(info["features"][name], {"dtype": kind, "shape": [1], "names": None})
        for name, feature in info["features"].items():
            self.assertNotIn("/", name)
            self.assertEqual(values_of(table, info, name).dtype.name, feature["dtype"], name)
            self.assertIn(len(feature["names"] or [0]), feature["shape"], name)
        ends = np.cumsum(episodes["length"])
        self.assertEqual(list(episodes["dataset_from_index"]), [0, *ends[:-1]])
        self.assertEqual(list(episodes["dataset_to_index"]), list(ends))
        self.assertEqual(list(episodes["episode_index"]), list(range(len(episodes))))
        self.assertEqual(str(episodes["trial"].dtype), "int64")
        frames = np.concatenate([np.arange(length) for length in episodes["length"]])
        np.testing.assert_array_equal(table["index"], np.arange(len(table)))
        np.testing.assert_array_equal(table["frame_index"], frames)
        np.testing.assert_array_equal(
            table["episode_index"], np.repeat(np.arange(len(episodes)), episodes["length"])
        )
        np.testing.assert_array_equal(table["timestamp"], (frames / rate).astype(np.float32))

    @for_each_scene("lerobot")
    def test_every_value_comes_back(self, dataset, out):
        with h5py.File(dataset) as file:
            rates = {}
            for sensor, group in file["data/demo_0/sensors"].items():
                rates.setdefault(group.attrs["rate_hz"], []).append(sensor)
            self.assertEqual(
                {path.name for path in out.iterdir()}, {f"{rate:.0f}hz" for rate in rates}
            )
            for rate, sensors in rates.items():
                self.check_values(file, out / f"{rate:.0f}hz", rate, sensors)

    def check_values(self, file, folder, rate, sensors):
        info, table, episodes = read(folder)
        self.check_layout(info, table, episodes, rate)
        # Episodes follow the masks: train, then valid, then test.
        order, splits = [], {}
        for part in ("train", "valid", "test"):
            members = list(file[f"mask/{part}"].asstr())
            if members:
                splits[part] = f"{len(order)}:{len(order) + len(members)}"
            order += members
        self.assertEqual(info["splits"], splits)
        self.assertEqual([f"demo_{number}" for number in episodes["trial"]], order)
        for episode, name in enumerate(order):
            demo, part = (
                file["data"][name],
                table.slice(episodes["dataset_from_index"][episode], episodes["length"][episode]),
            )
            expected = {
                feature: (times, values) for feature, times, values in arrays(demo, sensors)
            }
            begin = max(times[0] for times, _ in expected.values())
            instants = [t for t in demo["sensors"][sensors[0]]["t"][:] if t >= begin - 1e-9]
            np.testing.assert_array_equal(values_of(part, info, "time")[:, 0], instants)
            for feature, (times, values) in expected.items():
                found = values_of(part, info, feature)
                self.assertEqual(found.dtype, values.dtype, feature)
                self.assertEqual(found.tobytes(), held(times, values, instants).tobytes(), feature)
            grasp = "control" in demo and "command" in demo["control"]
            further = {"time", *COUNTS, "action", *(["observation.state"] if grasp else [])}
            self.assertEqual(set(info["features"]), set(expected) | further)
            if grasp:
                np.testing.assert_array_equal(
                    values_of(part, info, "action"), values_of(part, info, "control.command")
                )
                np.testing.assert_array_equal(
                    values_of(part, info, "observation.state"),
                    values_of(part, info, "control.measured_position"),
                )
            else:
                moving = [body for body in demo["truth"] if body in {"pad", *demo["sensors"]}]
                np.testing.assert_array_equal(
                    values_of(part, info, "action"),
                    np.concatenate(
                        [values_of(part, info, f"truth.{body}.velocity") for body in moving], axis=1
                    ),
                )

    def test_statistics_are_those_of_numpy(self):
        dataset = make("papillarray/stage.yaml")
        export(dataset, self.folder / "out", "--format", "lerobot")
        info, table, episodes = read(self.folder / "out/1000hz")
        told = json.loads((self.folder / "out/1000hz/meta/stats.json").read_text())
        self.assertEqual(set(told), set(info["features"]))
        for feature in info["features"]:
            values = values_of(table, info, feature).astype(np.float64)
            of_episodes = []
            for _, row in episodes.iterrows():
                part = values[row["dataset_from_index"] : row["dataset_to_index"]]
                numbers = np.sum(~np.isnan(part), axis=0)
                part = np.where(numbers > 0, part, 0)  # a value that is never a number has zeros
                expected = {
                    "min": np.nanmin(part, axis=0),
                    "max": np.nanmax(part, axis=0),
                    "mean": np.nanmean(part, axis=0),
                    "std": np.nanstd(part, axis=0),
                    **{
                        name: np.nanquantile(part, share, axis=0)
                        for name, share in QUANTILES.items()
                    },
                }
                of_episodes.append((numbers, expected))
                for name, value in expected.items():
                    np.testing.assert_allclose(
                        row[f"stats/{feature}/{name}"],
                        value,
                        rtol=1e-6,
                        atol=1e-9,
                        err_msg=f"{feature} {name}",
                    )
                self.assertEqual(list(row[f"stats/{feature}/count"]), [row["length"]])
            self.assertEqual(list(told[feature]), STATS)
            whole = np.where(np.sum(~np.isnan(values), axis=0) > 0, values, 0)
            for name, function in (
                ("min", np.nanmin),
                ("max", np.nanmax),
                ("mean", np.nanmean),
                ("std", np.nanstd),
            ):
                np.testing.assert_allclose(
                    told[feature][name],
                    function(whole, axis=0),
                    rtol=1e-5,
                    atol=1e-9,
                    err_msg=f"{feature} {name}",
                )
            # Over all episodes: the means of theirs, as in lerobot.
            weights = np.stack([numbers for numbers, _ in of_episodes])
            for name in QUANTILES:
                mean = np.sum(
                    [numbers * expected[name] for numbers, expected in of_episodes], axis=0
                ) / np.maximum(weights.sum(axis=0), 1)
                np.testing.assert_allclose(
                    told[feature][name], mean, rtol=1e-6, atol=1e-9, err_msg=f"{feature} {name}"
                )
            self.assertEqual(told[feature]["count"], [len(table)])

    def test_tasks_have_the_index_of_pandas(self):
        dataset = make("papillarray/stage.yaml")
        export(dataset, self.folder / "out", "--format", "lerobot")
        tasks = pandas.read_parquet(self.folder / "out/1000hz/meta/tasks.parquet")
        _, _, episodes = read(self.folder / "out/1000hz")
        self.assertEqual(
            (tasks.index.name, list(tasks.columns), list(tasks["task_index"])),
            ("task", ["task_index"], [0]),
        )
        description = next(
            line
            for line in (ROOT / "scenes/papillarray/stage.yaml").read_text().splitlines()
            if line.startswith("description: ")
        )
        self.assertEqual(f"description: {tasks.index[0]}", description)
        self.assertEqual([list(names) for names in episodes["tasks"]], [list(tasks.index)] * 3)

    def test_two_runs_write_the_same_bytes_and_an_episode_is_a_row_group(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        export(dataset, out, "--format", "lerobot")
        before = contents(out)
        self.assertEqual(
            pyarrow.parquet.ParquetFile(
                out / "1000hz/data/chunk-000/file-000.parquet"
            ).num_row_groups,
            3,
        )
        (out / "1000hz.partial/data").mkdir(parents=True)  # as a killed run leaves it
        told, _ = export(dataset, out, "--format", "lerobot", "--json")
        self.assertEqual(contents(out), before)
        self.assertEqual([path.name for path in out.iterdir()], ["1000hz"])
        self.assertEqual(json.loads(told)["files"], [str(out / name) for name in before])

    def test_a_rate_makes_one_dataset_and_labels_choose(self):
        both = make("grasp/two_skins.yaml")
        export(
            both,
            self.folder / "out",
            "--format",
            "lerobot",
            "--rate",
            "100 Hz",
            "--labels",
            "strict",
        )
        info, table, episodes = read(self.folder / "out/100hz")
        self.check_layout(info, table, episodes, 100)
        with h5py.File(both) as file:
            for sensor, group in file["data/demo_0/sensors"].items():
                for channel in group.attrs["channels"]:
                    self.assertIn(f"observation.{sensor}.{channel}", info["features"])
                self.assertEqual(
                    [
                        name
                        for name in info["features"]
                        if name.startswith(f"labels.{sensor}.state")
                    ],
                    [f"labels.{sensor}.state"],
                )

    def test_points_of_units_are_a_feature(self):
        dataset, out = make("papillarray/stage.yaml"), self.folder / "points"
        export(dataset, out, "--format", "lerobot", "--points")
        info, table, episodes = read(out / "1000hz")
        names = {
            "unit": [str(unit) for unit in range(9)],
            "value": ["x [m]", "y [m]", "z [m]", "fx [N]", "fy [N]", "fz [N]"],
        }
        self.assertEqual(
            info["features"].pop("observation.tactile.pad"),
            {"dtype": "float32", "shape": [9, 6], "names": names},
        )
        self.check_layout(info, table.drop_columns(["observation.tactile.pad"]), episodes, 1000)
        stored = pyarrow.parquet.read_table(out / "1000hz/data/chunk-000/file-000.parquet")[
            "observation.tactile.pad"
        ]
        points = np.array(stored.to_pylist(), np.float32)
        with h5py.File(dataset) as file:
            for _, row in episodes.iterrows():
                demo = file[f"data/demo_{row['trial']}"]
                part = points[row["dataset_from_index"] : row["dataset_to_index"]]
                attrs, pad = demo["labels/pad"].attrs, demo["sensors/pad"]
                # The trial begins with all sensors read, so each sample is a frame.
                places = np.column_stack([attrs["unit_positions"], attrs["unit_heights"]])
                np.testing.assert_array_equal(
                    part[..., :3], (places + pad["displacement"][:]).astype(np.float32)
                )
                np.testing.assert_array_equal(part[..., 3:], pad["force"][:])
        stats = json.loads((out / "1000hz/meta/stats.json").read_text())["observation.tactile.pad"]
        np.testing.assert_array_equal(stats["max"], points.max(axis=0))
        np.testing.assert_array_equal(
            np.max(
                [np.stack(one) for one in episodes["stats/observation.tactile.pad/max"].map(list)],
                axis=0,
            ),
            points.max(axis=0),
        )
        export(dataset, self.folder / "without", "--format", "lerobot")
        self.assertNotIn(
            "observation.tactile.pad", read(self.folder / "without/1000hz")[0]["features"]
        )

    def test_points_need_forces_of_units(self):
        out = self.folder / "out"
        _, told = export(make("myrmex/slip.yaml"), out, "--format", "lerobot", "--points", status=2)
        self.assertRegex(
            told,
            r"--points: .*the forces or the positions of the units are not recorded.*papillarray",
        )
        _, told = export(
            make("papillarray/stage.yaml"), out, "--format", "parquet", "--points", status=2
        )
        self.assertIn("parquet cannot contain points of units; --points needs lerobot", told)
        self.assertFalse(out.exists())

    def test_what_cannot_be_is_refused_and_nothing_is_left(self):
        dataset = make("papillarray/stage.yaml")
        out = self.folder / "out"
        _, told = export(dataset, out, "--format", "lerobot", "--rate", "62.5 Hz", status=2)
        self.assertRegex(told, "lerobot.*pad.* 62.5 Hz.*--rate")
        self.assertFalse(out.exists())
        for name, message in (
            ("1000hz", "is not a LeRobot dataset of slipbench"),
            ("1000hz.partial", "is not left by a killed export"),
        ):
            with self.subTest(name=name):
                notes = self.folder / name[6:] / "out" / name / "notes.txt"
                notes.parent.mkdir(parents=True)
                notes.write_text("mine")
                _, told = export(dataset, notes.parent.parent, "--format", "lerobot", status=2)
                self.assertIn(message, told)
                self.assertEqual(contents(notes.parent.parent), {f"{name}/notes.txt": b"mine"})


class Recordings(ExportTest):
    """Logs of one channel with the effects of a recorder's clock and float32 timestamps."""

    def imported(self, name, times, digits=6):
        table, columns, dataset = (
            self.folder / f"{name}.csv",
            self.folder / "map.yaml",
            self.folder / f"{name}.h5",
        )
        table.write_text(
            "t,f\n" + "".join(f"{time:.{digits}f},{k}\n" for k, time in enumerate(times))
        )
        columns.write_text(
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}}\n"
        )
        subprocess.run(
            [PROGRAM, "import", table, "--format", "csv", "--map", columns, "-o", dataset],
            capture_output=True,
            check=True,
        )
        return dataset

    def check_steps(self, info, table):
        """LeRobot's own check: every step inside an episode is 1/fps within 1e-4 s, in float32."""
        stamps, episodes = table["timestamp"].to_numpy(), table["episode_index"].to_numpy()
        self.assertEqual(stamps.dtype, np.float32)
        inside = np.diff(episodes) == 0
        self.assertLess(np.max(np.abs(np.diff(stamps) - np.float32(1 / info["fps"]))[inside]), 1e-4)

    def test_a_long_recording_becomes_several_episodes(self):
        # Floats are 2^-13 s apart from 1,024 s on and 2^-12 s from 2,048 s on. There 0.1 s is 819.2
        # and 409.6 spacings, while a step is a whole number of them: it deviates by at most 0.8 of
        # 2^-13 s = 0.098 ms, then by 0.6 of 2^-12 s = 0.146 ms. So an episode ends at 2,048 s, and
        # 3,000 s need two.
        dataset, out = (
            self.imported("long", [k / 10 for k in range(30_000)], 1),
            self.folder / "long",
        )
        _, told = export(dataset, out, "--format", "lerobot")
        self.assertIn(
            "slipbench: note: trial 0: its 30000 frames at 10 fps become 2 episodes", told
        )
        info, table, episodes = read(out / "10hz")
        self.check_steps(info, table)
        self.assertEqual(list(episodes["length"]), [15_000] * 2)
        self.assertEqual(list(info["splits"].values()), ["0:2"])
        np.testing.assert_array_equal(
            table["observation.pad.force"], np.arange(30_000, dtype=np.float32)
        )
        np.testing.assert_array_equal(table["time"], [round(k / 10, 1) for k in range(30_000)])
        np.testing.assert_array_equal(table["frame_index"], np.tile(np.arange(15_000), 2))
        # 0.01 s is 81.92 spacings of 2^-13 s: 0.112 ms from 1,024 s on.
        dataset, out = (
            self.imported("hundred", [k / 100 for k in range(103_000)], 2),
            self.folder / "hundred",
        )
        export(dataset, out, "--format", "lerobot")
        info, table, episodes = read(out / "100hz")
        self.check_steps(info, table)
        self.assertEqual(list(episodes["length"]), [51_500] * 2)

    def test_stamps_that_float32_holds_exactly_stay_one_episode(self):
        # 1/4 s is a power of two: exact until 2^22 s.
        dataset, out = (
            self.imported("quarters", [k / 4 for k in range(8000)], 2),
            self.folder / "quarters",
        )
        _, told = export(dataset, out, "--format", "lerobot", "--rate", "4 Hz")
        self.assertNotIn("note", told)
        info, table, episodes = read(out / "4hz")
        self.check_steps(info, table)
        self.assertEqual(list(episodes["length"]), [8000])

    def test_a_slow_clock_is_written_at_the_nearest_whole_rate(self):
        dataset = self.imported("slow", [0.010001 * k for k in range(500)])  # 99.99 Hz
        for words in ([], ["--rate", "100 Hz"]):
            out = self.folder / f"slow{len(words)}"
            _, told = export(dataset, out, "--format", "lerobot", *words)
            self.assertIn(
                "slipbench: note: trial 0: pad was recorded at 99.99 Hz and is written as 100 fps",
                told,
            )
            info, table, _ = read(out / "100hz")
            self.check_steps(info, table)
            # Every sample once, at the recorder's own time.
            np.testing.assert_array_equal(
                table["observation.pad.force"], np.arange(500, dtype=np.float32)
            )
            np.testing.assert_allclose(
                table["time"], [0.010001 * k for k in range(500)], rtol=0, atol=1e-12
            )
        _, told = export(
            dataset, self.folder / "fast", "--format", "lerobot", "--rate", "102 Hz", status=2
        )
        self.assertRegex(told, " 102 Hz .*'pad'.* 99.99 Hz")

    def test_frames_are_not_counted_where_samples_are_missing(self):
        dataset, out = (
            self.imported("gap", [k / 100 + (0.5 if k >= 300 else 0) for k in range(600)], 2),
            self.folder / "gap",
        )
        _, told = export(dataset, out, "--format", "lerobot", status=2)
        self.assertIn(
            "trial 0: pad: its samples are not evenly spaced (92.2958 Hz on average, 100 Hz by the median step, the longest step is 0.51 s",
            told,
        )
        self.assertFalse(out.exists())

    def test_other_rates_of_later_trials_are_refused(self):
        (self.folder / "logs").mkdir()
        for name, rate in (("a", 100), ("b", 50)):
            (self.folder / f"logs/{name}.csv").write_text(
                "t,f\n" + "".join(f"{k / rate:.2f},{k}\n" for k in range(100))
            )
        self.imported("any", [0, 1])  # for its map
        dataset = self.folder / "two.h5"
        subprocess.run(
            [
                PROGRAM,
                "import",
                self.folder / "logs",
                "--format",
                "csv",
                "--map",
                self.folder / "map.yaml",
                "-o",
                dataset,
            ],
            capture_output=True,
            check=True,
        )
        _, told = export(dataset, self.folder / "two", "--format", "lerobot", status=2)
        self.assertRegex(told, r"trial \d: pad .*(50|100) Hz.*(100|50) Hz.*--rate")
        export(dataset, self.folder / "two", "--format", "lerobot", "--rate", "50 Hz")


if __name__ == "__main__":
    unittest.main()
