"""Pads on robots of MuJoCo Menagerie: a Panda and a 2F-85 let a box slip, a LEAP hand holds a bar. README.md lists the expected results.

python robots.py MENAGERIE panda|robotiq_2f85|leap_hand [-o PICTURE.png]
"""

import argparse
import copy
import sys
from pathlib import Path

import mujoco
import numpy as np
import slipbench
import slipbench.mujoco

FRICTION = 0.5
PILLARS = {
    "type": "papillarray",
    "profile": "hexapod",
}  # soft pillars, of which several touch at the 1 N of a Panda
# m, of their tips (sensors/papillarray)
TIPS = 1e-3 * np.array(
    [
        [7, 7, 0.45],
        [0, 7, 0.2],
        [-7, 7, 0.45],
        [7, 0, 0.2],
        [0, 0, 0],
        [-7, 0, 0.2],
        [7, -7, 0.45],
        [0, -7, 0.2],
        [-7, -7, 0.45],
    ]
)
PALM_SIDE = [1, 0, 1, 0]  # quaternion that turns a site's +Z to +X, for a LEAP fingertip
JAW_SIDE = [
    1,
    -1,
    0,
    0,
]  # quaternion that turns a site's +Z to +Y, for the fingers of both grippers
UNSEEN = {"size": [0.0018, 0.0018, 0.0018], "rgba": [0.0, 0.0, 0.0, 0.0]}  # a site behind its pad


def panda(menagerie):
    """The drive is a spring of 100 N/m to the commanded position, and each finger gets half of its force."""
    spec = load(menagerie, "franka_emika_panda/panda.xml")
    for side in (
        "left",
        "right",
    ):  # the tips are 10 mm in front of the middle of the fingertip's face
        part(spec, f"{side}_finger").add_site(
            name=side, pos=[0, -0.01, 0.0445], quat=JAW_SIDE, **UNSEEN
        )
    model, data, pads = with_pads(spec, ["left", "right"], [0.02, 0.02, 0.03], 0.1)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    data.joint("finger_joint1").qpos = data.joint("finger_joint2").qpos = (
        0.0297  # compresses the tips by 0.3 mm
    )
    put_between(model, data, "left", "right")
    drive = data.actuator("actuator8")
    drive.ctrl = 0.0
    mujoco.mj_step(model, data, round(2 / model.opt.timestep))
    figures = {
        "force of the drive on a finger [N]": -float(drive.force[0]) / 2,
        "normal force of the pads at rest [N]": normal_force(pads, data),
    }
    slip, picture = let_go(model, data, pads, drive, 6.4)  # 0.05 N/s
    return {**figures, **slip}, (model, picture, "hand", 0.18, [0, 0, 0.1], 65)


def robotiq_2f85(menagerie):
    """A linkage between drive and pads: by virtual work, the work of both in a small motion adds up to zero."""
    spec = load(menagerie, "robotiq_2f85/2f85.xml")
    base = part(spec, "base_mount")
    base.pos, base.quat = [0, 0, 0.3], [0, 1, 0, 0]  # the gripper points downwards
    for side in ("left", "right"):  # 4 mm in front of the fingertip
        part(spec, f"{side}_pad").add_site(
            name=side, pos=[0, -0.0106, 0.01875], quat=JAW_SIDE, **UNSEEN
        )
    model, data, pads = with_pads(spec, ["left", "right"], [0.02, 0.02, 0.03], 0.5)
    for side in ("left", "right"):  # closed until it touches the box
        for joint, angle in (("driver", 0.4), ("spring_link", 0.4), ("follower", -0.385)):
            data.joint(f"{side}_{joint}_joint").qpos = angle
    put_between(model, data, "left", "right")
    drive = data.actuator("fingers_actuator")
    drive.ctrl = 124.0
    mujoco.mj_step(model, data, round(2 / model.opt.timestep))
    figures = {
        "normal force of the pads at rest [N]": normal_force(pads, data),
        **virtual_work(model, data, pads),
    }
    slip, picture = let_go(model, data, pads, drive, -0.12)  # 0.1 N/s
    return {**figures, **slip}, (model, picture, "base", 0.17, [0, 0, 0.14], 65)


