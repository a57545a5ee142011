"""Grasps and stages as Gymnasium environments. Argument: the program."""

import ctypes.util
import importlib.util
import sys
import unittest

import gymnasium
import numpy as np
import slipbench
import slipbench.gym
from gymnasium.utils.env_checker import check_env
from gymnasium.utils.env_match import check_environments_match
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

del sys.argv[1]
# The lift ends at 1.5 s + 10 mm / (43 mm/s) + 43/400 s = 1.84 s.
SHORT = {
    "friction": {"static": 0.2, "kinetic": 0.15},
    "duration": "2.2 s",
    "motion.distance": "10 mm",
}


def make(**options):
    return gymnasium.make("slipbench/Grasp-v0", **{"values": SHORT, **options})


def total_force(environment, observation):
    """Returns the measured grip force [N], summed like the controllers do."""
    names = environment.unwrapped.observation_names
    return sum(
        float(value)
        for name, value in zip(names, observation, strict=True)
        if name.startswith("pad.") and name.endswith("FZ")
    )


class Grasps(unittest.TestCase):
    def test_gymnasiums_own_check_passes(self):
        for environment in (
            make(),
            make(command="position"),
            gymnasium.make("slipbench/GraspLift-v0"),
        ):
            check_env(environment.unwrapped)

    @unittest.skipUnless(
        importlib.util.find_spec("stable_baselines3"), "stable_baselines3 is not installed"
    )
    def test_the_check_of_stable_baselines3_passes(self):
        from stable_baselines3.common.env_checker import check_env as check

        for name in ("Grasp-v0", "GraspLift-v0", "StageSlip-v0"):
            check(gymnasium.make(f"slipbench/{name}").unwrapped)  # its warnings are errors here

    def test_two_of_them_match(self):
        check_environments_match(make(), make(), num_steps=60, seed=4)

    def test_a_policy_that_acts_as_a_controller_gives_the_command_lines_trial(self):
        scene = slipbench.Scene.load("grasp/lift.yaml").set(
            {**SHORT, "controller.type": "hold_preset"}
        )
        preset = 7.0  # N, which holds
        environment = make(command="position", values={**SHORT, "grip.preset": f"{preset} N"})
        position = environment.unwrapped.observation_names.index("gripper.position")
        for seed in (2, 3):
            observation, _ = environment.reset(seed=seed)
            last, over = None, False
            while not over:
                measured = int(observation[position])
                if total_force(environment, observation) < preset:
                    last = min(measured + 1, 255)
                elif last is None:
                    last = measured
                observation, _, terminated, truncated, info = environment.step(
                    np.array([2.0 * last / 255.0 - 1.0], np.float64)
                )
                over = terminated or truncated
            expected = (
                scene.set({"grip.preset": f"{preset} N"}).run(seed=seed, record="outcome").outcome
            )
            for key in (
                "dropped",
                "lifted",
                "max_grip_force_N",
                "final_grip_force_N",
                "slip_translation_m",
                "touch_time_s",
                "max_slip_distance_m",
            ):
                if (expected["lifted"] and not expected["dropped"]) or key in (
                    "dropped",
                    "lifted",
                    "touch_time_s",
                ):
                    self.assertEqual(info["outcome"][key], expected[key], key)

    def test_an_action_of_another_shape_is_named(self):
        one, two = (
            slipbench.gym.GraspEnv(values=SHORT),
            slipbench.gym.GraspVectorEnv(2, values=SHORT),
        )
        one.reset(seed=1)
        two.reset(seed=1)
        for action, shape in (([0.1, 0.2], r"\(2,\)"), (np.zeros((1, 0)), r"\(1, 0\)")):
            with self.assertRaisesRegex(
                slipbench.InputError, rf"^action: expected shape \(1,\), found {shape}$"
            ):
                one.step(action)
        with self.assertRaisesRegex(
            slipbench.InputError, r"^actions: expected shape \(2, 1\), found \(3, 1\)$"
        ):
            two.step(np.zeros((3, 1)))
        one.step(np.zeros(1))  # a refused action has not ended the episode

    def test_episodes_of_a_seed_differ_and_repeat(self):
        environment = make()

        def first_observations():
            return [environment.reset(seed=9)[0], *(environment.reset()[0] for _ in range(3))]

        once, again = first_observations(), first_observations()
        for a, b in zip(once, again, strict=True):
            np.testing.assert_array_equal(a, b)
        self.assertEqual(len({observation.tobytes() for observation in once}), 4)

    def test_truth_is_in_the_info_alone(self):
        environment = make()
        self.assertFalse(
            [
                name
                for name in environment.unwrapped.observation_names
                if "truth" in name or "ideal" in name
            ]
        )
        _, info = environment.reset(seed=1)
        self.assertEqual(
            set(info), {"time", "grip_force", "ideal_force", "slip_distance", "lifting", "params"}
        )
        self.assertAlmostEqual(
            info["ideal_force"], 5.0, delta=2.0
        )  # m g/(2 mu) = 0.2*9.81/0.4 = 4.9 N, times the trial's scatter

    def test_the_reward_is_the_stated_one(self):
        environment = make()
        environment.reset(seed=1)
        before, duration = environment.unwrapped.reset(seed=1)[1], 2.2
        for _ in range(90):
            _, reward, terminated, truncated, info = environment.step(np.array([-0.6], np.float32))
            expected = (
                -info["grip_force"]
                / info["ideal_force"]
                * (info["time"] - before["time"])
                / duration
            )
            if before["lifting"]:
                expected -= 100.0 * max(0.0, info["slip_distance"] - before["slip_distance"])
            expected -= 10.0 * terminated
            self.assertAlmostEqual(reward, expected, places=12)
            before = info
            if terminated or truncated:
                break

    def test_a_box_left_on_the_table_ends_the_episode_and_is_penalised_like_a_drop(self):
        rise = 1.5 + 0.01 / 0.043 + 0.043 / 0.4  # s, when the arm has risen
        for action in (-1.0, 0.5):  # never touched; 15 N for 3 kg, which needs 3*9.81/0.4 = 74 N
            environment = make(values={**SHORT, "box.mass": "3 kg"})
            environment.reset(seed=1)
            over, rewards = False, []
            while not over:
                _, reward, terminated, truncated, info = environment.step(
                    np.array([action], np.float32)
                )
                over = terminated or truncated
                rewards.append(reward)
            self.assertTrue(terminated)
            self.assertFalse(truncated)
            self.assertAlmostEqual(info["time"], rise, delta=1e-3)
            self.assertFalse(info["outcome"]["lifted"])
            self.assertFalse(info["outcome"]["dropped"])
            self.assertEqual(info["outcome"]["lift_height_m"], 0.0)
            self.assertLess(rewards[-1], -10.0 + 1e-9)
            self.assertGreater(min(rewards[:-1]), -1.0)

    def test_an_episode_may_end_before_the_lift(self):
        environment = make(values={**SHORT, "motion.distance": "100 mm"})
        environment.reset(seed=1)
        over = False
        while not over:
            _, reward, terminated, truncated, info = environment.step(np.array([0.5], np.float32))
            over = terminated or truncated
        self.assertTrue(truncated)
        self.assertGreater(reward, -1.0)
        with self.assertRaisesRegex(
            slipbench.InputError,
            r"lift.yaml:\d+: motion: the lift ends at 3.934 s, after the trial's end at 2.2 s",
        ):
            slipbench.Scene.load("grasp/lift.yaml").set({"duration": "2.2 s"})

    def test_a_force_is_followed(self):
        environment = make()
        environment.reset(seed=1)
        for _ in range(70):
            observation, *_ = environment.step(
                np.array([2.0 * 8.0 / 20.0 - 1.0], np.float32)
            )  # 8 N of 20
        self.assertAlmostEqual(
            total_force(environment, observation), 8.0, delta=2.0
        )  # a count of the gripper is worth some 1.6 N

    def test_the_vector_environment_equals_the_synchronous_one(self):
        values = {**SHORT, "sweep": {"surface.material": ["ptfe", "felt"]}, "friction.scale": 1.0}
        del values["friction"]
        own = gymnasium.make_vec("slipbench/Grasp-v0", num_envs=3, values=values, jobs=2)
        self.assertIsInstance(own, slipbench.gym.GraspVectorEnv)
        other = SyncVectorEnv(
            [lambda: gymnasium.make("slipbench/Grasp-v0", values=values) for _ in range(3)]
        )
        self.assert_same(own.reset(seed=5), other.reset(seed=5))
        draws = np.random.default_rng(0)
        ends = 0
        for _ in range(250):
            actions = draws.uniform(-1.0, 1.0, (3, 1)).astype(np.float32)
            mine, theirs = own.step(actions), other.step(actions)
            self.assert_same(mine, theirs)
            ends += int((mine[2] | mine[3]).sum())
        self.assertGreaterEqual(ends, 6)
        self.assertEqual(
            (own.single_action_space, own.single_observation_space),
            (other.single_action_space, other.single_observation_space),
        )

    def assert_same(self, mine, theirs):
        for a, b in zip(mine, theirs, strict=True):
            if isinstance(a, dict):
                self.assertEqual(a.keys(), b.keys())
                self.assert_same([a[key] for key in sorted(a)], [b[key] for key in sorted(a)])
            elif a.dtype == object:
                self.assertEqual(a.tolist(), b.tolist())
            else:
                np.testing.assert_array_equal(a, b)

    def test_many_episodes_leak_nothing_and_repeat(self):
        def episodes(count):
            environment = make(values={**SHORT, "duration": "1.7 s"})
            draws, ends = np.random.default_rng(1), []
            for number in range(count):
                environment.reset(seed=number % 7)
                over = False
                while not over:
                    _, _, terminated, truncated, info = environment.step(
                        draws.uniform(-1.0, 1.0, 1).astype(np.float32)
                    )
                    over = terminated or truncated
                ends.append(info["outcome"]["max_grip_force_N"])
            return ends

        def resident():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1])

        first = episodes(20)
        before = resident()
        self.assertEqual(episodes(60)[:20], first)
        self.assertLess(resident(), 1.05 * before)

    def test_pictures_show_the_box_rise_or_say_what_is_missing(self):
        try:
            environment = make(
                values={
                    **SHORT,
                    "friction": {"static": 0.8, "kinetic": 0.8},
                    "duration": "3 s",
                    "motion.distance": "100 mm",
                },
                render_mode="rgb_array",
            )
        except slipbench.InputError as error:
            self.assertRegex(str(error), "needs EGL and pip install")
            self.assertFalse(
                importlib.util.find_spec("OpenGL") and ctypes.util.find_library("EGL"),
                "it is there, and was not used",
            )
            return

        def height():
            """Returns the rows of the box's orange in the picture, and its share of the picture.

            Rows are in pixels from below.
            """
            picture = environment.render().astype(int)
            self.assertEqual(picture.shape, (480, 480, 3))
            rows, _ = np.nonzero(
                (picture[:, :, 0] > picture[:, :, 2] + 60) & (picture[:, :, 0] > 80)
            )
            return 480.0 - rows.mean(), len(rows) / 480.0**2

        environment.reset(seed=1)
        before, share = height()
        self.assertGreater(share, 0.02)
        over = False
        while not over:
            _, _, terminated, truncated, _ = environment.step(np.array([0.0], np.float32))
            over = terminated or truncated
        self.assertGreater(height()[0], before + 30.0)
        environment.close()

    def test_what_cannot_be_is_said(self):
        for options, told in (
            ({"scene": "papillarray/stage.yaml", "values": {}}, "grasp"),
            ({"command": "torque"}, "torque.*force, position"),
            ({"render_mode": "human"}, "human.*'rgb_array'"),
            ({"values": {"sped": 1}}, "'sped'"),
        ):
            with self.subTest(told=told), self.assertRaisesRegex(slipbench.InputError, told):
                slipbench.gym.GraspEnv(**{"values": SHORT, **options})
        vector = slipbench.gym.GraspVectorEnv(3, values=SHORT)
        for seed, told in (
            ([7, 8], "2 seeds; expected one for each of the 3"),
            (-1, "allowed"),
            (2**64, "allowed"),
        ):
            with self.subTest(seed=seed), self.assertRaisesRegex(slipbench.InputError, told):
                vector.reset(seed=seed)
        with self.assertRaisesRegex(slipbench.InputError, "options has 'reset_mask'"):
            vector.reset(seed=1, options={"reset_mask": np.array([True, False, False])})
        before = vector.reset(seed=1)[1]["time"].copy()
        with self.assertRaisesRegex(slipbench.InputError, r"action nan.*-1 .* 1\b"):
            vector.step(np.array([[0.0], [np.nan], [0.0]], np.float32))
        after = vector.step(np.zeros((3, 1), np.float32))[4]["time"]
        self.assertLess(np.ptp(after - before), 1e-3, "a refused step moved some of them")
        environment = slipbench.gym.GraspEnv(values=SHORT)
        environment.reset(seed=1)
        with self.assertRaisesRegex(slipbench.InputError, r"action 1.5.*-1 .* 1\b"):
            environment.step(np.array([1.5], np.float32))


