"""Random scenes, drawn from the JSON schema of scenes.

A scene is a plausible rig (a stage, articulated pads, bodies, a gripper's model, a grasp) with ordinary values, of which some are
replaced by extreme ones: limits of the allowed range, 0, the least and greatest numbers, anything between in equal decades.
"""

import math
import random

import slipbench

LEAST, GREATEST = 1e-60, 1e60  # sizes that a scene may have
BEYOND = (5e-324, 1e-300, 1e300, 1.7976931348623157e308)
# Order of magnitude [SI] of a parameter whose default has none, by the quantity in the schema.
SCALES = {"length": 1e-3, "angle": 0.1, "speed": 1e-2, "time": 5e-2, "force": 1.0, "mass": 0.1, "stiffness": 1e3, "number": 1.0,
          "acceleration": 1.0, "angular_speed": 1.0, "angular_acceleration": 10.0, "frequency": 100.0, "pressure": 1e5}  # fmt: skip
# Parameters whose value multiplies the cost of a trial: greatest value of a draw.
COSTLY = {"bristles": 6, "rows": 6, "columns": 6, "marker_rows": 6, "marker_columns": 6, "points": 4, "elements": 260, "map": 8, "rate": 4000,
          "iterations": 100, "noslip": 20, "width": 400, "height": 400, "directions": 4, "strokes": 5, "shake_cycles": 3}  # fmt: skip
# Whole numbers of the sensors gel_markers and magnetic_skin, which the schema gives as numbers.
WHOLE = {"rows", "columns", "width", "height", "map"}
# Keys whose ordinary values depend on other keys: only extreme values are drawn.
BOUND = {"cycle_rate", "device_number", "label_rate", "far", "near", "electrode_place", "dome", "field", "patch", "window", "hop", "edge", "duty",
         "lever", "fabric_radius", "gap", "range_flag", "thickness", "marker_pitch", "pitch", "marker_rows", "marker_columns"}  # fmt: skip
# Keys that a rig sets, or that name a file.
NOT_DRAWN = {"damping", "ahead", "type", "kind", "shape", "sensor", "electronics", "follows", "site", "touches", "library", "parameters", "model", "memories", "waveform",
             "push", "changes", "channels", "matrix", "curve", "places", "material", "duration"}  # fmt: skip
SENSORS = (
    "papillarray",
    "nib_pad",
    "piezo_skin",
    "biotac_sp",
    "biotac_19",
    "myrmex",
    "taxels",
    "gel_markers",
    "magnetic_skin",
)
# Fewer elements than the defaults, for speed.
SMALL = {"biotac_sp": {"elements": 200}, "biotac_19": {"elements": 200}, "myrmex": {"rows": 4, "columns": 4},
         "gel_markers": {"columns": 6, "rows": 6, "marker_columns": 4, "marker_rows": 4, "pitch": "3 mm"}, "piezo_skin": {"elements": 12},
         "magnetic_skin": {"rows": 3, "columns": 3}}  # fmt: skip
# Sampling rates [Hz] that divide a second's tenth into whole numbers of steps.
RATES = {"papillarray": (100, 250, 500, 1000), "nib_pad": (300,), "piezo_skin": (10000, 2000), "biotac_sp": (100,), "biotac_19": (100,),
         "myrmex": (1000, 500, 100), "taxels": (1000, 500, 100, 50), "gel_markers": (50, 100, 500), "magnetic_skin": (100, 500, 1000)}  # fmt: skip
# Sensors whose samples may be the steps of 1 ms.
BY_STEP = ("papillarray", "myrmex", "taxels", "gel_markers", "magnetic_skin")
# Effects that cannot be combined: each sets the force of an element.
TIPS, SKINS, MAPS = (
    {"inertia", "asperities"},
    {"elastic_skin"},
    {"viscoelastic", "viscous_friction", "anisotropic_friction"},
)
# Effects that need a flat surface.
FLAT = {"texture", "roughness", "patchy_friction", "anisotropic_friction"}
# Detectors by the sensor that they read; the others read any.
DETECTORS = {"papillarray": ("gst_hd", "force_ratio", "shear_rate"), "nib_pad": ("nib_linear_slip", "nib_slip_kind"),
             "piezo_skin": ("band_energy",), "gel_markers": ("marker_deviation", "marker_entropy")}  # fmt: skip


