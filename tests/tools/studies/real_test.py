"""The study `real`: thresholds and steady labels on known answers, and the study on invented recordings.

Argument: the program, which is not used.
"""

import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from slipbench import InputError, RandomStream
from slipbench_studies.real import HEAD, reason_of, study
from slipbench_studies.real.answers import (
    GROSS,
    NO_CONTACT,
    NON_SLIP,
    UNKNOWN,
    Answer,
    at_threshold,
    best_threshold,
    left_out,
    steady,
    summary,
)
from slipbench_studies.result import Options


def answer(labels, probability, rate=10.0, trial=0):
    """An answer that never reports slip."""
    time = np.arange(len(labels)) / rate
    return Answer(
        trial,
        time,
        np.array(labels, dtype=np.uint8),
        np.full(len(labels), NON_SLIP, np.uint8),
        time,
        np.array(probability, dtype=float),
    )


class Thresholds(unittest.TestCase):
    def test_greatest_balanced_accuracy(self):
        # From .6 on: both slips of 3, and none of the holds .1, .2: (2/3 + 1)/2. From .15 on: all slips, and one
        # of the two holds: (1 + 1/2)/2, which is less. The middle of .6 and the next value, .2, is .4.
        one = answer([1, 1, 3, 3, 3, UNKNOWN], [0.1, 0.2, 0.15, 0.6, 0.9, 0.99])
        self.assertAlmostEqual(best_threshold([one]), 0.4, 12)
        self.assertEqual(at_threshold(one, 0.4).seen.tolist(), [1, 1, 1, 3, 3, 3])
        self.assertTrue(math.isnan(best_threshold([answer([1, 1], [0.1, 0.2])])), "no slip")
        # Samples without an estimate are no slip, and choose nothing.
        late = answer([3, 1, 3], [math.nan, 0.1, 0.5])
        self.assertAlmostEqual(best_threshold([late]), 0.3, 12)
        self.assertEqual(at_threshold(late, 0.3).seen.tolist(), [NO_CONTACT, NON_SLIP, GROSS])

    def test_equal_values_have_one_side(self):
        # Two slips and a hold share .5: a threshold between them does not exist. From .5 on: (1 + 1/2)/2 = .75;
        # from above .5 on: nothing, .5.
        self.assertAlmostEqual(
            best_threshold([answer([3, 1, 3, 1], [0.5, 0.5, 0.5, 0.1])]), 0.3, 12
        )

    def test_the_threshold_is_of_the_others(self):
        # a: slip above .5; b: slip above .05. Each is judged by the middle of the other's values.
        a, b = answer([1, 3], [0.4, 0.6]), answer([1, 3], [0.04, 0.06], trial=1)
        chosen, thresholds = left_out([a, b], ["a", "b"])
        np.testing.assert_allclose(thresholds, [0.05, 0.5], atol=1e-12)
        self.assertEqual([one.seen.tolist() for one in chosen], [[3, 3], [1, 1]])
        alone, none = left_out([a], ["a"])
        self.assertEqual(alone, [])
        self.assertTrue(math.isnan(none[0]))

    def test_steady_labels_have_held_for_half_a_second(self):
        # At 10 Hz: five steps after the label began.
        one = steady(answer([1] * 7 + [3] * 6 + [UNKNOWN], [0.0] * 14))
        self.assertEqual(one.labels.tolist(), [4, 4, 4, 4, 4, 1, 1, 4, 4, 4, 4, 4, 3, 4])

    def test_figures_are_those_of_eval(self):
        # Three of four pairs of slip and hold are in order. At .5: one of two slips, both holds. One report, from 0.1 s on, in
        # 0.2 s of hold; it begins in the slip.
        one = at_threshold(answer([1, 3, 3, 1], [0.3, 0.6, 0.2, 0.1]), 0.5)
        found = summary([one], ["r0"])
        self.assertEqual(found["figures"]["auc"]["value"], 0.75)
        self.assertEqual(found["figures"]["balanced_slip_accuracy"]["value"], 0.75)
        self.assertEqual(
            (
                found["slips"],
                found["slips_found"],
                found["figures"]["false_alarms_per_minute"]["value"],
            ),
            (1, 1, 0.0),
        )

    def test_recordings_of_a_group_are_one_experiment(self):
        # Twelve fingers of six recordings: fewer than ten groups have no bootstrap interval.
        many = [answer([1, 3], [0.4, 0.6], trial=k) for k in range(12)]
        self.assertIsNone(
            summary(many, [f"r{k // 2}" for k in range(12)])["figures"]["recall_of_slip"]["low"]
        )
        self.assertIsNotNone(
            summary(many, [f"r{k}" for k in range(12)])["figures"]["recall_of_slip"]["low"]
        )

    def test_reasons_name_no_temporary_file(self):
        self.assertEqual(
            reason_of(
                "/tmp/x/a.h5: trial 0: detector.model: /net.onnx: the network needs 100 Hz",
                "/net.onnx",
            ),
            "the network needs 100 Hz",
        )


