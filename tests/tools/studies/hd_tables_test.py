"""The hyperdimensional detector's tables I to III: figures, thread independence, closed forms.

The paper's estimates of a grasp are tested in closed form, figures on artificial results. Argument:
the program, which is not used.
"""

import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from slipbench import InputError, Scene, State
from slipbench.bin import _core
from slipbench_studies.hd_papillarray import grasp, table1, table2, table3
from slipbench_studies.result import Options

# 24 trials of 0.4 s: pressed 0.6 mm until 0.2 s, then slid at two speeds, with twelve draws of
# direction and friction each.
SMALL = """slipbench: 1
description: short slides
duration: 0.4 s
time_step: 1 ms
seed: 5
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.5}
motion: {kind: stage, gap: 0 mm, compression: 0.6 mm, approach_speed: 10 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}
sensors:
  pad: {type: papillarray, rate: 1 kHz, electronics: typical, bristles: 3, profile: hexapod}
sweep:
  motion.speed: [4 mm/s, 16 mm/s]
  motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}
  friction.scale: {draw: lognormal, median: 1, sd: 0.1}
  trials: 12
"""
PAPER = {
    "encoding": "spatial",
    "context_driven": False,
    "window": 15,
    "dimension": 1000,
    "compat": "paper",
    "ties": "one",
    "quantiser": "fixed_point",
    "epochs": 0,
    "memories_seed": 1,
    "seed": 1,
    "by_frame": False,
    "jobs": 1,
}


