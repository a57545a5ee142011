"""Scenes, trials, datasets, windows and environments can be pickled and copied.

Copies work in other processes. Argument: the program.
"""

import copy
import importlib.util
import multiprocessing
import pickle
import sys
import tempfile
import unittest
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import gymnasium
import numpy as np
import own_in_module
import slipbench
import slipbench.gym
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

BRIEF = {"duration": "2 s"}
KINDS = ("fork", "forkserver", "spawn")


def both(held):
    """Returns a pickled copy and a deep copy."""
    return pickle.loads(pickle.dumps(held)), copy.deepcopy(held)


def digest(scene):
    return scene.run().sha256


def taken(windows, index):
    values, label = windows[index]
    return float(values.sum()), label


def onset(trial):
    return trial.labels["pad"].onset_time.min(), trial.sensors["pad"].force.sum()


def steps(env, count):
    """Returns the results of an environment's next steps."""
    return [env.step(np.full(env.action_space.shape, -0.2, np.float32))[:4] for _ in range(count)]


def grasp():
    return slipbench.gym.GraspEnv(
        "grasp/lift.yaml", values={**BRIEF, "detector": {"type": "mine_in_a_module"}}
    )


def unknown():
    return slipbench.gym.GraspEnv(
        "grasp/lift.yaml", values={**BRIEF, "detector": {"type": "mine_in_main"}}
    )


def loads(scene):
    return pickle.loads(scene)


def rolled(vector):
    found = [vector.reset(seed=3)[0]]
    for _ in range(4):
        observations, rewards, *_ = vector.step(np.full((2, 1), -0.2, np.float32))
        found += [observations, rewards]
    vector.close()
    return np.concatenate([np.ravel(one) for one in found])


