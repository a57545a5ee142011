"""Images of a grasp, drawn by MuJoCo's renderer at the poses of its bodies."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipbench.bin import _core

WIDTH, HEIGHT = 480, 480
_PLATE = 0.022, 0.0375, 8e-3  # m, of a finger: the 2F-85's (mujoco_menagerie)
_BOX, _FIRST, _OTHER = (
    "0.85 0.55 0.2 1",
    "0.2 0.45 0.75 1",
    "0.35 0.35 0.4 1",
)  # colours: the box, the first pad, other pads
_HEADER = f"""<mujoco>
  <visual><global offwidth="{WIDTH}" offheight="{HEIGHT}"/><headlight ambient="0.4 0.4 0.4"/></visual>
  <asset><texture type="skybox" builtin="gradient" rgb1="1 1 1" rgb2="0.75 0.82 0.9" width="64" height="384"/>
  <texture name="grid" type="2d" builtin="checker" rgb1="0.9 0.9 0.9" rgb2="0.82 0.82 0.84" width="256" height="256"/>
  <material name="grid" texture="grid" texrepeat="20 20" texuniform="true"/></asset>
  <worldbody><light pos="0.2 -0.4 0.8" dir="-0.2 0.4 -0.8"/>"""

Bodies = Mapping[
    str, tuple[NDArray[np.float64], Any]
]  # name: pose x y z qw qx qy qz in the world [m], extent [3] or None


def _drawn(bodies: Bodies) -> list[str]:
    return [name for name in bodies if name not in ("arm", "table")]


def _drawing(bodies: Bodies) -> str:
    table = bodies["table"][0]
    text = (
        _HEADER
        + f'<geom type="plane" size="0 0 1" pos="{table[0]} {table[1]} {table[2]}" material="grid"/>'
    )
    colours = iter([_FIRST])
    for name in _drawn(bodies):
        # A pad's Z points opposite to its closing direction; the plate is on that side.
        size, back, colour = (
            (bodies[name][1], 0.0, _BOX)
            if name == "box"
            else (_PLATE, _PLATE[2] / 2, next(colours, _OTHER))
        )
        half = " ".join(str(extent / 2) for extent in size)
        text += f'<body name="{name}" mocap="true"><geom type="box" pos="0 0 {back}" size="{half}" rgba="{colour}"/></body>'
    return text + "</worldbody></mujoco>"


class Renderer:
    """Draws one grasp without a screen.

    Raises InputError if EGL or the package PyOpenGL is missing.
    """

    def __init__(self, bodies: Bodies) -> None:
        try:
            import mujoco
            import mujoco.egl

            self._context: Any = mujoco.egl.GLContext(WIDTH, HEIGHT)
        except (
            ImportError,
            RuntimeError,
            AttributeError,
            ctypes.ArgumentError,
        ) as error:  # ctypes.ArgumentError: PyOpenGL without libOpenGL
            raise _core.InputError(
                f"render_mode 'rgb_array': needs EGL and pip install 'slipbench[render]' ({error}); allowed here: None"
            ) from error
        self._mujoco: Any = mujoco
        self._model = mujoco.MjModel.from_xml_string(_drawing(bodies))
        self._data = mujoco.MjData(self._model)
        self._context.make_current()
        self._gpu = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._gpu)
        self._scene = mujoco.MjvScene(self._model, maxgeom=100)
        self._camera = mujoco.MjvCamera()
        self._camera.lookat[:] = bodies["table"][0][:3] + [0.0, 0.0, 0.08]
        self._camera.azimuth, self._camera.elevation, self._camera.distance = 75.0, -12.0, 0.42

    def draw(self, bodies: Bodies) -> NDArray[np.uint8]:
        """Image [HEIGHT, WIDTH, 3]."""
        mujoco = self._mujoco
        for name in _drawn(bodies):
            body = self._model.body(name).mocapid[0]
            self._data.mocap_pos[body], self._data.mocap_quat[body] = (
                bodies[name][0][:3],
                bodies[name][0][3:],
            )
        mujoco.mj_forward(self._model, self._data)
        self._context.make_current()
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            mujoco.MjvOption(),
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )
        view = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        mujoco.mjr_render(view, self._scene, self._gpu)
        picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_readPixels(picture, None, view, self._gpu)
        return np.ascontiguousarray(picture[::-1])

    def close(self) -> None:
        """Frees the buffers."""
        self._context.make_current()
        self._gpu.free()
        self._context.free()
