"""Grasps as Gymnasium environments: importing this module registers them.

`slipbench/GraspLift-v0`: the published grasp with a lift of 100 mm. `slipbench/Grasp-v0`: any grasp
scene, `gymnasium.make("slipbench/Grasp-v0", scene="my.yaml")`. `slipbench/StageSlip-v0`: detection
in an open recording, frame by frame.

Reward of a grasp's step: -(F / F_ideal) dt / T - 0.1 for each mm slipped since the lift began - 10
if the box is dropped in it, or the lift ends without the box. F is the true grip force at the
step's end, F_ideal the least force that can hold the box, dt the step's length, T the scene's
duration. The episode terminates when the box is dropped, or when the arm rose without the box, and
is truncated at the end of the scene's duration. The duration may be shorter than the lift; then the
episode's end counts as the lift's.

Seeds: `reset(seed=s)` starts the first episode of seed s, each further `reset()` the next one. If
    no seed was ever given, `reset()` draws one from the operating system's entropy, a different one
    for each environment. The episodes of a seed cycle through the cells of a grid sweep. Successive
    seeds begin in successive cells, so that the environments of a vector run different trials.
"""

from __future__ import annotations

import copy
import json
import math
import os
import shlex
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import register
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from slipbench._program import counted
from slipbench._render import Renderer
from slipbench._scene import Scene, located, naming_unknown_classes, overrides_of, warn
from slipbench.bin import _core

__all__ = ["GraspEnv", "GraspVectorEnv", "StageSlipEnv"]

Observation = NDArray[np.float32]


def _seed(seed: int | None) -> int | None:
    if seed is not None and not 0 <= int(seed) < 2**64:
        raise _core.InputError(f"seed {seed}; allowed: 0 to 2^64 - 1")
    return None if seed is None else int(seed)


def _next_episode(
    environment: gymnasium.Env[Any, Any] | VectorEnv[Any, Any, Any],
    seed: int | None,
    episode: int,
    asked: int | None,
) -> tuple[int, int]:
    """Seed and number of the episode that a reset with the seed `asked` starts.

    The last episode was number `episode` of `seed`.
    """
    if asked is not None:
        return int(asked), 0
    if seed is not None:
        return seed, episode + 1
    return int(environment.np_random.integers(_SEEDS)), 0


def _refuse_pictures(render_mode: str | None, allowed: str) -> None:
    if render_mode is not None:
        raise _core.InputError(f"render_mode {render_mode!r}; allowed: {allowed}")


class _ResetNeeded(gymnasium.error.ResetNeeded, RuntimeError):
    """A step without an episode: before the first reset(), or after the episode's end."""


def _begun(episode: int) -> None:
    if episode < 0:
        raise _ResetNeeded("no episode has begun; call reset() first")