# The friction is drawn for each episode.
DRAWN = {
    "duration": "2.2 s",
    "motion.distance": "10 mm",
    "sweep": {"friction.scale": {"draw": "uniform", "min": 0.5, "max": 1.5}, "trials": 1},
}


class Seeds(unittest.TestCase):
    def scales(self, info):
        """Returns the drawn values of each environment of a vector."""
        params = info["params"]
        return [
            float(scale)
            for scale in (
                params["friction.scale"]
                if isinstance(params, dict)
                else [one["friction.scale"] for one in params]
            )
        ]

    def vectors(self):
        grasp = lambda: slipbench.gym.GraspEnv(values=DRAWN)  # noqa: E731
        yield "GraspVectorEnv", slipbench.gym.GraspVectorEnv(4, values=DRAWN)
        yield "make_vec", gymnasium.make_vec("slipbench/Grasp-v0", num_envs=4, values=DRAWN)
        yield "SyncVectorEnv", SyncVectorEnv([grasp] * 4)
        yield "AsyncVectorEnv", AsyncVectorEnv([grasp] * 4)

    def test_without_a_seed_all_environments_draw_for_themselves(self):
        seen = []
        for name, vector in self.vectors():
            with self.subTest(vector=name):
                for _ in range(2):
                    seen += self.scales(vector.reset()[1])
                vector.close()
        for _ in range(3):
            environment = slipbench.gym.GraspEnv(values=DRAWN)
            seen += [environment.reset()[1]["params"]["friction.scale"] for _ in range(2)]
        self.assertEqual(len(set(seen)), 4 * 2 * 4 + 3 * 2, "doubles drawn twice")

    def test_a_seed_repeats_and_resets_without_one_go_on_with_it(self):
        one_by_one = []
        for i in range(4):
            environment = slipbench.gym.GraspEnv(values=DRAWN)
            environment.reset()  # independent of earlier episodes
            one_by_one.append(
                [
                    environment.reset(seed=7 + i)[1]["params"]["friction.scale"],
                    *(environment.reset()[1]["params"]["friction.scale"] for _ in range(2)),
                ]
            )
        expected = [list(column) for column in zip(*one_by_one, strict=True)]
        for name, vector in self.vectors():
            with self.subTest(vector=name):
                vector.reset()
                self.assertEqual(
                    [
                        self.scales(vector.reset(seed=7)[1]),
                        *(self.scales(vector.reset()[1]) for _ in range(2)),
                    ],
                    expected,
                )
                mixed = self.scales(vector.reset(seed=[7, None, 9, None])[1])
                self.assertEqual([mixed[0], mixed[2]], [expected[0][0], expected[0][2]])
                vector.close()

    def test_the_cells_of_a_grid_are_all_seen(self):
        masses = ["100 g", "120 g", "140 g", "160 g"]
        values = {"sweep": {"box.mass": masses, "trials": 1}}
        every = {0.1, 0.12, 0.14, 0.16}

        def mass(info):
            return info["params"]["box.mass"]

        environment = slipbench.gym.GraspEnv(values=values)
        # Four successive seeds, and four successive resets of one seed, are the four cells.
        self.assertEqual({mass(environment.reset(seed=seed)[1]) for seed in range(4)}, every)
        self.assertEqual(
            {
                mass(environment.reset(seed=1000)[1]),
                *(mass(environment.reset()[1]) for _ in range(3)),
            },
            every,
        )
        # Seeds that are multiples of the number of cells begin in several cells.
        self.assertGreater(
            len({mass(environment.reset(seed=4 * seed)[1]) for seed in range(16)}), 1
        )
        self.assertEqual(
            mass(environment.reset(seed=1000)[1]), mass(environment.reset(seed=1000)[1])
        )
        vector = gymnasium.make_vec(
            "slipbench/Grasp-v0", num_envs=4, values=values, vectorization_mode="vector_entry_point"
        )
        for _ in range(2):
            self.assertEqual(set(vector.reset(seed=8)[1]["params"]["box.mass"].tolist()), every)
            self.assertEqual(set(vector.reset()[1]["params"]["box.mass"].tolist()), every)
        vector.close()
        grid = {
            "duration": "1 s",
            "motion.start": "0.5 s",
            "sweep": {"motion.speed": ["1 mm/s", "2 mm/s", "4 mm/s"], "trials": 2},
        }
        stage = slipbench.gym.StageSlipEnv("papillarray/stage.yaml", grid)
        self.assertEqual(
            {stage.reset(seed=seed)[1]["params"]["motion.speed"] for seed in range(3)},
            {1e-3, 2e-3, 4e-3},
        )

    def test_recordings_of_a_stage_are_seeded_alike(self):
        values = {
            "duration": "2.5 s",
            "sweep": {"friction.scale": {"draw": "uniform", "min": 0.5, "max": 1.5}, "trials": 1},
        }
        environments = [
            slipbench.gym.StageSlipEnv("papillarray/stage.yaml", values) for _ in range(2)
        ]
        self.assertNotEqual(*(one.reset()[1]["params"] for one in environments))
        self.assertEqual(*(one.reset(seed=3)[1]["params"] for one in environments))
        self.assertEqual(*(one.reset()[1]["params"] for one in environments))

    def test_scaled_observations_are_the_others_over_their_scale(self):
        plain, scaled = (
            slipbench.gym.GraspEnv("grasp/lift.yaml", values={"duration": "2 s"}, scaled=on)
            for on in (False, True)
        )
        vector = slipbench.gym.GraspVectorEnv(
            1, "grasp/lift.yaml", values={"duration": "2 s"}, scaled=True
        )
        names, units = scaled.observation_names, scaled.observation_units
        by = dict(
            zip(names, zip(units, scaled.observation_scale.tolist(), strict=True), strict=True)
        )
        self.assertEqual(by["pad.P0_FZ"], ("N", 5.0))
        self.assertEqual(by["pad.P0_DZ"], ("m", np.float32(1e-3)))
        self.assertEqual(
            (by["gripper.position"], by["slip.state"]), (("counts", 255.0), ("1", 3.0))
        )
        self.assertTrue((plain.observation_scale == 1.0).all())
        observations = [env.reset(seed=1)[0] for env in (plain, scaled, vector)]
        for _ in range(60):
            np.testing.assert_array_equal(
                observations[1], observations[0] / scaled.observation_scale
            )
            np.testing.assert_array_equal(observations[2][0], observations[1])
            self.assertTrue(scaled.observation_space.contains(observations[1]))
            observations = [
                env.step(np.full(env.action_space.shape, -0.2, np.float32))[0]
                for env in (plain, scaled, vector)
            ]
        self.assertLess(np.abs(observations[1]).max(), 2.0)  # of order one
        self.assertGreater(
            np.abs(observations[0]).max(), 50.0
        )  # the position alone is tens of counts

    def test_options_have_no_effect_in_either(self):
        environment, vector = (
            slipbench.gym.GraspEnv(values=DRAWN),
            slipbench.gym.GraspVectorEnv(2, values=DRAWN),
        )
        for options in (None, {}, {"low": 1, "high": 2}):
            self.assertEqual(
                environment.reset(seed=1, options=options)[1], environment.reset(seed=1)[1]
            )
            self.assertEqual(
                self.scales(vector.reset(seed=1, options=options)[1]),
                self.scales(vector.reset(seed=1)[1]),
            )

    def test_a_step_needs_an_episode(self):
        vector = slipbench.gym.GraspVectorEnv(2, values=DRAWN)
        cases = [
            (slipbench.gym.GraspEnv(values=DRAWN), np.zeros(1)),
            (vector, np.zeros((2, 1))),
            (slipbench.gym.StageSlipEnv("papillarray/stage.yaml", {"duration": "2.1 s"}), 1),
        ]
        for environment, action in cases:
            with self.subTest(environment=type(environment).__name__):
                with self.assertRaisesRegex(
                    gymnasium.error.ResetNeeded, "no episode has begun; call reset\\(\\) first"
                ):
                    environment.step(action)
                environment.reset(seed=1)
                if environment is vector:  # the next episode begins automatically
                    continue
                with self.assertRaisesRegex(
                    gymnasium.error.ResetNeeded, "the episode is over; call reset\\(\\) first"
                ):
                    for _ in range(3000):
                        environment.step(action)
                environment.reset()
                environment.step(action)


