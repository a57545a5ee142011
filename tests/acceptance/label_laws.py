"""The laws of contact, checked in the arrays of a recorded trial, without the program's own checks.

`faults(trial, scene, applied)` returns sentences, and counts in `applied` how many samples each law was applied to. Signs: `force` acts on the unit, `slip_velocity` is that of the unit's tip over the surface.
"""

from collections import Counter

import numpy as np

ROUNDING = 2.0**-24  # of a float32, relative
SMALLEST = 2.0**-149  # of a float32, absolute
# m, the shortest slip that the field distinguishes from rest: friction may exceed its limit by this much of the spring.
SHORTEST_SLIP = 1e-13
DETACHED, STICK, SLIP, PARTIAL = range(4)
TOUCH, WHOLE, STUCK, DETACH, MICRO, PART_STICKS = range(6)
AFTER = {
    TOUCH: STICK,
    WHOLE: SLIP,
    STUCK: STICK,
    DETACH: DETACHED,
    MICRO: PARTIAL,
    PART_STICKS: PARTIAL,
}
BEFORE = {
    TOUCH: {DETACHED},
    MICRO: {STICK},
    WHOLE: {PARTIAL},
    STUCK: {SLIP, PARTIAL},
    PART_STICKS: {SLIP},
    DETACH: {STICK, SLIP, PARTIAL},
}
# Effects by what their descriptions say that they change. An effect in none of these sets may change
# everything: only the laws that no effect changes are checked with it.
STATIC = {"ageing", "anisotropic_friction", "load_dependent_friction", "patchy_friction"}
KINETIC = {
    "anisotropic_friction",
    "load_dependent_friction",
    "patchy_friction",
    "stribeck",
    "viscous_friction",
}
TIPS_WITH_MASS = {"inertia", "asperities"}
SPRINGS = {"viscoelastic", "elastic_skin", "inertia", "asperities"}
HEIGHT = {"texture", "roughness"}
KNOWN = STATIC | KINETIC | TIPS_WITH_MASS | SPRINGS | HEIGHT


class Pad:
    """One sensor's labels, with the properties of its scene."""

    def __init__(self, trial, name, scene):
        group = trial[f"labels/{name}"]
        self.name, self.trial = name, trial
        self.applied = Counter()
        self.t, self.state = group["t"][:], group["unit_state"][:]
        self.velocity = group["slip_velocity"][:].astype(float)
        self.distance = group["slip_distance"][:].astype(float)
        self.margin = group["margin"][:].astype(float)
        self.force = group["force"][:].astype(float)
        self.stuck_fraction = group["stuck_fraction"][:]
        self.events = [group[f"events/{column}"][:] for column in ("t", "unit", "kind")]
        self.attributes = {
            key: group.attrs[key]
            for key in (
                "k_normal",
                "k_tangential",
                "mu_static",
                "mu_kinetic",
                "unit_positions",
                "unit_heights",
            )
        }
        self.f_t, self.f_n = np.hypot(self.force[..., 0], self.force[..., 1]), self.force[..., 2]
        effects = {
            name
            for one in scene.get("effects", [])
            for name in ([one] if isinstance(one, str) else one)
        }
        is_unknown = not effects <= KNOWN
        sensor = scene["sensors"][name]
        self.dynamic = bool({"bodies", "model", "box", "grip"} & scene.keys())
        self.exact = scene.get("fidelity", "field") == "field"
        self.creeps = scene.get("fidelity") == "mujoco_contact"
        self.single = (
            sensor["type"] not in ("piezo_skin", "biotac_sp", "biotac_19")
            and sensor.get("bristles", 1) == 1
            and sensor.get("points", 1) == 1
        )
        self.flat = not self.dynamic and scene.get("surface", {}).get("shape", "plane") == "plane"
        self.static = not (is_unknown or effects & STATIC)
        self.kinetic = not (is_unknown or effects & KINETIC)
        self.strengthens = is_unknown or "viscous_friction" in effects
        self.massless = not (is_unknown or effects & TIPS_WITH_MASS)
        # In a unit of several elements, detached ones ring beside those that stick.
        self.rings = is_unknown or "asperities" in effects or not (self.massless or self.single)
        self.springs = not (is_unknown or effects & SPRINGS)
        self.level = not (is_unknown or effects & HEIGHT)
        self.step = scene.get("time_step")
        self.slips = (self.state == SLIP) | (self.state == PARTIAL)

    def count(self, law, samples):
        self.applied[law] += int(np.count_nonzero(samples))

    def where(self, mask):
        row, unit = np.argwhere(mask)[0][:2]
        return f"{self.name}: {np.count_nonzero(mask)} samples, the first at {self.t[row]:.6g} s, unit {unit}"

    # N, error of f_t and of mu f_n in the file.
    def slack(self, mu):
        rounded = 2.0 * ROUNDING * (self.f_t + mu * np.abs(self.f_n)) + 2.0 * SMALLEST * (1.0 + mu)
        if self.strengthens:  # a creeping tip counts as sticking up to 1e-6 beyond mu_s f_n
            rounded = rounded + 1e-6 * mu * np.abs(self.f_n)
        return (
            rounded
            + 1e-14 * (self.f_t + np.abs(self.f_n))
            + SHORTEST_SLIP * self.attributes["k_tangential"]
        )