def write_directions(folder):
    """BioTacSP-DoS: noise of 2 counts in t, of 20 counts in n; two objects, two recordings of each class."""
    for name, sd in (("n", 20.0), ("t", 2.0)):
        (folder / "csvs" / name).mkdir(parents=True)
        for number, thing in enumerate(("pen", "pen", "sponge", "sponge")):
            noise = RandomStream(1, number, name)
            rows = [[round(3000.0 + sd * noise.normal()) for _ in range(24)] for _ in range(150)]
            text = (
                ",".join(f"ff_e{k}" for k in range(1, 25))
                + "\n"
                + "".join(",".join(map(str, row)) + "\n" for row in rows)
            )
            (folder / "csvs" / name / f"{thing}{number}.csv").write_text(text, encoding="utf-8")


def write_boxes(folder, gap=0.0):
    """Two recordings of two fingers at 40 Hz: 0.5 s unknown, 1.5 s of a still hold, with a longer step by gap [s], 1.5 s of slip with noise."""
    folder.mkdir()
    (folder / "recordings.csv").write_text("recording,object\n0,11\n1,7\n", encoding="utf-8")
    for recording in range(2):
        for finger in (1, 2):
            noise = RandomStream(1, 2 * recording + finger, "boxes")
            lines = [",".join(["t", *(f"{axis}{k}" for k in range(16) for axis in "xyz"), "state"])]
            for row in range(140):
                state = "unknown" if row < 20 else "hold" if row < 80 else "slip"
                sway = [20.0 * noise.normal() if state == "slip" else 0.0 for _ in range(32)]
                values = [
                    f"{value:.2f}"
                    for k in range(16)
                    for value in (sway[2 * k], sway[2 * k + 1], 500.0)
                ]
                lines.append(
                    ",".join([f"{row / 40 + (gap if row >= 40 else 0.0)}", *values, state])
                )
            (folder / f"r{recording:02d}_finger{finger}.csv").write_text(
                "\n".join(lines) + "\n", encoding="utf-8"
            )


def write_fabric(folder):
    folder.mkdir()
    titles = ", ".join(
        ["timestamp", "proximity1", "proximity2", *(f"channel{k}" for k in range(1, 17))]
    )
    text = (
        titles
        + "\n"
        + "".join(
            ",".join(map(str, [28 * row, 284, 48215, *range(100, 116)])) + "\n" for row in range(60)
        )
    )
    (folder / "Board10mm_F120_V-5mmps_0.csv").write_text(text, encoding="utf-8")


