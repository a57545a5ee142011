"""Simulated and stored trials have one interface, representations and windows. Argument: the program."""

import dataclasses
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import slipbench

del sys.argv[1]


class OneInterface(unittest.TestCase):
    """Each attribute of a simulated trial equals the stored one in value, shape and type."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.pairs, cls.opened = [], []
        for name, sets in (
            ("papillarray/stage.yaml", {}),
            ("grasp/lift.yaml", {"duration": "2 s", "motion.distance": "10 mm"}),
            ("piezo_skin/slide.yaml", {}),
            ("bodies/sliding_block.yaml", {}),
        ):
            scene = slipbench.Scene.load(name).set(sets)
            path = Path(cls.folder.name) / name.replace("/", "_").replace("yaml", "h5")
            scene.write(path, trials=1)
            cls.opened.append(slipbench.open(path))
            cls.pairs.append((name, scene.run(), cls.opened[-1][0]))

    @classmethod
    def tearDownClass(cls):
        for data in cls.opened:
            data.close()
        cls.folder.cleanup()

    def same(self, simulated, stored):
        """Compares all fields of a dataclass."""
        for field in dataclasses.fields(simulated):
            one, other = getattr(simulated, field.name), getattr(stored, field.name)
            with self.subTest(field=field.name):
                if isinstance(one, np.ndarray):
                    self.assertEqual((one.dtype, one.shape), (other.dtype, other.shape))
                    np.testing.assert_array_equal(one, other)
                elif field.name in ("channels", "channel_time"):
                    self.assertEqual(list(one), list(other))
                    for name in one:
                        np.testing.assert_array_equal(one[name], other[name])
                else:
                    self.assertEqual(one, other)

    def test_all_attributes_agree(self):
        for name, simulated, stored in self.pairs:
            with self.subTest(scene=name):
                for attribute in ("trial", "seed", "params", "outcome", "sha256", "contacts"):
                    self.assertEqual(getattr(simulated, attribute), getattr(stored, attribute))
                for attribute in ("sensors", "labels", "bodies"):
                    ours, theirs = getattr(simulated, attribute), getattr(stored, attribute)
                    self.assertEqual(sorted(ours), sorted(theirs))
                    for key in ours:
                        self.same(ours[key], theirs[key])
                self.assertEqual(simulated.control is None, stored.control is None)
                if simulated.control is not None:
                    self.same(simulated.control, stored.control)
                for sensor in simulated.sensors.values():
                    for channel in sensor.channels:
                        np.testing.assert_array_equal(
                            getattr(sensor, channel), getattr(stored.sensors[sensor.name], channel)
                        )
                        np.testing.assert_array_equal(
                            sensor[channel], stored.sensors[sensor.name][channel][:]
                        )

    def test_names_that_are_not_there_are_named(self):
        _, simulated, stored = self.pairs[0]
        for trial in (simulated, stored):
            with self.assertRaisesRegex(
                AttributeError,
                "sensor 'pad' has no channel or attribute 'forces'; channels: .*force",
            ):
                _ = trial.sensors["pad"].forces
            with self.assertRaises(AttributeError):
                _ = trial.labels["pad"].stat
            with self.assertRaises(KeyError):
                trial.labels["pad"]["stat"]
            self.assertFalse(hasattr(trial.bodies["pad"], "time"))

    def test_representations_are_short_and_show_shapes_and_units(self):
        for name, simulated, stored in self.pairs:
            for trial in (simulated, stored):
                with self.subTest(scene=name, kind=type(trial).__name__):
                    self.assertLess(len(repr(trial)), 400)
                    for held in (
                        *trial.sensors.values(),
                        *trial.labels.values(),
                        *trial.bodies.values(),
                    ):
                        self.assertRegex(repr(held), r"^<slipbench\.(Sensor|Labels|Body)\b.*\[\d+")
                        self.assertIn("<table>", held._repr_html_())
                    self.assertIn("<table>", trial._repr_html_())
        _, simulated, stored = self.pairs[0]
        self.assertEqual(repr(simulated), repr(stored))
        self.assertEqual(repr(simulated.sensors["pad"]), repr(stored.sensors["pad"]))
        self.assertRegex(
            repr(simulated.sensors["pad"]),
            r"^<slipbench\.Sensor 'pad' papillarray, 4000 samples at 1000 Hz: .*force \[4000, 9, 3\] N",
        )
        self.assertRegex(repr(simulated.bodies["pad"]), r"pose \[4000, 7\] m, quaternion wxyz")


class Windows(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = Path(cls.folder.name) / "speeds.h5"
        sweep = {"friction.scale": [0.8, 1.0, 1.2], "motion.speed": ["2 mm/s", "4 mm/s"]}
        slipbench.Scene.load("papillarray/stage.yaml").set(
            sweep=sweep, split={"by": "trial", "shares": [0.5, 0.25, 0.25]}
        ).write(path)
        cls.data = slipbench.open(path)

    @classmethod
    def tearDownClass(cls):
        cls.data.close()
        cls.folder.cleanup()

    def test_arrays_are_the_windows_with_their_trials(self):
        for part in ("", "train"):
            windows = self.data.windows(length=40, stride=30, channels=["force"], part=part)
            X, y, groups = windows.arrays()
            self.assertEqual(
                (X.shape, X.dtype, y.dtype, groups.dtype),
                ((len(windows), 40, 27), np.float32, np.uint8, np.int64),
            )
            for at in range(0, len(windows), 17):
                values, slips = windows[at]
                np.testing.assert_array_equal(X[at], values)
                self.assertEqual((int(y[at]), int(groups[at])), (slips, windows.trial(at)))
            self.assertEqual(
                sorted(set(groups.tolist())), self.data.mask(part) if part else self.data.trials
            )
            self.assertEqual(windows.trial(-1), groups[-1])

    def test_a_window_knows_its_time(self):
        windows = self.data.windows(length=40, stride=30)
        times = self.data[windows.trial(1)].sensors["pad"].t
        self.assertEqual(
            windows.time(1), times[30 + 39]
        )  # the last sample of the window that begins at sample 30

    def test_labels_are_strict_unless_they_are_said(self):
        for rule, array in (
            ("strict", "state"),
            ("micro", "state_micro"),
            ("paper", "state_paper"),
        ):
            _, y, _ = self.data.windows(length=1, labels=rule).arrays()
            states = np.concatenate(
                [getattr(self.data[trial].labels["pad"], array) for trial in self.data.trials]
            )
            np.testing.assert_array_equal(y, states >= 2)
        np.testing.assert_array_equal(
            self.data.windows(length=1).arrays()[1],
            self.data.windows(length=1, labels="strict").arrays()[1],
        )

    def test_too_many_are_refused(self):
        # 6 trials of 4000 samples have 6 * 2001 windows of 2000 samples, of 54 float32 each: 5.19
        # GB.
        with (
            unittest.mock.patch("slipbench._data._MOST_BYTES", 5e9),
            self.assertRaisesRegex(
                slipbench.InputError,
                "12006 windows of 2000 samples of 54 values need 5.19 GB; allowed: 5 GB; use a greater stride",
            ),
        ):
            self.data.windows(length=2000).arrays()


if __name__ == "__main__":
    unittest.main()
