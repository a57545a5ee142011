"""Speed at which a capsule creeps out of a grip: pads of slipbench compared with MuJoCo's own contact.

    python scenes/mujoco/creep.py "$(./slipbench plugin-path)"

The case of google-deepmind/mujoco issue 3328: radius 4 mm, 45 g, friction 0.7, held by 12 to 60 N.
"""

import pathlib
import re
import sys

import mujoco

TEXT = pathlib.Path(__file__).with_name("capsule.xml").read_text()
# Nine elements of 20 and 12 kN/m, 2.7 mm apart: pillars of 7.1 kN/m would be 3 mm deep in the capsule at 60 N.
FIRM = [[2.7e-3 * (i - 1), 2.7e-3 * (j - 1), 0, 20e3, 12e3] for i in range(3) for j in range(3)]
CONTACTS = {
    "MuJoCo's defaults": "",
    "elliptic, impratio 10": 'cone="elliptic" impratio="10"',
    "elliptic, impratio 10, noslip 10": 'cone="elliptic" impratio="10" noslip_iterations="10"',
}


def with_firm_pads():
    """The model with stiff pads instead of the PapillArrays; its fingers start at the position at which 60 N compress three elements."""
    firm = TEXT.replace(
        'key="sensor" value="{type: papillarray}"', f'key="elements" value="{FIRM}"'
    )
    depth = 60.0 / (3 * 20e3) - 0.3e-3
    return re.sub(
        r'name="30N" qpos="0 0 0.1 1 0 0 0 .*?" ctrl=".*?"',
        f'name="60N" qpos="0 0 0.1 1 0 0 0 {depth} {depth}" ctrl="60 60"',
        firm,
    )


def without_pads(option, force):
    """The model with MuJoCo's own contact between fingers and capsule, which start 0.35 mm deep."""
    plain = re.sub(
        r"<extension>.*?</extension>|<plugin instance.*?/>|<sensor>.*?</sensor>|<keyframe>.*?</keyframe>",
        "",
        TEXT,
        flags=re.S,
    )
    plain = plain.replace('contype="0" conaffinity="0"', 'friction="0.7 0.005 0.0001"')
    plain = re.sub(r'pos="(-?)0.01 0 0" size', r'pos="\g<1>0.00495 0 0" size', plain)
    keyframe = f'<keyframe><key name="{force}N" qpos="0 0 0.1 1 0 0 0 0 0" ctrl="{force} {force}"/></keyframe></mujoco>'
    return plain.replace("</mujoco>", keyframe).replace(
        '"implicitfast"', f'"implicitfast" {option}'
    )


def creep(text, force, settle=1.0, watch=4.0):
    """Mean speed downwards [um/s] in the `watch` seconds after the first `settle` seconds."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(f"{force}N").id)
    mujoco.mj_step(model, data, round(settle / model.opt.timestep))
    start = data.qpos[2]
    mujoco.mj_step(model, data, round(watch / model.opt.timestep))
    return 1e6 * (start - data.qpos[2]) / watch


if __name__ == "__main__":
    mujoco.mj_loadPluginLibrary(sys.argv[1])
    for force in (12, 30, 60):
        print(
            f"{force} N, pads of slipbench: {creep(TEXT if force < 60 else with_firm_pads(), force):.2g} um/s"
        )
        for name, option in CONTACTS.items():
            print(f"{force} N, {name}: {creep(without_pads(option, force), force):.2g} um/s")