def leap_hand(menagerie):
    """Each finger presses with 1 N and the thumb with 3 N, by torques J^T f, which the servos exert if their target angles are offset accordingly."""
    spec = load(menagerie, "leap_hand/right_hand.xml")
    # The names of bodies and joints differ between versions of the model; their order is the same.
    tips = [body for body in spec.bodies if body.name != "world" and not len(body.bodies)]
    names = ["index", "middle", "ring", "thumb"]
    if len(tips) != len(names) or len(spec.joints) != 16:
        raise slipbench.InputError(
            f"the LEAP hand has {len(tips)} tips and {len(spec.joints)} joints; allowed: 4 and 16"
        )
    for name, tip in zip(names, tips, strict=True):
        tip.add_site(
            name=name,
            pos=[-0.015, -0.047, -0.0143] if name == "thumb" else [-0.015, -0.034, 0.0146],
            quat=PALM_SIDE,
            **UNSEEN,
        )
    model, data, pads = with_pads(spec, names, [0.015, 0.06, 0.012], 0.1)
    data.qpos[:16] = 3 * [1.735, 0.0, -0.13, -0.03] + [1.868, 0.0, 0.1, -0.1]
    put_between(model, data, "middle", "thumb")
    mujoco.mj_forward(model, data)
    torque = data.qfrc_bias.copy()  # carries the fingers
    for name, force in zip(names, (1.0, 1.0, 1.0, 3.0), strict=True):
        jacobian = np.empty((3, model.nv))
        mujoco.mj_jacSite(model, data, jacobian, None, model.site(name).id)
        torque -= force * data.site(name).xmat.reshape(3, 3)[:, 2] @ jacobian
    data.ctrl[:] = data.qpos[:16] + torque[:16] / model.actuator_gainprm[:, 0]
    mujoco.mj_step(model, data, round(6 / model.opt.timestep))
    held = sum(axes_of(data, pad) @ -pad.read(data).force.sum(axis=0) for pad in pads)
    figures = {
        f"normal force of {pad.name} [N]": float(pad.read(data).force[:, 2].sum()) for pad in pads
    }
    figures |= {
        "weight of the bar [N]": weight(model),
        "sum of the pads' forces on it, upwards [N]": float(held[2]),
        "sum, sideways [N]": float(np.hypot(held[0], held[1])),
        "other contacts of the bar": others(model, data),
    }
    return figures, (model, data, "object", 0.25, [0.01, 0, -0.03], 65)


def load(menagerie, file):
    path = Path(menagerie) / file
    if not path.is_file():
        raise slipbench.InputError(
            f"{path}: no such file; allowed: the folder of a clone of github.com/google-deepmind/mujoco_menagerie"
        )
    return mujoco.MjSpec.from_file(str(path))


def part(spec, name):
    body = spec.body(name)
    if body is None:
        raise slipbench.InputError(
            f"the model {spec.modelname!r} has no body {name!r}; allowed: the model as MuJoCo Menagerie has it"
        )
    return body


def with_pads(spec, sites, size, mass):
    """Adds a free box and the pads that touch it.

    Implicit ones if MuJoCo has the integrator for them (since 3.14). Explicit ones refuse these models'
    step of 2 ms.
    """
    light = [0.97, 0.97, 0.98]
    spec.add_texture(
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=light,
        rgb2=light,
        width=8,
        height=48,
    )
    body = spec.worldbody.add_body(name="object", pos=[0, 0, 1])
    body.add_freejoint(name="object")
    body.add_geom(
        name="object",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=size,
        mass=mass,
        rgba=[0.85, 0.8, 0.7, 0.25],
    )
    release = tuple(map(int, mujoco.__version__.split(".")[:2]))
    solver = "implicit" if release >= (3, 14) else "explicit"
    if solver == "explicit":
        spec.option.timestep = 0.0005
    pads = [
        slipbench.mujoco.attach_pad(
            spec, site, "object", pad=PILLARS, friction=FRICTION, solver=solver
        )
        for site in sites
    ]
    model = spec.compile()
    return model, mujoco.MjData(model), pads


def put_between(model, data, one, other):
    mujoco.mj_kinematics(model, data)
    data.joint("object").qpos[:3] = (data.site(one).xpos + data.site(other).xpos) / 2


def axes_of(data, pad):
    return data.site(pad.name).xmat.reshape(3, 3)


