"""The examples and those of the Markdown pages run; with the tutorials they call every public function. Argument: the program."""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from public_names import functions

del sys.argv[1]
FOLDER = Path(__file__).resolve().parents[2] / "python"
# Runs the script of the second argument; writes the package functions it calls to the file of the
# first.
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
with open(told, "w") as file:
    json.dump(sorted(calls), file)
"""


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        scripts = sorted((FOLDER / "examples").glob("*.py"))
        for name, text in re.findall(
            r"```python (\S+)\n(.*?)```",
            "".join(page.read_text(encoding="utf-8") for page in sorted(FOLDER.glob("*.md"))),
            re.DOTALL,
        ):
            scripts.append(cls.folder / name)
            scripts[-1].write_text(text, encoding="utf-8")
        cls.calls = set()
        for script in scripts:
            # Slow scripts have a short mode.
            quick = ["--quick"] if "--quick" in script.read_text(encoding="utf-8") else []
            subprocess.run(
                [sys.executable, "-c", CALLS, "calls.json", str(script), *quick],
                cwd=cls.folder,
                check=True,
            )
            cls.calls |= {
                tuple(call)
                for call in json.loads((cls.folder / "calls.json").read_text(encoding="utf-8"))
            }

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def test_every_public_function_is_called(self):
        # Functions called in a tutorial's test count as called.
        tutorials = "".join(
            path.read_text(encoding="utf-8") for path in (FOLDER / "tutorials").glob("*.ipynb")
        )
        named = set(re.findall(r"\bslipbench[.\w]*\.(\w+)\(", tutorials))
        offered = dict(functions())
        self.assertGreater(len(offered), 30)
        uncalled = [
            name
            for name, function in offered.items()
            if (function.__module__, function.__qualname__) not in self.calls
        ]
        self.assertEqual([name for name in uncalled if name not in named], [])


if __name__ == "__main__":
    unittest.main()