# Parts of the laws, each counted in samples of units, except events and, for the stuck fraction, samples of the pad.
LAWS = (
    "finite",
    "events",
    "rest: velocity",
    "rest: path",
    "rest: stuck fraction",
    "cone: detached",
    "cone: pulled",
    "cone: stick",
    "cone: slip",
    "cone: margin",
    "dissipation",
    "springs: normal",
    "springs: tangential",
)


def faults(trial, scene, applied=None):
    """Returns the faults of a trial. Adds the numbers of samples that each of LAWS was applied to to the Counter `applied`."""
    found = []
    for name in scene["sensors"]:
        pad = Pad(trial, name, scene)
        if applied is not None:
            pad.applied = applied
        for law in (finite, events, rest, cone, dissipation, springs):
            found += [f"{law.__name__}: {fault}" for fault in law(pad)]
    for name, group in trial["truth"].items():
        if not (np.isfinite(group["pose"][:]).all() and np.isfinite(group["velocity"][:]).all()):
            found.append(f"finite: {name}: pose or velocity")
    return found


def finite(pad):
    pad.count("finite", np.ones_like(pad.state))
    for name in ("velocity", "distance", "force"):
        if not np.isfinite(getattr(pad, name)).all():
            yield f"{pad.name}: {name}"
    wrong = np.isfinite(pad.margin) != (pad.state != DETACHED)
    if wrong.any():
        yield f"margin: {pad.where(wrong)}"
    for name, channel in pad.trial[f"sensors/{pad.name}"].items():
        if not np.isfinite(channel[:]).all():
            yield f"{pad.name}: channel {name}"


def events(pad):
    """In order, each possible after the one before, and the states are those after the events."""
    time, unit, kind = pad.events
    pad.count("events", np.ones_like(time))
    if (np.diff(time) < 0.0).any():
        e = int(np.argmax(np.diff(time) < 0.0))
        yield f"{pad.name}: {time[e + 1]!r} s after {time[e]!r} s"
        return
    for u in range(pad.state.shape[1]):
        own = unit == u
        now, states = DETACHED, [DETACHED]
        for e in np.flatnonzero(own):
            if now not in BEFORE[kind[e]]:
                yield f"{pad.name}: unit {u}: kind {kind[e]} in state {now} at {time[e]!r} s"
            now = AFTER[kind[e]]
            states.append(now)
        # An event at the instant of a sample counts before or after it.
        first, last = (
            np.searchsorted(time[own], pad.t + shift, side)
            for shift, side in ((-1e-9, "right"), (1e-9, "right"))
        )
        states = np.array(states)
        fits = np.zeros(len(pad.t), bool)
        for extra in range(int((last - first).max(initial=0)) + 1):
            fits |= pad.state[:, u] == states[np.minimum(first + extra, last)]
        if not fits.all():
            row = int(np.argmin(fits))
            yield f"{pad.name}: unit {u}: state {pad.state[row, u]} at {pad.t[row]!r} s contradicts its events"


