"""Shared code of the Python studies: results as JSON, text, page and charts.

Intervals; grid trials.

Argument: the program.
"""

import importlib.util
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import slipbench
from slipbench import InputError
from slipbench_studies import page, statistics, text
from slipbench_studies.__main__ import module_of
from slipbench_studies.catalogue import STUDIES, check_options, find_study
from slipbench_studies.grid import Cell, check_only, chosen, make_dataset, run_grid
from slipbench_studies.result import Chart, Curve, Options, Result, Table, plain, result_object

PROGRAM = sys.argv.pop()


def sample():
    return Result(
        "A <title>",
        "A paper",
        {"a": np.float64(1.25), "none": math.nan, "n": np.int64(3)},
        ["one thread"],
        [Table("Table & more", ["what", "value"], [["a < b", "1.0"]], "a note")],
        [
            Chart(
                "Curve",
                "level",
                "area",
                ["0", "8 <"],
                [Curve("all", [(0.95, 0.91, 0.99), (math.nan, math.nan, math.nan)])],
                0.95,
                "wanted",
            )
        ],
        ["it differs"],
    )


class Results(unittest.TestCase):
    def test_figures_become_plain_json(self):
        shown = result_object("paper/table", sample())
        self.assertEqual(
            list(shown), ["reproduction", "title", "source", "setup", "figures", "remarks"]
        )
        self.assertEqual(json.dumps(shown["figures"]), '{"a": 1.25, "none": null, "n": 3}')
        with self.assertRaisesRegex(TypeError, "set in the figures"):
            plain({"a": {1}})

    def test_text_has_tables_and_sentences(self):
        shown = text.result_text(sample(), False, 60)
        self.assertIn("  what   value\n  a < b    1.0\n  a note\n", shown)
        self.assertIn("\nHow it was measured\n  one thread\n", shown)

    def test_the_page_escapes_and_loads_nothing(self):
        shown = page.result_page("paper/table", sample())
        for part in (
            "A &lt;title&gt;",
            "Table &amp; more",
            "<td>a &lt; b</td><td>1.0</td>",
            "a note",
            "it differs",
            "one thread",
            "paper/table",
            'src="data:image/svg+xml;base64,',
        ):
            self.assertIn(part, shown)
        self.assertNotIn("://", shown)
        self.assertNotIn("<script", shown)

    def test_charts_have_the_same_bytes_each_time(self):
        [chart] = sample().charts
        for kind in ("svg", "png"):
            self.assertEqual(page.drawn(chart, kind), page.drawn(chart, kind))
        self.assertIn(b">wanted</text>", page.drawn(chart, "svg"))

    def test_places_without_an_order_are_rows(self):
        drawn = page.draw(
            Chart(
                "Rows",
                "",
                "share, %",
                ["centre of mass at L/3", "paper"],
                [Curve("all", [(1.0, 0.0, 2.0), (3.0, 2.0, 4.0)])],
                joined=False,
            )
        )
        [axes] = drawn.axes
        self.assertEqual(
            [label.get_text() for label in axes.get_yticklabels()],
            ["centre of mass at L/3", "paper"],
        )
        self.assertEqual(axes.get_xlabel(), "share, %")
        self.assertGreater(axes.get_ylim()[0], axes.get_ylim()[1])  # the first row at the top

    def test_a_chart_that_cannot_be_written_leaves_the_earlier_one(self):
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / "r.html"
            page.write(str(output), "paper/table", sample())
            before = (Path(folder) / "r-1.png").read_bytes()
            (Path(folder) / "r-1.png.partial").mkdir()
            with self.assertRaisesRegex(InputError, r"r-1\.png: cannot be written: Is a directory"):
                page.write(str(output), "paper/table", sample())
            self.assertEqual((Path(folder) / "r-1.png").read_bytes(), before)

    def test_files_of_others_are_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / "r.html"
            names = [Path(name).name for name in page.write(str(output), "paper/table", sample())]
            self.assertEqual(names, ["r.html", "r.json", "r-1.svg", "r-1.png"])
            self.assertEqual(
                json.loads((Path(folder) / "r.json").read_text())["figures"]["a"], 1.25
            )
            page.write(str(output), "paper/table", sample())  # replaces its own files
            for name in ("r.json", "r-1.png"):
                (Path(folder) / name).write_text("mine")
                with self.assertRaisesRegex(InputError, name):
                    page.write(str(output), "paper/table", sample())
                self.assertEqual((Path(folder) / name).read_text(), "mine")
                (Path(folder) / name).unlink()


