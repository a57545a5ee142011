"""Writes the recordings of slip-3's open scenes: travels that end before or after the first slip.

    python3 scenes/benchmark/slip-3/travels.py           # rewrites the lists of recordings in open_*.yaml and outside_*.yaml
    python3 scenes/benchmark/slip-3/travels.py --check   # exit status 1 if a list is not what this program writes

Recordings come in pairs with one motion and one load. In the first of a pair no element slips by the law of sim/contact; in the
second, with less friction, some do. So neither the motion nor the load tells whether the pad slips. All lengths are in mm,
angles in rad.

    element i slips at the travel      u_i = mu k_n delta_i/k_t                         (flat surface)
    margin of a motion                 least mu k_n delta_i(s)/(k_t u_i(s)) over elements and path; below 1 an element slips
"""

import argparse
import math
import random
import sys
from dataclasses import dataclass, field
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
PAIRS = 120
STEPS = 6  # along a motion
GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))
AIR = 24  # recordings of the piezoelectric skin in which motors run in the air
ROUNDING = (
    0.005  # of a depth, from the digits in the scene: below it, contact of an element is undecided
)
MOST_DRAWS = 20000
SLIP_SHARE = 0.4  # least mean slip of a recording that slips, as a share of its travel
LEAST_SLIP = 0.13  # mean slip of a recording that slips: above least_slip_distance of tools/benchmark/protocol.h


@dataclass
class Element:
    x: float
    y: float
    z: float  # undeformed tip in the pad's frame, +Z out of the surface
    weight: float  # share of the normal stiffness over that of the tangential stiffness
    unit: int


@dataclass
class Contact:
    """The load of a pad, which determines when the pad slips. `scene`: the part of a recording that sets it."""

    elements: list
    ratio: float  # k_n/k_t
    compression: float
    tilt: tuple = (0.0, 0.0)
    radius: float = math.inf  # of the touched ball
    unsure: float = 0.0  # possible decrease of an element's depth by ridges or roughness
    scene: dict = field(default_factory=dict)


@dataclass
class Motion:
    travel: float  # of the outermost element
    speed: float
    acceleration: float
    direction: float
    start: float
    turn: float = 0.0  # angle; 0: a slide
    pivot: tuple = (0.0, 0.0)


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def normal(rng, sd, most):
    while True:
        value = rng.gauss(0.0, sd)
        if abs(value) <= most:
            return value


def tilted(point, tilt):
    """Ry Rx, as sim/core/math/rotation.h."""
    (x, y, z), (a, b) = point, tilt
    y, z = math.cos(a) * y - math.sin(a) * z, math.sin(a) * y + math.cos(a) * z
    return math.cos(b) * x + math.sin(b) * z, y, math.cos(b) * z - math.sin(b) * x


def tip_at(motion, share, point):
    """Position of the tip after the share `share` of the motion: p + R (q - p) for a turn, as sim/motion/stage.cc."""
    x, y, z = point
    if motion.turn:
        px, py = motion.pivot
        angle = motion.turn * share
        c, s = math.cos(angle), math.sin(angle)
        # the pad's origin moves along with the arm of the pivot
        return px + c * (x - px) - s * (y - py), py + s * (x - px) + c * (y - py), z
    way = motion.travel * share
    return x + way * math.cos(motion.direction), y + way * math.sin(motion.direction), z


def depth(contact, point):
    x, y, z = point
    if math.isinf(contact.radius):
        return -z
    return contact.radius - math.sqrt(x * x + y * y + (z + contact.radius) ** 2)


