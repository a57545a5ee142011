"""Pads in any MuJoCo model.

Importing this loads the plugin `slipbench.field` into the package `mujoco`.

`attach_pad()` puts a pad on a site of an MjSpec, `Pad.read()` reads it by name, `max_timestep()`
returns the longest stable step. It supports the releases of MuJoCo that `builds()` lists; with any
other the import raises `InputError` with the command that adds the release.
"""

from __future__ import annotations

import ctypes
import itertools
import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from slipbench import _own
from slipbench._values import plain
from slipbench.bin import _core
from slipbench.bin._core import InputError

try:
    import mujoco as _mujoco
except ImportError as error:
    raise ImportError(
        "slipbench.mujoco needs the package mujoco, which is not installed; install it: pip install mujoco"
    ) from error

__all__ = [
    "Pad",
    "Reading",
    "attach_pad",
    "builds",
    "complete",
    "load",
    "max_timestep",
    "pads",
    "plugin_path",
]

_PLUGIN = "slipbench.field"
_FOLDER = Path(__file__).parent / "lib" / "slipbench"
_library: ctypes.CDLL | None = None
_numbers = itertools.count(1)


def builds() -> list[str]:
    """Releases of MuJoCo that this slipbench knows, oldest first."""
    return list(_core.known_releases())


def plugin_path(version: str | None = None) -> str:
    """Path of the plugin's library, the same for all releases of MuJoCo.

    Args:
        version: the release in which it will be loaded; None: that of the package `mujoco`

    Returns:
        The path.

    Raises:
        InputError: the plugin does not know this release; the text contains the command that adds
            it
    """
    folder = _FOLDER.resolve()
    own = version is None or version == _mujoco.__version__
    library = Path(_mujoco.__file__).parent / f"libmujoco.so.{_mujoco.__version__}"
    _core.check_release(version or _mujoco.__version__, str(folder), str(library) if own else "")
    return str(folder / "libslipbench_mujoco.so")


def load() -> None:
    """Loads the plugin into the package `mujoco`, once. Importing `slipbench.mujoco` calls it."""
    global _library
    if _library is not None:
        return
    path = plugin_path()
    _mujoco.mj_loadPluginLibrary(path)
    _library = ctypes.CDLL(path)


load()


def _ask(function: str, *addresses: int) -> str:
    text = ctypes.create_string_buffer(1 << 16)
    assert _library is not None
    arguments = [
        ctypes.c_char_p(_mujoco.__version__.encode()),
        *(ctypes.c_void_p(address) for address in addresses),
    ]
    length = getattr(_library, function)(*arguments, text, ctypes.c_int(len(text)))
    if length < 0:
        raise InputError(text.value.decode())
    if length >= len(text):
        text = ctypes.create_string_buffer(length + 1)
        getattr(_library, function)(*arguments, text, ctypes.c_int(len(text)))
    return text.value.decode()