def rest(pad):
    """A unit of which nothing slips has no slip velocity, and its slipped path is constant."""
    pad.count("rest: velocity", ~pad.slips)
    moves = ~pad.slips & (pad.velocity != 0.0).any(-1)
    if moves.any():
        yield f"slip velocity without slip: {pad.where(moves)}"
    falls = np.diff(pad.distance, axis=0, prepend=0.0) < 0.0
    if falls.any():
        yield f"slipped path falls: {pad.where(falls)}"
    quiet = ~pad.slips
    quiet[1:] &= ~pad.slips[:-1]
    for time, unit, _ in zip(*pad.events, strict=True):
        rows = slice(*np.searchsorted(pad.t, (time - 1e-9, time + 1e-9)))
        quiet[rows, unit] = False
        quiet[min(rows.stop, len(pad.t) - 1), unit] = False
    if not pad.creeps:
        pad.count("rest: path", quiet)
    grows = quiet & (np.diff(pad.distance, axis=0, prepend=0.0) > 0.0)
    if grows.any() and not pad.creeps:
        yield f"slipped path grows at rest: {pad.where(grows)}"
    touching, slipping = (pad.state != DETACHED).sum(1), pad.slips.sum(1)
    share = pad.stuck_fraction
    pad.count("rest: stuck fraction", touching > 0)
    wrong = np.isnan(share) != (touching == 0)
    wrong |= (touching > 0) & (slipping == 0) & (share != 1.0)
    if pad.single:  # of single friction points the share is that of the units
        wrong |= (touching > 0) & (
            np.abs(share - (1.0 - slipping / np.maximum(touching, 1))) > 1e-6
        )
    if wrong.any():
        yield f"stuck fraction: {pad.name}: {np.count_nonzero(wrong)} samples, the first at {pad.t[np.argmax(wrong)]:.6g} s"


def cone(pad):
    """|f_t| <= mu_s f_n, with equality to mu_k f_n in slip; where effects change mu, margin >= 0."""
    off = pad.state == DETACHED
    rotated = 1e-14 * np.hypot(pad.f_t, pad.f_n)  # N, error of the rotation into the contact plane
    lifted = off & (
        (np.abs(pad.f_n) > (0.0 if pad.massless else rotated)) | (pad.massless & (pad.f_t != 0.0))
    )
    pad.count("cone: detached", off)
    if lifted.any():
        yield f"force without contact: {pad.where(lifted)}"
    if not pad.exact:
        return
    with np.errstate(invalid="ignore", over="ignore"):
        if pad.single or pad.flat:
            pad.count("cone: pulled", ~off)
            pulled = pad.f_n < -rotated
            if pulled.any():
                yield f"pulled: {pad.where(pulled)}"
            yield from cone_in_one_plane(pad)
        yield from margin(pad)


def cone_in_one_plane(pad):
    """Stick within mu_s f_n and slip at mu_k f_n, of units with one contact plane."""
    mu_s, mu_k = pad.attributes["mu_static"], pad.attributes["mu_kinetic"]
    stick, partial, slip = (pad.state == state for state in (STICK, PARTIAL, SLIP))
    bounded = (stick & (not pad.rings)) | (partial & pad.massless & (not pad.strengthens))
    if pad.static:
        pad.count("cone: stick", bounded)
        beyond = bounded & (pad.f_t > mu_s * pad.f_n + pad.slack(mu_s))
        if beyond.any():
            yield f"sticks beyond mu_s f_n: {pad.where(beyond)}"
    if pad.kinetic and pad.massless:
        pad.count("cone: slip", slip)
        off_cone = slip & (pad.f_t > mu_k * pad.f_n + pad.slack(mu_k))
        if pad.single:
            off_cone |= slip & (pad.f_t < mu_k * pad.f_n - pad.slack(mu_k))
        if off_cone.any():
            yield f"slips off mu_k f_n: {pad.where(off_cone)}"


def margin(pad):
    """Margin >= 0, but for rounding."""
    mu_s, one_plane = pad.attributes["mu_static"], pad.single or pad.flat
    stick, partial, slip = (pad.state == state for state in (STICK, PARTIAL, SLIP))
    # Friction beyond its limit is -margin times the limit, which is f_t/(1 - margin).
    limited = stick | ((slip | partial) & (not pad.strengthens))
    limit = np.where(pad.static & one_plane, mu_s * pad.f_n, pad.f_t / (1.0 - pad.margin))
    pad.count("cone: margin", limited)
    over = (
        limited
        & (pad.margin < 0.0)
        & (-pad.margin * limit > pad.slack(mu_s if pad.static else 0.0 * mu_s))
    )
    if not one_plane or not (pad.static or pad.massless):
        over &= pad.margin < -1e-3
    if over.any():
        yield f"margin below 0: {pad.where(over)}"


