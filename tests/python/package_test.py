"""The package gives the command line's results. Argument: the program."""

import gzip
import importlib.util
import json
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path

import h5py
import numpy as np
import slipbench

PROGRAM = sys.argv.pop(1)


def command_line(folder, *words):
    """Returns the dataset that the program writes."""
    path = str(Path(folder) / "command.h5")
    subprocess.run([PROGRAM, *words, "-o", path, "--quiet"], check=True)
    return path


class Trials(unittest.TestCase):
    def test_digests_are_those_of_the_command_line(self):
        for scene, sets in (
            ("papillarray/stage.yaml", {"motion.speed": "8 mm/s"}),
            ("grasp/lift.yaml", {"duration": "2 s", "motion.distance": "10 mm"}),
            ("piezo_skin/slide.yaml", {}),
        ):
            with self.subTest(scene=scene), tempfile.TemporaryDirectory() as folder:
                words = [
                    word for path, value in sets.items() for word in ("--set", f"{path}={value}")
                ]
                path = command_line(
                    folder,
                    "run",
                    str(slipbench.scenes() / scene),
                    *words,
                    "--seed",
                    "5",
                    "--trials",
                    "2",
                )
                with slipbench.open(path) as stored:
                    self.assertEqual(stored.trials, [0, 1])
                    for number, trial in stored.items():
                        simulated = slipbench.Scene.load(scene).set(sets).run(number, seed=5)
                        self.assertEqual(simulated.sha256, trial.sha256)
                        self.assertEqual(
                            (simulated.outcome, simulated.params), (trial.outcome, trial.params)
                        )

    def test_written_datasets_are_those_of_the_command_line(self):
        sweep = {"motion.speed": ["2 mm/s", "4 mm/s"], "trials": 2}
        with tempfile.TemporaryDirectory() as folder:
            path = command_line(
                folder,
                "sweep",
                str(slipbench.scenes() / "papillarray/stage.yaml"),
                "--set",
                "sweep=" + json.dumps(sweep),
            )
            own = str(Path(folder) / "own.h5")
            told = []
            summary = (
                slipbench.Scene.load("papillarray/stage.yaml")
                .set(sweep=sweep)
                .write(own, jobs=2, progress=lambda *at: told.append(at))
            )
            self.assertEqual(sorted(told), told)
            self.assertEqual(told[-1], (4, 4))
            self.assertEqual(summary["files"], [own])
            with h5py.File(own) as one, h5py.File(path) as other:
                self.assertEqual(one.attrs["content_sha256"], other.attrs["content_sha256"])

    def test_a_sweep_gives_every_trial_in_order_whatever_the_threads(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml").set(
            sweep={"motion.speed": ["1 mm/s", "2 mm/s", "4 mm/s"], "trials": 2}
        )
        self.assertEqual(scene.trials(), 6)
        one = [trial.sha256 for trial in scene.sweep(jobs=1)]
        self.assertEqual([trial.sha256 for trial in scene.sweep(jobs=4)], one)
        self.assertEqual([scene.run(number).sha256 for number in range(6)], one)
        self.assertEqual(one[::2], one[1::2])  # an ideal sensor draws nothing
        self.assertEqual(len(set(one)), 3)

    def test_an_abandoned_sweep_ends_its_trials(self):
        sweep = slipbench.Scene.load("grasp/lift.yaml").set(sweep={"trials": 100}).sweep(jobs=2)
        next(sweep)
        sweep.close()
        self.assertEqual(sweep.done, 1)
        self.assertEqual([thread.name for thread in threading.enumerate()], ["MainThread"])

    def test_arrays_are_views_that_outlive_the_trial(self):
        trial = slipbench.Scene.load("papillarray/stage.yaml").run()
        force = trial.sensors["pad"].force
        again = trial._record.sensors(trial._record)["pad"]["channels"]["force"]
        self.assertEqual(force.__array_interface__["data"][0], again.__array_interface__["data"][0])
        self.assertFalse(force.flags.writeable)
        copy = force.copy()
        del trial, again
        np.testing.assert_array_equal(force, copy)

    def test_outcome_alone_has_no_arrays(self):
        trial = slipbench.Scene.load("papillarray/stage.yaml").run(record="outcome")
        self.assertEqual(trial.sensors, {})
        self.assertGreater(trial.outcome["first_slip_time_s"], 0.0)

    def test_bodies_and_control_stand_beside_the_sensors(self):
        trial = (
            slipbench.Scene.load("grasp/lift.yaml")
            .set({"duration": "2 s", "motion.distance": "10 mm"})
            .run()
        )
        samples = len(trial.control.t)
        self.assertEqual(trial.control.command.shape, (samples, 3))
        self.assertEqual(
            (trial.control.detector, trial.control.controller), ("gst_hd", "step_on_slip")
        )
        self.assertEqual(trial.bodies["box"]["pose"].shape[1], 7)

    def test_stored_trials_look_as_simulated_ones(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set(
            {"duration": "2 s", "motion.distance": "10 mm"}
        )
        one = scene.run()
        with tempfile.TemporaryDirectory() as folder:
            scene.write(folder + "/lift.h5", trials=1)
            with slipbench.open(folder + "/lift.h5") as data:
                other = data[0]
                for simulated, stored in (
                    (one.sensors["pad"], other.sensors["pad"]),
                    (one.labels["pad"], other.labels["pad"]),
                    (one.bodies["box"], other.bodies["box"]),
                    (one.control, other.control),
                ):
                    with self.subTest(name=type(stored).__name__):
                        self.assertEqual(
                            {
                                name
                                for name in set(dir(simulated)) - set(dir(stored))
                                if not name.startswith("_")
                            },
                            set(),
                        )
                        self.assertEqual(
                            (repr(stored), stored._repr_html_()),
                            (repr(simulated), simulated._repr_html_()),
                        )
                        for name, shape, _ in simulated._rows():
                            self.assertEqual(getattr(stored, name).shape, shape)
                            self.assertFalse(getattr(stored, name).flags.writeable, name)
                self.assertFalse(other.sensors["pad"].channels["force"].flags.writeable)

    def test_a_check_is_that_of_the_command_line(self):
        path, expect = (
            slipbench.scenes() / "grasp/lift.yaml",
            {"dropped": False, "max_slip": "0.1 mm"},
        )
        with tempfile.TemporaryDirectory() as folder:  # a failed check leaves its evidence there
            done = subprocess.run(
                [
                    str(Path(PROGRAM).resolve()),
                    "check",
                    str(path),
                    "--set",
                    "duration=2.5 s",
                    "--set",
                    "motion.distance=30 mm",
                    "--set",
                    "expect=" + json.dumps(expect),
                    "--trials",
                    "2",
                    "--json",
                ],
                capture_output=True,
                text=True,
                check=False,
                cwd=folder,
            )
        told = json.loads(done.stdout)["scenes"][0]
        check = (
            slipbench.Scene.load(path)
            .set({"duration": "2.5 s", "motion.distance": "30 mm", "expect": expect})
            .check(draws=2)
        )
        self.assertEqual(check.verdict, told["verdict"])
        self.assertEqual(
            [one["kept"] for one in check.expectations],
            [one["kept"] for one in told["expectations"]],
        )


class Warnings(unittest.TestCase):
    """Warnings of the command line are Python warnings with the same text."""

    STAGE = str(slipbench.scenes() / "papillarray/stage.yaml")
    LIFT = str(slipbench.scenes() / "grasp/lift.yaml")

    def told(self, call):
        """Returns the texts of the warnings in `call`, and its result.

        All warnings are at lines of this file.
        """
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = call()
        self.assertEqual({Path(one.filename).name for one in caught} - {Path(__file__).name}, set())
        return [str(one.message) for one in caught], result

    def command_lines(self, verb, scene, sets, *words):
        sets = [
            word
            for path, value in sets.items()
            for word in (
                "--set",
                f"{path}={value if isinstance(value, str) else json.dumps(value)}",
            )
        ]
        done = subprocess.run(
            [PROGRAM, verb, scene, *sets, *words, "--json"],
            capture_output=True,
            text=True,
            check=True,
        )
        return [one["text"] for one in json.loads(done.stdout)["warnings"]]

    def test_a_value_is_warned_of_where_it_is_set(self):
        brief = {"duration": "2.5 s"}
        for scene, sets in (
            (self.STAGE, {"motion.speed": 8}),
            (self.STAGE, {"motion.start": "3 s"}),
            (self.STAGE, {"motion.speed": [2, 4]}),
            (self.LIFT, {"motion.speed": 5, "motion.distance": "10 mm"}),
        ):
            verb = "run"
            if isinstance(sets.get("motion.speed"), list):
                sets, verb = {"sweep": sets}, "sweep"
            with self.subTest(sets=sets):
                expected = self.command_lines(verb, scene, {**brief, **sets})
                self.assertEqual(len(expected), 1, expected)
                told, made = self.told(
                    lambda scene=scene, sets=sets: slipbench.Scene.load(scene).set(
                        {**brief, **sets}
                    )
                )
                self.assertEqual(told, expected)
                self.assertEqual(
                    self.told(lambda made=made: made.set(seed=3).run(record="outcome"))[0],
                    [],
                    "said twice",
                )

    def test_what_takes_a_look_at_sensors_is_warned_of_before_trials_run(self):
        deep = {"duration": "2.1 s", "motion.compression": "5 mm"}
        expected = self.command_lines("run", self.STAGE, deep)
        self.assertIn("motion.compression", " ".join(expected))
        scene = slipbench.Scene.load(self.STAGE)
        self.assertEqual(
            sorted(self.told(lambda: scene.set(deep).run(record="outcome"))[0]), sorted(expected)
        )
        self.assertEqual(
            sorted(self.told(lambda: list(scene.set(deep).sweep(record="outcome")))[0]),
            sorted(expected),
        )

    def test_a_dataset_without_a_part_is_warned_of(self):
        sets = {
            "duration": "2 s",
            "motion.distance": "10 mm",
            "sweep": {"surface.material": ["ptfe", "felt"]},
        }
        with tempfile.TemporaryDirectory() as folder:
            expected = self.command_lines("sweep", self.LIFT, sets, "-o", folder + "/command.h5")
            self.assertEqual(len(expected), 1, expected)
            self.assertEqual(
                self.told(
                    lambda: slipbench.Scene.load(self.LIFT).set(sets).write(folder + "/own.h5")
                )[0],
                expected,
            )

    def test_environments_warn_when_they_are_made(self):
        import gymnasium
        import slipbench.gym

        sets = {"motion.speed": 5, "motion.distance": "10 mm"}
        expected = self.command_lines("run", self.LIFT, sets)
        for make in (slipbench.gym.GraspEnv, slipbench.gym.GraspVectorEnv):
            self.assertEqual(
                self.told(lambda make=make: make(scene=self.LIFT, values=sets))[0], expected
            )
        with self.assertWarnsRegex(UserWarning, "5 has no unit, so it is in m/s"):
            gymnasium.make("slipbench/Grasp-v0", values=sets)
        self.assertEqual(
            self.told(
                lambda: slipbench.gym.StageSlipEnv(
                    self.STAGE, {"duration": "2.5 s", "motion.speed": 8}
                )
            )[0],
            self.command_lines("run", self.STAGE, {"duration": "2.5 s", "motion.speed": 8}),
        )


class Errors(unittest.TestCase):
    def test_bad_input_is_the_programs_own_message(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "stage.yaml"
            path.write_text(
                "slipbench: 1\nduration: 1 s\nmotion: {sped: 1 mm/s}\nsensors: {pad: {type: papillarray}}\n"
            )
            with self.assertRaisesRegex(
                slipbench.InputError,
                r"stage.yaml:3: unknown key 'sped' in motion; did you mean 'speed'",
            ):
                slipbench.Scene.load(path)
        with self.assertRaisesRegex(ValueError, "--set motion.speed=fast"):
            slipbench.Scene.load("papillarray/stage.yaml").set({"motion.speed": "fast"})
        with self.assertRaisesRegex(slipbench.InputError, "gone.yaml: cannot be read"):
            slipbench.Scene.load("gone.yaml")
        with self.assertRaisesRegex(slipbench.InputError, "trial -1.* 0 "):
            slipbench.Scene.load("papillarray/stage.yaml").run(-1)

    def test_counts_that_cannot_be_are_named(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        for call, told in (
            (lambda: scene.sweep(jobs=-1), "jobs=-1; allowed"),
            (lambda: scene.run(seed=-1), "seed=-1; allowed"),
            (lambda: scene.run(seed=2**64), "allowed"),
            (lambda: scene.check(draws=-2), "draws=-2; allowed"),
            (lambda: scene.write("never.h5", draws=3, trials=2), "draws=3.*trials=2"),
        ):
            with self.subTest(told=told), self.assertRaisesRegex(slipbench.InputError, told):
                call()
        self.assertFalse(Path("never.h5").exists())

    def test_interrupts_go_back_to_python_when_the_last_thread_is_done(self):
        scene, before = (
            slipbench.Scene.load("papillarray/stage.yaml"),
            signal.getsignal(signal.SIGINT),
        )
        threads = [
            threading.Thread(target=lambda: [scene.run(k, record="outcome") for k in range(10)])
            for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        with self.assertRaises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)

    def test_channels_of_another_rate_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "nib.h5"
            slipbench.Scene.load("nib_pad/reorient.yaml").set({"duration": "1 s"}).write(
                path, trials=1
            )
            with slipbench.open(path) as data:
                name = next(iter(data[0].sensors))
                rates = {channel: len(values) for channel, values in data[0].sensors[name].items()}
                self.assertGreater(len(set(rates.values())), 1)
                with self.assertRaisesRegex(slipbench.InputError, "rate.*labels.*channels="):
                    data.windows(length=4, sensor=name)[0]
                with self.assertRaisesRegex(slipbench.InputError, "'nope'.*channels="):
                    data.windows(length=4, sensor=name, channels=["nope"])[0]

    def test_records_and_parts_are_named(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        with self.assertRaisesRegex(slipbench.InputError, "'full', 'outcome'"):
            scene.run(record="all")


class Datasets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = str(Path(cls.folder.name) / "speeds.h5")
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        scene.set(sweep={"motion.speed": ["2 mm/s", "4 mm/s", "8 mm/s"], "trials": 2}).write(
            cls.path
        )

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_masks_and_outcomes(self):
        with slipbench.open(self.path) as data:
            parts = [data.mask(part) for part in ("train", "valid", "test")]
            self.assertEqual(sorted(sum(parts, [])), list(range(6)))
            table = data.to_pandas()
            self.assertEqual(table.index.tolist(), list(range(6)))
            self.assertEqual(table["motion.speed"].tolist(), [2e-3, 2e-3, 4e-3, 4e-3, 8e-3, 8e-3])
            self.assertTrue(data.complete)
            self.assertEqual(data.failed, [])

    def test_windows_are_the_samples_and_their_last_label(self):
        with slipbench.open(self.path) as data:
            length, stride = 40, 7
            windows = data.windows(length=length, stride=stride, channels=["force"], labels="micro")
            samples = data[0].sensors["pad"]["force"].shape[0]
            each = (samples - length) // stride + 1  # windows that fit into a trial
            self.assertEqual(len(windows), 6 * each)
            for index in (0, each - 1, each, 3 * each + 5, len(windows) - 1):
                trial, first = data[index // each], index % each * stride
                values, slips = windows[index]
                np.testing.assert_array_equal(
                    values,
                    trial.sensors["pad"]["force"][first : first + length].reshape(length, -1),
                )
                self.assertEqual(
                    slips, int(trial.labels["pad"]["state_micro"][first + length - 1] >= 2)
                )
            self.assertEqual(windows[-1][1], windows[len(windows) - 1][1])
            self.assertEqual(len(windows[2:5]), 3)
            with self.assertRaises(IndexError):
                windows[len(windows)]

    def test_notebooks_show_shapes(self):
        with slipbench.open(self.path) as data:
            windows = data.windows(length=40, channels=["force"])
            self.assertIn("<code>pad.force</code>", data._repr_html_())
            self.assertIn(f"<td>[{len(windows)}, 40, 27]</td>", windows._repr_html_())
        for closed in (data, windows):  # nothing is read
            self.assertIn("slipbench.", closed._repr_html_())

    def test_windows_of_a_part_come_from_its_trials_alone(self):
        with slipbench.open(self.path) as data:
            every = len(data.windows(length=10))
            parts = [len(data.windows(length=10, part=part)) for part in ("train", "valid", "test")]
            self.assertEqual(sum(parts), every)
            self.assertEqual(parts[0], every // 6 * len(data.mask("train")))

    def test_windows_of_trials_that_differ_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = slipbench.Scene.from_text(
                "slipbench: 1\nduration: 0.6 s\nmotion: {start: 0.46 s}\n"
                "sensors: {pad: {type: papillarray, rate: 1 kHz}}\n"
            )
            path = Path(folder, "rates.h5")
            scene.set({"sweep": {"sensors.pad.rate": ["1 kHz", "100 Hz"], "trials": 2}}).write(path)
            with slipbench.open(path) as data:
                # 40 samples are 40 ms and 400 ms.
                with self.assertRaisesRegex(
                    slipbench.InputError,
                    r"trial 2: sensor 'pad' has 100 Hz, but 1000 Hz in trial 0.*trials=\[2, 3\]",
                ):
                    data.windows(length=4)
                self.assertEqual(
                    len(data.windows(length=4, stride=4, trials=[2, 3])),
                    2 * ((len(data[2].sensors["pad"].t) - 4) // 4 + 1),
                )
                with self.assertRaisesRegex(slipbench.InputError, "trials: 7; allowed"):
                    data.windows(length=4, trials=[0, 7])
            path = Path(folder, "durations.h5")
            scene.set({"sweep": {"duration": ["0.6 s", "0.5 s"], "trials": 1}}).write(path)
            with slipbench.open(path) as data:
                samples = [len(data[trial].sensors["pad"].t) for trial in (0, 1)]
                self.assertGreater(samples[0], samples[1])
                with self.assertRaisesRegex(
                    slipbench.InputError,
                    f"length 1000: the longest trial, 0, has {samples[0]} samples; allowed: 1 to {samples[0]}",
                ):
                    data.windows(length=1000)
                with self.assertWarnsRegex(
                    UserWarning,
                    f"1 of 2 trials has fewer than {samples[0]} samples and no window: 1",
                ):
                    self.assertEqual(len(data.windows(length=samples[0])), 1)
                with self.assertRaisesRegex(
                    slipbench.InputError, "trial 0: channel 'nope' is not there; allowed: .*'force'"
                ):
                    data.windows(length=4, channels=["nope"])

    def test_windows_without_trials_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "one.h5")
            slipbench.Scene.from_text(
                "slipbench: 1\nduration: 0.5 s\nmotion: {start: 0.46 s}\n"
                "sensors: {pad: {type: papillarray}}\n"
            ).write(path)
            with slipbench.open(path) as data:
                # The only trial is in one of the three masks.
                sizes = {part: len(data.mask(part)) for part in ("train", "valid", "test")}
                self.assertEqual(sorted(sizes.values()), [0, 0, 1])
                masks = ", ".join(f"'{part}' {size}" for part, size in sizes.items())
                for part, size in sizes.items():
                    if size:
                        self.assertGreater(len(data.windows(length=10, part=part)), 0)
                        continue
                    with self.assertRaises(slipbench.InputError) as caught:
                        data.windows(length=10, part=part)
                    self.assertEqual(
                        str(caught.exception),
                        f"part '{part}' has no trials; trials in the masks: {masks}, of 1 in the dataset",
                    )
                with self.assertRaises(slipbench.InputError) as caught:
                    data.windows(length=10, trials=[])
                self.assertEqual(
                    str(caught.exception),
                    f"trials: found an empty list; expected numbers of trials, or None for all of them; trials in the masks: {masks}",
                )

    def test_what_cannot_be_asked_for_is_said(self):
        with slipbench.open(self.path) as data:
            for wrong, told in (
                ({"length": 0}, "length 0"),
                ({"length": 4, "labels": "strickt"}, "labels 'strickt'.*'strict'"),
                ({"length": 4, "sensor": "skin"}, "sensor 'skin'.*'pad'"),
                ({"length": 4, "part": "rest"}, "part 'rest'.*'train'"),
            ):
                with self.subTest(wrong=wrong), self.assertRaisesRegex(slipbench.InputError, told):
                    data.windows(**wrong)

    def test_links_to_other_files_are_refused(self):
        linked = Path(self.folder.name) / "linked.h5"
        linked.write_bytes(Path(self.path).read_bytes())
        with h5py.File(linked, "r+") as file:
            group = file["data/demo_0/sensors/pad"]
            del group["force"]
            group["force"] = h5py.ExternalLink(self.path, "/data/demo_0/sensors/pad/force")
        with self.assertRaisesRegex(slipbench.InputError, "linked.h5: .*is a link to another file"):
            slipbench.open(linked)
        with (
            slipbench.open(linked, check=False) as data,
            self.assertRaisesRegex(slipbench.InputError, "is a link to another file"),
        ):
            data[0].sensors["pad"]["force"]


def values_of(path, check):
    """Returns everything that the package reads of a dataset, as text."""

    def arrays(group):
        return {
            name: arrays(group[name])
            if isinstance(group[name], slipbench.Arrays)
            else group[name][()].tobytes()
            for name in group
        }

    with slipbench.open(path, check=check) as data:
        return repr(
            [
                (
                    data.scene,
                    data.seed,
                    data.command,
                    data.failed,
                    [data.mask(part) for part in ("train", "valid", "test")],
                )
            ]
            + [
                (number, trial.params, trial.outcome, trial.sha256)
                + tuple(
                    {name: (arrays(group), group.attrs) for name, group in groups.items()}
                    for groups in (trial.sensors, trial.labels, trial.bodies)
                )
                for number, trial in data.items()
            ]
        )


class DamagedDatasets(unittest.TestCase):
    """The package refuses what the command line refuses.

    An InputError of one line that begins with the file's name.
    """

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name) / "a.h5"
        scene = slipbench.Scene.load("papillarray/stage.yaml").set(
            {"duration": "0.9 s", "motion.start": "0.5 s", "sensors.pad.rate": "100 Hz"}
        )
        scene = scene.set({"sweep": {"motion.speed": ["2 mm/s", "4 mm/s"]}})
        scene.write(cls.path)
        cls.whole = cls.path.read_bytes()
        scene.write(Path(cls.folder.name) / "other.h5", seed=5)
        cls.other = (Path(cls.folder.name) / "other.h5").read_bytes()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def refusal(self, path, **options):
        with self.assertRaises(slipbench.InputError) as refused, slipbench.open(path, **options):
            pass
        message = str(refused.exception)
        self.assertNotIn("\n", message)
        told = subprocess.run(
            [PROGRAM, "report", path, "-o", Path(self.folder.name) / "page.html"],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual((told.returncode, told.stderr), (2, f"slipbench: {message}\n"))
        return message

    def test_other_files_are_no_datasets(self):
        path = Path(self.folder.name) / "file.h5"
        self.assertIn(f"{path}: no such file", self.refusal(path))
        self.assertIn("is a folder", self.refusal(Path(self.folder.name)))
        kinds = {
            b"": "is empty",
            self.whole[:1]: "is truncated",
            self.whole[
                : len(self.whole) // 2
            ]: f"is truncated: it has {len(self.whole) // 2} of {len(self.whole)} bytes",
            self.whole[:-1]: "is truncated",
            bytes(4096): "is not an HDF5 file",
            b"version https://git-lfs.github.com/spec/v1\n": "is a Git LFS pointer, not the data; run 'git lfs pull'",
            b"<!DOCTYPE html>": "is an HTML page",
            gzip.compress(self.whole): "is compressed with gzip",
        }
        for data, kind in kinds.items():
            with self.subTest(kind=kind):
                path.write_bytes(data)
                self.assertIn(f"{path}: {kind}", self.refusal(path))
        path.write_bytes(self.whole + b"\0")
        self.assertEqual(values_of(path, check=True), values_of(self.path, check=True))

    def write_pair(self, first, second, number):
        """Joins `first` and `second` as files 0 and `number` of a dataset of two files."""
        paths = [Path(self.folder.name) / name for name in ("pair.h5", "pair-0001.h5")]
        for path, data, shard in zip(paths, (first, second), (0, number), strict=True):
            path.write_bytes(data)
            with h5py.File(path, "r+") as file:
                file.attrs.modify("shards", 2)
                file.attrs.modify("shard", shard)
                if shard:
                    for trial in (1, 0):
                        file.move(f"data/demo_{trial}", f"data/demo_{trial + 2}")
                    for part in ("train", "valid", "test"):
                        del file["mask"][part]
                        file["mask"][part] = np.array([], "S6")
        return paths

    def test_files_that_do_not_belong_together(self):
        first, second = self.write_pair(self.whole, self.other, 1)
        self.assertRegex(self.refusal(first), f"^{second}: .*another dataset.*{first}")
        first, second = self.write_pair(self.whole, self.whole, 0)
        self.assertIn(
            f"{second}: /: is file 0 of its dataset, but file 1 was expected", self.refusal(first)
        )
        self.assertEqual(self.refusal(first, check=False), self.refusal(first))
        second.unlink()
        self.assertRegex(self.refusal(first), f"^{second}: no such file.*file 1 .*{first}")
        second.write_bytes(self.whole[:1000])
        self.assertIn(
            f"{second}: is truncated: it has 1000 of {len(self.whole)} bytes", self.refusal(first)
        )
        first, second = self.write_pair(self.whole, self.whole, 1)
        with slipbench.open(
            first, check=False
        ) as data:  # together they are one; their digests belong to two
            self.assertEqual(data.trials, [0, 1, 2, 3])
        self.assertIn("is damaged: its content has the SHA-256", self.refusal(first))

    def test_a_flipped_bit_is_refused_or_changes_nothing(self):
        path = Path(self.folder.name) / "flip.h5"
        expected = values_of(self.path, check=True)
        used = [place for place, byte in enumerate(self.whole) if byte]
        refused = 0
        for k in range(60):
            places = used if k % 2 else range(len(self.whole))
            flipped = bytearray(self.whole)
            flipped[places[k * len(places) // 60]] ^= 1 << k // 2 % 8
            path.write_bytes(flipped)
            for check in (True, False):
                with self.subTest(flip=k, check=check):
                    try:
                        found = values_of(path, check)
                    except slipbench.InputError as error:
                        self.assertTrue(str(error).startswith(f"{path}: "), error)
                        refused += check
                    else:
                        self.assertTrue(found == expected or not check)
        self.assertGreater(refused, 15)


def with_training(network, trained):
    """Copies a network's file with other training data in its description.

    This is the last entry of the file.
    """
    data = network.read_bytes()
    start = data.rindex(
        b"\x72", 0, data.index(b"\n\tslipbench\x12")
    )  # metadata_props is field 14 of ModelProto, of the wire type 2
    text = data[data.index(b'{"format"', start) :]

    def field(tag, value):
        length, size = b"", len(value)
        while size > 127:
            length, size = length + bytes([size & 127 | 128]), size >> 7
        return bytes([tag]) + length + bytes([size]) + value

    description = json.loads(text) | {"trained": trained}
    return data[:start] + field(
        0x72, field(0x0A, b"slipbench") + field(0x12, json.dumps(description).encode())
    )


@unittest.skipUnless(importlib.util.find_spec("openvino"), "networks need the package openvino")
class Networks(unittest.TestCase):
    def test_a_network_is_not_judged_on_what_it_has_learnt(self):
        with tempfile.TemporaryDirectory() as folder:
            path, model = Path(folder) / "lifts.h5", Path(folder) / "grasp.onnx"
            slipbench.Scene.load("grasp/lift.yaml").set(
                {
                    "duration": "2 s",
                    "motion.distance": "10 mm",
                    "sensors.pad.rate": "1 kHz",
                    "sweep": {"trials": 3},
                }
            ).write(path)
            with slipbench.open(path) as data:
                learnt = [data[0].sha256, data[2].sha256]
            model.write_bytes(
                with_training(
                    slipbench.scenes() / "learn/papillarray_slip.onnx", {"sha256_seen": learnt}
                )
            )
            told = subprocess.run(
                [PROGRAM, "eval", str(model), str(path), "--json"],
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            own = slipbench.evaluate(str(model), path)
            self.assertEqual(own["left_out"], [0, 2])
            self.assertEqual(own["all"], json.loads(told)["all"])
            self.assertEqual(slipbench.evaluate(str(model), path, all_trials=True)["left_out"], [])
            with self.assertRaisesRegex(slipbench.InputError, "network.*FILE.onnx"):
                slipbench.evaluate("network", path)


class Words(unittest.TestCase):
    def test_describe_and_list_are_the_programs(self):
        told = json.loads(
            subprocess.run(
                [PROGRAM, "describe", "papillarray", "--json"],
                capture_output=True,
                text=True,
                check=True,
            ).stdout
        )
        self.assertEqual(slipbench.describe("papillarray"), told["entries"])
        self.assertIn("papillarray", [one["name"] for one in slipbench.list_names()["sensors"]])

    def test_versions_agree(self):
        told = subprocess.run(
            [PROGRAM, "--version"], capture_output=True, text=True, check=True
        ).stdout
        self.assertEqual(told.split()[1], slipbench.__version__)


if __name__ == "__main__":
    unittest.main()
