"""Measures control steps per second of MuJoCo alone and of GraspLift-v0.

MuJoCo runs with and without contacts, GraspLift-v0 by environments and threads, with Python's
share: PYTHONPATH=build/release/python build/venv/bin/python tests/benchmarks/vector_speed.py
"""

import statistics
import time
from types import SimpleNamespace

import gymnasium
import mujoco
import numpy as np
import slipbench.gym  # noqa: F401 (registers the environments)

EPISODE = 251  # control steps of 20 ms, including the one that begins the next episode
STEPS = 34  # of the lift's own time step, per control step
# The lift's bodies and options as slipbench compiles them; MuJoCo's contacts replace its pads and
# the fingers' springs.
BODIES = f"""<mujoco><option timestep="{0.02 / STEPS}" cone="elliptic" noslip_iterations="10"/><default><geom friction="0.5" solref="0.002"/></default>
<worldbody><geom type="plane" size="0 0 1" pos="0 0 -0.05"/><body><freejoint/><geom type="box" size="0.03 0.03 0.05" mass="0.2"/></body>
<body pos="-0.034 0 0" gravcomp="1"><freejoint/><geom type="box" size="0.004 0.011 0.01875" mass="0.08"/></body>
<body pos="0.034 0 0" gravcomp="1"><freejoint/><geom type="box" size="0.004 0.011 0.01875" mass="0.08"/></body></worldbody></mujoco>"""


def mujoco_alone(flags: int) -> float:
    model = mujoco.MjModel.from_xml_string(BODIES)
    model.opt.disableflags |= flags
    data = mujoco.MjData(model)
    data.xfrc_applied[2:4, 0] = 10.0, -10.0  # N
    began = time.perf_counter()
    for _ in range(EPISODE):
        mujoco.mj_step(model, data, nstep=STEPS)
    return EPISODE / (time.perf_counter() - began)


def grasps(count: int, jobs: int) -> tuple[float, float]:
    grasps = gymnasium.make_vec("slipbench/GraspLift-v0", num_envs=count, jobs=jobs).unwrapped
    grasps.reset(seed=1)
    inside = grasps._grasps  # the extension
    turns, actions, spent = EPISODE * max(1, 8 // count), np.zeros((count, 1), np.float32), 0.0
    for _ in range(turns):
        began = time.perf_counter()
        grasps.step(actions)
        spent += time.perf_counter() - began
    result = inside.step(actions[:, 0].tolist())
    grasps._grasps = SimpleNamespace(step=lambda actions: result)  # a step that costs nothing
    began = time.perf_counter()
    for _ in range(turns):
        grasps.step(actions)
    return turns * count / spent, (time.perf_counter() - began) / spent


cases = [(1, 1), (8, 1), (64, 1), (8, 2), (64, 2)]
rows = [
    [
        mujoco_alone(0),
        mujoco_alone(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT),
        *(x for case in cases for x in grasps(*case)),
    ]
    for _ in range(5)
]
for row in [
    ["MuJoCo", "apart", *(x for count, jobs in cases for x in (f"{count} x {jobs}", "Python"))],
    *rows,
]:
    print(*(f"{x:9}" if isinstance(x, str) else f"{x:9.4g}" for x in row))
print(*(f"{statistics.median(column):9.4g}" for column in zip(*rows, strict=True)))