def dissipation(pad):
    """Friction takes energy: force on the unit times its slip velocity is not positive."""
    if not (pad.exact and pad.single and pad.massless):
        return
    power = (pad.force[..., :2] * pad.velocity).sum(-1)
    speed = np.hypot(*np.moveaxis(pad.velocity, -1, 0))
    pad.count("dissipation", speed > 0.0)
    gains = (
        power > (8.0 * ROUNDING * pad.f_t + 1e-13 * np.abs(pad.f_n) + SMALLEST) * speed + SMALLEST
    )
    if gains.any():
        yield f"friction does work on the tip: {pad.where(gains)}"


def springs(pad):
    """Every spring's force follows the pad: k (motion of the root - slip), and f_n = k_n depth.

    With f_1 at the end of a step, motion d and slip s, the pad's work f_1 d is then the slip's loss f_1 s, plus the change of the
    spring's energy (f_1^2 - f_0^2)/2k, plus (f_1 - f_0)^2/2k: no energy is created.
    """
    if (
        not (pad.exact and pad.single and pad.flat and pad.springs)
        or "pad" not in pad.trial["truth"]
    ):
        return
    body = pad.trial["truth/pad"]
    pose = body["pose"][:].astype(float)
    level = (np.abs(pose[:, 4:6]) < 1e-12).all()  # turns about the vertical alone
    if not level or len(pose) != len(pad.t) or (body["t"][:] != pad.t).any():
        return
    place, height = pad.attributes["unit_positions"], pad.attributes["unit_heights"]
    k_n, k_t = pad.attributes["k_normal"], pad.attributes["k_tangential"]
    depth = -(pose[:, 2:3] + height)
    # Poses are float32.
    inexact = (
        4.0
        * ROUNDING
        * (
            np.abs(pose[:, :3]).max()
            + np.abs(place).max(initial=0.0)
            + np.abs(height).max(initial=0.0)
        )
        + SMALLEST
    )
    if pad.level:
        pad.count("springs: normal", depth > 0.0)
        wrong = (
            np.abs(pad.f_n - k_n * np.maximum(depth, 0.0))
            > k_n * inexact + 2.0 * ROUNDING * pad.f_n + SMALLEST
        )
        if wrong.any():
            yield f"f_n is not k_n times the depth: {pad.where(wrong)}"
    if (
        len(pad.t) < 2
        or not isinstance(pad.step, float)
        or abs(pad.step * (len(pad.t) - 1) / (pad.t[-1] - pad.t[0]) - 1.0) > 1e-6
    ):
        return  # samples are not steps
    angle = 2.0 * np.arctan2(pose[:, 6], pose[:, 3])
    turn = np.stack(
        [
            np.stack([np.cos(angle), -np.sin(angle)], -1),
            np.stack([np.sin(angle), np.cos(angle)], -1),
        ],
        -2,
    )

    def world(vectors):
        return np.einsum("tij,tuj->tui", turn, vectors)

    root = pose[:, None, :2] + np.einsum("tij,uj->tui", turn, place)
    stretch = -world(pad.force[..., :2]) / k_t[:, None]
    slip = world(pad.velocity) * pad.step
    stays = (pad.state[1:] != DETACHED) & (pad.state[:-1] != DETACHED)
    for time, unit, kind in zip(*pad.events, strict=True):
        if kind in (TOUCH, DETACH):
            row = int(np.searchsorted(pad.t, time - 1e-9))
            stays[max(row - 2, 0) : row + 1, unit] = False
    error = np.hypot(
        *np.moveaxis(np.diff(root, axis=0) - np.diff(stretch, axis=0) - slip[1:], -1, 0)
    )
    allowed = 8.0 * inexact + 4.0 * ROUNDING * (
        np.abs(stretch[1:]).sum(-1) + np.abs(slip[1:]).sum(-1)
    )
    pad.count("springs: tangential", stays)
    broken = stays & (error > allowed)
    if broken.any():
        row, unit = np.argwhere(broken)[0]
        yield (f"force does not follow the motion by k_t: {pad.where(np.vstack([broken[:1] & False, broken]))}, by {error[row, unit]:.3g} m of "
               f"allowed {allowed[row, unit]:.3g} m")  # fmt: skip
