"""Learned detectors: the controls of their loop without training, and tables of required trials.

Argument: the program, which is not used.
"""

import math
import sys
import unittest

from slipbench import InputError
from slipbench_studies.learned import grasp_loop, scaling
from slipbench_studies.result import Options, Result


class GraspLoop(unittest.TestCase):
    # Two pads of 4 N hold 2 mu 4 N: 1.2 of 2.9 N at mu 0.15, 2.4 of 4.9 N at 0.3, 4 of 2 N at 0.5.
    # The oracle's loop has no ceiling.
    def test_never_tightening_drops_what_the_preset_force_cannot_hold(self):
        result = grasp_loop.study(Options(trials=2, only=("oracle", "never")))
        self.assertEqual([len(table.rows) for table in result.tables], [2] * 4)
        self.assertIsNone(result.figures["held_out_balanced_accuracy"])
        loop = result.figures["loop"]
        for condition in ("mu 0.15, 0.3 kg", "mu 0.3, 0.5 kg"):
            self.assertEqual(loop[condition]["never"]["dropped"], 2)
            self.assertEqual(loop[condition]["oracle"]["dropped"], 0)
        holds = loop["mu 0.5, 0.2 kg: the preset force holds"]["never"]
        self.assertEqual(holds["dropped"], 0)
        self.assertGreater(holds["greatest_force_ratio"], 1.0)

    def test_unknown_rows_get_the_nearest(self):
        with self.assertRaisesRegex(InputError, "grasp_gru"):
            grasp_loop.study(Options(only=("grasp_gro",)))

    def test_figures_are_of_the_boxes_that_were_held(self):
        lift = {
            "dropped": False,
            "lifted": True,
            "slip_translation_m": 2e-3,
            "max_grip_force_N": 6.0,
            "final_grip_force_N": 5.0,
            "ideal_grip_force_N": 4.0,
        }
        lifts = [
            grasp_loop.lift_of(lift | more)
            for more in ({}, {"slip_translation_m": 4e-3}, {"dropped": True}, {"lifted": False})
        ]
        self.assertEqual(
            grasp_loop.figures_of(lifts),
            {
                "dropped": 2,
                "trials": 4,
                "slip_mm": 3.0,
                "greatest_force_ratio": 1.5,
                "last_force_ratio": 1.25,
            },
        )
        none = grasp_loop.figures_of(lifts[2:])
        self.assertTrue(math.isnan(none["slip_mm"]))
        [row] = grasp_loop.table_of("box", {"row": grasp_loop.Loop("Row", {})}, {"row": none}).rows
        self.assertEqual(
            row, ["Row", "2 of 2", "16 to 100 %", "-", "-", "-"]
        )  # 0.025^(1/2) = 0.158


def row(kind, value, slipping=10):
    return {
        "kind": kind,
        "score": {"value": value, "low": value - 0.25, "high": None},
        "false_alarms_per_minute": 1.25,
        "figures": {
            "early": 1,
            "slipping": slipping,
            "figures": {"delay_median_s": {"value": 0.05}},
        },
    }


BOARD = {
    "sets": [
        {"track": "closed loop", "rows": [row("given", 0.9)]},
        {"domain": "outside", "rows": [row("shipped", 0.8), row("given", 0.25)]},
        {"domain": "inside", "rows": [row("given", 0.5)]},
    ]
}


class Scaling(unittest.TestCase):
    def test_unknown_sensors_get_the_nearest(self):
        with self.assertRaisesRegex(InputError, "papillarray"):
            scaling.study(Options(only=("papilarray",)))

    def test_full_adds_trials_and_factors(self):
        self.assertEqual(
            [task.trials for task in scaling.tasks_of(["papillarray"], Options())],
            [100, 300, 1000, 3000],
        )
        self.assertEqual(
            [
                task.trials
                for task in scaling.tasks_of(["papillarray", "piezo_skin"], Options(trials=96))
            ],
            [96, 96],
        )
        full = scaling.tasks_of(["piezo_skin"], Options(full=True))
        self.assertEqual(
            [task.trials for task in full], [100, 300, 1000, 3000, 10_000, 30_000, *[1000] * 6]
        )
        self.assertEqual([task.without.name for task in full[6:8]], ["friction", "load"])
        self.assertEqual(full[7].without.overrides, {"sweep.motion.compression": "[0.2 mm]"})

    # With one draw a scene's sweep has one trial per cell of its grid, so its trials are the stated
    # cells.
    def test_factors_are_of_their_scenes(self):
        for subject in scaling.SUBJECTS.values():
            self.assertEqual(scaling.Cell("", subject.scene).load().trials(1), subject.cells)
            for factor in subject.factors:
                self.assertEqual(
                    scaling.Cell("", subject.scene, factor.overrides).load().trials(1),
                    factor.cells or subject.cells,
                    factor.name,
                )

    def test_the_board_is_read_by_domain(self):
        found = scaling.figures_of(BOARD)
        self.assertEqual(
            found,
            {
                "inside": [50.0, 25.0, None],
                "outside": [25.0, 0.0, None],
                "delay_median_s": 0.05,
                "early": 0.1,
                "false_alarms_per_minute": 1.25,
            },
        )
        with self.assertRaisesRegex(InputError, "recordings inside"):
            scaling.figures_of({"sets": BOARD["sets"][:2]})

    def test_tables_tell_counts_from_factors(self):
        result = Result("", "", {})
        tasks = [
            *scaling.tasks_of(["papillarray"], Options())[:2],
            scaling.Task("papillarray", scaling.SUBJECTS["papillarray"].factors[0], 1000),
            scaling.Task("piezo_skin", None, 100),
        ]
        scaling.add_subject(
            result,
            "papillarray",
            tasks,
            [{"trials": trials} | scaling.figures_of(BOARD) for trials in (96, 288, 984, 95)],
        )
        counts, factors = result.tables
        self.assertEqual([one[0] for one in counts.rows], ["96", "288"])
        self.assertEqual(
            factors.rows,
            [["friction", "50.0", "25.0 to nan", "50 ms", "10 %", "1.2", "25.0", "0.0 to nan"]],
        )
        self.assertEqual(
            [one["without"] for one in result.figures["papillarray"]], [None, None, "friction"]
        )
        self.assertEqual(result.charts[0].places, ["96", "288"])
        self.assertEqual(result.charts[0].curves[1].points[0][:2], (25.0, 0.0))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
