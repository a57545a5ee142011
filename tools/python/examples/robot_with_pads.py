"""PapillArray pads on the gripper of a robot in MuJoCo, which lifts a box and then lets it slip. Writes robot_with_pads.png."""

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import slipbench.mujoco

# Where these two stand, mujoco.MjSpec.from_file() may read an arm and a gripper of MuJoCo Menagerie.
ARM = """<mujoco><option integrator="implicitfast"/><worldbody>
  <geom type="plane" size="0.5 0.5 0.1"/>
  <body name="box" pos="0 0 0.03"><freejoint/><geom name="box" type="box" size="0.02 0.02 0.03" mass="0.1"/></body>
  <body name="wrist" pos="0 0 0.15"><joint name="lift" type="slide" axis="0 0 1" armature="1"/>
    <geom type="cylinder" size="0.02 0.02" mass="0.5"/><site name="attachment_site" pos="0 0 -0.02"/></body>
</worldbody><actuator><position name="lift" joint="lift" kp="5000" dampratio="1"/></actuator></mujoco>"""
GRIPPER = """<mujoco><worldbody><body name="palm"><geom type="box" size="0.05 0.02 0.005" mass="0.1"/>
  <body name="left" pos="-0.022 0 -0.09"><joint name="left" type="slide" axis="1 0 0" damping="5"/>
    <geom type="box" pos="-0.006 0 0.04" size="0.005 0.012 0.05" mass="0.05"/><site name="left_pad" zaxis="-1 0 0"/></body>
  <body name="right" pos="0.022 0 -0.09"><joint name="right" type="slide" axis="-1 0 0" damping="5"/>
    <geom type="box" pos="0.006 0 0.04" size="0.005 0.012 0.05" mass="0.05"/><site name="right_pad" zaxis="1 0 0"/></body>
</body></worldbody><actuator><motor name="left" joint="left"/><motor name="right" joint="right"/></actuator></mujoco>"""
FRICTION, MASS = 0.4, 0.1  # 1, kg

gripper, robot = mujoco.MjSpec.from_string(GRIPPER), mujoco.MjSpec.from_string(ARM)
for side in ("left", "right"):
    slipbench.mujoco.attach_pad(gripper, f"{side}_pad", touch="box", friction=FRICTION)
robot.attach(gripper, prefix="hand_", site="attachment_site")
slipbench.mujoco.complete(robot)  # the box is the robot's, not the gripper's
model = robot.compile()
model.opt.timestep = min(1e-3, 0.5 * slipbench.mujoco.max_timestep(model))
data, (left, right) = mujoco.MjData(model), slipbench.mujoco.pads(model).values()

rows = []
while data.time < 4.0:
    grip = 4.0 if data.time < 2.0 else 4.0 - 2.0 * (data.time - 2.0)  # N, of each finger: from 2 s on ever less
    data.actuator("hand_left").ctrl = data.actuator("hand_right").ctrl = grip if data.time > 0.1 else 0.0
    data.actuator("lift").ctrl = 0.05 * np.clip(data.time - 0.8, 0.0, 1.0)  # m
    mujoco.mj_step(model, data)
    pad = left.read(data)
    rows.append([data.time, pad.force[:, 2].sum(), (pad.unit_state == 1).sum(), data.body("box").xpos[2]])
time, force, sticking, height = np.array(rows).T
slips = np.argmax((time > 2.0) & (sticking == 0))
law = MASS * 9.81 / (2.0 * FRICTION)
print(f"MuJoCo {mujoco.__version__}; builds of the plugin: {slipbench.mujoco.builds()}")
print(f"all pillars slip from {force[slips]:.2f} N on; m g / (2 mu) = {law:.2f} N")

figure, axes = plt.subplots(3, 1, figsize=(9, 6), layout="constrained", sharex=True)
for axis, values, label in zip(axes, (force, sticking, 1e3 * height), ("normal force [N]", "pillars that stick", "height of the box [mm]"), strict=True):
    axis.plot(time, values)
    axis.set_ylabel(label)
axes[0].axhline(law, color="grey", linestyle=":", label="least that holds")
axes[0].legend()
axes[2].set_xlabel("time [s]")
figure.savefig("robot_with_pads.png")
