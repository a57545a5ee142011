"""Scenes from text and dicts, numpy values, quantities, random streams, and forces of units.

Argument: the program.
"""

import copy
import decimal
import fractions
import json
import pickle
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import slipbench

del sys.argv[1]

STAGE = {
    "slipbench": 1,
    "duration": "1.2 s",
    "surface": {"material": "rubber"},
    "motion": {"kind": "stage", "compression": "1 mm", "start": "0.5 s", "speed": "4 mm/s"},
    "sensors": {"pad": {"type": "papillarray", "rate": "1 kHz"}},
}


class Scenes(unittest.TestCase):
    def test_text_dict_and_file_are_the_same_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "stage.yaml"
            path.write_text(json.dumps(STAGE), encoding="utf-8")
            digest = slipbench.Scene.load(path).run().sha256
        self.assertEqual(slipbench.Scene.from_text(json.dumps(STAGE)).run().sha256, digest)
        self.assertEqual(slipbench.Scene.from_dict(STAGE).run().sha256, digest)
        self.assertEqual(
            slipbench.Scene.from_dict(STAGE)
            .set({"motion.speed": 0.002})
            .set({"motion.speed": "4 mm/s"})
            .run()
            .sha256,
            digest,
        )

    def test_a_scene_of_text_writes_and_its_paths_begin_in_the_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = slipbench.Scene.from_dict(
                {**STAGE, "sweep": {"motion.speed": ["2 mm/s", "4 mm/s"]}}, folder=folder
            )
            out = Path(folder) / "out.h5"
            self.assertEqual(scene.write(out)["files"], [str(out)])
            with slipbench.open(out) as data:
                self.assertEqual(
                    [trial.sha256 for trial in data.values()],
                    [trial.sha256 for trial in scene.sweep()],
                )
                self.assertEqual(data.scene, scene.text)
            detector = {"type": "network", "model": "missing.onnx"}
            with self.assertRaisesRegex(slipbench.InputError, f"{folder}/missing.onnx"):
                slipbench.Scene.from_dict({**STAGE, "detector": detector}, folder=folder).run()
            with self.assertRaisesRegex(
                slipbench.InputError, r"detector\.model: missing\.onnx: cannot be opened"
            ):
                scene.set({"detector": detector}).run()

    def test_wrong_text_is_named_by_line_or_key(self):
        with self.assertRaisesRegex(slipbench.InputError, "<text>:2: unknown key 'sped' in motion"):
            slipbench.Scene.from_text("slipbench: 1\nmotion: {sped: 1}\n")
        for values, message in (
            ({"motion": {"sped": 1}}, r"^motion\.sped: unknown key 'sped' in motion"),
            ({"motion": {"tilt": [0, 1, 2]}}, r"^motion\.tilt has 3 entries"),
            (
                {"sensors": {"pad": {"type": "papillarray", "electronics": [{"nois": {}}]}}},
                r"^sensors\.pad\.electronics\.0\.nois: unknown part",
            ),
            (
                {"sweep": {"motion.speed": ["1 mm/s", "2 mn/s"]}},
                r"^sweep\.motion\.speed\.1: motion\.speed: unknown unit 'mn/s'",
            ),
        ):
            with self.subTest(values=values), self.assertRaisesRegex(slipbench.InputError, message):
                slipbench.Scene.from_dict({**STAGE, **values})
        with self.assertWarnsRegex(UserWarning, r"^motion\.speed: 8 has no unit, so it is in m/s"):
            slipbench.Scene.from_dict({**STAGE, "motion": {**STAGE["motion"], "speed": 8}})
        with self.assertRaisesRegex(
            slipbench.InputError,
            r"scene\.motion\.speed: expected a number, a text, a list or a dict, found complex",
        ):
            slipbench.Scene.from_dict({"motion": {"speed": 1j}})
        with self.assertRaisesRegex(
            slipbench.InputError, r"scene\.motion: expected names as keys, found int 3"
        ):
            slipbench.Scene.from_dict({"motion": {3: 1}})
        with self.assertRaisesRegex(slipbench.InputError, "needs a scene in a file"):
            slipbench.Scene.from_dict(STAGE).check()

    def test_wrong_types_are_refused(self):
        for value in (Path("stage.yaml"), b"slipbench: 1", None, ["slipbench: 1"], STAGE):
            with (
                self.subTest(value=repr(value)),
                self.assertRaisesRegex(
                    slipbench.InputError,
                    rf"^text: expected a scene's YAML as str, found {type(value).__name__} ",
                ),
            ):
                slipbench.Scene.from_text(value)
        for value in (Path("stage.yaml"), b"slipbench: 1", None, ["slipbench"], "slipbench: 1"):
            with (
                self.subTest(value=repr(value)),
                self.assertRaisesRegex(
                    slipbench.InputError,
                    rf"^values: expected a dict of a scene's keys, found {type(value).__name__} ",
                ),
            ):
                slipbench.Scene.from_dict(value)

    def test_notebooks_show_its_text(self):
        scene = slipbench.Scene.from_text(json.dumps({**STAGE, "description": "a < b"})).set(
            {"description": "b & c"}
        )
        self.assertIn("a &lt; b", scene._repr_html_())
        self.assertIn("description=b &amp; c", scene._repr_html_())