class Copies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name) / "speeds.h5"
        sweep = {"motion.speed": ["2 mm/s", "3 mm/s", "4 mm/s", "5 mm/s"], "trials": 1}
        slipbench.Scene.load("papillarray/stage.yaml").set(
            sweep=sweep, split={"by": "trial", "shares": [0.5, 0.25, 0.25]}
        ).write(cls.path)
        cls.data = slipbench.open(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.data.close()
        cls.folder.cleanup()

    def test_scenes_give_the_same_trial_with_and_without_their_file(self):
        path = Path(self.folder.name) / "own.yaml"
        path.write_text(slipbench.Scene.load("papillarray/stage.yaml").text, encoding="utf-8")
        scene = slipbench.Scene.load(path).set({"motion.speed": "8 mm/s"})
        pickled = pickle.dumps(scene)
        for other in both(scene):
            self.assertEqual(
                (other.path, other.overrides, other.run().sha256),
                (scene.path, scene.overrides, scene.run().sha256),
            )
        path.unlink()
        self.assertEqual(pickle.loads(pickled).run().sha256, scene.run().sha256)

    def test_trials_keep_every_value(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set({**BRIEF, "motion.distance": "10 mm"})
        trial = scene.run(record="contact")
        for other in both(trial):
            self.assertEqual(
                (other.sha256, other.outcome, other.params),
                (trial.sha256, trial.outcome, trial.params),
            )
            with self.assertRaisesRegex(
                slipbench.InputError, "a copy by pickle or deepcopy, which has no record"
            ):
                _ = other._simulated
            np.testing.assert_array_equal(other.sensors["pad"].force, trial.sensors["pad"].force)
            np.testing.assert_array_equal(other.labels["pad"].state, trial.labels["pad"].state)
            np.testing.assert_array_equal(other.contacts["pad"].force, trial.contacts["pad"].force)
            np.testing.assert_array_equal(other.bodies["box"].pose, trial.bodies["box"].pose)
            self.assertEqual(repr(other), repr(trial))
        for held in (trial.sensors["pad"], trial.labels["pad"], trial.control):
            for other in both(held):
                self.assertEqual(repr(other), repr(held))

    def test_datasets_and_windows_open_the_file_again(self):
        windows = self.data.windows(length=40, stride=10, channels=["force"], part="train")
        self.assertGreater(len(windows), 0)
        for other in both(windows):
            np.testing.assert_array_equal(other.arrays()[0], windows.arrays()[0])
            other._dataset.close()
        for other in both(self.data):
            self.assertEqual(
                [trial.sha256 for trial in other.values()],
                [trial.sha256 for trial in self.data.values()],
            )
            other.close()
        for held in (self.data[1], self.data[1].sensors["pad"], self.data[1].labels["pad"]):
            for other in both(held):
                self.assertEqual(repr(other), repr(held))
                other._group.file.close()

    def test_processes_of_every_kind_take_them(self):
        scene = slipbench.Scene.load("papillarray/stage.yaml").set({"motion.speed": "8 mm/s"})
        trial = scene.run()
        windows = self.data.windows(length=40, stride=10, channels=["force"])
        for kind in KINDS:
            with (
                self.subTest(kind=kind),
                ProcessPoolExecutor(2, multiprocessing.get_context(kind)) as pool,
            ):
                self.assertEqual(pool.submit(digest, scene).result(60), trial.sha256)
                self.assertEqual(pool.submit(onset, trial).result(60), onset(trial))
                self.assertEqual(pool.submit(onset, self.data[1]).result(60), onset(self.data[1]))
                self.assertEqual(
                    [pool.submit(taken, windows, index).result(60) for index in (0, 7, 50)],
                    [taken(windows, index) for index in (0, 7, 50)],
                )

    @unittest.skipUnless(importlib.util.find_spec("joblib"), "joblib is not installed")
    def test_joblib_takes_them(self):
        from joblib import Parallel, delayed

        scene = slipbench.Scene.load("papillarray/stage.yaml")
        found = Parallel(n_jobs=2)(
            delayed(digest)(scene.set({"motion.speed": speed})) for speed in (0.002, 0.004)
        )
        self.assertEqual(
            found, [digest(scene.set({"motion.speed": speed})) for speed in (0.002, 0.004)]
        )


class Environments(unittest.TestCase):
    def equal(self, one, other):
        for a, b in zip(one, other, strict=True):
            for x, y in zip(a, b, strict=True):
                np.testing.assert_array_equal(x, y)

    def test_a_grasps_copy_goes_on_bit_for_bit(self):
        for env in (
            slipbench.gym.GraspEnv("grasp/lift.yaml", values=BRIEF),
            gymnasium.make("slipbench/GraspLift-v0"),
        ):
            copies = both(env)  # before a first reset
            for each in (env, *copies):
                each.reset(seed=5)
            self.equal(steps(env, 10), steps(copies[0], 10))
            copies = both(env)  # in the midst of an episode
            expected = steps(env, 5)
            for other in copies:
                self.equal(steps(other, 5), expected)
                np.testing.assert_array_equal(other.reset()[0], copy.deepcopy(env).reset()[0])

    def test_a_vectors_copy_goes_on_also_where_episodes_have_ended(self):
        # 1.6 s in steps of 20 ms: after 100 steps each environment is in its second episode.
        vector = slipbench.gym.GraspVectorEnv(
            2, "grasp/lift.yaml", values={"duration": "1.6 s"}, jobs=1
        )
        vector.reset(seed=5)
        steps(vector, 100)
        self.assertEqual(vector._episodes, [1, 1])
        copies = both(vector)
        expected = steps(vector, 20)
        for other in copies:
            self.equal(steps(other, 20), expected)

    def test_a_stage_goes_on(self):
        env = slipbench.gym.StageSlipEnv("papillarray/stage.yaml")
        env.reset(seed=1)
        env.step(slipbench.State.NON_SLIP)
        for other in both(env):
            for _ in range(3):
                np.testing.assert_array_equal(
                    copy.deepcopy(env).step(1)[0], copy.deepcopy(other).step(1)[0]
                )

    def test_vectors_of_processes_equal_those_of_one(self):
        self.assertTrue(own_in_module.Mine)
        expected = rolled(SyncVectorEnv([grasp, grasp]))
        for kind in KINDS:
            with self.subTest(kind=kind):
                np.testing.assert_array_equal(
                    rolled(AsyncVectorEnv([grasp, grasp], context=kind)), expected
                )

    def test_a_worker_that_does_not_know_a_class_says_where_to_register_it(self):
        slipbench.detector("mine_in_main")(own_in_module.Mine)
        scene = slipbench.Scene.load("grasp/lift.yaml").set({"detector": {"type": "mine_in_main"}})
        hint = r"unknown detector 'mine_in_main'.*'mine_in_main' is a Python class, .*register it in a module that the worker imports"
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            for call in (pool.submit(loads, pickle.dumps(scene)), pool.submit(unknown)):
                with self.assertRaisesRegex(slipbench.InputError, hint):
                    call.result(60)


if __name__ == "__main__":
    del sys.argv[1]
    unittest.main()
