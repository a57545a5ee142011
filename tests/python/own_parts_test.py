"""Sensors, detectors and controllers that are Python classes. Argument: the program."""

import json
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np
import slipbench
from slipbench import Command, Estimate, State

PROGRAM = sys.argv.pop(1)
GRASP = {
    "friction": {"static": 0.2, "kinetic": 0.15},
    "duration": "2.5 s",
    "motion.distance": "30 mm",
}


@slipbench.detector("twin_of_force_ratio")
class ForceRatio:
    """The catalogue's force_ratio over all units, with a ratio that a scene may set."""

    parameters = {"share": 0.3}
    made = 0

    def __init__(self, source, share):
        self.share = share
        self.source = source
        type(self).made += 1

    def update(self, frame):
        assert frame["force"].shape == self.source.shapes["force"]
        normal = frame["force"][:, 2].astype(float)
        tangential = np.hypot(
            frame["force"][:, 0].astype(float), frame["force"][:, 1].astype(float)
        )
        touching = normal > 0.05
        if not touching.any():
            return State.NO_CONTACT
        slips = tangential[touching] > self.share * normal[touching]
        return State.GROSS if slips.all() else State.INCIPIENT if slips.any() else State.NON_SLIP


@slipbench.controller("twin_of_hold_preset")
class HoldPreset:
    """Like hold_preset: tightens below the preset force, then keeps the last position."""

    def __init__(self, source):
        self.preset = source.preset
        self.position = None

    def act(self, frame, slip):
        if sum(float(normal) for normal in frame["force"][:, 2]) < self.preset:
            self.position = min(slip.position + 1, 255)
        elif self.position is None:
            self.position = slip.position
        return Command(self.position)


@slipbench.sensor("nine_pillars")
class NinePillars:
    """The built-in papillarray: columns from +Y to -Y, each from +X to -X, in metres."""

    parameters = {"rate": "1 kHz", "edge_drop": "0.2 mm", "corner_drop": 0.45e-3}

    def __init__(self, source, rate, edge_drop, corner_drop):
        self.rate, self.drop = rate, (0.0, edge_drop, corner_drop)

    def layout(self):
        tips = [
            (7e-3 * x, 7e-3 * y, self.drop[abs(x) + abs(y)]) for y in (1, 0, -1) for x in (1, 0, -1)
        ]
        return slipbench.Layout(
            tips,
            k_normal=7100.0,
            k_tangential=3900.0,
            rate=self.rate,
            channels={"force": ((9, 3), "N"), "displacement": ((9, 3), "m")},
        )

    def measure(self, frame):
        return {"displacement": frame["displacement"], "force": frame["force"]}


def one_point(measured, **layout):
    """A sensor of one point whose measure() returns a given value."""

    class One:
        def __init__(self, source):
            self.source = source

        def layout(self):
            return slipbench.Layout(
                **{
                    "tips": [(0, 0, 0)],
                    "k_normal": 1e3,
                    "k_tangential": 500.0,
                    "channels": {"load": ((2,), "N")},
                    **layout,
                }
            )

        def measure(self, frame):
            return measured(self, frame) if callable(measured) else measured

    return One


STAGE = "slipbench: 1\nduration: 0.7 s\nmotion: {start: 0.5 s}\nsensors: {pad: {type: NAME}}\n"