def write_bag(folder):
    """A bag with two arrays of Weiss, 40 messages at 20 Hz, whose cells do not change."""
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(
        get_types_from_msg(
            "uint32 matrix_id\nint16 cells_x\nint16 cells_y\nint16[] tactile_array\n",
            "schunk_sdh/msg/TactileMatrix",
        )
        | get_types_from_msg(
            "Header header\nschunk_sdh/TactileMatrix[] tactile_matrix\n",
            "schunk_sdh/msg/TactileSensor",
        )
    )
    names = (
        "schunk_sdh/msg/TactileMatrix",
        "schunk_sdh/msg/TactileSensor",
        "std_msgs/msg/Header",
        "builtin_interfaces/msg/Time",
    )
    matrix, sensor, header, stamp = (store.types[name] for name in names)
    folder.mkdir()
    with Writer(folder / "hand.bag") as writer:
        connection = writer.add_connection("/tactile", sensor.__msgtype__, typestore=store)
        for row in range(40):
            time = stamp(sec=5 + row // 20, nanosec=50_000_000 * (row % 20))
            cells = [
                matrix(matrix_id=k, cells_x=2, cells_y=3, tactile_array=np.full(6, 100, np.int16))
                for k in range(2)
            ]
            message = sensor(header=header(seq=row, stamp=time, frame_id=""), tactile_matrix=cells)
            writer.write(connection, 10**9 + row, store.serialize_ros1(message, sensor.__msgtype__))


class Study(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_invented_recordings(self):
        write_directions(self.folder / "dos")
        write_fabric(self.folder / "fabric")
        result = study(Options(recordings=str(self.folder)))
        found = result.figures["biotacsp-dos"]
        self.assertEqual((found["recordings"], found["objects"]), (8, ["pen", "sponge"]))
        deviation = found["detectors"]["deviation, chosen threshold"]
        # Standard deviations about 2 and 20 counts in any window: all pairs are in order, and any threshold in between is right.
        self.assertEqual(deviation["figures"]["auc"]["value"], 1.0)
        self.assertEqual((deviation["slips"], deviation["slips_found"]), (4, 4))
        self.assertEqual(deviation["figures"]["false_alarms_per_minute"]["value"], 0.0)
        self.assertEqual(len(deviation["thresholds"]), 2, "one for each object that is left out")
        for threshold in deviation["thresholds"]:
            self.assertTrue(2.5 < threshold < 19.0, threshold)
        # The first 49 of 150 samples have no estimate, so that 101 of 150 slipping samples are seen: (101/150 + 1)/2.
        self.assertAlmostEqual(
            deviation["figures"]["balanced_slip_accuracy"]["value"], 0.5 * (101 / 150 + 1.0), 12
        )
        # The default threshold, 6 counts, lies between 2 and 20 too. Each slip begins with its recording, so no delay is known.
        shipped = found["detectors"]["deviation"]
        self.assertEqual(
            (shipped["threshold"], shipped["thresholds"], shipped["slips_found"]), (6.0, [], 4)
        )
        self.assertIsNone(shipped["figures"]["slip_delay_median_s"]["value"])
        self.assertIn("pdc", found["detectors"]["biotac_grasp.onnx"]["failure"])
        self.assertIn("three axes", found["detectors"]["shear_ratio"]["failure"])
        # Nothing changes in the invented fabric.
        self.assertEqual(result.figures["fabric-slide"]["detectors"]["deviation"]["alarms"], 0)
        titles = [table.title for table in result.tables]
        for title in (
            "biotacsp-dos: 8 recordings",
            "biotacsp-dos: by object",
            "biotacsp-dos: not evaluated",
            "fabric-slide: 1 recording without labels",
            "Sets that were not found",
        ):
            self.assertIn(title, titles)
        [table] = [table for table in result.tables if table.title == "biotacsp-dos: 8 recordings"]
        self.assertEqual(table.head, HEAD)
        self.assertEqual({len(row) for row in table.rows}, {len(HEAD)})
        missing = [row[0] for row in result.tables[-1].rows]
        self.assertIn("uskin-boxes", missing)
        self.assertNotIn("biotacsp-dos", missing)
        json.dumps(result.figures)

    def test_a_set_with_one_class_has_shares_at_the_default_threshold(self):
        # Two recordings of 150 samples that all slip. deviation has a value from sample 49 on, about 2 in the one, below its threshold of 6, and
        # about 20 in the other: it finds one of two slips, in 101 of 300 samples.
        folder = self.folder / "slide"
        folder.mkdir()
        for number, sd in ((1, 2.0), (2, 20.0)):
            noise = RandomStream(1, number, "slide")
            titles = [
                "timestamp",
                "pdc",
                *(f"pac{k}" for k in range(1, 23)),
                *(f"ele{k}" for k in range(1, 20)),
            ]
            lines = [",".join(titles)] + [
                ",".join(
                    [
                        f"{row / 100}",
                        "2000",
                        *["2000"] * 22,
                        *(f"{round(3000 + sd * noise.normal())}" for _ in range(19)),
                    ]
                )
                for row in range(150)
            ]
            (folder / f"mat{number}_1_bio.csv").write_text(
                "\n".join(lines) + "\n", encoding="utf-8"
            )
        result = study(Options(recordings=str(self.folder)))
        found = result.figures["biotac-slide"]["detectors"]
        self.assertNotIn("deviation, chosen threshold", found)
        deviation = found["deviation"]
        self.assertEqual((deviation["slips"], deviation["slips_found"]), (2, 1))
        self.assertAlmostEqual(deviation["figures"]["recall_of_slip"]["value"], 101 / 300, 12)
        [table] = [
            table
            for table in result.tables
            if table.title == "biotac-slide: 2 recordings with one class"
        ]
        self.assertIn(["deviation", "50.0 % of 2", "33.7 %", "-", "-", "6, default"], table.rows)

    def test_only_some_sets(self):
        write_fabric(self.folder / "fabric")
        self.assertEqual(
            list(study(Options(recordings=str(self.folder), only=("fabric-slide",))).figures),
            ["fabric-slide"],
        )

    def test_fingers_boxes_and_rates(self):
        write_boxes(self.folder / "boxes")
        result = study(Options(recordings=str(self.folder)))
        found = result.figures["uskin-boxes"]
        self.assertEqual(
            (found["recordings"], found["objects"]),
            (2, ["11", "7"]),
            "two fingers are one recording",
        )
        deviation = found["detectors"]["deviation, chosen threshold"]
        # Half a second after its beginning, a window of 0.5 s is in the slip, where it deviates; before the slip nothing does.
        self.assertEqual(deviation["figures"]["auc_steady"]["value"], 1.0)
        self.assertEqual(deviation["slips"], 4)
        network = found["detectors"]["magnetic_skin_slip.onnx"]
        self.assertEqual(network["failure"], "")
        self.assertIn("from 40 Hz to 100 Hz", network["notice"])
        [table] = [table for table in result.tables if table.title == "uskin-boxes: 2 recordings"]
        self.assertIn(network["notice"], table.note)

    def test_a_long_gap_is_bridged_for_every_detector(self):
        write_boxes(self.folder / "boxes", gap=0.4)
        found = study(Options(recordings=str(self.folder))).figures["uskin-boxes"]["detectors"]
        for name in (
            "deviation",
            "relative_deviation",
            "shear_ratio",
            "sum_change",
            "magnetic_skin_slip.onnx",
        ):
            self.assertEqual(found[name]["failure"], "", name)
            self.assertIn("1 gap of at most 425 ms bridged", found[name]["notice"])
        self.assertEqual(found["deviation"]["figures"]["auc_steady"]["value"], 1.0)

    def test_every_sensor_of_a_bag(self):
        write_bag(self.folder / "bags")
        found = study(Options(recordings=str(self.folder))).figures
        self.assertEqual(list(found), ["weiss-bags"])
        deviation = found["weiss-bags"]["detectors"]["deviation"]
        self.assertEqual(deviation["alarms"], 0)
        self.assertAlmostEqual(deviation["minutes"], 2 * 39 / 20 / 60, 9)  # of two arrays

    def test_damaged_tables_of_boxes_are_refused(self):
        boxes = self.folder / "boxes"
        write_boxes(boxes)
        expected = "recordings.csv:2: expected the columns recording, a number, and object"
        for table, text in (
            ("rec,object\n0,11\n1,7\n", expected),
            ("recording;object\n0;11\n1;7\n", expected),
            ("recording\n0\n1\n", expected),
            ("recording,object\nzero,11\n1,7\n", expected),
            ("recording,object\n1,7\n", "has no row for recording 0, of r00_finger1.csv"),
        ):
            (boxes / "recordings.csv").write_text(table, encoding="utf-8")
            with (
                self.subTest(table),
                self.assertRaisesRegex(
                    InputError, f"{text}.*--only evaluates other sets than uskin-boxes"
                ),
            ):
                study(Options(recordings=str(self.folder)))

    def test_a_table_of_boxes_may_begin_with_a_mark(self):
        boxes = self.folder / "boxes"
        write_boxes(boxes)
        (boxes / "recordings.csv").write_text("recording,object\n0,11\n1,7\n", encoding="utf-8-sig")
        self.assertEqual(
            study(Options(recordings=str(self.folder))).figures["uskin-boxes"]["objects"],
            ["11", "7"],
        )

    def test_a_damaged_bag_is_named(self):
        write_fabric(self.folder / "fabric")
        (self.folder / "hand.bag").write_bytes(b"#ROSBAG V2.0\nabc")
        with self.assertRaisesRegex(InputError, "hand.bag.*repair the bag, or move it"):
            study(Options(recordings=str(self.folder)))

    def test_refusals(self):
        for options, text in (
            (Options(), "needs --recordings DIR"),
            (Options(recordings=str(self.folder / "none")), "expected a folder"),
            (Options(recordings=str(self.folder)), "contains no known set"),
            (
                Options(recordings=str(self.folder), only=("uskin",)),
                "--only uskin: expected sets of recordings: biotacsp-dos",
            ),
        ):
            with self.subTest(text), self.assertRaisesRegex(InputError, text):
                study(options)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
