"""The examples run and write their pictures; with those of the README they call every public function. Argument: the program."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
from public_names import functions

del sys.argv[1]
FOLDER = Path(__file__).resolve().parents[3] / "tools/python"
# Runs the script of the second argument; writes which functions of the package it calls into the file of the first.
CALLS = """
import json, runpy, sys, threading
calls = set()
def note(frame, event, _):
    if event == "call" and frame.f_globals.get("__name__", "").startswith("slipbench"):
        calls.add((frame.f_globals["__name__"], frame.f_code.co_qualname))
told, *sys.argv = sys.argv[1:]
threading.setprofile(note)
sys.setprofile(note)
runpy.run_path(sys.argv[0], run_name="__main__")
sys.setprofile(None)
json.dump(sorted(calls), open(told, "w"))
"""


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        cls.scripts = sorted((FOLDER / "examples").glob("*.py"))
        for name, text in re.findall(r"```python (\S+)\n(.*?)```", (FOLDER / "README.md").read_text(encoding="utf-8"), re.DOTALL):
            cls.scripts.append(cls.folder / name)
            cls.scripts[-1].write_text(text, encoding="utf-8")
        cls.calls, cls.output = set(), {}
        for script in cls.scripts:
            # What takes minutes has a short way, too.
            quick = ["--quick"] if "--quick" in script.read_text(encoding="utf-8") else []
            done = subprocess.run([sys.executable, "-c", CALLS, "calls.json", str(script), *quick], cwd=cls.folder, stdout=subprocess.PIPE, text=True,
                                  check=True, env={**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(cls.folder / "matplotlib")})
            cls.output[script.name] = done.stdout
            cls.calls |= {tuple(call) for call in json.loads((cls.folder / "calls.json").read_text(encoding="utf-8"))}

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def test_every_public_function_is_called(self):
        offered = dict(functions())
        self.assertGreater(len(offered), 30)
        self.assertEqual([name for name, function in offered.items() if (function.__module__, function.__qualname__) not in self.calls], [])

    def test_pictures_are_written(self):
        pictures = [picture for script in self.scripts for picture in re.findall(r"Writes (\S+\.png)\.", script.read_text(encoding="utf-8"))]
        self.assertGreaterEqual(len(pictures), 3)
        for picture in pictures:
            height, width, _ = matplotlib.image.imread(self.folder / picture).shape
            self.assertGreaterEqual((height, width), (400, 900))  # 100 dots an inch

    def test_what_they_say_is_so(self):
        accuracy = float(re.search(r"^classifier \[(\S+)", self.output["slip_classifier.py"], re.MULTILINE)[1])
        self.assertGreater(accuracy, 0.9)  # a constant answer has 0.5
        slips, law = map(float, re.search(r"slip from (\S+) N on; m g / \(2 mu\) = (\S+) N", self.output["robot_with_pads.py"]).groups())
        self.assertAlmostEqual(law, 0.1 * 9.81 / (2.0 * 0.4), delta=0.005)  # two digits
        self.assertAlmostEqual(slips, law, delta=0.03 * law)  # both pads bear the same share but for the swing of the lift
        self.assertIn("truth: 8 of 8 held", self.output["own_detector.py"])  # who knows of slip at once drops nothing


if __name__ == "__main__":
    unittest.main()
