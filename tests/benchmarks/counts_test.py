"""Tests counts.py on a profile in callgrind's format, and on counts that grew."""

import contextlib
import csv
import io
import json
import pathlib
import tempfile
import unittest

import counts

# main calls Field::step twice, for 30 + 12 instructions of its own, 12 of them in a clone; a call's
# cost belongs to the callee.
PROFILE = """version: 1
positions: line
events: Ir
ob=(1) /bin/slipbench
fl=(1) main.cc
fn=(1) main
3 5
cfn=(2) slipbench::Field::step() [clone .constprop.0]
calls=2 7
+4 42
* 1
fn=(2)
7 12
fn=(3) slipbench::Field::step()'2
9 30
11
totals: 48
"""


class Profile(unittest.TestCase):
    def test_own_instructions_by_function(self):
        self.assertEqual(
            counts.own_instructions(PROFILE), {"main": 6, "slipbench::Field::step()": 42}
        )

    def test_what_does_not_add_up_is_refused(self):
        for damaged in (
            PROFILE.replace("totals: 48", "totals: 49"),
            PROFILE.replace("totals: 48", "totals: 0"),
        ):
            with (
                contextlib.redirect_stderr(io.StringIO()) as said,
                self.assertRaises(SystemExit) as end,
            ):
                counts.own_instructions(damaged)
            self.assertEqual(end.exception.code, 2)
            self.assertIn("the functions add up to 48 instructions of", said.getvalue())


class Comparison(unittest.TestCase):
    def said(self, step, more=()):
        now = {
            "a": {
                "instructions": 1_000_000 + step - 1000,
                "functions": {"step": step, **dict(more)},
            }
        }
        with contextlib.redirect_stdout(io.StringIO()) as text:
            grew = counts.compared(
                {"a": {"instructions": 1_000_000, "functions": {"step": 1000, "rest": 200}}}, now
            )
        return grew, text.getvalue()

    def test_over_two_percent_is_growth_and_named(self):
        self.assertEqual(self.said(20_999, {"rest": 200})[0], [])
        grew, text = self.said(21_001, {"rest": 200})
        self.assertEqual(grew, ["a"])
        self.assertIn("+20,001 (+2.00 % of the scene) step", text)

    def test_a_function_that_was_not_kept_had_at_most_the_least_of_those_that_were(self):
        self.assertIn(
            "+400 at least (+0.04 % of the scene) new",
            self.said(1500, {"rest": 200, "new": 600})[1],
        )

    def test_only_results_of_the_same_build_are_compared(self):
        with (
            tempfile.TemporaryDirectory() as name,
            contextlib.redirect_stderr(io.StringIO()) as said,
        ):
            folder = pathlib.Path(name)
            (folder / "one.json").write_text(
                '{"build": {"compiler": "GNU 12"}, "scenes": {"a": 1}}'
            )
            self.assertEqual(counts.of_this_build(folder, {"compiler": "GNU 12"}), {"a": 1})
            self.assertRaises(SystemExit, counts.of_this_build, folder, {"compiler": "GNU 14"})
            self.assertIn(
                "one.json is of another compiler (GNU 12 there, GNU 14 here)", said.getvalue()
            )


class History(unittest.TestCase):
    def test_a_row_is_added_and_a_new_scene_adds_a_column(self):
        with tempfile.TemporaryDirectory() as name:
            path = pathlib.Path(name) / "history.csv"
            counts.append_history(
                path, "release", "2026-11-28", "1a2b", {"a/b": {"instructions": 7}}
            )
            counts.append_history(
                path,
                "release",
                "2026-11-29",
                "3c4d-dirty",
                {"a/b": {"instructions": 8}, "c/d": {"instructions": 9}},
            )
            self.assertEqual(
                path.read_text(),
                "date,commit,build,a/b,c/d\n2026-11-28,1a2b,release,7,\n2026-11-29,3c4d-dirty,release,8,9\n",
            )
            self.assertEqual([entry.name for entry in path.parent.iterdir()], ["history.csv"])

    def test_the_shipped_history_ends_with_the_stored_counts(self):
        folder = pathlib.Path(counts.__file__).parent / "results"
        *_, last = csv.DictReader((folder / "history.csv").open(newline=""))
        stored = json.loads((folder / f"{last['build']}.json").read_text())["scenes"]
        self.assertEqual(
            {scene: int(last[scene]) for scene in stored},
            {scene: counted["instructions"] for scene, counted in stored.items()},
        )


if __name__ == "__main__":
    unittest.main()