class Table1(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.data = str(Path(cls.folder.name) / "data.h5")
        Scene.from_text(SMALL).write(cls.data)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_a_given_dataset_does_without_what_needs_fresh_ones(self):
        one, three = (table1.study(Options(data=self.data, jobs=jobs)) for jobs in (1, 3))
        self.assertEqual(one, three)
        self.assertEqual(
            [len(table.rows) for table in one.tables], [5, 4, 3, 17]
        )  # four models and the best constant answer; three causes need fresh data
        for table in one.tables:
            self.assertEqual({len(row) for row in table.rows}, {len(table.head)})
        main = one.tables[0]
        self.assertEqual(
            (main.rows[3][0], main.head[1], main.head[4], main.rows[3][4]),
            ("CL-gstHDC", "recall of slip", "accuracy: paper", "91.78 +- 0.53"),
        )
        self.assertEqual(main.rows[4][2], "33.33")  # constant answer, in three classes
        self.assertIn("data.h5, made by: slipbench", one.setup[0])
        self.assertNotIn("scatter", one.figures)
        # The model of the first row of the causes is the ablation's.
        self.assertEqual(one.figures["causes"]["as published"], one.figures["by_sequence"])
        self.assertEqual([figure.real for figure in one.real], [85.00, 86.42, 89.86, 91.78])

    def test_an_interrupt_leaves_no_dataset(self):
        def interrupt(_):
            raise KeyboardInterrupt

        before = set(Path(tempfile.gettempdir()).iterdir())
        with self.assertRaises(KeyboardInterrupt):
            table1.study(Options(say=interrupt))
        self.assertEqual(
            {
                path
                for path in Path(tempfile.gettempdir()).iterdir()
                if path not in before and (path / "hexapod.h5").exists()
            },
            set(),
        )

    # 40 frames per trial; those from number 14 on have a full window: 26 in each of 24 trials,
    # fewer without frames at rest. The stage moves from 0.2 s to the end, so nothing follows its
    # last motion.
    def test_frames_at_rest_are_left_out(self):
        def frames(before):
            sequences = _core.HdSequences(self.data, "paper")
            if before is not None:
                sequences.leave_out_motionless(before)
            [draws] = sequences.cross_validate(**PAPER)
            found = json.loads(draws)["draws"][1]
            return found["all"]["frames"] / found["tested"], found["moving"]["frames"] / found[
                "tested"
            ]

        self.assertEqual(frames(None)[0], 26)
        self.assertEqual(frames(False), frames(None))
        all_frames, moving = frames(True)
        self.assertEqual(all_frames, moving)
        self.assertEqual(moving, frames(None)[1])

    def test_unknown_words_get_the_nearest(self):
        sequences = _core.HdSequences(self.data, "paper")
        self.assertEqual(len(sequences), 24)
        for key, word, nearest in (
            ("encoding", "spacial", "spatial"),
            ("compat", "papper", "paper"),
            ("ties", "on", "one"),
            ("quantiser", "exakt", "exact"),
        ):
            with self.assertRaisesRegex(InputError, f"{key}: unknown '{word}'.*{nearest}"):
                sequences.cross_validate(**{**PAPER, key: word})
        with self.assertRaisesRegex(InputError, "has_slipped"):
            _core.HdSequences(self.data, "has_sliped")


def log(*rows):
    """Returns a log of two pillars with one row per sample.

    State, then tangential and normal force [N] of each pillar.
    """
    force = [
        [[0.6 * t1, -0.8 * t1, n1], [t2, 0.0, n2]]
        for _, t1, n1, t2, n2 in (row + (0.0,) * (5 - len(row)) for row in rows)
    ]
    return np.array(force, np.float32), np.array([row[0] for row in rows], np.uint8)


HOLD, INCIPIENT, GROSS = State.NON_SLIP, State.INCIPIENT, State.GROSS
REST = (HOLD,)


def ideal(*rows):
    return grasp.estimated_forces(*log(*rows), 1).ideal


# sum f_t / mean(f_t/f_n).
class EstimatedForces(unittest.TestCase):
    def test_ideal_is_shear_over_the_mean_ratio(self):
        # Equal ratios of 1/2: 2 / (1/2), the whole normal force. Then 1/2 and 1/8 on 1 N and 4 N: 1
        # / (5/16).
        self.assertAlmostEqual(
            ideal((INCIPIENT, 0.5, 1.0, 1.5, 3.0), (GROSS,), (GROSS,), REST, REST), 4.0, delta=1e-6
        )
        self.assertAlmostEqual(
            ideal((INCIPIENT, 0.5, 1.0, 0.5, 4.0), (GROSS,), (GROSS,), REST, REST), 3.2, delta=1e-6
        )

    def test_what_has_no_ratio_below_one_stays_in_the_sum_alone(self):
        # A ratio of 2, and one without normal force, together with 1/2: (2 + 1)/(1/2).
        for normal in (1.0, 0.0):
            self.assertAlmostEqual(
                ideal((INCIPIENT, 2.0, normal, 1.0, 2.0), (GROSS,), (GROSS,), REST, REST),
                6.0,
                delta=1e-6,
            )
        # A pillar without shear does not count as a ratio of 0: 1/(1/2).
        self.assertAlmostEqual(
            ideal((INCIPIENT, 0.0, 3.0, 1.0, 2.0), (GROSS,), (GROSS,), REST, REST), 2.0, delta=1e-6
        )

    def test_a_window_needs_three_slips_of_four_and_an_incipient_one(self):
        def with_states(*states):
            return ideal(*((state, 1.0, 2.0) for state in states), REST)

        self.assertAlmostEqual(with_states(GROSS, HOLD, GROSS, INCIPIENT), 2.0, delta=1e-6)
        self.assertAlmostEqual(with_states(*[INCIPIENT] * 4), 2.0, delta=1e-6)
        for states in ((GROSS, HOLD, HOLD, INCIPIENT), [GROSS] * 4, [HOLD] * 4):
            self.assertTrue(math.isnan(with_states(*states)))

    def test_windows_do_not_overlap_once_they_count(self):
        # Rows 0 to 3 count; row 4, whose 1 N would be the smallest, begins a window that does not
        # count.
        rows = [(INCIPIENT, 1, 2), *[(GROSS, 1, 2)] * 3, (INCIPIENT, 0.5, 1)]
        self.assertAlmostEqual(ideal(*rows, *[REST] * 5), 2.0, delta=1e-6)
        # With rows before them the first window is rows 1 to 4 only if rows 0 to 3 do not count:
        # two of those slip.
        rows = [REST, REST, *[(GROSS, 1, 2)] * 2, (INCIPIENT, 0.5, 1)]
        self.assertAlmostEqual(ideal(*rows, *[REST] * 5), 1.0, delta=1e-6)

    # The script's loop ends one window early.
    def test_the_last_four_rows_begin_no_window(self):
        rows = [(INCIPIENT, 1, 2), *[(GROSS, 1, 2)] * 3]
        self.assertTrue(math.isnan(ideal(*rows)))
        self.assertAlmostEqual(ideal(*rows, REST), 2.0, delta=1e-6)

    def test_the_most_is_over_all_rows_up_to_ten_newtons(self):
        self.assertEqual(
            grasp.estimated_forces(
                *log((HOLD, 0, 4, 0, 5), (HOLD, 0, 4, 0, 6), (HOLD, 0, 6, 0, 5)), 1
            ).most,
            10.0,
        )
        self.assertTrue(math.isnan(grasp.estimated_forces(*log((HOLD, 0, 6, 0, 5)), 1).most))

    def test_rows_that_are_not_finite_are_left_out(self):
        # Without the second row the first four of the others are a window.
        rows = [
            (INCIPIENT, 1, 2),
            (HOLD, 1, math.nan, 0, 7),
            (HOLD, 1, 2),
            (GROSS, 1, 2),
            (GROSS, 1, 3),
            REST,
        ]
        forces = grasp.estimated_forces(*log(*rows), 1)
        self.assertAlmostEqual(forces.ideal, 2.0, delta=1e-6)
        self.assertEqual(forces.most, 3.0)
        self.assertAlmostEqual(forces.ratio, 1.5, delta=1e-6)

    def test_rows_are_the_last_sample_of_each_stride(self):
        forces = grasp.estimated_forces(
            *log(*[(HOLD, 0, 9), (GROSS, 1, 8), (INCIPIENT, 1, 2)] * 5), 3
        )
        self.assertAlmostEqual(forces.ideal, 2.0, delta=1e-6)
        self.assertEqual(forces.most, 2.0)


class MarkerSlip(unittest.TestCase):
    # 200 samples; the arm rises by 100 mm between sample 60 and 90, and the box stays 2 mm behind.
    def test_it_is_the_difference_of_the_means_before_and_after(self):
        share = np.clip((np.arange(200) - 60.0) / 30.0, 0.0, 1.0)
        arm, box = np.zeros((200, 7)), np.zeros((200, 7))
        arm[:, 2], box[:, 0], box[:, 2] = 0.1 * share, 0.01, 0.098 * share
        slip = grasp.marker_slip(arm, box, 60)
        self.assertAlmostEqual(slip.along, 2e-3, delta=1e-12)
        beside = math.hypot(*grasp.MARKER_LINE[:2])
        self.assertAlmostEqual(
            slip.spin, math.atan(beside / 135.4e-3) - math.atan(beside / 137.4e-3), delta=1e-12
        )
        with self.assertRaisesRegex(ValueError, "101 samples or more"):
            grasp.marker_slip(arm[:100], box[:100], 60)


class Spread(unittest.TestCase):
    def test_it_leaves_out_nan(self):
        value = grasp.spread([4.0, math.nan, 1.0, 2.0])
        self.assertEqual((value.n, value.median), (3, 2.0))
        self.assertAlmostEqual(value.mean, 7.0 / 3.0, delta=1e-12)
        self.assertAlmostEqual(value.sd, math.sqrt((25.0 + 16.0 + 1.0) / 9.0 / 2.0), delta=1e-12)
        self.assertEqual(grasp.spread([math.nan]).n, 0)
        self.assertTrue(math.isnan(grasp.spread([]).median))


def table2_of(*only, **more):
    return table2.study(Options(trials=1, only=only, **{"jobs": 1, **more}))


class Table2(unittest.TestCase):
    def test_unknown_names_get_the_nearest(self):
        with self.assertRaisesRegex(InputError, "--only: unknown name 'gst_hb'.*gst_hd"):
            table2_of("ptfe", "gst_hb")

    def test_a_folder_without_memories_is_refused(self):
        with self.assertRaisesRegex(
            InputError,
            r"^as_recorded, light, ptfe, gst_hd_published, trial 0: .*/nowhere.*"
            r"--set 'grip.protocol=as_recorded' --set 'box.mass=0.2 kg'",
        ):
            table2_of("as_recorded", "light", "ptfe", "gst_hd_published", memories="/nowhere")

    def test_rows_are_by_box_and_the_same_on_any_number_of_threads(self):
        only = ("as_recorded", "light", "heavy", "rubber", "hold_preset", "gst_hd")
        one = table2_of(*only)
        self.assertEqual(one, table2_of(*only, jobs=3))
        # Displacements and forces for each box. The paper has no force of the heavy box.
        self.assertEqual([len(table.rows) for table in one.tables], [3, 3, 3, 2])
        for table in one.tables:
            self.assertEqual({len(row) for row in table.rows}, {len(table.head)})
        slips, forces = one.tables[0].rows, one.tables[1].rows
        self.assertEqual(
            (slips[0][0], slips[0][7], slips[1][0]),
            ("rubber: published", "1.34 +- 3.35", "rubber: gst_hd, shipped memory"),
        )
        self.assertEqual(forces[0][7], "1.36 +- 0.36")
        cells = one.figures["cells"]
        self.assertEqual(
            (len(cells), cells[3]["loop"], cells[3]["slip_mm"]["n"]), (4, "hold_preset", 1)
        )
        self.assertTrue(one.remarks[0].startswith("The negative control"))

    def test_fitted_surfaces_say_what_the_fit_saw(self):
        result = table2_of("as_recorded", "light", "heavy", "rubber_fitted", "oracle")
        self.assertEqual(
            [(figure.what, figure.real) for figure in result.real],
            [
                ("slip of the light box, rubber, median, mm", 0.25),
                ("slip of the heavy box, rubber, median, mm", 1.00),
            ],
        )
        self.assertTrue(result.real[0].note.startswith("fitted to it"))
        self.assertTrue(result.real[1].note.startswith("not seen by the fit"))
        self.assertEqual(result.tables[0].rows[0][0], "rubber: published")
        self.assertIn("friction.static=0.5", result.figures["cells"][0]["command"])

    def test_lost_boxes_are_named(self):
        [cell] = table2.grasp_cells(Options(only=("as_recorded", "light", "ptfe", "oracle")))
        trials = [grasp.GraspFigures(slip=1e-3), grasp.GraspFigures(dropped=True)]
        [lost, *_] = table2.remarks_on([cell], [trials], 7)
        self.assertTrue(
            lost.startswith(
                "The oracle drops 1 of 2 light boxes: slipbench run scenes/grasp/lift.yaml"
            )
        )
        self.assertTrue(lost.endswith("--seed 7 --trials 2 --trial 1."))
        figures = table2.cell_figures(cell, trials, 7)
        self.assertEqual(
            (figures["dropped"], figures["slip_mm"]["n"], figures["slip_mm"]["median"]),
            ([1], 1, 1.0),
        )
        self.assertEqual(
            list(table2.cell_figures(cell, [], 7)), ["protocol", "box", "surface", "loop", "trials"]
        )

    # lift.yaml leaves the motion's `settle` at its default, which the setup states.
    def test_the_lift_begins_after_settling(self):
        self.assertEqual(table2.lift_start(), 1.5)


def figure(value):
    return {"value": value, "low": None, "high": None}


# Ten trials: eight slip, of which five are detected, two early, one missed; one of the two others
# has a false alarm.
GRU = {
    "all": {
        "trials": 10,
        "slipping": 8,
        "seen": 5,
        "early": 2,
        "missed": 1,
        "false_alarms": 1,
        "more": 0,
        "figures": {
            "balanced_slip_accuracy": figure(0.9),
            "auc": figure(0.95),
            "delay_median_s": figure(0.05),
            "delay_p10_s": figure(None),
            "delay_p90_s": figure(0.1),
            "false_alarms_per_minute": figure(3.0),
        },
    }
}


class Table3(unittest.TestCase):
    def test_figures_are_plain_counts_of_the_trials(self):
        figures = table3.gru_figures(GRU)
        self.assertEqual(
            table3.right_share(figures, False), 0.6
        )  # five detected, and one correctly quiet
        self.assertEqual(table3.right_share(figures, True), 0.8)
        self.assertEqual(
            (figures["balanced_accuracy"], figures["delay_p10_s"], figures["delay_p90_s"]),
            (0.9, None, 0.1),
        )

    def test_rows_are_as_long_as_their_heads(self):
        figures = table3.gru_figures(GRU) | {"learnt": 160, "kilobytes": 3825.4, "step_s": 45.4e-6}
        row = table3.ROWS["gru5_latched"]
        self.assertEqual(
            table3.frames_row(row, figures),
            ["five GRUs averaged", "latched", "160", "90.0", "0.950", "60.0", "80.0", "3825", "45"],
        )
        self.assertEqual(
            table3.events_row(row, figures),
            [
                "five GRUs averaged, 160 learnt",
                "latched",
                "8",
                "5",
                "2",
                "1",
                "50",
                "- to 100",
                "1 of 2",
                "3.0",
            ],
        )
        self.assertEqual(len(table3.frames_table().head), 9)
        self.assertEqual({len(one) for one in table3.frames_table().rows}, {9})
        self.assertEqual(len(table3.events_table().head), 10)
        self.assertEqual(table3.decimals(None, 3, none="nan"), "nan")

    def test_unknown_rows_get_the_nearest(self):
        with self.assertRaisesRegex(InputError, "gru_latched"):
            table3.study(Options(only=("gru_latch",)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