class Reading:
    """The values of a pad as attributes.

    Each is a numpy view of `data.sensordata` that changes with every step. SI units, forces in the
    pad's frame.

    The channels of the sensor, such as `force` [N,3] N and `displacement` [N,3] m of a PapillArray,
    and with truth: `unit_state` [N] (0 detached, 1 stick, 2 slip, 3 partial), `slip_velocity` [N,2]
    m/s, `slip_distance` [N] m, `margin` [N], `contact_force` [N,3] N, `state` and `state_micro` []
    (0 none, 1 non-slip, 2 incipient, 3 gross), `stuck_fraction` []. Like all of MuJoCo's sensordata
    they are from before the last step. `slip_velocity` and `contact_force` are in the contact
    plane, x and y along the touched surface, so that Coulomb's law holds for a tilted pad.

    Attributes:
        units: unit of each value, by name: "N", "m/s", "1"
        shapes: shape of each value, by name: (9, 3); () for a single number
    """

    def __init__(
        self, arrays: Mapping[str, npt.NDArray[np.float64]], units: Mapping[str, str]
    ) -> None:
        self._arrays = dict(arrays)
        self.units = dict(units)
        self.shapes = {name: array.shape for name, array in arrays.items()}

    def __getattr__(self, name: str) -> npt.NDArray[np.float64]:
        arrays: dict[str, npt.NDArray[np.float64]] = self.__dict__.get("_arrays", {})
        if name in arrays:
            return arrays[name]
        raise AttributeError(f"the pad has no {name!r}; allowed: {', '.join(arrays)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]


class _Measured:
    """A user class that computes its readings from the contact of a pad."""

    contact = ("force", "displacement", "depth", "shear")

    def __init__(self, made: Any) -> None:
        self._made = made
        _, elements, units, channels = _own.layout_of(made.layout())
        self.config = {
            "elements": json.dumps([row[:3] + row[6:] + row[3:6] for row in elements]),
            "element_truth": "read",
            "units": json.dumps([len(list(same)) for _, same in itertools.groupby(units)]),
        }
        self._units = {name: unit for name, unit, _ in channels}
        self._shapes = {name: tuple(shape) for name, _, shape in channels}

    def read(
        self, time: float, arrays: Mapping[str, npt.NDArray[np.float64]], units: Mapping[str, str]
    ) -> Reading:
        frame = _own.Frame(time, {name: arrays[name] for name in self.contact})
        readings = {
            name: values.astype(float)
            for name, values in zip(
                self._shapes, _own.readings_of(self._made.measure(frame), self._shapes), strict=True
            )
        }
        for name, values in readings.items():
            if not np.isfinite(values).all():
                raise InputError(f"measure() returned {name} that is not finite at {time:g} s")
        truth = [name for name in arrays if name not in self.contact]
        if both := self._shapes.keys() & set(truth):
            raise InputError(
                f"the channel {min(both)!r} has the name of an array of the truth; choose another name, or truth=False"
            )
        return Reading(
            readings | {name: arrays[name] for name in truth},
            self._units | {name: units[name] for name in truth},
        )


class Pad:
    """A pad of a model, by the name of its plugin instance.

    After `MjSpec.attach` it is found under the name with prefix or suffix.

    Attributes:
        name: name of the instance, without prefix or suffix
    """

    def __init__(self, name: str, sensor: _Measured | None = None) -> None:
        self.name = name
        self._sensor = sensor
        self._model: Any = None
        self._address = 0
        self._parts: list[tuple[str, str, tuple[int, ...]]] = []

    def read(self, data: Any) -> Reading:
        """Returns the pad's values.

        Args:
            data: an MjData

        Returns:
            The values, in SI units.

        Raises:
            InputError: the data's model has no such pad, or no sensor reads it
        """
        if self._model is not data.model:
            self._find(data.model)
        arrays, start = {}, self._address
        for name, _, shape in self._parts:
            size = math.prod(shape)
            arrays[name] = data.sensordata[start : start + size].reshape(shape)
            start += size
        units = {name: unit for name, unit, _ in self._parts}
        return (
            Reading(arrays, units)
            if self._sensor is None
            else self._sensor.read(float(data.time), arrays, units)
        )

    def _find(self, model: Any) -> None:
        described = _described(model)
        # MjSpec.attach adds a prefix or a suffix to the name.
        found = (
            [self.name]
            if self.name in described
            else [name for name in described if name.endswith(self.name)]
        )
        found = found or [name for name in described if name.startswith(self.name)]
        if len(found) != 1:
            raise InputError(
                f"the model has {'several pads' if found else 'no pad'} {self.name!r}; allowed: {', '.join(found or described)}"
            )
        instance, self._parts = described[found[0]]
        sensors = np.flatnonzero(model.sensor_plugin == instance)
        if not len(sensors):
            raise InputError(
                f"no sensor of the model reads the pad {found[0]!r}; add <sensor><plugin instance={found[0]!r}/></sensor>"
            )
        self._address = int(model.sensor_adr[sensors[0]])
        self._model = model

    def __repr__(self) -> str:
        return f"Pad({self.name!r})"


def _described(model: Any) -> dict[str, tuple[int, list[tuple[str, str, tuple[int, ...]]]]]:
    result: dict[str, tuple[int, list[tuple[str, str, tuple[int, ...]]]]] = {}
    truths: list[tuple[list[tuple[str, str, tuple[int, ...]]], int]] = []
    for line in _ask("slipbench_describe_pads", model._address).splitlines():
        words = line.split("\t")
        if words[0]:
            parts: list[tuple[str, str, tuple[int, ...]]] = []
            result[words[1]] = (int(words[0]), parts)
            if words[4] == "1":
                truths.append((parts, int(words[3])))
        else:
            parts.append((words[1], words[2], tuple(int(size) for size in words[3].split())))
    for parts, n in truths:
        parts += [
            ("unit_state", "1", (n,)),
            ("slip_velocity", "m/s", (n, 2)),
            ("slip_distance", "m", (n,)),
            ("margin", "1", (n,)),
            ("contact_force", "N", (n, 3)),
            ("state", "1", ()),
            ("state_micro", "1", ()),
            ("stuck_fraction", "1", ()),
        ]
    return result


def pads(model: Any) -> dict[str, Pad]:
    """All pads of a model.

    Args:
        model: an MjModel

    Returns:
        The pads by name.
    """
    return {name: Pad(name) for name in _described(model)}


def max_timestep(model: Any, data: Any = None) -> float:
    """The longest stable time step of explicit pads with all their elements in contact at once.

    It depends on the poses of the bodies.

    Args:
        model: an MjModel
        data: an MjData with the poses; None: the model's initial ones

    Returns:
        The longest `model.opt.timestep` [s]; infinite if no pad is explicit.
    """
    scratch = _mujoco.MjData(model)
    if data is not None:
        scratch.qpos[:] = data.qpos
        scratch.mocap_pos[:], scratch.mocap_quat[:] = data.mocap_pos, data.mocap_quat
    _mujoco.mj_fwdPosition(model, scratch)
    return float(_ask("slipbench_longest_step", model._address, scratch._address))


def attach_pad(
    spec: Any,
    site: Any,
    touch: Any,
    *,
    pad: str
    | Mapping[str, Any]
    | Callable[[_own.SensorSource], _own.OwnSensor]
    | npt.ArrayLike = "papillarray",
    name: str | None = None,
    friction: float | Mapping[str, float] | None = None,
    material: str | None = None,
    effects: Sequence[Any] = (),
    solver: str = "explicit",
    damping: float | None = None,
    truth: bool = True,
    seed: int = 0,
    trial: int = 0,
    check: str = "error",
    unloaded: str = "1",
) -> Pad:
    """Puts a pad on a site of an MjSpec, with a sensor that reads it.

    Also adds everything that the model needs for it (`complete()`).

    Args:
        spec: before or after it is attached to another; in the latter case call `complete()` on the
            other one too
        site: its name, or the MjsSite. +Z points from the touched object into the pad; the origin
            is at the undeformed tips
        touch: touched objects, one or a list: names of geoms, "body:NAME", "subtree:NAME",
            "group:N", MjsGeom or MjsBody objects. For a body, its geoms that can collide, or all if
            none can
        pad: the name of a sensor (`slipbench.list_names("sensors")`), a mapping with its parameters
            ({"type": "papillarray", "bristles": 6}), or elements [N,5] x, y, z [m], k_n, k_t [N/m],
            with three more columns for axes other than -Z. Or a class as for `slipbench.sensor()`:
            each `read()` of the returned pad is then a sample, which the class computes from the
            true contact; pads found by name return the contact
        name: name of the pad; None: that of the site
        friction: coefficient, or {"static": ..., "kinetic": ...}. Not with `material`
        material: name of a material. Not with `friction`
        effects: as in a scene's list of a sensor's effects
        solver: "explicit", or "implicit", which sets integrator, iterations and cone and adds
            tendons
        damping: time constant of a dashpot parallel to each spring [s]; None: 1 ms
        truth: True if the sensor also reads the truth
        seed: key of the effects' draws
        trial: key of the effects' draws
        check: "error", or "warn" to turn mistakes into warnings
        unloaded: margin without contact, "1" or "nan"

    Returns:
        The pad, which reads the data of every model compiled from the spec.

    Raises:
        InputError: objects that the spec lacks, or features that this MuJoCo lacks. Other mistakes
            are errors of `spec.compile()`.
    """
    site_name = site if isinstance(site, str) else _name(site, "site")
    if isinstance(site, str) and spec.site(site) is None:
        raise InputError(
            f"no site {site!r} in the spec; allowed: {', '.join(s.name for s in spec.sites if s.name)}"
        )
    if solver == "implicit":
        _need_discrete()
    own = name or site_name
    _check_free(spec, own)
    if check not in ("error", "warn"):
        raise InputError(f"check={check!r}; allowed: 'error', 'warn'")
    measured = _Measured(pad(_own.SensorSource(own, seed, trial))) if callable(pad) else None
    config = {
        "pad": site_name,
        "touch": " ".join(
            _touch_word(item) for item in (touch if isinstance(touch, (list, tuple)) else [touch])
        ),
        "name": own,
        "solver": solver,
        "truth": "true" if truth else "false",
        "seed": str(seed),
        "trial": str(trial),
        "check": check,
        "unloaded": unloaded,
        **(_pad_config(pad) if measured is None else measured.config),
        **_contact_config(friction, material, effects, damping),
    }
    _add_instance(spec, own, config)
    complete(spec)
    return Pad(own, measured)


def _check_free(spec: Any, name: str) -> None:
    """Raises InputError if the spec has a plugin or a sensor of this name."""
    for kind, objects in (("plugin", spec.plugins), ("sensor", spec.sensors)):
        if any(one.name == name for one in objects):
            raise InputError(f"the spec already has a {kind} {name!r}; choose another name=")


def _pad_config(pad: Any) -> dict[str, str]:
    """The plugin's attribute for the name of a sensor, its parameters, or an array of elements."""
    if isinstance(pad, str):
        return {"sensor": json.dumps({"type": pad})}
    if isinstance(pad, Mapping):
        return {"sensor": json.dumps(plain(pad, "pad"))}
    return {"elements": json.dumps(np.asarray(pad, float).tolist())}


def _contact_config(
    friction: float | Mapping[str, float] | None,
    material: str | None,
    effects: Sequence[Any],
    damping: float | None,
) -> dict[str, str]:
    """The plugin's attributes of the contact; those not given are left out."""
    config = {}
    if friction is not None:
        coefficients = friction if isinstance(friction, Mapping) else {"static": friction}
        config["friction"] = json.dumps(plain(coefficients, "friction"))
    if material is not None:
        config["material"] = material
    if damping is not None:
        config["damping"] = repr(float(damping))
    if effects:
        config["effects"] = json.dumps(plain(list(effects), "effects"))
    return config


def _add_instance(spec: Any, name: str, config: dict[str, str]) -> None:
    """Adds an instance of the plugin and a sensor that reads it."""
    if not any(plugin.plugin_name == _PLUGIN for plugin in spec.plugins):
        spec.activate_plugin(_PLUGIN)
    instance = spec.add_plugin(name=name, plugin_name=_PLUGIN, active=True)
    instance.config = config
    sensor = spec.add_sensor(name=name, type=_mujoco.mjtSensor.mjSENS_PLUGIN)
    sensor.plugin.plugin_name, sensor.plugin.name, sensor.plugin.active = _PLUGIN, name, True


def complete(spec: Any) -> None:
    """Adds to a spec the elements that its pads need.

    These are excludes between bodies that move with a pad and those that it touches, and for
    implicit pads options and tendons. `attach_pad()` calls it; call it again on a spec to which a
    spec with pads was attached. Names that the spec lacks are reported by `spec.compile()`.

    Args:
        spec: an MjSpec
    """
    known = {frozenset((exclude.bodyname1, exclude.bodyname2)) for exclude in spec.excludes}
    joined = {tendon.name for tendon in spec.tendons}
    for plugin in list(spec.plugins):
        if plugin.plugin_name != _PLUGIN or not plugin.name:
            continue
        config = dict(plugin.config)
        site = _lookup(plugin.name, config, config.get("pad", ""), spec.site)
        if site is None:
            continue
        for body in _touched_bodies(spec, plugin.name, config, site):
            for carrier in _moving_with(spec, site.parent):
                pair = frozenset((_name(carrier, "body"), _name(body, "body")))
                # An exclude with the world would let bodies fall through its other geoms, such as
                # the floor. The plugin then rejects contact that is possible.
                if len(pair) == 2 and pair not in known and "world" not in pair:
                    spec.add_exclude(bodyname1=carrier.name, bodyname2=body.name)
                    known.add(pair)
            if config.get("solver") == "implicit":
                _join(spec, site, body, joined)
        if config.get("solver") == "implicit":
            option = spec.option
            option.integrator = _need_discrete()
            option.noslip_iterations = 0
            option.iterations = max(option.iterations, 20)
            option.impratio = max(option.impratio, 1e4)
            option.cone = _mujoco.mjtCone.mjCONE_ELLIPTIC
            if option.solver == _mujoco.mjtSolver.mjSOL_PGS:
                option.solver = _mujoco.mjtSolver.mjSOL_NEWTON


def _need_discrete() -> Any:
    # 3.13 has the integrator, but not the metric that the pads need.
    if tuple(map(int, _mujoco.__version__.split(".")[:2])) < (3, 14):
        raise InputError(
            f"solver='implicit' needs the integrator discrete, with which pads do not work in MuJoCo {_mujoco.__version__}; use "
            "MuJoCo 3.14 or later, or solver='explicit'"
        )
    return _mujoco.mjtIntegrator.mjINT_DISCRETE


def _name(thing: Any, noun: str) -> str:
    """Returns the object's name.

    Names it if necessary, since plugins, excludes and tendons refer to names.
    """
    if not thing.name:
        thing.name = f"slipbench_{noun}_{next(_numbers)}"
    return str(thing.name)


def _touch_word(item: Any) -> str:
    if isinstance(item, str):
        return item
    if hasattr(item, "geoms"):
        return f"body:{_name(item, 'body')}"
    return _name(item, "geom")


def _lookup(instance: str, config: Mapping[str, str], name: str, find: Any) -> Any:
    """Looks up a name as the plugin will: first with the prefix and suffix of its instance."""
    declared = config.get("name", "")
    if declared:
        for at in range(len(instance)):
            if instance.startswith(declared, at):
                thing = find(instance[:at] + name + instance[at + len(declared) :])
                if thing is not None:
                    return thing
        return find(name)
    things = (find(instance[:size] + name) for size in (0, *range(len(instance), 0, -1)))
    return next((thing for thing in things if thing is not None), None)


def _touched_bodies(spec: Any, instance: str, config: Mapping[str, str], site: Any) -> list[Any]:
    bodies: list[Any] = []
    for word in config.get("touch", "").split():
        geom = _lookup(instance, config, word, spec.geom)
        kind, _, rest = word.partition(":")
        if geom is not None:
            bodies.append(geom.parent)
        elif kind in ("body", "subtree"):
            body = _lookup(instance, config, rest, spec.body)
            if body is not None:
                bodies += (
                    [body]
                    if kind == "body"
                    else [b for b in spec.bodies if body.name in _names_above(b)]
                )
        elif kind == "group":
            carriers = {_name(body, "body") for body in _moving_with(spec, site.parent)}
            bodies += [
                geom.parent
                for geom in spec.geoms
                if str(geom.group) == rest and _name(geom.parent, "body") not in carriers
            ]
    by_name = {_name(body, "body"): body for body in bodies if len(body.geoms)}
    return list(by_name.values())


def _names_above(body: Any) -> list[str]:
    names = [body.name]
    while body.parent is not None and body.name != "world":
        body = body.parent
        names.append(body.name)
    return names


def _moving_with(spec: Any, body: Any) -> list[Any]:
    """The bodies that move with a body; for a body fixed to the world only itself."""

    def top(b: Any) -> Any:
        while b.name != "world" and not len(b.joints) and not b.mocap:
            b = b.parent
        return b

    carrier = _name(top(body), "body")
    return (
        [body]
        if carrier == "world"
        else [b for b in spec.bodies if b.name != "world" and top(b).name == carrier]
    )


def _join(spec: Any, site: Any, body: Any, joined: set[str]) -> None:
    """Adds one tendon for each object and kinematic tree with pads.

    Each costs MuJoCo more than a pad.
    """
    first, above = site.parent, site.parent
    while above.name != "world":
        first = above if len(above.joints) else first
        above = above.parent
    name = f"slipbench_{_name(first, 'body')}_{body.name}"
    if name in joined:
        return
    body.add_site(name=name, rgba=[0, 0, 0, 0])
    tendon = spec.add_tendon(name=name, rgba=[0, 0, 0, 0])
    tendon.damping = (
        1e-9 if np.ndim(tendon.damping) == 0 else [1e-9, *([0.0] * (len(tendon.damping) - 1))]
    )
    tendon.wrap_site(_name(site, "site"))
    tendon.wrap_site(name)
    joined.add(name)