class OwnSensors(unittest.TestCase):
    def scene(self, name, more=""):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name) / "own.yaml"
        path.write_text(STAGE.replace("NAME", name) + more)
        return slipbench.Scene.load(path)

    def test_a_twin_of_the_papillarray_reads_its_forces(self):
        trials = [self.scene(name).run() for name in ("nine_pillars", "papillarray")]
        own, built_in = (trial.sensors["pad"] for trial in trials)
        for channel in ("force", "displacement"):
            self.assertGreater(np.abs(built_in.channels[channel]).max(), 1e-5)
            self.assertLessEqual(
                np.abs(own.channels[channel].astype(float) - built_in.channels[channel]).max(),
                1e-12,
            )
        np.testing.assert_array_equal(
            trials[0].labels["pad"].onset_time, trials[1].labels["pad"].onset_time
        )
        self.assertEqual(own.units["force"], "N")

    def test_threads_do_not_change_it_and_its_random_numbers_are_the_trials(self):
        class Noisy(one_point(lambda self, frame: self.random.normal(size=2))):
            def __init__(self, source):
                self.random = source.random

        slipbench.sensor("noisy")(Noisy)
        scene = self.scene("noisy", "sweep: {friction.scale: [0.8, 1.0, 1.2, 1.4]}\n")
        four = list(scene.sweep(jobs=4))
        self.assertEqual(
            [trial.sha256 for trial in scene.sweep(jobs=1)], [trial.sha256 for trial in four]
        )
        loads = [trial.sensors["pad"].load for trial in four]
        self.assertFalse(np.array_equal(loads[0], loads[1]))
        np.testing.assert_array_equal(
            loads[2][0], np.random.default_rng([0, 2, *b"pad"]).normal(size=2).astype(np.float32)
        )

    def test_datasets_and_exports_hold_what_it_read(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "own.h5")
            scene = self.scene("nine_pillars", "sweep: {motion.speed: [2 mm/s, 4 mm/s]}\n")
            scene.write(path)
            with slipbench.open(path) as data:
                np.testing.assert_array_equal(
                    data[1].sensors["pad"]["force"][:], list(scene.sweep())[1].sensors["pad"].force
                )
            for words in (
                ["export", path, "--format", "npz", "-o", folder + "/npz"],
                ["verify", path],
                ["report", path],
            ):
                subprocess.run([PROGRAM, *words], check=True, capture_output=True, cwd=folder)

    def test_grasps_and_vectors_of_them_feel_with_it(self):
        import gymnasium
        import slipbench.gym  # noqa: F401

        values = {"detector.type": "force_ratio", "duration": "2 s"}
        built_in, own = (
            gymnasium.make_vec(
                "slipbench/Grasp-v0",
                num_envs=2,
                scene="grasp/lift.yaml",
                command="position",
                values={**values, **told},
            )
            for told in ({}, {"sensors.pad.type": "nine_pillars", "sensors.pad.rate": 100})
        )
        for grasps in (built_in, own):
            grasps.reset(seed=1)
        for _ in range(20):
            seen, felt = (grasps.step(np.full(2, 1.0))[0] for grasps in (built_in, own))
            np.testing.assert_array_equal(seen, felt)
        self.assertGreater(np.abs(felt).max(), 0.0)

    def test_what_goes_wrong_in_it_is_told_with_the_line(self):
        def raises(self, frame):
            raise RuntimeError("out of ideas")

        for name, made, told in (
            ("shape", one_point(np.zeros(3)), r"measure\(\) .*load .*\(3,\).*\(2,\)"),
            ("nothing", one_point(None), "TypeError|ValueError"),
            ("other", one_point({"lod": np.zeros(2)}), r"measure\(\) .*lod\b.*load"),
            ("nan", one_point([0.0, np.nan]), "measure .*nan .*load_1 .*0 s.*finite"),
            ("raises", one_point(raises), "RuntimeError: out of ideas"),
            ("soft", one_point([0.0, 0.0], k_normal=0.0), "element 0 .*stiffness .*0 N/m"),
            ("flat", one_point([0.0, 0.0], tips=[0.0, 0.0]), r"tips .*\(2,\).*\(points, 3\)"),
            ("dumb", one_point([0.0, 0.0], channels={}), "has 0 channels"),
        ):
            slipbench.sensor("wrong_" + name)(made)
            with (
                self.subTest(name=name),
                self.assertRaisesRegex(
                    slipbench.InputError, f"own.yaml:4: (?s:.*)sensor wrong_{name}(?s:.*){told}"
                ),
            ):
                self.scene("wrong_" + name).run()

    def test_it_ends_its_own_trial_only(self):
        slipbench.sensor("fails_once")(
            one_point(lambda self, frame: [0.0, np.nan if self.source.trial == 1 else 0.0])
        )
        with tempfile.TemporaryDirectory() as folder:
            summary = self.scene("fails_once", "sweep: {friction.scale: [0.8, 1.0, 1.2]}\n").write(
                folder + "/own.h5"
            )
            self.assertIn("own.yaml:4: ", json.dumps(summary["failed"]))
            with slipbench.open(folder + "/own.h5") as data:
                self.assertEqual(len(data), 2)

    def test_names_of_the_program_are_taken(self):
        with self.assertRaisesRegex(
            slipbench.InputError, "sensor 'papillarray' is a name of slipbench itself"
        ):
            slipbench.sensor("papillarray")(NinePillars)


