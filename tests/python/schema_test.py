"""`slipbench schema`: the schemas accept what the program accepts. Arguments: the program, the source folder."""

import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

import slipbench
import yaml
from jsonschema import Draft202012Validator
from slipbench._import import MAPS
from slipbench._import.block import read_map

PROGRAM = sys.argv.pop(1)
SOURCE = Path(sys.argv.pop(1))
SCENES = SOURCE / "scenes"
MODELINE = "# yaml-language-server: $schema="
# Scenes whose bytes are part of a protocol's digest in `slipbench benchmark`.
FROZEN = (
    "benchmark/*/*.yaml",
    "biotac_sp/slip.yaml",
    "myrmex/dataset.yaml",
    "piezo_skin/dataset.yaml",
)
STAGE = "slipbench: 1\nsensors: {pad: {type: papillarray}}\n"
WRONG = (
    "sensors: {pad: {type: papillarray}}",  # no version
    "slipbench: 2\nsensors: {pad: {type: papillarray}}",
    "slipbench: 1",
    "slipbench: 1\nsensors: {}",
    "slipbench: 1\nsensors: {1st: {type: papillarray}}",
    "slipbench: 1\nsensors: {pad: {rate: 1 kHz}}",
    "slipbench: 1\nsensors: {pad: {type: papilarray}}",
    "slipbench: 1\nsensors: {pad: {type: papillarray, electronics: typcal}}",
    "slipbench: 1\nsensors: {pad: {type: papillarray, electronics: [no_such_part]}}",
    "slipbench: 1\nsensors: {pad: {type: papillarray, profil: gripper}}",
    STAGE + "durations: 4 s",
    STAGE + "duration: 4 mm",
    STAGE + "duration: -4 s",
    STAGE + "duration: 0",
    STAGE + "duration: 100000",  # s, more than a day
    STAGE + "fidelity: feld",
    STAGE + "motion: {sped: 4 mm/s}",
    STAGE + "motion: {speed: 4 mn/s}",
    STAGE + "motion: {kind: stge}",
    STAGE + "motion: {kind: lift}",  # without a grasp
    STAGE + "motion: {tilt: [1 deg]}",
    STAGE + "surface: {material: acryl}",
    STAGE + "surface: {shape: donut}",
    STAGE + "friction: {static: -1}",
    STAGE + "friction: {statc: 0.5}",
    STAGE + "effects: [ageeing]",
    STAGE + "effects: ageing",
    STAGE + "effects: [{ageing: {}, stribeck: {}}]",
    STAGE + "effects: [ageing, ageing]",
    STAGE + "detector: {ratio: 0.3}",
    STAGE + "detector: {type: force_ratio, rato: 0.3}",
    STAGE + "detector: {type: none, ratio: 0.3}",
    STAGE + "controller: {type: step_on_slip}",
    STAGE + "gravity: 1 m/s2",
    STAGE + "scatter: {}",
    STAGE + "grip: {}\nmodel: a.xml",
    STAGE + "grip: {}\nmotion: {kind: stage}",
    STAGE + "grip: {}\nsurface: {shape: plane}",
    STAGE + "contact: {cone: elliptic}",
    STAGE + "seed: -1",
    STAGE + "split: {shares: [0.8, 0.2]}",
    STAGE + "expect: {max_slips: 3 mm}",
    STAGE + "expect: {gross_slip_by: {pass: 0.9}}",
    STAGE + "sweep: {motion.sped: [1 mm/s]}",
    STAGE + "sweep: {motion.speed: 1 mm/s}",
    STAGE + "sweep: {motion.speed: [1 mn/s]}",
    STAGE + "sweep: {seed: [1, 2]}",
    STAGE + "sweep: {motion.speed: {draw: unifrm, min: 1, max: 2}}",
    STAGE + "sweep: {motion.speed: {draw: uniform, min: 1 mm/s}}",
    STAGE + "sweep: {trials: 0}",
)
RIGHT = (
    STAGE + "duration: 1e1\nmotion: {speed: 1e-3}",  # PyYAML reads it as text
    STAGE + "motion: {speed: 4mm/s, gap: +0.5 mm, tilt: [-1 deg, 0.1]}",
    STAGE + "motion: {speed: 4000 \u00b5m/s, acceleration: 2 m/s^2}",
    STAGE + "effects: [ageing, stribeck: {speed: 1 mm/s}]",
    STAGE + "sweep: {grip.preset: [5 N, 6 N], motion.kind: [lift]}",
    STAGE
    + "motion: {tilt: [0, 0]}\nsweep: {motion.tilt.0: {draw: normal, mean: 0 deg, sd: 1 deg}, motion: [{gap: 1 mm}]}",
    STAGE + "sweep: {scene: [{motion: {speed: 1 mm/s}}], trials: 5}",
    STAGE + "time_step: auto\nfield_solver: auto\nintegrator: auto\ncontact: none",
    STAGE + "detector: {type: none}\ncontroller: {type: none}",
)
MAP = "sensor: pad\ntype: own\nchannels: {force: {unit: N, columns: [f1]}}\n"
RIGHT_MAPS = (
    MAP,
    MAP + "time: {column: t, unit: ms}\nskip: [1, 2]\nmissing: nan\nseparator: ';'",
    MAP
    + "time: {rate: 100 Hz}\nstate: {column: label, values: {hold: non_slip, slip: 3}, rule: a button}",
    MAP.replace("N,", "counts, scale: 0.01 N, baseline: 0.2 s,")
    + "time: {column: t}\nnote: a gain of 1 is assumed",
    MAP.replace("N,", "counts, components: 2, scale: [0.6 uT, -1e-3 uT], baseline: 1,"),
    "sensors: {a: {type: own, channels: {f: {unit: N, scale: 1e-3, columns: [a]}}}}\nobject: {folder: 1}",
)
WRONG_MAPS = (
    "type: own",
    MAP + "sensors: {a: {type: own, channels: {f: {unit: N, columns: [a]}}}}",
    MAP + "tme: {column: t}",
    MAP + "time: {column: t, rate: 100 Hz}",
    MAP + "time: {rate: 5 mm}",
    MAP + "time: {rate: -5 Hz}",
    MAP + "skip: -1",
    MAP + "missing: skip",
    MAP + "header: yess",
    MAP + "state: {column: label}",
    MAP + "state: {rule: a button}",
    MAP.replace("[f1]", "f1"),
    MAP.replace("N,", "counts, scale: 0 N,"),
    MAP.replace("N,", "counts, scale: [],"),
    MAP.replace("N,", "counts, baseline: -1 s,"),
    MAP.replace("unit: N, ", ""),
    MAP.replace("pad", "1st"),
)