class Draw:
    """One scene: `Draw(schema, seed).scene()`."""

    def __init__(self, schema, seed):
        self.defs = schema["$defs"]
        self.random = random.Random(f"scene {seed}")

    def chance(self, share):
        return self.random.random() < share

    def pick(self, *items):
        return self.random.choice(items)

    def decades(self, low, high):
        """Log-uniform."""
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    # Values by their schema.

    def default(self, spec):
        """SI number; None: not a number."""
        value = spec.get("default")
        if isinstance(value, str):
            try:
                return slipbench.parse_quantity(value)
            except slipbench.InputError:
                return None
        return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None

    def numeric(self, spec):
        """The schema of the number itself, and its order of magnitude."""
        if spec.get("type") in ("number", "integer"):
            return spec, 1.0
        options = spec.get("anyOf", [])
        number = next((one for one in options if one.get("type") == "number"), None)
        quantity = next(
            (one["$ref"].rsplit("/", 1)[1] for one in options if "$ref" in one), "number"
        )
        return number, SCALES.get(
            quantity.removeprefix("positive_").removeprefix("non_negative_"), 1.0
        )

    def value(self, key, spec, extreme):
        if "enum" in spec:
            return self.pick(*spec["enum"])
        if spec.get("type") == "boolean":
            return self.chance(0.5)
        if spec.get("type") == "array" and spec.get("minItems") == spec.get("maxItems"):
            defaults = spec.get("default", [None] * spec["minItems"])
            return [self.value(key, {**spec["items"], "default": one}, extreme) for one in defaults]
        number, scale = self.numeric(spec)
        if number is None:
            return None
        low = number.get("minimum", number.get("exclusiveMinimum", -math.inf))
        high = number.get("maximum", math.inf)
        if key in COSTLY:
            high = min(high, COSTLY[key])
        value = (self.extreme if extreme else self.ordinary)(self.default(spec), scale, low, high)
        if number["type"] == "integer":
            return round(min(max(value, low), high, 2**62))
        return value if math.isfinite(value) else self.pick("inf", GREATEST)

    def ordinary(self, default, scale, low, high):
        if default is None or default == 0.0 or not math.isfinite(default):
            default = scale * self.pick(1.0, -1.0 if low < 0.0 else 1.0)
        value = default * math.exp(self.random.gauss(0.0, 0.6))
        return min(max(value, low), high)

    def extreme(self, default, scale, low, high):
        size = abs(default) if default and math.isfinite(default) else scale
        value = self.pick(low, high, 0.0, -0.0, size * self.decades(1e-12, 1e12), size * self.decades(1e-3, 1e3), size * self.decades(1e-3, 1e3),
                          LEAST, 1e-30, GREATEST, 1e30)  # fmt: skip
        if low < 0.0 and self.chance(0.5):
            value = -value
        # A few values outside, which must be refused.
        if self.chance(0.08):
            return self.pick(value, *BEYOND)
        value = min(max(value, low if low != 0.0 else self.pick(0.0, LEAST, 1e-3 * size)), high)
        return min(max(value, -GREATEST), GREATEST) if self.chance(0.9) else value

    def params(self, name, share=0.25, **fixed):
        """Parameters of an entry: `fixed`, and ordinary values of a share of the others."""
        found = dict(fixed)
        for key, spec in self.defs[name]["properties"].items():
            if (
                key in found
                or key in NOT_DRAWN | BOUND
                or not isinstance(spec, dict)
                or not self.chance(share)
            ):
                continue
            value = self.value(key, spec, False)
            if value is not None:
                found[key] = (
                    max(1, round(value)) if key in WHOLE and name.startswith("sensor_") else value
                )
        return found

    def spoil(self, scene, entries):
        """Replaces some values of the `entries`, (map, name of its schema), by extreme ones."""
        for _ in range(self.pick(0, 0, 0, 1, 1, 2, 3)):
            values, name = self.pick(*entries)
            properties = self.defs[name]["properties"]
            keys = [
                key
                for key in properties
                if key not in NOT_DRAWN and isinstance(properties[key], dict)
            ]
            if keys:
                key = self.pick(*keys)
                value = self.value(key, properties[key], True)
                if value is not None:
                    values[key] = value
        if self.chance(0.06):
            scene["time_step"] = self.pick(
                self.decades(2e-5, 1e-2), self.decades(2e-5, 1e-2), *BEYOND, LEAST, 1.0
            )

    # Parts of a scene.

    def sensor(self, entries, kind=None, **fixed):
        kind = kind or self.pick(*SENSORS)
        sensor = {
            "type": kind,
            **SMALL.get(kind, {}),
            **self.params(f"sensor_{kind}", 0.1),
            **fixed,
        }
        sensor["rate"] = self.pick(*RATES[kind])
        if self.chance(0.5):
            sensor["electronics"] = self.electronics(kind)
        entries.append((sensor, f"sensor_{kind}"))
        return sensor

    def electronics(self, kind):
        spec = self.defs[f"sensor_{kind}"]["properties"]["electronics"]
        parts = next((one for one in spec.get("anyOf", []) if one.get("type") == "array"), None)
        if parts is None or self.chance(0.4):
            return self.pick("ideal", "typical")
        chosen = []
        for name in parts["items"]["anyOf"][0]["enum"]:
            if self.chance(0.4):
                options = parts["items"]["anyOf"][1]["properties"][name]["anyOf"]
                entry = next(one["$ref"].rsplit("/", 1)[1] for one in options if "$ref" in one)
                values = self.params(entry, 0.5)
                if self.chance(0.2):
                    key = self.pick(*self.defs[entry]["properties"])
                    values[key] = self.value(key, self.defs[entry]["properties"][key], True)
                chosen.append({name: values})
        return chosen

    def effects(self, entries, shape, most=3):
        """Effects that fit the surface and each other, or, rarely, any."""
        names = {name.removeprefix("effect_") for name in self.defs if name.startswith("effect_")}
        if self.chance(0.95):
            one_law = (
                self.pick(TIPS, TIPS, SKINS, MAPS)
                if shape == "plane"
                else self.pick(SKINS, MAPS, MAPS)
            )
            names -= (TIPS | SKINS | MAPS) - one_law
            if shape not in ("plane", "box"):
                names -= FLAT
        chosen = self.random.sample(
            sorted(names), min(len(names), self.pick(0, 1, 1, most, self.random.randint(0, most)))
        )
        if (
            "inertia" in names
            and "inertia" not in chosen
            and ("asperities" in chosen or self.chance(0.4))
        ):
            chosen.append("inertia")
        effects = []
        for name in chosen:
            values = self.params(f"effect_{name}", 0.3)
            if values.get("profile") == "bars":
                values["duty"], values["edge"] = (
                    self.random.uniform(0.1, 0.9),
                    self.decades(1e-5, 5e-4),
                )
            entries.append((values, f"effect_{name}"))
            effects.append({name: values})
        return effects

    def friction(self, entries):
        static = self.pick(
            self.decades(0.05, 2.0),
            self.decades(0.05, 2.0),
            0.0,
            30.0,
            100.0,
            LEAST,
            self.decades(1e-6, 100.0),
        )
        friction = {
            "static": static,
            "kinetic": static * self.pick(1.0, 1.0, self.random.random(), 0.0),
        }
        if self.chance(0.2):
            entries.append((friction, "friction"))
        return friction

    def stage(self, entries, duration):
        """A motion that touches and slides within the duration."""
        kind = self.pick("stage", "stage", "stage", "press", "rub", "wander")
        depth, gap = self.decades(1e-4, 1.5e-3), self.pick(1e-3, 2e-3, 4e-3)
        if kind == "stage":
            motion = self.params("motion_stage", 0.1, compression=depth, gap=gap, approach_speed=0.2, acceleration=self.pick(50.0, 50.0, 100.0, "inf"),
                                 start=0.4 * duration, speed=self.decades(1e-3, 0.1))  # fmt: skip
            for key in (
                "stop",
                "reverse",
                "retract",
                "travel",
                "strokes",
                "vibration",
                "rest_speed",
                "idle_speed",
            ):
                motion.pop(key, None)
            if self.chance(0.4):
                motion["rotation"] = self.pick(1, -1) * self.decades(0.1, 20.0)
                motion["angular_acceleration"] = self.pick(100.0, "inf")
            if self.chance(0.3):
                motion["retract"] = 0.7 * duration
            elif self.chance(0.3):
                motion["stop"] = 0.6 * duration
            if self.chance(0.1):
                motion["vibration"] = self.decades(0.1, 10.0)
            if self.chance(0.8):
                motion["tilt"] = [0.0, 0.0]
        elif kind == "press":
            motion = self.params(
                "motion_press",
                0.15,
                compression=depth,
                gap=gap,
                approach_speed=0.1,
                acceleration=20.0,
            )
        elif kind == "rub":
            motion = self.params(
                "motion_rub", 0.15, compression=depth, gap=gap, start=0.0, approach=0.2 * duration
            )
        else:
            motion = self.params("motion_wander", 0.2, compression=depth, gap=gap, start=0.0, approach=0.2 * duration,
                                 bandwidth=self.decades(1.0, 30.0))  # fmt: skip
        motion["kind"] = kind
        entries.append((motion, f"motion_{kind}"))
        return motion

    def surface(self, entries):
        shape = self.pick(
            "plane",
            "plane",
            "plane",
            "plane",
            "box",
            "cylinder",
            "upright_cylinder",
            "capsule",
            "sphere",
        )
        material = self.pick(*self.defs["surface_plane"]["properties"]["material"]["enum"])
        surface = {"shape": shape, "material": material, **self.params(f"surface_{shape}", 0.2)}
        entries.append((surface, f"surface_{shape}"))
        return surface

    def detector(self, entries, sensor, kind, share=0.35):
        if not self.chance(share):
            return {}
        name = self.pick(*DETECTORS.get(kind, ("truth",))) if self.chance(0.8) else "truth"
        detector = {"type": name, **self.params(f"detector_{name}", 0.2), "sensor": sensor}
        entries.append((detector, f"detector_{name}"))
        return {"detector": detector}

    # Rigs.

    def scene(self):
        entries = []
        scene = {
            "slipbench": 1,
            "seed": self.random.randrange(2**64),
            "duration": self.pick(0.1, 0.2, 0.3, 0.4),
        }
        rig = self.random.choices(
            (self.on_stage, self.articulated, self.on_bodies, self.in_fingers, self.grasp),
            (60, 8, 9, 8, 15),
        )[0]
        rig(scene, entries)
        self.spoil(scene, entries)
        return scene

    def step(self, scene, sensor):
        """A step, or none: auto. Often that of the sensor, so that each step is recorded."""
        fine = any(
            name in ("roughness", "texture", "patchy_friction")
            for effect in scene["effects"]
            for name in effect
        )
        if (
            len(scene["sensors"]) == 1
            and sensor["type"] in BY_STEP
            and self.chance(0.8)
            and not fine
        ):
            sensor["rate"] = 1000
            scene["time_step"] = 1e-3
        elif sensor["type"] in BY_STEP and self.chance(0.3) and not fine:
            scene["time_step"] = self.pick(1e-3, 5e-4, 1e-4)

    def on_stage(self, scene, entries):
        scene["surface"] = self.surface(entries)
        scene["motion"] = self.stage(entries, scene["duration"])
        if self.chance(0.7):
            scene["friction"] = self.friction(entries)
        pad = self.sensor(entries)
        scene["sensors"] = {"pad": pad}
        if self.chance(0.1):
            scene["sensors"]["second"] = self.sensor(entries)
        scene["effects"] = self.effects(entries, scene["surface"]["shape"])
        scene.update(self.detector(entries, "pad", pad["type"]))
        self.step(scene, pad)

    def articulated(self, scene, entries):
        scene["duration"] = 0.1
        scene["fidelity"] = self.pick("articulated", "mujoco_contact")
        scene["surface"] = {"material": "acrylic"}
        scene["motion"] = self.stage(entries, scene["duration"])
        scene["friction"] = {"static": 0.5, "kinetic": 0.5}
        scene["sensors"] = {
            "pad": self.sensor(entries, self.pick("papillarray", "papillarray", "nib_pad"))
        }
        if scene["fidelity"] == "mujoco_contact":
            scene["contact"] = self.params("contact", 0.2)
            entries.append((scene["contact"], "contact"))

    def body(self, entries, free):
        shape = self.pick("box", "box", "sphere", "cylinder", "capsule", "ellipsoid")
        body = {"shape": shape, **self.params(f"body_{shape}", 0.1), "free": free}
        body.pop("velocity", None)
        entries.append((body, f"body_{shape}"))
        return body

    def on_bodies(self, scene, entries):
        """The stage presses a pad onto bodies."""
        duration = scene["duration"]
        scene["bodies"] = {"table": {"shape": "plane", "position": [0, 0, -0.02]},
                           "thing": {"shape": "box", "size": [0.04, 0.04, 0.02], "mass": self.decades(0.02, 2.0), "position": [0, 0, -0.01]}}  # fmt: skip
        touched = ["thing"]
        if self.chance(0.4):  # a body that stands still, its top at a height of 0
            block = self.body(entries, free=False)
            block["position"], block["rotation"] = (
                [0.0, 0.0, -0.02],
                [0.0, 0.0, self.random.uniform(-1.0, 1.0)],
            )
            size = {"box": {"size": [0.06, 0.06, 0.04]}, "ellipsoid": {"size": [0.08, 0.08, 0.04]}, "capsule": {"radius": 0.015, "length": 0.01},
                    "cylinder": {"radius": 0.02, "length": 0.04}}  # fmt: skip
            block.update(size.get(block["shape"], {"radius": 0.02}))
            scene["bodies"] = {"block": block}
            touched = ["block"]
        scene["motion"] = {"kind": "stage", "compression": self.decades(1e-4, 8e-4), "gap": 1e-3, "approach_speed": 0.1, "acceleration": 20.0,
                           "start": 0.4 * duration, "speed": self.decades(1e-3, 0.05)}  # fmt: skip
        entries.append((scene["motion"], "motion_stage"))
        scene["friction"] = self.friction(entries)
        kind = self.pick(*SENSORS)
        scene["sensors"] = {"pad": self.sensor(entries, kind, touches=touched)}
        if self.chance(0.3):
            scene["sensors"]["twin"] = {"type": kind, **SMALL.get(kind, {}), "follows": "pad"}
        scene["effects"] = self.effects(entries, "body", most=2)
        scene.update(self.detector(entries, "pad", kind))
        if self.chance(0.3):
            scene["sensors"]["pad"]["damping"] = self.decades(1e-5, 1e-2)
        self.solver(scene)

    def in_fingers(self, scene, entries):
        """Two fingers of a model hold a box; forces change."""
        duration = scene["duration"]
        scene["model"] = "two_fingers.xml"
        scene["bodies"] = {
            "box": {
                "shape": "box",
                "size": [0.04, 0.04, 0.06],
                "mass": self.decades(0.02, 0.4),
                "position": [0, 0, 0.1],
            }
        }
        force = self.decades(0.5, 15.0)
        scene["controls"] = {
            name: [[0.3 * duration, force], [duration, force * self.random.random()]]
            for name in ("left", "right")
        }
        scene["friction"] = self.friction(entries)
        kind = self.pick("papillarray", "taxels", "myrmex", "nib_pad", "magnetic_skin")
        scene["sensors"] = {"left": self.sensor(entries, kind, site="left_pad", touches=["box"]),
                            "right": self.sensor(entries, "papillarray", site="right_pad", touches=["box"])}  # fmt: skip
        if self.chance(0.3):
            scene["hold"] = {"body": "box", "against": "left"}
        if kind in ("papillarray", "nib_pad") and self.chance(0.4):
            scene["fidelity"] = "articulated"
            scene["friction"] = {"static": 0.5, "kinetic": 0.5}
            scene["duration"] = 0.1
        else:
            scene["effects"] = self.effects(entries, "body", most=2)
            self.solver(scene)
        scene.update(self.detector(entries, "left", kind))

    def solver(self, scene):
        if self.chance(0.2):
            scene["integrator"] = self.pick("Euler", "implicit", "implicitfast", "discrete", "RK4")
        if self.chance(0.2):
            scene["field_solver"] = self.pick("explicit", "implicit")
            if scene["field_solver"] == "implicit":
                scene["integrator"] = "discrete"

    def grasp(self, scene, entries):
        scene["duration"] = self.pick(0.5, 0.6, 0.8)
        scene["surface"] = {"material": self.pick("ptfe", "rubber", "acrylic", "paper")}
        scene["box"] = self.params(
            "box",
            0.05,
            mass=self.decades(0.05, 0.6),
            size=[self.random.uniform(0.03, 0.075), 0.06, 0.1],
        )
        scene["grip"] = self.params(
            "grip", 0.05, protocol="as_recorded", clearance=5e-4, fastest=0.15
        )
        if self.chance(0.5):
            scene["scatter"] = self.params("scatter", 0.2)
        guided = self.chance(0.2)
        scene["motion"] = {"kind": "guided"} if guided else self.params("motion_lift", 0.05, settle=0.05, distance=0.02, speed=0.2, acceleration=5.0,
                                                                        tilt=[0.0, 0.0], shake=[0.0, 0.0, 0.0], kind="lift")  # fmt: skip
        for key, name in (
            ("box", "box"),
            ("grip", "grip"),
            ("motion", f"motion_{scene['motion']['kind']}"),
        ):
            entries.append((scene[key], name))
        kind = (
            "nib_pad"
            if guided
            else self.pick(*["papillarray"] * 6, "nib_pad", "myrmex", "taxels", "magnetic_skin")
        )
        scene["sensors"] = {"pad": self.sensor(entries, kind)}
        if self.chance(0.3):
            scene["effects"] = self.effects(entries, "body", most=2)
        scene.update(self.detector(entries, "pad", kind, share=0.7))
        controllers = []
        if guided:
            controllers, scene["detector"] = ["reorient"], {"type": "nib_slip_kind"}
        elif kind == "papillarray":  # the only one of these with the forces that a controller needs
            controllers = ["constant_force", "hold_preset", "force_ratio"]
            controllers += ["step_on_slip"] if "detector" in scene else []
        if controllers:
            name = self.pick(*controllers)
            scene["controller"] = {"type": name, **self.params(f"controller_{name}", 0.15)}
            entries.append((scene["controller"], f"controller_{name}"))