def judged(contact, friction, motion, wanted):
    """Returns the margin of a motion and the mean slip of the touching units at its end. Returns a margin of 0 as soon as an
    element has slipped in a motion that is `wanted` not to slip."""
    flat = math.isinf(contact.radius)
    slips = {}
    margin = math.inf
    # If one of a third of many elements slips, the pad slips; only if none of all elements slips, the pad sticks.
    for e in contact.elements[:: 3 if wanted == "slip" and len(contact.elements) > 100 else 1]:
        x, y, z = tilted((e.x, e.y, e.z), contact.tilt)
        point = (x, y, z - contact.compression)
        touches = depth(contact, point) > 0.0
        if wanted == "stick" and abs(depth(contact, point)) < ROUNDING:
            return 0.0, 0.0
        if flat and not touches:
            continue
        slip = 0.0
        for step in (
            (STEPS,) if flat else range(1, STEPS + 1)
        ):  # on a flat surface depth does not change
            now = tip_at(motion, step / STEPS, point)
            deep = depth(contact, now)
            if not touches:
                if deep > 0.0:  # an element that touches while the pad moves slips at once
                    margin = 0.0
                continue
            stretch = math.hypot(now[0] - point[0], now[1] - point[1])
            if stretch > 0.0:
                strength = friction * contact.ratio * e.weight
                margin = min(margin, strength * max(deep - contact.unsure, 0.0) / stretch)
                slip = max(slip, stretch - strength * max(deep, 0.0))
            if wanted == "stick" and margin < 1.0:
                return 0.0, 0.0
        if touches:
            slips.setdefault(e.unit, []).append(slip)
    if not slips:
        return 0.0, 0.0
    return margin, sum(sum(s) / len(s) for s in slips.values()) / len(slips)