class Catalogue(unittest.TestCase):
    def test_every_study_has_its_module(self):
        self.assertEqual(len({one.name for one in STUDIES}), len(STUDIES))
        for one in STUDIES:
            self.assertIs(find_study(one.name), one)
            self.assertIsNotNone(importlib.util.find_spec(module_of(one.name)), one.name)

    def test_an_unknown_name_gets_the_nearest(self):
        with self.assertRaisesRegex(
            InputError, "'hd-papillarray/latancy'; did you mean 'hd-papillarray/latency'"
        ):
            find_study("hd-papillarray/latancy")

    def test_an_option_without_use_is_refused(self):
        latency, table3 = (
            find_study("hd-papillarray/latency"),
            find_study("nib-reconfigurable/table3"),
        )
        check_options(table3, Options(trials=3, only=("felt",), seed=0, jobs=2, output="page.html"))
        for study, options, message in (
            (
                latency,
                Options(data="a.h5"),
                "latency does not take --data; allowed: --output, --json, --quiet",
            ),
            (
                table3,
                Options(full=True),
                "table3 does not take --full; allowed: --trials, --only, --seed, --jobs",
            ),
            (find_study("piezo-fft-gru/table1"), Options(resume=True), "needs -o"),
        ):
            with self.assertRaisesRegex(InputError, message):
                check_options(study, options)


class Statistics(unittest.TestCase):
    def test_exact_intervals(self):
        # The upper end of 0 in n is 1 - 0.025^(1/n); the lower end of n in n is 0.025^(1/n).
        self.assertEqual(statistics.clopper_pearson(0, 0), (0.0, 1.0))
        self.assertAlmostEqual(statistics.clopper_pearson(0, 5)[1], 1 - 0.025**0.2, 12)
        self.assertAlmostEqual(statistics.clopper_pearson(5, 5)[0], 0.025**0.2, 12)
        with self.assertRaises(ValueError):
            statistics.clopper_pearson(3, 2)

    def test_area_counts_pairs(self):
        # 2 and 4 against 1, 3 and 4: 2 is above 1; 4 is above 1 and 3, and ties with 4: 3.5 of 6
        # pairs.
        self.assertAlmostEqual(statistics.auc([2, 4], [1, 3, 4]).value, 3.5 / 6)
        # At 1 the interval is that of two pairs in the right order.
        self.assertEqual(
            statistics.auc([5, 6, 7], [1, 2]).interval, statistics.clopper_pearson(2, 2)
        )
        # Groups of two equal values count as one value: the same as four separate values.
        alone, twice = (
            statistics.auc([1, 3], [2, 0]),
            statistics.auc([1, 1, 3, 3], [2, 2, 0, 0], [0, 0, 1, 1], [2, 2, 3, 3]),
        )
        np.testing.assert_allclose(alone.interval, twice.interval)
        with self.assertRaises(ValueError):
            statistics.auc([], [1])

    def test_medians_leave_nan_out(self):
        self.assertEqual(statistics.median([3, math.nan, 1]), 2.0)
        self.assertTrue(math.isnan(statistics.median([])))
        self.assertEqual(statistics.mean_sd([1, 3])[0], 2.0)
        self.assertAlmostEqual(statistics.mean_sd([1, 3])[1], math.sqrt(2))

    def test_interval_of_a_median(self):
        # All six values are below the median with probability 1/64 < 2.5 %, at least five with
        # 7/64: so the interval spans all six.
        self.assertEqual(statistics.median_interval([6, 1, 2, 3, 4, 5]), (1.0, 6.0))
        self.assertTrue(math.isnan(statistics.median_interval([1, 2, 3, 4, 5])[0]))

    def test_bootstrap_over_groups(self):
        self.assertTrue(
            math.isnan(statistics.bootstrap_intervals(1, 3, 1, lambda groups: [1.0])[0][0])
        )
        [(low, high)] = statistics.bootstrap_intervals(
            4, 50, 1, lambda groups: [float(np.mean(groups))]
        )
        self.assertLess(low, 1.5)
        self.assertGreater(high, 1.5)