class Failing(unittest.TestCase):
    def test_a_reset_that_fails_leaves_nothing_to_step(self):
        @slipbench.detector("fails_to_begin")
        class Fails:
            fails = False

            def __init__(self, source):
                if Fails.fails:
                    raise ValueError(
                        "not today \udce9"
                    )  # a lone surrogate, which UTF-8 cannot encode

            def update(self, frame):
                return slipbench.State.NON_SLIP

        environment = slipbench.gym.GraspEnv(
            values={**SHORT, "detector": {"type": "fails_to_begin"}}
        )
        Fails.fails = True
        with self.assertRaisesRegex(
            slipbench.InputError, r"(?s)detector fails_to_begin: .*ValueError: not today \\udce9$"
        ):
            environment.reset(seed=1)
        for use in (lambda: environment.step(np.zeros(1)), lambda: environment._grasp.bodies()):
            with self.assertRaisesRegex(RuntimeError, "call reset\\(\\) first"):
                use()


class Stages(unittest.TestCase):
    def test_gymnasiums_own_check_passes(self):
        check_env(gymnasium.make("slipbench/StageSlip-v0").unwrapped)

    def test_who_says_the_truth_is_always_right(self):
        environment = gymnasium.make("slipbench/StageSlip-v0", scene="papillarray/stage.yaml")
        _, info = environment.reset(seed=1)
        states, right, steps, over = set(), 0.0, 0, False
        while not over:
            states.add(info["state"])
            _, reward, _, over, info = environment.step(info["state"])
            right, steps = right + reward, steps + 1
        self.assertEqual(right, steps)
        self.assertGreater(len(states), 2)


if __name__ == "__main__":
    unittest.main()