def _shaped(values: Any, key: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Converts a policy's values to an array with as many values as `shape`.

    Raises InputError with `key` and both shapes.
    """
    array = np.asarray(values)
    if array.size != math.prod(shape):
        raise _core.InputError(f"{key}: expected shape {shape}, found {array.shape}")
    return array


_SEEDS = 2**63  # upper limit of drawn seeds
_TRUTHS = ("time", "grip_force", "ideal_force", "slip_distance", "lifting")
_GREATEST = np.finfo(np.float32).max  # the only bound of a sensor's float32
_BOUNDS = {
    "gripper.position": 255.0,
    "gripper.moving": 1.0,
    "gripper.stopped": 1.0,
    "slip.state": 3.0,
}


# Divisors of a sensor's values in scaled observations, by unit, so that values of a grasp are of
# order one; other units: 1.
_SCALES = {"N": 5.0, "m": 1e-3, "counts": 4096.0, "V": 1.0, "Pa": 1e4, "kPa": 10.0}


def _scale(names: list[str], units: list[str], scaled: bool) -> Observation:
    """Divisor of each value of an observation: 1 unless observations are scaled."""
    if not scaled:
        return np.ones(len(names), np.float32)
    return np.array(
        [
            _BOUNDS.get(name, _SCALES.get(unit, 1.0))
            for name, unit in zip(names, units, strict=True)
        ],
        np.float32,
    )


def _spaces(
    names: list[str], scale: Observation
) -> tuple[gymnasium.Space[Observation], gymnasium.Space[Observation]]:
    low = np.array([0.0 if name in _BOUNDS else -_GREATEST for name in names], np.float32)
    high = np.array(
        [
            _BOUNDS[name] / by if name in _BOUNDS else _GREATEST
            for name, by in zip(names, scale, strict=True)
        ],
        np.float32,
    )
    return gymnasium.spaces.Box(low, high, dtype=np.float32), gymnasium.spaces.Box(
        -1.0, 1.0, (1,), np.float32
    )


def _info(truth: dict[str, Any], params: str) -> dict[str, Any]:
    info = {**truth, "params": json.loads(params)}
    if "outcome" in info:
        info["outcome"] = json.loads(info["outcome"])
    return info


class GraspEnv(gymnasium.Env[Observation, Observation]):
    """A grasp whose gripper the policy commands.

    A step lasts from one read of the gripper to the next, by default 20 ms.

    Truth is in `info` only. Each episode of a seed is another draw of the scene's sweep and
    scatter. Environments can be pickled and deep-copied at any step: the copy replays the episode's
    actions, and its next steps are bit-identical.

    Attributes:
        observation_names: name of each value of an observation: "gripper.position", "pad.P0_FX",
            ...
        observation_units: unit of each value before scaling: "counts", "N", ...; "1" for flags and
            codes
        observation_scale: [values] divisor of each value; 1 unless `scaled`
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 50}

    def __init__(
        self,
        scene: str | os.PathLike[str] = "grasp/lift.yaml",
        values: dict[str, Any] | None = None,
        command: str = "force",
        render_mode: str | None = None,
        scaled: bool = False,
    ) -> None:
        """`scene`: a file, or a scene of the package. `values`: as for `Scene.set()`.

        `command`: meaning of the action in [-1, 1]: "force", 0 to 20 N of measured grip force, or
        "position", 0 to 255 counts. `render_mode`: one of `metadata["render_modes"]`, or None.
        `scaled`: divides each value of an observation by `observation_scale`: forces by 5 N,
        displacements by 1 mm, counts of a sensor by 4096, the gripper's position by 255 and the
        detector's state by 3, so that values are of order one, as policies expect.
        """
        if render_mode != "rgb_array":
            _refuse_pictures(render_mode, "None, 'rgb_array'")
        self.render_mode = render_mode
        self._path, self._overrides = located(scene), overrides_of(values)
        self._command = command
        self._grasp = self._make()
        warn(text for _, text in self._grasp.warnings())
        self._seed: int | None = None
        self._episode, self._over = -1, False
        self._actions: list[float] = []  # of the episode
        self.observation_names: list[str] = self._grasp.names
        self.observation_units: list[str] = self._grasp.units
        self.observation_scale = _scale(self.observation_names, self.observation_units, scaled)
        self.observation_space, self.action_space = _spaces(
            self.observation_names, self.observation_scale
        )
        self._renderer = Renderer(self._grasp.bodies()) if render_mode else None

    def _make(self) -> _core.Grasp:
        with naming_unknown_classes():
            return _core.Grasp(self._path, self._overrides, self._command)

    def __getstate__(self) -> dict[str, Any]:
        return {
            name: value
            for name, value in self.__dict__.items()
            if name not in ("_grasp", "_renderer")
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._grasp = self._make()
        if self._seed is not None and self._episode >= 0:
            self._grasp.reset(self._seed, self._episode)
            for action in self._actions:
                self._grasp.step(action)
        self._renderer = Renderer(self._grasp.bodies()) if self.render_mode else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts the next episode of the seed, and runs it to the first read of the gripper.

        Args:
            seed: starts the first episode of this seed; None: the seed goes on. Without a seed now
                or before, a seed is drawn from the operating system's entropy
            options: ignored

        Returns:
            The observation [len(observation_names)], and `info`: the truth before the first step.
        """
        super().reset(seed=_seed(seed))
        self._seed, self._episode = _next_episode(self, self._seed, self._episode, seed)
        self._actions = []
        observation, _, failed, ended, truth = self._grasp.reset(self._seed, self._episode)
        self._over = failed or ended
        return observation / self.observation_scale, _info(truth, self._grasp.params)

    def step(self, action: Observation) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Sends a command, and runs to the next read.

        Args:
            action: the command [1], -1 to 1

        Returns:
            Observation, reward, terminated, truncated, info. `info` holds the truth: time s,
            grip_force N, ideal_force N, slip_distance m since the trial began, lifting, the draws
            (`params`), and after the last step the trial's `outcome`.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset(), and after the episode's end
            InputError: an action of another shape
        """
        _begun(self._episode)
        if self._over:
            raise _ResetNeeded("the episode is over; call reset() first")
        command = float(_shaped(action, "action", (1,)).reshape(()))
        observation, reward, failed, ended, truth = self._grasp.step(command)
        self._actions.append(command)
        self._over = failed or ended
        return (
            observation / self.observation_scale,
            reward,
            failed,
            ended,
            _info(truth, self._grasp.params),
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Image of the grasp, [480, 480, 3].

        It shows box, plates of the fingers (the blue one carries the first sensor) and table.
        """
        return self._renderer.draw(self._grasp.bodies()) if self._renderer else None

    def close(self) -> None:
        """Frees the renderer's buffers."""
        if self._renderer:
            self._renderer.close()
            self._renderer = None

    @property
    def episode_command(self) -> str:
        """Command line that runs this episode's trial with the scene's own controller."""
        sets = "".join(
            f" --set {shlex.quote(f'{path}={value}')}" for path, value in self._overrides
        )
        return self._grasp.command(shlex.quote(self._path) + sets)


class GraspVectorEnv(VectorEnv[Observation, Observation, Any]):
    """Several grasps, stepped by threads.

    Equal, step by step, to `SyncVectorEnv` of GraspEnv. Created by `gymnasium.make_vec()`.

    It can be pickled and deep-copied like a GraspEnv.

    Attributes:
        observation_names: name of each value of an environment's observation
        observation_units: unit of each value before scaling
        observation_scale: [values] divisor of each value; 1 unless `scaled`
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        scene: str | os.PathLike[str] = "grasp/lift.yaml",
        values: dict[str, Any] | None = None,
        command: str = "force",
        render_mode: str | None = None,
        jobs: int = 0,
        scaled: bool = False,
    ) -> None:
        """`num_envs` grasps.

        Other arguments are those of GraspEnv.

        `jobs`: threads; 0: one per core. The results do not depend on it.
        """
        _refuse_pictures(render_mode, "None, in a vector of grasps")
        if num_envs < 1 or jobs < 0:
            raise _core.InputError(
                f"num_envs {num_envs}, jobs {jobs}; allowed: 1 or more, 0 or more"
            )
        self.render_mode = render_mode
        self.num_envs = num_envs
        self._path, self._overrides, self._command, self._jobs = (
            located(scene),
            overrides_of(values),
            command,
            jobs,
        )
        self._grasps = self._make()
        warn(text for _, text in self._grasps.warnings())
        self._actions: list[list[float]] = [
            [] for _ in range(num_envs)
        ]  # of each environment's episode
        self._seeds: list[int | None] = [None] * num_envs
        self._episodes = [-1] * num_envs
        self._drawn: list[str] = []
        self._params: dict[str, Any] = {}
        self.observation_names: list[str] = self._grasps.names
        self.observation_units: list[str] = self._grasps.units
        self.observation_scale = _scale(self.observation_names, self.observation_units, scaled)
        self.single_observation_space, self.single_action_space = _spaces(
            self.observation_names, self.observation_scale
        )
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _make(self) -> _core.Grasps:
        with naming_unknown_classes():
            return _core.Grasps(
                self._path,
                self._overrides,
                self._command,
                self.num_envs,
                self._jobs or os.cpu_count() or 1,
            )

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_grasps"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._grasps = self._make()
        if min(self._episodes) >= 0:
            self._grasps.reset([seed for seed in self._seeds if seed is not None], self._episodes)
            for i, actions in enumerate(self._actions):
                self._grasps.replay(i, actions)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts an episode in each environment.

        Args:
            seed: environment i starts with `seed` + i, or with its seed in a list. Without a seed
                now or before, each environment draws its own from the operating system's entropy
            options: ignored, except that the key `reset_mask`, which requests a partial reset, is
                refused

        Returns:
            The observations [num_envs, values], and `info`.

        Raises:
            InputError: another number of seeds than environments, or `reset_mask`
        """
        first = seed if seed is None or not isinstance(seed, (list, tuple)) else None
        super().reset(seed=_seed(first))
        seeds = (
            list(seed)
            if isinstance(seed, (list, tuple))
            else [None if first is None else int(first) + i for i in range(self.num_envs)]
        )
        if len(seeds) != self.num_envs:
            raise _core.InputError(
                f"{counted(len(seeds), 'seed')}; expected one for each of the {self.num_envs} environments"
            )
        if options and "reset_mask" in options:
            raise _core.InputError(
                "options has 'reset_mask', but this vector resets all environments together"
            )
        asked = [_seed(one) for one in seeds]
        begun = [
            _next_episode(self, before, episode, one)
            for before, episode, one in zip(self._seeds, self._episodes, asked, strict=True)
        ]
        self._seeds = [one for one, _ in begun]
        self._actions = [[] for _ in begun]
        observations, _, _, _, infos = self._batch(
            self._grasps.reset([one for one, _ in begun], [episode for _, episode in begun])
        )
        return observations, infos

    def step(
        self, actions: Observation
    ) -> tuple[
        Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Sends a command to each environment, and runs it to its next read.

        An environment whose episode has ended starts its next one instead and ignores the command.

        Args:
            actions: a row for each environment [num_envs, 1], -1 to 1

        Returns:
            Observations [num_envs, values], and [num_envs] rewards, terminated, truncated; info.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset()
            InputError: actions of another shape
        """
        _begun(min(self._episodes))
        commands: list[float] = (
            _shaped(actions, "actions", (self.num_envs, 1))
            .astype(np.float64)
            .reshape(self.num_envs)
            .tolist()
        )
        before = self._episodes
        result = self._batch(self._grasps.step(commands))
        for i, command in enumerate(commands):
            if self._episodes[i] == before[i]:
                self._actions[i].append(command)
            else:
                self._actions[i] = []
        return result

    def _batch(
        self, results: Any
    ) -> tuple[
        Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        observations, numbers, flags, self._episodes, drawn, outcomes = results
        rewards, *truths = numbers.reshape(-1, self.num_envs)
        terminated, truncated, lifting = flags.view(np.bool_).reshape(-1, self.num_envs)
        # Built as by `_add_info`, whose call takes as long as a step of a grasp; constant entries
        # are therefore added once per episode.
        infos: dict[str, Any] = {}
        for name, truth, known in zip(
            _TRUTHS,
            (*truths, lifting),
            np.ones((len(_TRUTHS), self.num_envs), np.bool_),
            strict=True,
        ):
            infos[name], infos[f"_{name}"] = truth, known
        if drawn != self._drawn:
            self._drawn, self._params = drawn, {}
            for i, params in enumerate(drawn):
                self._params = self._add_info(self._params, {"params": json.loads(params)}, i)
        infos.update(copy.deepcopy(self._params))
        for i, outcome in outcomes.items():
            infos = self._add_info(infos, {"outcome": json.loads(outcome)}, i)
        return (
            observations.reshape(self.num_envs, -1) / self.observation_scale,
            rewards,
            terminated,
            truncated,
            infos,
        )


class StageSlipEnv(gymnasium.Env[Observation, np.int64]):
    """Slip detection in an open recording of a stage scene, sample by sample.

    The action is the pad's `State` at that sample.

    Observation: the sensor's channels at that sample, concatenated, in their own units. Reward: 1
        if the action is right about slip (incipient or gross, by `state_micro`), else 0. Truth is
        in `info` only. The episode is truncated at the recording's end.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        scene: str | os.PathLike[str] = "papillarray/hexapod.yaml",
        values: dict[str, Any] | None = None,
        sensor: str = "",
        render_mode: str | None = None,
    ) -> None:
        """`scene`, `values`: as for GraspEnv.

        `sensor`: the observed one; empty: the only one. `render_mode`: None.
        """
        _refuse_pictures(render_mode, "None: a recording has no picture")
        self._scene = Scene.load(scene).set(values)
        self.render_mode = render_mode
        self._sensor = sensor
        self._seed: int | None = None
        self._episode = -1
        self._record(self._scene.seed, 0)
        self.observation_space = gymnasium.spaces.Box(
            -_GREATEST, _GREATEST, (self._values.shape[1],), np.float32
        )
        self.action_space = gymnasium.spaces.Discrete(4)

    def _record(self, seed: int, episode: int) -> None:
        trial = self._scene._run_episode(episode, seed)
        if self._sensor not in trial.sensors and (self._sensor or len(trial.sensors) != 1):
            raise _core.InputError(
                f"sensor {self._sensor!r}; allowed: {', '.join(map(repr, trial.sensors))}"
            )
        sensor = trial.sensors[self._sensor or next(iter(trial.sensors))]
        samples = len(sensor.t)
        slower = [name for name, values in sensor.channels.items() if len(values) != samples]
        if slower:
            raise _core.InputError(
                f"sensor {sensor.type!r}: channels {slower} have separate rates; use a sensor whose channels share one rate"
            )
        self._values = np.concatenate(
            [values.reshape(samples, -1) for values in sensor.channels.values()], axis=1
        )
        self._time, self._states, self._params = (
            sensor.t,
            trial.labels[sensor.name].state_micro,
            trial.params,
        )
        self._at = 0

    def _info(self) -> dict[str, Any]:
        return {
            "time": float(self._time[self._at]),
            "state": int(self._states[self._at]),
            "params": dict(self._params),
        }

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Simulates the next recording of the seed.

        Args:
            seed: simulates the first recording of this seed; None: the seed goes on. Without a seed
                now or before, a seed is drawn from the operating system's entropy
            options: ignored

        Returns:
            The first sample, and `info`.
        """
        super().reset(seed=_seed(seed))
        self._seed, self._episode = _next_episode(self, self._seed, self._episode, seed)
        self._record(self._seed, self._episode)
        return self._values[0].copy(), self._info()

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Judges an action for the sample shown last, and shows the next sample.

        Args:
            action: the code of a `State`

        Returns:
            Observation, reward, terminated, truncated, info.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset(), and after the recording's end
            InputError: an action that is no code
        """
        _begun(self._episode)
        if not self.action_space.contains(np.int64(action)):
            raise _core.InputError(f"action {action}; allowed: 0 to 3, a State")
        if self._at + 1 == len(self._values):
            raise _ResetNeeded("the episode is over; call reset() first")
        right = (int(action) >= 2) == (self._states[self._at] >= 2)
        self._at += 1
        return (
            self._values[self._at].copy(),
            float(right),
            False,
            self._at + 1 == len(self._values),
            self._info(),
        )


register(
    "slipbench/Grasp-v0",
    "slipbench.gym:GraspEnv",
    vector_entry_point="slipbench.gym:GraspVectorEnv",
)
register(
    "slipbench/GraspLift-v0",
    "slipbench.gym:GraspEnv",
    vector_entry_point="slipbench.gym:GraspVectorEnv",
    kwargs={"scene": "grasp/lift.yaml", "values": {"friction": {"static": 0.2, "kinetic": 0.15}}},
)
register("slipbench/StageSlip-v0", "slipbench.gym:StageSlipEnv")