class Grids(unittest.TestCase):
    CELLS = [
        Cell(
            "slow",
            "scenes/papillarray/stage.yaml",
            {"motion.speed": "2 mm/s", "duration": "2.2 s"},
            2,
        ),
        Cell(
            "fast",
            "scenes/papillarray/stage.yaml",
            {"motion.speed": "9 mm/s", "duration": "2.2 s"},
            2,
        ),
    ]

    def test_trials_are_the_same_on_any_number_of_threads(self):
        heard = []
        options = [Options(seed=3, jobs=1, say=heard.append), Options(seed=3, jobs=2)]
        one, two = (
            run_grid(self.CELLS, each, lambda cell, trial: (cell.name, trial.trial, trial.sha256))
            for each in options
        )
        self.assertEqual(one, two)
        self.assertEqual(
            [[row[:2] for row in rows] for rows in one],
            [[("slow", k) for k in range(len(one[0]))], [("fast", k) for k in range(len(one[1]))]],
        )
        self.assertTrue(heard[0].startswith("slow (0 of "))

    def test_a_dataset_holds_the_trials_of_a_cell(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "slow.h5")
            make_dataset(path, self.CELLS[0], Options(seed=3, jobs=1), "trials")
            with slipbench.open(path) as data:
                stored = [data[trial].sha256 for trial in data]
        self.assertEqual(
            stored, run_grid(self.CELLS[:1], Options(seed=3), lambda _, trial: trial.sha256)[0]
        )

    def test_errors_name_the_command(self):
        def fail(cell, trial):
            raise InputError("no such thing")

        with self.assertRaisesRegex(
            InputError,
            "slow, trial 1: no such thing; the same: slipbench run scenes/papillarray/stage.yaml "
            "--set 'motion.speed=2 mm/s' --set 'duration=2.2 s' --seed 1 --trials . --trial 1",
        ):
            run_grid(
                self.CELLS,
                Options(jobs=1),
                lambda cell, trial: trial if trial.trial == 0 else fail(cell, trial),
            )

    def test_changes_are_of_the_text(self):
        cell = Cell(
            "changed",
            "scenes/papillarray/stage.yaml",
            change=lambda scene: scene.replace("seed: 7", "seed: 5"),
        )
        self.assertEqual(cell.load().seed, 5)

    def test_names_of_only(self):
        with self.assertRaisesRegex(
            InputError,
            "--only: unknown name 'com_hi'; did you mean 'com_high'\\? allowed: com_low, com_high",
        ):
            check_only(["com_hi"], ["com_low", "com_high"])
        self.assertEqual(chosen(["a", "b"], ["b", "x"]), ["b"])
        self.assertEqual(chosen(["a", "b"], ["x"]), ["a", "b"])


class Programs(unittest.TestCase):
    def start(self, *words, stdout=subprocess.PIPE):
        return subprocess.Popen(
            [PROGRAM, "reproduce", *words], stdout=stdout, stderr=subprocess.PIPE, text=True
        )

    def test_wrong_names_are_refused(self):
        run = self.start("nib-reconfigurable/table3", "--only", "com_hi")
        out, err = run.communicate(timeout=120)
        self.assertEqual((run.returncode, out), (2, ""))
        self.assertIn("slipbench: reproduce: --only: unknown name 'com_hi'", err)

    def test_output_that_cannot_be_written_is_reported(self):
        for form in ([], ["--json"]):
            with open("/dev/full", "wb") as full:
                run = self.start(
                    "nib-reconfigurable/table3",
                    "--only",
                    "200g",
                    "--trials",
                    "1",
                    *form,
                    stdout=full,
                )
                err = run.communicate(timeout=120)[1]
            self.assertEqual(
                (run.returncode, err.splitlines()[-1]),
                (2, "slipbench: cannot write to standard output: No space left on device"),
            )

    def test_an_interrupt_ends_it(self):
        run = self.start(
            "nib-reconfigurable/table3", "--trials", "1000", "--only", "200g", "--jobs", "1"
        )
        self.assertIn("200g (0 of 1000 done)", run.stderr.readline())
        os.kill(run.pid, signal.SIGINT)
        out, err = run.communicate(timeout=120)
        self.assertEqual((run.returncode, out), (130, ""))
        self.assertIn("slipbench: interrupted; nothing is kept\n", err)


if __name__ == "__main__":
    unittest.main()
