"""Searches a grip policy that holds the box of mu 0.2 with less force than step_on_slip.

The policy commands the force w0 + w1 T [N], with T the tangential force measured by the pad [N].
The cross-entropy method searches w: candidates are drawn, all grasp the same boxes, and the next
candidates are drawn around the best.
"""

import sys
from typing import Any

import numpy as np
import slipbench
import slipbench.gym
from numpy.typing import NDArray

MU = {"friction": {"static": 0.2, "kinetic": 0.15}}  # of slipbench/GraspLift-v0
STRONGEST = 20.0  # N, force of the action 1
ROUNDS, CANDIDATES, BEST, UNSEEN = 4, 10, 3, 40
if "--quick" in sys.argv:
    ROUNDS, CANDIDATES, BEST, UNSEEN = 1, 3, 2, 8
BOXES = 8
FIGURES = ("dropped", "lifted", "max_grip_force_N", "ideal_grip_force_N")


def grasps(
    environment: slipbench.gym.GraspVectorEnv, weights: NDArray[np.float64], seed: int
) -> tuple[NDArray[np.float64], list[dict[str, Any]]]:
    """Each environment's return and last `info` of one episode, with the boxes of `seed`."""
    names = environment.observation_names
    along = [
        [k for k, name in enumerate(names) if name.startswith("pad.P") and name.endswith(axis)]
        for axis in ("FX", "FY")
    ]
    observations, _ = environment.reset(seed=[seed + i for i in range(environment.num_envs)])
    returns = np.zeros(environment.num_envs)
    outcomes: list[dict[str, Any]] = [{} for _ in range(environment.num_envs)]
    while not all(outcomes):
        tangential = np.hypot(*(observations[:, columns].sum(axis=1) for columns in along))
        actions = np.clip(2.0 * (weights[0] + weights[1] * tangential) / STRONGEST - 1.0, -1.0, 1.0)
        observations, rewards, terminated, truncated, infos = environment.step(
            actions[:, None].astype(np.float32)
        )
        for i in range(environment.num_envs):
            if not outcomes[i]:
                returns[i] += rewards[i]
                if terminated[i] or truncated[i]:
                    outcomes[i] = {name: infos["outcome"][name][i] for name in FIGURES}
    return returns, outcomes


def report(name: str, outcomes: list[dict[str, Any]]) -> None:
    """Prints the number of boxes dropped or not lifted, and the relative grip force.

    This is the ratio of the greatest force to the least that holds.
    """
    lost = sum(outcome["dropped"] or not outcome["lifted"] for outcome in outcomes)
    ratios = [outcome["max_grip_force_N"] / outcome["ideal_grip_force_N"] for outcome in outcomes]
    print(
        f"{name:28} lost {lost:2} of {len(outcomes)}, greatest force over the least that holds: {np.median(ratios):.2f}"
    )


def main() -> None:
    draws = np.random.default_rng(1)
    environment = slipbench.gym.GraspVectorEnv(BOXES, values=MU)
    middle, width = np.array([6.0, 0.0]), np.array([2.0, 1.0])
    for number in range(ROUNDS):
        candidates = middle + width * draws.standard_normal((CANDIDATES, 2))
        scores = np.array(
            [grasps(environment, candidate, 100 * number)[0].mean() for candidate in candidates]
        )
        best = candidates[np.argsort(-scores)[:BEST]]
        middle, width = best.mean(axis=0), best.std(axis=0) + 0.05
        print(
            f"round {number + 1}: best return {scores.max():.2f}, force {middle[0]:.2f} N + {middle[1]:.2f} T"
        )

    held = [
        outcome
        for first in range(0, UNSEEN, BOXES)
        for outcome in grasps(environment, middle, 10_000 + first)[1]
    ]
    report("found by search", held)
    for detector in ("gst_hd", "truth"):
        scene = slipbench.Scene.load("grasp/lift.yaml").set({**MU, "detector": {"type": detector}})
        report(
            f"step_on_slip with {detector}",
            [scene.run(seed=10_000 + k, record="outcome").outcome for k in range(UNSEEN)],
        )


if __name__ == "__main__":
    main()