class Numpy(unittest.TestCase):
    """Values as scripts have them: the field's tools return numpy's."""

    SCENE = slipbench.Scene.load("papillarray/stage.yaml")

    def test_any_number_is_a_number(self):
        expected = self.SCENE.set({"motion.speed": 0.004}).overrides
        for value in (
            np.float64(0.004),
            np.float32(0.004),
            np.float16(0.004),
            np.array(0.004),
            np.array(0.004, np.float32),
            fractions.Fraction(1, 250),
            decimal.Decimal("0.004"),
        ):
            with self.subTest(value=repr(value)):
                self.assertEqual(self.SCENE.set({"motion.speed": value}).overrides, expected)
        for value in (np.int64(3), np.int32(3), np.uint8(3), np.array(3)):
            with self.subTest(value=repr(value)):
                self.assertEqual(
                    self.SCENE.set({"sensors.pad.bristles": value}).overrides,
                    [("sensors.pad.bristles", "3")],
                )

    def test_any_sequence_is_a_list(self):
        speeds = [0.002, 0.004]
        expected = self.SCENE.set({"sweep": {"motion.speed": speeds, "trials": 3}}).overrides
        for value in (
            tuple(speeds),
            np.array(speeds),
            np.array(speeds, np.float32),
            list(np.array(speeds)),
        ):
            with self.subTest(value=repr(value)):
                scene = self.SCENE.set({"sweep": {"motion.speed": value, "trials": np.int64(3)}})
                self.assertEqual(scene.overrides, expected)
                self.assertEqual(scene.trials(), 6)
        self.assertEqual(
            self.SCENE.set({"sweep": {"sensors.pad.bristles": range(3, 5)}}).overrides,
            [("sweep", '{"sensors.pad.bristles": [3, 4]}')],
        )
        self.assertEqual(
            self.SCENE.set({"description": Path("a/b")}).overrides, [("description", "a/b")]
        )

    def test_other_values_are_refused_with_their_key(self):
        for key, value in (
            ("motion.speed", 4e-3 + 0j),
            ("motion.speed", b"4 mm/s"),
            ("effects", {"ageing"}),
            ("motion.speed", np.datetime64("2026-01-01")),
            ("motion.speed", object()),
        ):
            with (
                self.subTest(value=repr(value)),
                self.assertRaisesRegex(slipbench.InputError, f"^{key}: expected a number"),
            ):
                self.SCENE.set({key: value})
        with self.assertRaisesRegex(
            slipbench.InputError, r"^sweep\.motion\.speed\.1: expected a number"
        ):
            self.SCENE.set({"sweep": {"motion.speed": [0.002, None.__class__]}})
        with self.assertRaisesRegex(
            slipbench.InputError, r"dotted paths as keys, such as 'motion\.speed', found 3"
        ):
            self.SCENE.set({3: 4})
        for value in (np.bool_(True), np.array([0.004]), float("nan")):
            with (
                self.subTest(value=repr(value)),
                self.assertRaisesRegex(slipbench.InputError, "motion.speed"),
            ):
                self.SCENE.set({"motion.speed": value})
        with self.assertRaisesRegex(slipbench.InputError, "no key 'sped' to remove"):
            self.SCENE.set({"motion.sped": None})

    def test_counts_may_be_numpys(self):
        self.assertEqual(
            self.SCENE.run(np.int64(0), seed=np.int32(3)).sha256, self.SCENE.run(seed=3).sha256
        )
        with self.assertRaisesRegex(
            slipbench.InputError, "^seed: expected a whole number, found float 3.0"
        ):
            self.SCENE.run(seed=3.0)
        with self.assertRaisesRegex(
            slipbench.InputError, "^trial: expected a whole number, found str '0'"
        ):
            self.SCENE.run("0")


class Quantities(unittest.TestCase):
    def test_text_is_read_as_in_a_scene(self):
        self.assertEqual(slipbench.parse_quantity("4 mm/s", "m/s"), 0.004)
        self.assertEqual(slipbench.parse_quantity("0.5 s"), 0.5)
        self.assertEqual(
            slipbench.parse_quantity("111 Hz", "kHz"), 111.0
        )  # the unit names the quantity, the result is SI
        self.assertEqual(slipbench.parse_quantity("3", ""), 3.0)
        self.assertEqual(slipbench.parse_quantity("9 mm"), slipbench.parse_quantity("0.009", "m"))

    def test_wrong_text_is_refused(self):
        for text, unit in (
            ("4 mn/s", "m/s"),
            ("4 mm", "m/s"),
            ("fast", None),
            ("", None),
            ("4 mm", ""),
        ):
            with self.subTest(text=text), self.assertRaises(slipbench.InputError):
                slipbench.parse_quantity(text, unit)
        with self.assertRaisesRegex(
            slipbench.InputError, "unit 'furlong' is not a unit of any quantity; allowed: m, s, m/s"
        ):
            slipbench.parse_quantity("4 mm", "furlong")


