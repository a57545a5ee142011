"""The hyperdimensional detector's tables II and III: figures of results made by hand, and the names that they take. Argument: the program, which is not
used.
"""

import sys
import unittest

from slipbench import InputError
from slipbench_studies.hd_papillarray import table3
from slipbench_studies.result import Options


def figure(value):
    return {"value": value, "low": None, "high": None}


# Ten trials: eight slip, of which five are seen, two early and one is missed; one of the two others has a false alarm.
GRU = {"all": {"trials": 10, "slipping": 8, "seen": 5, "early": 2, "missed": 1, "false_alarms": 1, "more": 0,
               "figures": {"balanced_slip_accuracy": figure(0.9), "auc": figure(0.95), "delay_median_s": figure(0.05), "delay_p10_s": figure(None),
                           "delay_p90_s": figure(0.1), "false_alarms_per_minute": figure(3.0)}}}


class Table3(unittest.TestCase):
    def test_figures_are_plain_counts_of_the_trials(self):
        figures = table3.gru_figures(GRU)
        self.assertEqual(table3.right_share(figures, False), 0.6)  # five seen, and one that is rightly quiet
        self.assertEqual(table3.right_share(figures, True), 0.8)
        self.assertEqual((figures["balanced_accuracy"], figures["delay_p10_s"], figures["delay_p90_s"]), (0.9, None, 0.1))

    def test_rows_are_as_long_as_their_heads(self):
        figures = table3.gru_figures(GRU) | {"learnt": 160, "kilobytes": 3825.4, "step_s": 45.4e-6}
        row = table3.ROWS["gru5_latched"]
        self.assertEqual(table3.frames_row(row, figures),
                         ["five GRUs averaged", "latched", "160", "90.0", "0.950", "60.0", "80.0", "3825", "45"])
        self.assertEqual(table3.events_row(row, figures),
                         ["five GRUs averaged, 160 learnt", "latched", "8", "5", "2", "1", "50", "- to 100", "1 of 2", "3.0"])
        self.assertEqual(len(table3.frames_table().head), 9)
        self.assertEqual({len(one) for one in table3.frames_table().rows}, {9})
        self.assertEqual(len(table3.events_table().head), 10)
        self.assertEqual(table3.decimals(None, 3, none="nan"), "nan")

    def test_unknown_rows_get_the_nearest(self):
        with self.assertRaisesRegex(InputError, "gru_latched"):
            table3.study(Options(only=("gru_latch",)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
