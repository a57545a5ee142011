"""Extreme values of every number of a scene.

Each run ends with a result or a message for the user, never with an internal error, a signal or
another status.

usage: extremes_test.py SLIPBENCH [COUNT]

Each number of the schema is replaced in a small scene by the ends of its range, by the smallest and
largest doubles and by sizes between these. COUNT: number of such scenes, spread evenly over all of
them (default: 2000; 0: all). A scene that is still running after SECONDS is valid, only long, and
is ended.
"""

import functools
import json
import os
import subprocess
import sys
import tempfile

SECONDS = 10
SIZES = [
    5e-324,
    2.3e-308,
    1e-200,
    1e-60,
    1e-30,
    1e-12,
    1e-9,
    1e-6,
    1e-3,
    1.0,
    1e3,
    1e6,
    1e9,
    1e12,
    1e30,
    1e60,
    1e200,
    1.7e308,
]
STAGE = {
    "kind": "stage",
    "compression": "0.3 mm",
    "gap": "0.1 mm",
    "approach_speed": "10 mm/s",
    "start": "0.25 s",
    "speed": "8 mm/s",
}
GRASP = {
    "slipbench": 1,
    "duration": "4.2 s",
    "sensors": {"pad": {"type": "papillarray", "rate": "100 Hz"}},
}


def scene(**parts):
    return {
        "slipbench": 1,
        "duration": "0.4 s",
        "motion": dict(STAGE),
        "sensors": {"pad": {"type": "papillarray"}},
        **parts,
    }


def numbers(schema):
    """Yields the keys of a section that hold numbers, with the number of entries (0: no list) and the range."""
    for key, value in schema.get("properties", {}).items():
        size = value.get("minItems", 0) if value.get("type") == "array" else 0
        kinds = value.get("items", value) if size else value
        for kind in kinds.get("anyOf", [kinds]):
            if kind.get("type") in ("number", "integer"):
                yield key, size, kind


def values(kind):
    low = kind.get("minimum", kind.get("exclusiveMinimum", -float("inf")))
    high = kind.get("maximum", kind.get("exclusiveMaximum", float("inf")))
    found = [
        value
        for value in (low, high, 0, *SIZES, *(-size for size in SIZES))
        if low <= value <= high and abs(value) != float("inf")
    ]
    if kind["type"] == "integer":
        found = [int(value) for value in found if abs(value) < 2**62 and float(value).is_integer()]
    return sorted(set(found))


def with_motion(kind, change):
    if kind in ("lift", "guided"):
        return {**GRASP, "motion": {"kind": kind, **change}}
    return scene(motion={**(STAGE if kind == "stage" else {"kind": kind}), **change})


def with_surface(shape, change):
    return scene(surface={"shape": shape, **change})


def with_effect(effect, change):
    before = ["inertia"] if effect == "asperities" else []
    return scene(effects=[*before, {effect: change}])


def with_sensor(kind, change):
    channels = {"channels": {"f": "force"}} if kind == "taxels" else {}
    return scene(sensors={"pad": {"type": kind, **channels, **change}})


def with_detector(kind, change):
    return scene(detector={"type": kind, **change})


def with_controller(kind, change):
    return {**GRASP, "controller": {"type": kind, **change}}


def with_body(shape, change):
    return {
        "slipbench": 1,
        "duration": "0.4 s",
        "motion": {"kind": "press"},
        "sensors": {"pad": {"type": "papillarray", "rate": "100 Hz", "touches": ["ball"]}},
        "bodies": {"ball": {"shape": shape, **change}},
    }


def of_grasp(key, change):
    return {**GRASP, key: change}


def with_friction(_, change):
    return scene(friction=change)


def with_contact(_, change):
    return scene(fidelity="mujoco_contact", time_step="0.2 ms", contact=change)


# Beginnings of names in the schema: the function that makes a scene with such a section, from the
# rest of the name and the section.
KINDS = {
    "motion_": with_motion,
    "surface_": with_surface,
    "effect_": with_effect,
    "sensor_": with_sensor,
    "detector_": with_detector,
    "controller_": with_controller,
    "body_": with_body,
}
ALONE = {
    "grip": of_grasp,
    "box": of_grasp,
    "scatter": of_grasp,
    "friction": with_friction,
    "contact": with_contact,
}
SIMPLE_DETECTORS = ("detector_force_ratio", "detector_shear_rate", "detector_truth")


def is_testable(name):
    """False for parts that need a file of their own."""
    if name.startswith("detector_"):
        return name in SIMPLE_DETECTORS
    return name not in ("sensor_plugin", "controller_plugin")


def sections(definitions):
    """Yields the schema of each section and a function that returns the scene with this section."""
    for prefix, make in KINDS.items():
        for name, schema in definitions.items():
            if name.startswith(prefix) and is_testable(name):
                yield name, schema, functools.partial(make, name.removeprefix(prefix))
    for name, make in ALONE.items():
        yield name, definitions[name], functools.partial(make, name)


def cases(schema):
    whole = {
        "type": "object",
        "properties": {key: schema["properties"][key] for key in ("duration", "time_step")},
    }
    for key, _, kind in numbers(whole):
        for value in values(kind):
            yield f"{key} {value!r}", scene(**{key: value})
    for name, section, make in sections(schema["$defs"]):
        for key, size, kind in numbers(section):
            for value in values(kind):
                yield f"{name}.{key} {value!r}", make({key: [value] * size if size else value})


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 2000
    schema = json.loads(
        subprocess.run([program, "schema", "scene"], capture_output=True, check=True).stdout
    )
    all_cases = list(cases(schema))
    chosen = (
        all_cases if count == 0 else [all_cases[k * len(all_cases) // count] for k in range(count)]
    )
    wrong, statuses, late = [], {}, 0
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.yaml")
        for title, made in chosen:
            with open(path, "w", encoding="utf-8") as file:
                json.dump(made, file)
            try:
                result = subprocess.run(
                    [program, "run", path, "--trials", "1"],
                    cwd=folder,
                    capture_output=True,
                    text=True,
                    timeout=SECONDS,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                late += 1
                continue
            statuses[result.returncode] = statuses.get(result.returncode, 0) + 1
            placed = (
                result.returncode == 0
                or "scene.yaml" in result.stderr
                or "trial 0: " in result.stderr
            )
            if (
                result.returncode not in (0, 1, 2)
                or "internal error" in result.stderr
                or not placed
            ):
                wrong.append(f"{title}: status {result.returncode}: {result.stderr.strip()[-300:]}")
            left = sorted(set(os.listdir(folder)) - {"scene.yaml"})
            if left:
                wrong.append(f"{title}: leaves {left}")
                for name in left:
                    os.remove(os.path.join(folder, name))
    print(
        f"{len(chosen)} of {len(all_cases)} scenes; status: {statuses}; longer than {SECONDS} s: {late}"
    )
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
