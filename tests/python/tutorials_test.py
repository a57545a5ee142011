"""A tutorial runs from first to last cell, shows what its text says, and is stored without outputs.

Argument: its name. The kernel is this Python. It uses sockets in its temporary working folder,
which is also its home.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import nbformat
import yaml
from nbclient import NotebookClient
from traitlets.config import Config

NAME = sys.argv.pop(1)
FOLDER = Path(__file__).resolve().parents[2] / "python/tutorials"
# By cell id: patterns that the cell must show, and how often.
SHOWN = {
    "dataset_and_classifier": {
        "judge": [
            (r"^any constant answer +same.h5 +0.500 ", 1),
            (r"^classifier +same.h5 +0.9[89]", 1),
            (r"^best threshold, .* 0.(8[4-9]|9[0-2])\d* +(0.[89]|1.00)", 2),
            (r"^classifier +other.h5 +0.9[3-7]\d* +0.[01]", 1),
        ],
    },
    "own_detector": {
        "force": [
            (r"^(ideal|typical|) +truth +1.00 ", 2),
            (r"^ideal +equal_ratios +1.00 ", 1),
            (r"^typical +equal_ratios +0.[3-7]", 1),
        ]
    },
    "grasp_regression": {
        "green": [("15 passed", 1)],
        "show": [(">kept<", 15)],
        "red": [(">kept<", 12), (">broken<", 3), ("3 failed", 1)],
    },
    "pads_on_a_robot": {"law": [(r"^greatest difference: 0\.[0-4]", 1)]},
}


def shown(cell):
    """Returns a cell's output as text, without terminal colours."""
    parts = [
        part
        for one in cell.outputs
        for part in [
            one.get("text", ""),
            *(one.get("data", {}).get(kind, "") for kind in ("text/plain", "text/html")),
        ]
    ]
    return re.sub(r"\x1b\[[0-9;]*m", "", "\n".join(parts))


class Tutorial(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "tutorials"
        shutil.copytree(FOLDER, cls.folder)
        home = cls.folder.parent / "home"
        home.mkdir()
        for name in [
            name for name in os.environ if name.startswith(("JUPYTER_", "IPYTHON", "MPL", "XDG_"))
        ]:
            del os.environ[name]
        os.environ["HOME"] = str(home)
        cls.notebook = nbformat.read(cls.folder / f"{NAME}.ipynb", nbformat.NO_CONVERT)
        sockets = Config({"KernelManager": {"transport": "ipc", "ip": str(home / "kernel")}})
        NotebookClient(
            cls.notebook,
            config=sockets,
            timeout=240,
            resources={"metadata": {"path": str(cls.folder)}},
        ).execute()
        cls.cells = {cell.id: cell for cell in cls.notebook.cells if cell.cell_type == "code"}

    def test_it_is_stored_without_outputs(self):
        stored = nbformat.read(FOLDER / f"{NAME}.ipynb", nbformat.NO_CONVERT)
        nbformat.validate(stored)
        self.assertEqual((stored.nbformat, stored.nbformat_minor), (4, 5))
        self.assertEqual(set(stored.metadata), {"kernelspec", "language_info"})
        for cell in stored.cells:
            self.assertEqual(
                (cell.metadata, cell.get("outputs", []), cell.get("execution_count")),
                ({}, [], None),
                cell.id,
            )
            links = (
                re.findall(r"\]\(([^):]+)\)", cell.source) if cell.cell_type == "markdown" else []
            )
            self.assertEqual([link for link in links if not (FOLDER / link).exists()], [])

    def test_it_shows_what_it_says(self):
        pictures = [
            one
            for cell in self.cells.values()
            for one in cell.outputs
            if "image/png" in one.get("data", {})
        ]
        self.assertGreaterEqual(len(pictures), 2)
        bars = re.findall(
            r"<progress style='width:60ex' max='(\d+)' value='(\d+)'>",
            "\n".join(map(shown, self.cells.values())),
        )
        self.assertGreaterEqual(len(bars), 1)
        self.assertEqual([bar for bar in bars if bar[0] != bar[1]], [])
        for name, expected in SHOWN[NAME].items():
            for pattern, times in expected:
                self.assertEqual(
                    len(re.findall(pattern, shown(self.cells[name]), re.MULTILINE)),
                    times,
                    (pattern, shown(self.cells[name])),
                )
        self.assertEqual(
            [
                one.text
                for cell in self.cells.values()
                for one in cell.outputs
                if one.get("name") == "stderr"
            ],
            [],
        )

    @unittest.skipUnless(NAME == "grasp_regression", "has no workflow")
    def test_the_workflow_runs(self):
        steps = {
            step["name"]: step
            for step in yaml.safe_load((self.folder / "grasp.yml").read_text(encoding="utf-8"))[
                "jobs"
            ]["grasp"]["steps"]
            if "name" in step
        }
        self.assertEqual(list(steps), ["Install", "Grasp", "Show"])
        self.assertEqual(
            steps["Install"]["run"].split(),
            ["python", "-m", "pip", "install", "pytest", "wheels/slipbench-*-cp312-abi3-*.whl"],
        )  # needs the network
        self.assertEqual(steps["Show"]["if"], "${{ !cancelled() }}")  # also after a red test
        good = (self.folder / "grip.py").read_text(encoding="utf-8")
        for patience, end, broken in (
            (1, 0, []),
            (
                8,
                1,
                [
                    f"test_promise[{surface}-max_reaction_time]"
                    for surface in ("ptfe", "rubber", "felt")
                ],
            ),
        ):
            summary = self.folder / f"summary-{patience}.md"
            (self.folder / "grip.py").write_text(
                good.replace('"patience": 1', f'"patience": {patience}'), encoding="utf-8"
            )
            environment = {
                **os.environ,
                "GITHUB_STEP_SUMMARY": str(summary),
                "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
            }
            grasp = subprocess.run(
                ["bash", "-e", "-c", steps["Grasp"]["run"]],
                cwd=self.folder,
                env=environment,
                check=False,
            )
            self.assertEqual(grasp.returncode, end)
            subprocess.run(
                [steps["Show"]["shell"], "-c", steps["Show"]["run"]],
                cwd=self.folder,
                env=environment,
                check=True,
            )
            rows = summary.read_text(encoding="utf-8").splitlines()
            self.assertEqual(rows[:2], ["| test | result |", "|---|---|"])
            self.assertEqual(sum(row.endswith("| kept |") for row in rows), 15 - len(broken))
            self.assertEqual(
                re.findall(
                    r"^\| (\S+) \| \*\*broken\*\* .*at most 120 ms: kept in \d+ of 20 trials",
                    "\n".join(rows),
                    re.MULTILINE,
                ),
                broken,
            )


if __name__ == "__main__":
    unittest.main()