class Streams(unittest.TestCase):
    def test_the_draws_of_a_scene_are_those_of_its_stream(self):
        # A sweep draws `uniform` from the stream (seed, trial, path): sweep.cc.
        scene = slipbench.Scene.load("papillarray/stage.yaml").set(
            {
                "sweep": {
                    "motion.speed": {"draw": "uniform", "min": 0.002, "max": 0.004},
                    "trials": 3,
                }
            }
        )
        drawn = [
            scene.run(trial, seed=5, record="outcome").params["motion.speed"] for trial in range(3)
        ]
        streams = [slipbench.RandomStream(5, trial, "sweep.motion.speed") for trial in range(3)]
        self.assertEqual(drawn, [stream.uniform(0.002, 0.004) for stream in streams])

    def test_many_draws_are_the_single_ones(self):
        one, many = slipbench.RandomStream(1, 2, "a"), slipbench.RandomStream(1, 2, "a")
        np.testing.assert_array_equal(
            many.uniforms(5, -1.0, 2.0), [one.uniform(-1.0, 2.0) for _ in range(5)]
        )
        np.testing.assert_array_equal(
            many.normals(5, 1.0, 2.0), [one.normal(1.0, 2.0) for _ in range(5)]
        )
        self.assertEqual(many.integer(10), one.integer(10))
        items = list("abcdef")
        order = many.permutation(6)
        one.shuffle(items)
        self.assertEqual(items, ["abcdef"[at] for at in order])
        self.assertEqual(sorted(items), list("abcdef"))

    def test_each_key_is_a_stream_of_its_own(self):
        draws = {
            slipbench.RandomStream(*key).uniform()
            for key in ((1,), (2,), (1, 1), (1, 0, "a"), (1, 0, "b"))
        }
        self.assertEqual(len(draws), 5)
        self.assertTrue(all(0.0 <= draw < 1.0 for draw in draws))

    def test_what_cannot_be_drawn_is_refused(self):
        stream = slipbench.RandomStream(1)
        for call in (
            lambda: slipbench.RandomStream(-1),
            lambda: slipbench.RandomStream(1.0),
            lambda: stream.integer(0),
            lambda: stream.uniform(2.0, 1.0),
            lambda: stream.uniform(0.0, float("inf")),
        ):
            with self.assertRaises(slipbench.InputError):
                call()
        for draw in (stream.uniforms, stream.normals, stream.permutation):
            self.assertEqual(len(draw(np.int64(2))), 2)
            for count, told in (
                (-1, "count -1; allowed: 0 to 2"),
                (1.5, "count: expected a whole number, found float 1.5"),
                ("3", "count: expected"),
            ):
                with (
                    self.subTest(draw=draw.__name__, count=count),
                    self.assertRaisesRegex(slipbench.InputError, f"^{told}"),
                ):
                    draw(count)

    def test_a_stream_is_not_copied(self):
        stream = slipbench.RandomStream(1, 2, "split")
        for call in (pickle.dumps, copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(
                TypeError,
                r"cannot be pickled or copied; create a new one there: RandomStream\(1, 2, 'split'\)",
            ):
                call(stream)


class Contacts(unittest.TestCase):
    def test_they_leave_the_trial_as_it_is(self):
        for name, sets in (
            ("papillarray/stage.yaml", {}),
            ("grasp/lift.yaml", {"duration": "2 s", "motion.distance": "10 mm"}),
        ):
            with self.subTest(name=name):
                scene = slipbench.Scene.load(name).set(sets)
                trial = scene.run(record="contact")
                self.assertEqual(trial.sha256, scene.run().sha256)
                self.assertEqual(trial.contacts.keys(), trial.sensors.keys())

    def test_force_is_what_an_ideal_sensor_reads_and_displacement_is_force_over_stiffness(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        trial = next(scene.sweep(record="contact"))
        contact, sensor = trial.contacts["pad"], trial.sensors["pad"]
        labels = trial.labels["pad"]
        self.assertEqual(contact.force.shape, (len(sensor.t), len(labels.k_normal), 3))
        np.testing.assert_array_equal(contact.t, sensor.t)
        np.testing.assert_allclose(
            contact.force, labels.force, atol=1e-6
        )  # a flat pad on a flat surface: both frames are one
        # Springs: f = k u, along the plane and along the normal, where indentation and force are
        # positive.
        stiffness = np.stack([labels.k_tangential, labels.k_tangential, labels.k_normal], axis=-1)
        touches = labels.unit_state > 0
        np.testing.assert_allclose(
            (contact.displacement * stiffness)[touches],
            contact.force[touches],
            rtol=0.05,
            atol=0.02,
        )
        self.assertGreater(contact.displacement[..., 2].max(), 5e-4)
        self.assertEqual(scene.run().contacts, {})


if __name__ == "__main__":
    unittest.main()