def printed(*words):
    """Returns the output of `slipbench schema`."""
    return subprocess.run(
        [PROGRAM, "schema", *words], check=True, capture_output=True, text=True
    ).stdout


def faults(validator, text):
    """Returns a validator's messages about YAML."""
    return [
        f"{error.json_path}: {error.message}"
        for error in validator.iter_errors(yaml.safe_load(text))
    ]


class Scenes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = json.loads(printed())
        Draft202012Validator.check_schema(cls.schema)
        cls.validator = Draft202012Validator(cls.schema)

    def test_shipped_scenes_fit_and_name_the_schema(self):
        frozen = {path for pattern in FROZEN for path in SCENES.glob(pattern)}
        paths = sorted(SCENES.rglob("*.yaml"))
        self.assertGreaterEqual(len(paths), 69)
        for path in paths:
            with self.subTest(path.name):
                text = path.read_text(encoding="utf-8")
                self.assertEqual(faults(self.validator, text), [])
                if path not in frozen:
                    first = text.splitlines()[0]
                    self.assertTrue(first.startswith(MODELINE), first)
                    named = (path.parent / first.removeprefix(MODELINE)).resolve()
                    self.assertEqual(named, (SCENES / "scene.schema.json").resolve())

    def test_wrong_scenes_do_not_fit(self):
        for text in WRONG:
            with self.subTest(text):
                self.assertNotEqual(faults(self.validator, text), [])
                with self.assertRaises(slipbench.InputError):
                    slipbench.Scene.from_text(text)

    def test_right_scenes_fit(self):
        for text in RIGHT:
            with self.subTest(text):
                self.assertEqual(faults(self.validator, text), [])
                slipbench.Scene.from_text(text)

    def test_every_example_of_describe_fits(self):
        names = {entry["name"] for entries in slipbench.list_names().values() for entry in entries}
        count = 0
        for name in sorted(names):
            for entry in slipbench.describe(name):
                if "example" not in entry or "scene_key" not in entry:
                    continue  # a recipe
                with self.subTest(name):
                    scene = {"slipbench": 1, "sensors": {"pad": {"type": "papillarray"}}}
                    scene.update(yaml.safe_load(entry["example"]))
                    found = [
                        f"{error.json_path}: {error.message}"
                        for error in self.validator.iter_errors(scene)
                    ]
                    self.assertEqual(found, [])
                    count += 1
        self.assertGreater(count, 100)

    def test_sections_have_the_keys_of_the_parser(self):
        """The parser's message about an unknown key lists the known ones."""
        defs = self.schema["$defs"]
        root = self.schema["properties"]
        body = "bodies: {box: {shape: box}}\nslipbench: 1\nsensors: {pad: {type: papillarray, touches: [box]}}\n"
        for text, section in (
            (STAGE + "x: 1", root),
            (STAGE + "friction: {x: 1}", defs["friction"]["properties"]),
            (STAGE + "split: {x: 1}", root["split"]["properties"]),
            (STAGE + "expect: {x: 1}", root["expect"]["properties"]),
            (STAGE + "surface: {x: 1}", defs["surface_plane"]["properties"]),
            (STAGE + "motion: {x: 1}", defs["motion_stage"]["properties"]),
            (STAGE + "detector: {type: truth, x: 1}", defs["detector_truth"]["properties"]),
            (STAGE.replace("}}", ", x: 1}}"), defs["sensor_papillarray"]["properties"]),
            (body + "hold: {x: 1}", root["hold"]["properties"]),
        ):
            with self.subTest(text):
                with self.assertRaises(slipbench.InputError) as refused:
                    slipbench.Scene.from_text(text)
                allowed = re.search(
                    r"unknown key 'x' .*allowed: (.*)$", str(refused.exception)
                ).group(1)
                self.assertEqual(allowed.split(", "), sorted(section))

    def test_choices_hold_what_yaml_makes_of_their_texts(self):
        """YAML 1.1 reads `true` or `off` as booleans."""

        def check(schema):
            if isinstance(schema, dict):
                choices = schema.get("enum", [])
                for word in choices:
                    self.assertIn(yaml.safe_load(word) if isinstance(word, str) else word, choices)
                for child in schema.values():
                    check(child)
            elif isinstance(schema, list):
                for child in schema:
                    check(child)

        check(self.schema)


class Maps(unittest.TestCase):
    def test_maps_fit_as_the_program_reads_them(self):
        schema = json.loads(printed("map"))
        Draft202012Validator.check_schema(schema)
        validator = Draft202012Validator(schema)
        for path in sorted(MAPS.glob("*.yaml")):
            with self.subTest(path.name):
                self.assertEqual(faults(validator, path.read_text(encoding="utf-8")), [])
                read_map(str(path))
        for text in RIGHT_MAPS:
            with self.subTest(text):
                self.assertEqual(faults(validator, text), [])
        for text in WRONG_MAPS:
            with self.subTest(text):
                self.assertNotEqual(faults(validator, text), [])

    def test_another_kind_is_refused(self):
        refused = subprocess.run(
            [PROGRAM, "schema", "scenes"], check=False, capture_output=True, text=True
        )
        self.assertEqual(refused.returncode, 2)
        self.assertIn(
            "unknown kind 'scenes'; did you mean 'scene'? allowed: map, scene", refused.stderr
        )


if __name__ == "__main__":
    unittest.main()
