"""Detectors and controllers that are Python classes. Argument: the program."""

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
GRASP = {"friction": {"static": 0.2, "kinetic": 0.15}, "duration": "2.5 s"}


@slipbench.detector("twin_of_force_ratio")
class ForceRatio:
    """The catalogue's force_ratio over all units, told a ratio that a scene may set."""

    parameters = {"share": 0.3}
    made = 0

    def __init__(self, source, share):
        self.share = share
        self.source = source
        type(self).made += 1

    def update(self, frame):
        assert frame["force"].shape == self.source.shapes["force"]
        normal = frame["force"][:, 2].astype(float)
        tangential = np.hypot(frame["force"][:, 0].astype(float), frame["force"][:, 1].astype(float))
        touching = normal > 0.05
        if not touching.any():
            return State.NO_CONTACT
        slips = tangential[touching] > self.share * normal[touching]
        return State.GROSS if slips.all() else State.INCIPIENT if slips.any() else State.NON_SLIP


@slipbench.controller("twin_of_hold_preset")
class HoldPreset:
    """As hold_preset: tightens below the preset force, then keeps the last position."""

    def __init__(self, source):
        self.preset = source.preset
        self.position = None

    def act(self, frame, slip):
        if sum(float(normal) for normal in frame["force"][:, 2]) < self.preset:
            self.position = min(slip.position + 1, 255)
        elif self.position is None:
            self.position = slip.position
        return Command(self.position)