def grid(columns, rows, pitch, points=1, width=0.0):
    elements = []
    for unit in range(rows * columns):
        x, y = (
            (unit % columns - 0.5 * (columns - 1)) * pitch,
            (0.5 * (rows - 1) - unit // columns) * pitch,
        )
        for i in range(points * points):
            beside, along = (
                (k - 0.5 * (points - 1)) * width / points for k in (i % points, i // points)
            )
            elements.append(Element(x + beside, y + along, 0.0, 1.0, unit))
    return sorted(
        elements, key=lambda e: -math.hypot(e.x, e.y)
    )  # the elements that slip first on a ball come first


def papillarray(rng, outside):
    devices = (
        [
            {
                "k_normal": "0.5 N/mm",
                "k_tangential": "0.2 N/mm",
                "stiffness_sd": 0.14,
                "bristles": 2,
                "bristle_spread": 0.15,
            },
            {
                "k_normal": "0.5 N/mm",
                "k_tangential": "0.35 N/mm",
                "stiffness_sd": 0.2,
                "bristles": 24,
                "bristle_spread": 0.2,
                "edge_drop": "0.05 mm",
                "corner_drop": "0.12 mm",
            },
            {
                "k_normal": "16 N/mm",
                "k_tangential": "9 N/mm",
                "stiffness_sd": 0.15,
                "bristles": 24,
                "bristle_spread": 0.1,
            },
            {
                "k_normal": "14 N/mm",
                "k_tangential": "6 N/mm",
                "stiffness_sd": 0.18,
                "bristles": 2,
                "bristle_spread": 0.25,
                "edge_drop": "0.1 mm",
                "corner_drop": "0.2 mm",
            },
        ]
        if outside
        else [
            {"profile": "hexapod", "stiffness_sd": 0.02, "bristles": 6, "bristle_spread": 0.4},
            {
                "profile": "hexapod",
                "stiffness_sd": 0.06,
                "bristles": 12,
                "bristle_spread": 0.7,
                "edge_drop": "0.17 mm",
                "corner_drop": "0.32 mm",
            },
            {
                "profile": "hexapod",
                "stiffness_sd": 0.1,
                "bristles": 3,
                "bristle_spread": 0.3,
                "edge_drop": "0.21 mm",
                "corner_drop": "0.5 mm",
            },
            {
                "profile": "gripper",
                "stiffness_sd": 0.03,
                "bristles": 12,
                "bristle_spread": 0.35,
                "edge_drop": "0.19 mm",
                "corner_drop": "0.4 mm",
            },
            {
                "profile": "gripper",
                "stiffness_sd": 0.07,
                "bristles": 6,
                "bristle_spread": 0.75,
                "edge_drop": "0.16 mm",
                "corner_drop": "0.3 mm",
            },
            {"profile": "gripper", "stiffness_sd": 0.09, "bristles": 3, "bristle_spread": 0.5},
        ]
    )
    device = rng.choice(devices)
    stiffness = {"hexapod": (1.2, 0.65), "gripper": (7.1, 3.9)}
    number = lambda key, otherwise: float(str(device.get(key, otherwise)).split()[0])
    normal_stiffness, tangential = (
        stiffness[device["profile"]]
        if "profile" in device
        else (number("k_normal", 0), number("k_tangential", 0))
    )
    drops = (0.0, number("edge_drop", 0.2), number("corner_drop", 0.45))
    count, spread = device["bristles"], device["bristle_spread"]
    elements = []
    for pillar in range(9):
        column, row = divmod(pillar, 3)
        for bristle in range(count):
            weight = 2 - spread - 2 * (1 - spread) * bristle / (count - 1)
            elements.append(
                Element(
                    (1 - row) * 7.0,
                    (1 - column) * 7.0,
                    drops[abs(column - 1) + abs(row - 1)],
                    weight,
                    pillar,
                )
            )
    effect = rng.choice([[], [], ["viscous_friction"], ["stribeck"], ["ageing"], ["texture"]])
    return Contact(
        elements,
        normal_stiffness / tangential,
        log_uniform(rng, 0.2, 1.5),
        tuple(math.radians(normal(rng, 1.5, 6)) for _ in range(2)),
        unsure=0.04 if effect == ["texture"] else 0.0,
        scene={"effects": effect, "sensors": {"pad": device, "slow": device}},
    )


def piezo_skin(rng, outside):
    def between(beyond, within):
        return rng.choice(beyond) if outside else log_uniform(rng, *within)

    k_tangential = between((2.0, 14.0), (3.5, 9))
    curvature = 1 / between((25.0, 40.0), (60, 1500))
    count, radius = 20, 5.0
    elements = []
    for i in range(count):
        share = (i + 0.5) / count
        r, angle = radius * math.sqrt(share), GOLDEN_ANGLE * i
        elements.append(
            Element(
                r * math.cos(angle),
                r * math.sin(angle),
                0.5 * curvature * radius**2 * (share - 0.5),
                1.0,
                0,
            )
        )
    rough = between((0.0002, 0.007), (0.0006, 0.0045))
    return Contact(
        elements,
        20 / k_tangential,
        log_uniform(rng, 0.07, 0.65),
        unsure=3 * rough,
        scene={
            "effects": [
                {
                    "inertia": {
                        "frequency": f"{between((70, 90, 350, 450), (120, 280)):.3g} Hz",
                        "damping": float(f"{between((0.03, 0.3), (0.06, 0.18)):.3g}"),
                    }
                },
                {"roughness": {"height": f"{1000 * rough:.3g} um"}},
                {
                    "asperities": {
                        "amplitude": f"{between((0.2, 12), (0.6, 7)):.3g} mN",
                        "distance": f"{between((0.05, 0.9), (0.12, 0.55)):.3g} mm",
                    }
                },
            ],
            "sensors": {
                "pad": {
                    "k_tangential": f"{k_tangential:.3g} N/mm",
                    "tip_radius": f"{1 / curvature:.4g} mm",
                }
            },
        },
    )


def finger():
    count, radii = 300, (13.85, 10.1, 9.85)
    elements = []
    for k in range(count):
        height = (k + 0.5) / count - 1
        around, angle = math.sqrt(1 - height * height), GOLDEN_ANGLE * k
        x, y, z = (
            r * u
            for r, u in zip(radii, (around * math.cos(angle), height, around * math.sin(angle)))
        )
        if -y > 0.5:  # only the outer part of the skin can touch a plane
            elements.append(Element(x, -z, y + radii[1], 1.0, k))
    return elements


FINGER = finger()


def biotac_sp(rng, outside):
    shear = rng.choice((0.15, 1.5)) if outside else log_uniform(rng, 0.25, 1)
    return Contact(
        FINGER,
        1 / shear,
        rng.uniform(0.5, 1.8),
        (math.radians(rng.uniform(-25, 25)), math.radians(rng.uniform(-15, 20))),
        scene={"sensors": {"pad": {"shear": float(f"{shear:.3g}")}}},
    )


def ball(elements, compressions, radii, stiffness):
    """A sensor of separate springs on a ball. `stiffness`: k_n and k_t inside and outside of the training range, in N/mm."""

    def contact(rng, outside):
        radius = log_uniform(rng, *radii)
        if outside:
            k_normal, k_tangential = (rng.choice(values) for values in stiffness[1])
        else:
            k_normal, k_tangential = (log_uniform(rng, *values) for values in stiffness[0])
        return Contact(
            elements,
            k_normal / k_tangential,
            log_uniform(rng, *compressions),
            tuple(math.radians(normal(rng, 0.7, 2)) for _ in range(2)),
            radius,
            scene={
                "surface": {"radius": f"{radius:.4g} mm"},
                "sensors": {
                    "pad": {
                        "k_normal": f"{k_normal:.4g} N/mm",
                        "k_tangential": f"{k_tangential:.4g} N/mm",
                    }
                },
            },
        )

    return contact


@dataclass
class Stage:
    contact: object
    travels: tuple  # shortest and longest
    starts: tuple  # s, earliest and latest
    turns: int  # of ten pairs
    arm: float = 10.0  # distance from the pivot at which the travel of a turn is measured
    stick: tuple = (1.3, 2.2)  # margins of contacts that hold
    slip: tuple = (0.02, 0.75)  # margins of those that slip
    frictions: tuple = (
        (0.12, 1.4),
        (0.05, 0.065, 0.085, 1.7, 2.1, 2.6),
    )  # inside the training range: a range; outside: values
    redraws: bool = False  # the second contact of a pair is redrawn, except for its compression


SLOWEST = 0.5  # s, longest motion

STAGES = {
    "papillarray": Stage(papillarray, (0.25, 1.0), (0.7, 1.2), 3),
    "piezo_skin": Stage(
        piezo_skin,
        (0.2, 1.3),
        (0.75, 1.25),
        0,
        stick=(1.6, 3.2),
        slip=(0.02, 0.7),
        frictions=((0.17, 1.4), (0.07, 0.1, 0.13, 1.7, 2, 2.4)),
    ),
    "biotac_sp": Stage(
        biotac_sp, (0.28, 0.4), (0.7, 1.2), 3, arm=8.0, stick=(1.2, 2.2), redraws=True
    ),
    "magnetic_skin": Stage(
        ball(
            grid(4, 4, 4.7), (0.3, 1.2), (15, 200), (((1, 2), (0.35, 0.7)), ((0.5, 4), (0.2, 1.5)))
        ),
        (0.3, 1.2),
        (0.6, 1.1),
        3,
    ),
    "gel_markers": Stage(
        ball(
            grid(20, 16, 1.0),
            (0.2, 0.8),
            (15, 1000),
            (((0.08, 0.15), (0.025, 0.05)), ((0.04, 0.3), (0.012, 0.1))),
        ),
        (0.3, 0.7),
        (0.65, 1.15),
        3,
    ),
    "taxels": Stage(
        ball(
            grid(4, 4, 5.0, 3, 4.0),
            (0.3, 1.2),
            (15, 200),
            (((0.8, 1.8), (0.35, 0.75)), ((0.4, 4), (0.18, 1.6))),
        ),
        (0.3, 1.2),
        (0.6, 1.1),
        3,
    ),
}


def motion_of(stage, rng, pair, pairs):
    low, high = stage.travels
    travel = low * (high / low) ** ((pair + 0.5) / pairs)  # evenly over the logarithm
    while True:
        speed, acceleration = travel / log_uniform(rng, 0.01, SLOWEST), log_uniform(rng, 40, 2000)
        top = min(speed, math.sqrt(acceleration * travel))
        if travel / top + top / acceleration <= SLOWEST:
            break
    motion = Motion(
        travel, speed, acceleration, rng.uniform(0, 2 * math.pi), rng.uniform(*stage.starts)
    )
    if pair * 7 % 10 < stage.turns:
        motion.turn = rng.choice((-1, 1)) * travel / stage.arm
        distance, angle = rng.uniform(3, 7), rng.uniform(0, 2 * math.pi)
        motion.pivot = (distance * math.cos(angle), distance * math.sin(angle))
    return motion


def degrees(angle):
    return f"{math.degrees(angle):.4g} deg"


def motion_scene(motion, arm):
    start = {"start": f"{motion.start:.4g} s"}
    if not motion.turn:
        return start | {
            "direction": degrees(motion.direction),
            "speed": f"{motion.speed:.4g} mm/s",
            "acceleration": f"{motion.acceleration:.4g} mm/s2",
            "travel": f"{motion.travel:.4g} mm",
        }
    angle, rate, limit = abs(motion.turn), motion.speed / arm, motion.acceleration / arm
    seconds = (
        angle / rate if rate**2 < angle * limit else math.sqrt(angle / limit)
    )  # until it brakes
    return start | {
        "speed": "0 mm/s",
        "rotation": f"{math.copysign(math.degrees(rate), motion.turn):.4g} deg/s",
        "angular_acceleration": f"{math.degrees(limit):.4g} deg/s2",
        "stop": f"{1000 * seconds:.4g} ms",
        "pivot": [f"{place:.3g} mm" for place in motion.pivot],
    }


def friction_between(margin, wanted, stage, outside, rng):
    """Returns a friction at which a contact has one of the wanted margins, or None. `margin`: at friction 1, as margins are proportional to it."""
    low, high = getattr(stage, wanted)
    if outside:
        return rng.choice(
            [one for one in stage.frictions[1] if low <= one * margin <= high] or [None]
        )
    low, high = max(low / margin, stage.frictions[0][0]), min(high / margin, stage.frictions[0][1])
    return log_uniform(rng, low, high) if low < high else None


def slipping(contact, motion, stage, outside, rng):
    """Returns a friction with which a contact slips enough over a motion, or None."""
    margin, _ = judged(contact, 1.0, motion, "slip")
    for _ in range(3 if margin > 0.0 else 0):
        friction = friction_between(margin, "slip", stage, outside, rng)
        if friction and judged(contact, friction, motion, "slip")[1] >= max(
            LEAST_SLIP, SLIP_SHARE * motion.travel
        ):
            return friction
    return None


def pair_of(stage, motion, outside, rng):
    """Returns two contacts with their frictions, or None: the first holds over the motion, the second slips."""
    contact = stage.contact(rng, outside)
    most = max(stage.frictions[outside])
    margin = judged(contact, most, motion, "stick")[0] / most
    holds = friction_between(margin, "stick", stage, outside, rng) if margin > 0.0 else None
    if not holds:
        return None
    for _ in range(400 if stage.redraws else 1):
        other = contact
        if stage.redraws:
            other = stage.contact(rng, outside)
            other.compression = contact.compression
        slips = slipping(other, motion, stage, outside, rng)
        if slips:
            return (contact, holds), (other, slips)
    return None


def stage_recordings(sensor, outside, rng):
    stage = STAGES[sensor]
    pairs = PAIRS - AIR // 2 if sensor == "piezo_skin" else PAIRS
    recordings = []
    for pair in range(pairs):
        motion = motion_of(stage, rng, pair, pairs)
        found = next(
            filter(None, (pair_of(stage, motion, outside, rng) for _ in range(MOST_DRAWS))), None
        )
        if not found:
            raise SystemExit(
                f"travels.py: {sensor}: no contact both holds and slips over {motion.travel:.3g} mm"
            )
        for contact, friction in found:
            scene = {
                "friction": {"scale": float(f"{friction:.3g}")},
                "motion": {"compression": f"{contact.compression:.4g} mm"},
            }
            if contact.tilt != (0.0, 0.0):
                scene["motion"]["tilt"] = [degrees(angle) for angle in contact.tilt]
            scene["motion"] |= motion_scene(motion, stage.arm)
            recordings.append(scene | contact.scene)
    for _ in range(2 * (PAIRS - pairs)):
        motion = {
            "start": f"{rng.uniform(*stage.starts):.4g} s",
            "clearance": "5 mm",
            "speed": f"{log_uniform(rng, 10, 50):.3g} mm/s",
            "travel": "20 mm",
            "strokes": 10,
        }
        recordings.append(
            {
                "friction": {"scale": 1},
                "motion": {"compression": "0.1 mm", "acceleration": "500 mm/s2"} | motion,
            }
            | stage.contact(rng, outside).scene
        )
    return recordings


def nib_pad_recordings(outside, rng):
    """A lever pulls the plate by a force. Only the pad carries this force, so each nib has its share as under a rigid plate on equal springs."""
    nibs = [((i % 6 - 2.5) * 3.8, (2.5 - i // 6) * 3.8) for i in range(36)]
    k_normal, rig = 0.83, 15.0  # N/mm, sensors/nib_pad and lever.xml
    height_sd = 0.06 if outside else 0.03  # mm
    # patchy_friction at the weakest of 36 nibs, and of the few in the corners that a turn loads most: 2.3 and 1.5 deviations
    weakest = {
        arm: math.exp(-deviations * 0.3 - 0.3**2 / 2)
        for arm, deviations in ((0.0, 2.3), (31.75, 1.5))
    }
    square = sum(x * x + y * y for x, y in nibs)
    stiffness = 1 / (1 / rig + 1 / (36 * k_normal))
    recordings = []
    for pair in range(PAIRS):
        arm = (0.0, 31.75)[pair % 2]
        low, high = ((1.5, 2.3), (0.48, 0.66))[pair % 2]
        force, ramp = low * (high / low) ** ((pair + 0.5) / PAIRS), log_uniform(rng, 0.1, 0.7)
        start = rng.uniform(0.8, 1.1)
        for _ in range(MOST_DRAWS):
            holds, slips = (
                (rng.choice((1.4, 1.7, 2)), rng.choice((0.1, 0.14, 0.18)))
                if outside
                else (log_uniform(rng, 0.5, 1.3), log_uniform(rng, 0.2, 0.5))
            )
            compression = rng.uniform(0.4, 1.1)
            tilt = tuple(math.radians(normal(rng, 0.4, 1.2)) for _ in range(2))
            load = stiffness * compression
            depths = [
                load / (36 * k_normal) + x * math.sin(tilt[1]) - y * math.sin(tilt[0])
                for x, y in nibs
            ]
            share = [
                math.hypot(force * arm * y / square, force * (1 / 36 - arm * x / square))
                for x, y in nibs
            ]
            margin = min(
                holds * weakest[arm] * k_normal * (d - 2.4 * height_sd) / f
                for d, f in zip(depths, share)
            )
            # the least force at which the plate turns about a pole on X, or slides
            poles = (
                [
                    load * slips * sum(math.hypot(x - p, y) for x, y in nibs) / 36 / (p + arm)
                    for p in range(1, 30)
                ]
                if arm
                else [load * slips]
            )
            if 1.25 <= margin <= 3.5 and 0.1 <= min(poles) / force <= 0.93:
                break
        else:
            raise SystemExit(
                f"travels.py: nib_pad: no contact both holds and slips under {force:.3g} N"
            )
        for friction in (holds, slips):
            recordings.append(
                {
                    "friction": {"scale": float(f"{friction:.3g}")},
                    "motion": {
                        "offset": [f"{arm:g} mm", "0 mm"],
                        "compression": f"{compression:.4g} mm",
                        "tilt": [degrees(angle) for angle in tilt],
                    },
                    "controls": {
                        "pull": [
                            [f"{start:.4g} s", "0 N"],
                            [f"{start + ramp:.4g} s", f"{force:.4g} N"],
                        ]
                    },
                }
            )
    return recordings


def myrmex_recordings(outside, rng):
    """Two arms part by `apart` and hold a box whose weight both arrays carry: all cells share the load equally, and the weight as on equal springs."""
    boxes = [  # size y and z, position y and z in mm; mass in g
        (50, 100, 0, 10, 320),
        (45, 130, 0, 10, 170),
        (150, 42, 18, 0, 220),
        (130, 32, 14, 0, 140),
    ]
    cell, pitch, arm_stiffness = 0.1, 5.0, 5.0  # N/mm and mm, sensors/myrmex and two_arms.xml
    recordings = []
    for pair in range(PAIRS):
        width, height, beside, above, mass = boxes[pair % 4]
        apart = rng.uniform(4.2, 6.6)
        start = rng.uniform(0.8, 1.2)
        touching = [
            ((column - 7.5) * pitch, (row - 7.5) * pitch)
            for column in range(16)
            for row in range(16)
            if abs((column - 7.5) * pitch - beside) < width / 2
            and abs((row - 7.5) * pitch - above) < height / 2
        ]
        count, foam = len(touching), cell * len(touching)
        cx, cy = (sum(place[k] for place in touching) / count for k in (0, 1))
        stiffness, weight = 1 / (1 / arm_stiffness + 1 / foam), 0.5 * 9.81e-3 * mass
        square = sum((x - cx) ** 2 + (y - cy) ** 2 for x, y in touching)
        lever = beside - cx
        greatest = max(
            math.hypot(lever * (y - cy) / square, 1 / count + lever * (x - cx) / square)
            for x, y in touching
        )
        # Remaining squeeze at friction 1 at which the cell with the greatest share slips; the whole box slides, or turns, at less.
        needs, slides = weight * greatest * count / stiffness, (0.85, 0.85, 0.5, 0.5)[pair % 4]
        for _ in range(MOST_DRAWS):
            ramp = log_uniform(rng, 0.1, 0.6)
            # An arm that stops overshoots by about half of rate/omega, omega = sqrt((arm + foam)/2 kg).
            overshoot = 0.6 * apart / ramp / math.sqrt(1e3 * (arm_stiffness + foam) / 2)
            slips = rng.choice((0.22, 0.26, 0.3)) if outside else log_uniform(rng, 0.3, 0.6)
            left = slides * rng.uniform(0.5, 1) * needs / slips
            if left <= overshoot:
                continue
            least = needs / (left - overshoot)  # friction that holds
            holds = rng.choice((1.4, 1.7, 2)) if outside else least * rng.uniform(1.25, 2.2)
            if holds >= 1.25 * least and (outside or holds <= 1.3) and 4.5 <= apart + left <= 8.5:
                break
        else:
            raise SystemExit(
                f"travels.py: myrmex: no friction both holds and slips over {apart:.3g} mm"
            )
        for friction in (holds, slips):
            recordings.append(
                {
                    "friction": {"scale": float(f"{friction:.3g}")},
                    "bodies": {
                        "object": {
                            "shape": "box",
                            "size": ["60 mm", f"{width} mm", f"{height} mm"],
                            "mass": f"{mass} g",
                            "position": ["0 mm", f"{beside} mm", f"{above} mm"],
                        }
                    },
                    "controls": {
                        "squeeze": f"{apart + left:.4g} mm",
                        "apart": [
                            [f"{start:.4g} s", "0 mm"],
                            [f"{start + ramp:.4g} s", f"{apart:.4g} mm"],
                        ],
                    },
                }
            )
    return recordings


def text_of(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {text_of(one)}" for key, one in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(text_of(one) for one in value) + "]"
    return str(value)


def written(path):
    """Returns the text of a scene with recomputed recordings."""
    where, sensor = path.stem.split("_", 1)
    outside = where == "outside"
    rng = random.Random(path.stem)
    if sensor in STAGES:
        recordings = stage_recordings(sensor, outside, rng)
    else:
        recordings = {"nib_pad": nib_pad_recordings, "myrmex": myrmex_recordings}[sensor](
            outside, rng
        )
    before, rest = path.read_text().split("\n  scene:", 1)
    lines = rest.split("\n")
    after = next(k for k in range(1, len(lines)) if not lines[k].startswith("    "))
    return (
        before
        + "\n  scene:\n"
        + "".join(f"    - {text_of(recording)}\n" for recording in recordings)
        + "\n".join(lines[after:])
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--check", action="store_true", help="compare the scenes with what this program writes"
    )
    parser.add_argument("names", nargs="*", help="scenes, such as open_taxels [default: all]")
    arguments = parser.parse_args()
    paths = [FOLDER / f"{name}.yaml" for name in arguments.names] or sorted(
        FOLDER.glob("open_*.yaml")
    ) + sorted(FOLDER.glob("outside_*.yaml"))
    other = []
    for path in paths:
        text = written(path)
        if arguments.check and text != path.read_text():
            other.append(path.name)
        elif not arguments.check:
            path.write_text(text)
    if other:
        sys.exit(
            f"travels.py: {', '.join(other)}: not what this program writes; run it without --check"
        )


if __name__ == "__main__":
    main()