class OwnDetectors(unittest.TestCase):
    def test_a_detector_sees_each_frame_and_the_loop_what_it_says(self):
        trial = (
            slipbench.Scene.load("papillarray/stage.yaml")
            .set({"detector": {"type": "twin_of_force_ratio", "share": 0.4}})
            .run()
        )
        force = trial.sensors["pad"].force.astype(float)
        tangential = np.hypot(force[:, :, 0], force[:, :, 1])
        slips = (tangential > 0.4 * force[:, :, 2]) & (force[:, :, 2] > 0.05)
        touching = force[:, :, 2] > 0.05
        expected = np.where(
            ~touching.any(1),
            0,
            np.where((slips | ~touching).all(1), 3, np.where(slips.any(1), 2, 1)),
        )
        np.testing.assert_array_equal(trial.control.detector_class, expected)
        self.assertEqual(trial.control.detector, "twin_of_force_ratio")
        self.assertGreater(np.bincount(expected, minlength=4)[1:].min(), 0)

    def test_it_is_made_anew_for_each_trial_and_threads_do_not_change_it(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml").set(
            {
                "detector.type": "twin_of_force_ratio",
                "sweep": {"motion.speed": ["1 mm/s", "2 mm/s", "4 mm/s", "8 mm/s"]},
            }
        )
        before = ForceRatio.made
        four = [trial.sha256 for trial in scene.sweep(jobs=4)]
        self.assertEqual(ForceRatio.made - before, 4)
        self.assertEqual([trial.sha256 for trial in scene.sweep(jobs=1)], four)

    def test_latency_and_stuck_fraction_reach_the_loop(self):
        @slipbench.detector("late")
        class Late:
            def __init__(self, source):
                pass

            def update(self, frame):
                return Estimate(State.GROSS, latency=0.5)

        trial = slipbench.Scene.load("papillarray/stage.yaml").set({"detector.type": "late"}).run()
        first = trial.control.t[trial.control.detector_class == State.GROSS][0]
        self.assertAlmostEqual(
            first - trial.control.t[0], 0.5, delta=1.5 / trial.control.rate
        )  # the next sample after it

    def test_datasets_are_judged_by_it(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "stage.h5")
            slipbench.Scene.load("papillarray/stage.yaml").set(
                {"detector.type": "twin_of_force_ratio"}
            ).write(path)
            result = slipbench.evaluate("twin_of_force_ratio", path)
            self.assertTrue(result["loop"]["same"])  # the classes that the loop saw
            self.assertEqual(result["detector"]["type"], "twin_of_force_ratio")
            own = slipbench.evaluate("twin_of_force_ratio", path, parameters={"share": 0.05})
            self.assertNotEqual(own["all"], result["all"])
            # The judging child has none of this process's other threads and must not wait for them.
            stop = threading.Event()
            other = threading.Thread(target=stop.wait)
            busy = threading.Thread(
                target=lambda: [None for _ in iter(lambda: stop.wait(0.001), True)]
            )
            for thread in (other, busy):
                thread.start()
            try:
                again = slipbench.evaluate("twin_of_force_ratio", path)
            finally:
                stop.set()
            self.assertEqual(again["all"], result["all"])

    def test_what_goes_wrong_in_it_is_told(self):
        for wrong, told in (
            (lambda frame: 7, r"update\(\) .* 7.*State"),
            (lambda frame: None, "returned None"),
            (lambda frame: True, " True.*State"),
            (lambda frame: Estimate(1, latency=-1.0), "a latency of -1.0 s"),
            (lambda frame: Estimate(1, stuck_fraction=2.0), "a stuck fraction of 2.0"),
            (lambda frame: frame["gone"], "KeyError: 'gone'"),
        ):

            @slipbench.detector("wrong")
            class Wrong:
                def __init__(self, source, update=wrong):
                    self.update = update

            with (
                self.subTest(told=told),
                self.assertRaisesRegex(slipbench.InputError, "detector wrong: (?s:.*)" + told),
            ):
                slipbench.Scene.load("papillarray/stage.yaml").set({"detector.type": "wrong"}).run()

    def test_names_of_the_program_are_taken(self):
        for name, told in (
            ("gst_hd", "a name of slipbench itself"),
            ("truth", "a name of slipbench itself"),
            ("none", "a name of slipbench itself"),
            ("no name", "is not a valid name"),
        ):
            with self.subTest(name=name), self.assertRaisesRegex(slipbench.InputError, told):
                slipbench.detector(name)(ForceRatio)
        with self.assertRaisesRegex(slipbench.InputError, "a name of slipbench itself"):
            slipbench.controller("hold_preset")(HoldPreset)

    def test_parameters_are_checked_as_those_of_any_detector(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        with self.assertRaisesRegex(
            slipbench.InputError, "unknown key 'shre'.*did you mean 'share'"
        ):
            scene.set({"detector": {"type": "twin_of_force_ratio", "shre": 1}})
        self.assertEqual(
            slipbench.describe("twin_of_force_ratio")[0]["summary"][:13], "The catalogue"
        )


class OwnControllers(unittest.TestCase):
    def test_a_twin_of_a_controller_gives_its_trial(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set(GRASP)
        own, catalogues = (
            scene.set({"controller.type": name}).run(seed=3)
            for name in ("twin_of_hold_preset", "hold_preset")
        )
        # hold_preset never reacts to slip, so its reaction time is null. A custom controller counts
        # as reacting if it tightens after a slip.
        self.assertIsNone(catalogues.outcome["reaction_time_s"])
        self.assertEqual({**own.outcome, "reaction_time_s": None}, catalogues.outcome)
        np.testing.assert_array_equal(own.control.command, catalogues.control.command)
        np.testing.assert_array_equal(own.sensors["pad"].force, catalogues.sensors["pad"].force)

    def test_it_hears_the_detector(self):
        heard = []

        @slipbench.controller("listens")
        class Listens(HoldPreset):
            def act(self, frame, slip):
                heard.append(slip.slips)
                return super().act(frame, slip)

        slipbench.Scene.load("grasp/lift.yaml").set(
            {**GRASP, "detector.type": "truth", "controller.type": "listens"}
        ).run()
        self.assertIn(True, heard)
        self.assertIn(False, heard)

    def test_a_check_runs_it(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set(
            {
                **GRASP,
                "controller.type": "twin_of_hold_preset",
                "expect": {"dropped": False},
                "friction": {"static": 0.5, "kinetic": 0.4},
            }
        )
        self.assertEqual(scene.check(draws=2).expectations[0]["kept"], 2)

    def test_a_command_that_is_none_is_told(self):
        @slipbench.controller("wrong")
        class Wrong:
            def __init__(self, source):
                pass

            def act(self, frame, slip):
                return 256

        with self.assertRaisesRegex(
            slipbench.InputError, r"(?s)controller wrong: .*act\(\) .*256.* 0 .*255"
        ):
            slipbench.Scene.load("grasp/lift.yaml").set({**GRASP, "controller.type": "wrong"}).run()


class TheProgram(unittest.TestCase):
    def test_it_is_the_same_command_line(self):
        done = subprocess.run(
            [sys.executable, "-m", "slipbench", "describe", "stage", "--json"],
            capture_output=True,
            text=True,
            check=True,
        )
        told = subprocess.run(
            [PROGRAM, "describe", "stage", "--json"], capture_output=True, text=True, check=True
        )
        self.assertEqual(json.loads(done.stdout), json.loads(told.stdout))
        refused = subprocess.run(
            [sys.executable, "-m", "slipbench", "run", "gone.yaml"],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(refused.returncode, 2)
        self.assertIn("gone.yaml: cannot be read", refused.stderr)


if __name__ == "__main__":
    unittest.main()