class OwnDetectors(unittest.TestCase):
    def test_a_detector_sees_each_frame_and_the_loop_what_it_says(self):
        trial = slipbench.Scene.load("papillarray/stage.yaml").set({"detector": {"type": "twin_of_force_ratio", "share": 0.4}}).run()
        force = trial.sensors["pad"].channels["force"].astype(float)
        tangential = np.hypot(force[:, :, 0], force[:, :, 1])
        slips = (tangential > 0.4 * force[:, :, 2]) & (force[:, :, 2] > 0.05)
        touching = force[:, :, 2] > 0.05
        expected = np.where(~touching.any(1), 0, np.where((slips | ~touching).all(1), 3, np.where(slips.any(1), 2, 1)))
        np.testing.assert_array_equal(trial.control.detector_class, expected)
        self.assertEqual(trial.control.detector, "twin_of_force_ratio")
        self.assertGreater(np.bincount(expected, minlength=4)[1:].min(), 0)

    def test_it_is_made_anew_for_each_trial_and_threads_do_not_change_it(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml").set(
            {"detector.type": "twin_of_force_ratio", "sweep": {"motion.speed": ["1 mm/s", "2 mm/s", "4 mm/s", "8 mm/s"]}})
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
        first = trial.control.time[trial.control.detector_class == State.GROSS][0]
        self.assertAlmostEqual(first - trial.control.time[0], 0.5, delta=1.5 / trial.control.rate)  # the next sample after it

    def test_datasets_are_judged_by_it(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "stage.h5")
            slipbench.Scene.load("papillarray/stage.yaml").set({"detector.type": "twin_of_force_ratio"}).write(path)
            result = slipbench.evaluate("twin_of_force_ratio", path)
            self.assertTrue(result["loop"]["same"])  # the classes that the loop saw
            self.assertEqual(result["detector"]["type"], "twin_of_force_ratio")
            own = slipbench.evaluate("twin_of_force_ratio", path, parameters={"share": 0.05})
            self.assertNotEqual(own["all"], result["all"])
            # The child that judges has none of this process's other threads, and must not wait for them.
            stop = threading.Event()
            other = threading.Thread(target=stop.wait)
            busy = threading.Thread(target=lambda: [None for _ in iter(lambda: stop.wait(0.001), True)])
            for thread in (other, busy):
                thread.start()
            try:
                again = slipbench.evaluate("twin_of_force_ratio", path)
            finally:
                stop.set()
            self.assertEqual(again["all"], result["all"])

    def test_what_goes_wrong_in_it_is_told(self):
        for wrong, told in ((lambda frame: 7, r"update\(\) returned 7; allowed: a State"), (lambda frame: None, "returned None"),
                            (lambda frame: True, "returned True; allowed: a State"),
                            (lambda frame: Estimate(1, latency=-1.0), "a latency of -1.0 s"),
                            (lambda frame: Estimate(1, stuck_fraction=2.0), "a stuck fraction of 2.0"),
                            (lambda frame: frame["gone"], "KeyError: 'gone'")):
            @slipbench.detector("wrong")
            class Wrong:
                def __init__(self, source):
                    self.update = wrong

            with self.subTest(told=told), self.assertRaisesRegex(slipbench.InputError, "detector wrong: (?s:.*)" + told):
                slipbench.Scene.load("papillarray/stage.yaml").set({"detector.type": "wrong"}).run()

    def test_names_of_the_program_are_taken(self):
        for name, told in (("gst_hd", "one of slipbench's own"), ("truth", "one of slipbench's own"), ("none", "one of slipbench's own"),
                           ("no name", "is no name")):
            with self.subTest(name=name), self.assertRaisesRegex(slipbench.InputError, told):
                slipbench.detector(name)(ForceRatio)
        with self.assertRaisesRegex(slipbench.InputError, "one of slipbench's own"):
            slipbench.controller("hold_preset")(HoldPreset)

    def test_parameters_are_checked_as_those_of_any_detector(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml")
        with self.assertRaisesRegex(slipbench.InputError, "unknown key 'shre'.*did you mean 'share'"):
            scene.set({"detector": {"type": "twin_of_force_ratio", "shre": 1}})
        self.assertEqual(slipbench.describe("twin_of_force_ratio")[0]["summary"][:13], "The catalogue")


class OwnControllers(unittest.TestCase):
    def test_a_twin_of_a_controller_gives_its_trial(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set(GRASP)
        own, catalogues = (scene.set({"controller.type": name}).run(seed=3) for name in ("twin_of_hold_preset", "hold_preset"))
        self.assertEqual(own.outcome, catalogues.outcome)
        np.testing.assert_array_equal(own.control.command, catalogues.control.command)
        np.testing.assert_array_equal(own.sensors["pad"].channels["force"], catalogues.sensors["pad"].channels["force"])

    def test_it_hears_the_detector(self):
        heard = []

        @slipbench.controller("listens")
        class Listens(HoldPreset):
            def act(self, frame, slip):
                heard.append(slip.slips)
                return super().act(frame, slip)

        slipbench.Scene.load("grasp/lift.yaml").set({**GRASP, "detector.type": "truth", "controller.type": "listens"}).run()
        self.assertIn(True, heard)
        self.assertIn(False, heard)

    def test_a_check_runs_it(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set({**GRASP, "controller.type": "twin_of_hold_preset", "expect": {"dropped": False},
                                                             "friction": {"static": 0.5, "kinetic": 0.4}})
        self.assertEqual(scene.check(draws=2).expectations[0]["kept"], 2)

    def test_a_command_that_is_none_is_told(self):
        @slipbench.controller("wrong")
        class Wrong:
            def __init__(self, source):
                pass

            def act(self, frame, slip):
                return 256

        with self.assertRaisesRegex(slipbench.InputError, r"controller wrong: (?s:.*)act\(\) returned 256; allowed: a position of 0 to 255"):
            slipbench.Scene.load("grasp/lift.yaml").set({**GRASP, "controller.type": "wrong"}).run()


class TheProgram(unittest.TestCase):
    def test_it_is_the_same_command_line(self):
        done = subprocess.run([sys.executable, "-m", "slipbench", "describe", "stage", "--json"], capture_output=True, text=True, check=True)
        told = subprocess.run([PROGRAM, "describe", "stage", "--json"], capture_output=True, text=True, check=True)
        self.assertEqual(json.loads(done.stdout), json.loads(told.stdout))
        refused = subprocess.run([sys.executable, "-m", "slipbench", "run", "gone.yaml"], capture_output=True, text=True, check=False)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("gone.yaml: cannot be read", refused.stderr)


if __name__ == "__main__":
    unittest.main()