def normal_force(pads, data):
    return float(np.mean([pad.read(data).contact_force[:, 2].sum() for pad in pads]))


def let_go(model, data, pads, drive, rate):
    """Changes a control by `rate` per second until no pillar sticks. Returns the figures of that moment, and the data when half of them slipped."""
    half = None
    for _ in range(round(60 / model.opt.timestep)):
        drive.ctrl += rate * model.opt.timestep
        mujoco.mj_step(model, data)
        states = np.concatenate([pad.read(data).unit_state for pad in pads])
        if half is None and (states == 2).sum() >= (states == 1).sum():
            half = copy.copy(data)
        if not (states == 1).any():
            return {
                "the box slips at [N]": normal_force(pads, data),
                "m g / (2 mu) [N]": weight(model) / (2 * FRICTION),
                "other contacts of the box": others(model, data),
            }, half
    raise RuntimeError("the box has not slipped within a minute")


def weight(model):
    return float(-model.body("object").mass[0] * model.opt.gravity[2])


def virtual_work(model, data, pads):
    """Returns the virtual work of the drive and of the pads per turn of the drivers [N m/rad].

    The turn is along the one motion that the closed linkage and its stops allow.
    """
    mujoco.mj_forward(model, data)
    closed = np.isin(
        data.efc_type,
        [mujoco.mjtConstraint.mjCNSTR_EQUALITY, mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT],
    )
    linkage = data.efc_J.reshape(-1, model.nv)[closed, :8]
    turn = np.zeros(model.nv)
    turn[:8] = np.linalg.svd(linkage)[2][-1]  # the one motion that no constraint resists
    turn /= turn[model.joint("right_driver_joint").dofadr[0]]
    work = 0.0
    for pad in pads:
        reading, axes, site, jacobian = (
            pad.read(data),
            axes_of(data, pad),
            model.site(pad.name),
            np.empty((3, model.nv)),
        )
        # The force of a pillar acts at the point where its undeformed tip would meet the face.
        for tip, force in zip(TIPS + reading.displacement * [0, 0, 1], reading.force, strict=True):
            mujoco.mj_jac(
                model, data, jacobian, None, data.site(pad.name).xpos + axes @ tip, site.bodyid[0]
            )
            work += axes @ force @ jacobian @ turn
    return {
        "work of drive, springs and weight [N m/rad]": float(
            turn @ (data.qfrc_actuator + data.qfrc_spring - data.qfrc_bias)
        ),
        "work of the pads [N m/rad]": float(work),
    }


def others(model, data):
    """Number of MuJoCo's own contacts of the object; above 0 the pads do not carry it alone."""
    touched = model.geom("object").id
    return sum(touched in (contact.geom1, contact.geom2) for contact in data.contact)


def draw(file, model, data, body, distance, offset, azimuth):
    from PIL import Image

    model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:], model.vis.map.znear = (
        0.5,
        0.5,
        0.005,
    )
    camera = mujoco.MjvCamera()
    camera.lookat = data.body(body).xpos + data.body(body).xmat.reshape(3, 3) @ offset
    camera.distance, camera.azimuth, camera.elevation = distance, azimuth, -15
    with mujoco.Renderer(model, 400, 480) as renderer:
        renderer.update_scene(data, camera)
        Image.fromarray(renderer.render()).quantize(256).save(file, optimize=True)


def main():
    robots = {function.__name__: function for function in (panda, robotiq_2f85, leap_hand)}
    words = argparse.ArgumentParser(description="Pads on robots of MuJoCo Menagerie.")
    words.add_argument(
        "menagerie", help="folder of your clone of github.com/google-deepmind/mujoco_menagerie"
    )
    words.add_argument("robot", choices=robots)
    words.add_argument(
        "-o",
        metavar="PICTURE.png",
        help="draws the robot; needs MUJOCO_GL=egl where there is no screen",
    )
    given = words.parse_args()
    try:
        figures, picture = robots[given.robot](given.menagerie)
    except (
        ValueError
    ) as error:  # includes InputError; MuJoCo reports a missing file of the model by it
        print(f"error: {error}", file=sys.stderr)
        return 2
    for name, value in figures.items():
        print(f"{name:50} {value:.6g}")
    if given.o:
        draw(given.o, *picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
