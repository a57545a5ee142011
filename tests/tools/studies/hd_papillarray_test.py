"""The hyperdimensional detector's tables: figures and refusals of the synthesis.

The time of a frame.

Argument: the program, which is not used.
"""

import json
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from slipbench import InputError
from slipbench.bin import _core
from slipbench_studies.hd_papillarray import core, latency, resources
from slipbench_studies.result import Options

SMALL = {
    "latency_cycles": 37,
    "interval_cycles": 20,
    "lut": 20000,
    "ff": 9000,
    "bram36": 28.5,
    "dsp": 3,
    "levels": 18,
    "cells": {},
}
BIG = {
    "latency_cycles": 10,
    "interval_cycles": 1,
    "lut": 60000,
    "ff": 30000,
    "bram36": 0,
    "dsp": 27,
    "levels": 21,
}
TOOLS = {"yosys": "Yosys 0.70 (git sha1 28b)"}


def read(content):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.json"
        path.write_text(
            content if isinstance(content, str) else json.dumps(content), encoding="utf-8"
        )
        return core.read_figures(str(path))


class CoreFigures(unittest.TestCase):
    def test_they_have_the_order_of_the_file(self):
        figures = read({"tools": TOOLS, "window": 15, "unrollings": {"small": SMALL, "big": BIG}})
        self.assertEqual(figures.tool, "Yosys 0.70")
        self.assertEqual(
            figures.configurations[0], core.Configuration("small", 37, 20, 20000, 9000, 28.5, 3, 18)
        )
        self.assertEqual([one.name for one in figures.configurations], ["small", "big"])

    def test_what_is_missing_is_named(self):
        big = {key: BIG[key] for key in ("latency_cycles", "interval_cycles")}
        for content, named in [
            ("not json", r"results\.json: is not a JSON object"),
            ([], r"results\.json: is not a JSON object"),
            ({}, "tools is not an object"),
            ({"tools": {}}, "tools: yosys is not a text"),
            ({"tools": TOOLS, "unrollings": {}}, "unrollings is not an object"),
            ({"tools": TOOLS, "unrollings": {"big": 3}}, "unrolling 'big': is not a JSON object"),
            ({"tools": TOOLS, "unrollings": {"big": big}}, "unrolling 'big': lut is missing"),
            (
                {"tools": TOOLS, "unrollings": {"big": BIG | {"lut": True}}},
                "lut is true; expected a number",
            ),
            (
                {"tools": TOOLS, "unrollings": {"big": {"latency_cycles": -1}}},
                "latency_cycles is -1; expected a number of 0 or more",
            ),
        ]:
            with self.subTest(named), self.assertRaisesRegex(InputError, named):
                read(content)
        with self.assertRaisesRegex(InputError, r"none\.json: cannot be read"):
            core.read_figures("none.json")


class Resources(unittest.TestCase):
    def test_shares_of_the_device(self):
        # 67300 of 134600 LUTs, 26920 of 269200 flip-flops, 73 of 365 blocks, 74 of 740 multipliers.
        found = resources.figures_of(core.Configuration("half", 12, 3, 67300, 26920, 73, 74, 20))
        self.assertEqual(
            [found[f"{name}_share"] for name in ("lut", "ff", "bram", "dsp")], [0.5, 0.1, 0.2, 0.1]
        )
        self.assertEqual((found["cycles"], found["interval_cycles"], found["levels"]), (12, 3, 20))

    def test_the_stored_synthesis_beside_the_paper(self):
        result = resources.study(Options())
        [table] = result.tables
        self.assertTrue(all(len(row) == len(table.head) for row in table.rows))
        self.assertEqual(
            [row[0] for row in table.rows],
            ["paper", "published HDL, routed", *(f"ours: {name}" for name in result.figures)],
        )
        self.assertIn("smallest", result.figures)


class Latency(unittest.TestCase):
    def test_every_engine_takes_time(self):
        levels, displacements = latency.random_levels()[:16], latency.random_displacements()[:16]
        self.assertEqual(_core.hd_engines()[:2], [latency.REFERENCE, "portable"])
        for engine in _core.hd_engines():
            self.assertGreater(_core.hd_time(engine, levels, 1), 0.0)
            self.assertGreater(_core.hd_time_from_displacements(engine, displacements, 1), 0.0)

    def test_what_is_refused(self):
        levels = latency.random_levels()[:2]
        with self.assertRaisesRegex(InputError, "unknown 'portible'.*portable"):
            _core.hd_time("portible", levels, 1)
        for rows, passes in ((levels[:0], 1), (levels, 0)):
            with self.assertRaisesRegex(InputError, "allowed: 1 or more"):
                _core.hd_time("portable", rows, passes)
        with self.assertRaises(IndexError):  # levels end at 20
            _core.hd_time("portable", np.full((1, 10), 21, dtype=np.uint8), 1)

    def test_draws_reach_all_levels_and_contexts(self):
        levels, displacements = latency.random_levels(), latency.random_displacements()
        self.assertEqual((levels[:, :-1].max(), levels[:, -1].max(), levels.min()), (20, 3, 0))
        self.assertEqual(displacements.shape, (latency.FRAMES, 27))
        self.assertLess(np.abs(displacements).max(), 2.001e-3)

    def test_texts(self):
        self.assertEqual(
            [latency.time_text(value) for value in (42e-9, 0.42e-6, 4.63e-6)],
            ["42.0 ns", "420.0 ns", "4.63 us"],
        )
        # Two digits below 100, no decimals from 100 on.
        self.assertEqual(
            [latency.factor_text(value) for value in (0.0123, 9.94, 1234.4)],
            ["0.012 x", "9.9 x", "1234 x"],
        )

    def test_all_rows_beside_the_published_ones(self):
        result = latency.study(Options())
        [table] = result.tables
        self.assertTrue(all(len(row) == len(table.head) for row in table.rows))
        self.assertEqual([row[0] for row in table.rows], list(result.figures))
        self.assertEqual(
            result.figures["ours: RTL core, smallest"], 37 / 100e6
        )  # cycles of the stored synthesis at 100 MHz
        self.assertEqual(
            next(row for row in table.rows if row[0] == "paper: FPGA")[1:],
            ["42", "420.0 ns", "14250 x", "1 x"],
        )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
