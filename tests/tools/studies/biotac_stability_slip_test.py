"""The BioTac paper's tables: figures of answers by hand, training data, grasps and touches.

Grasps and touches are those of artificial trials, with the networks' inputs. Argument: the program,
which is not used.
"""

import math
import sys
import tempfile
import unittest
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import slipbench
from slipbench import InputError
from slipbench.learning import MASKED
from slipbench.learning.biotac import IMAGES, drawn_graph, pixels_of
from slipbench_studies.biotac_stability_slip import (
    fig12,
    grasps,
    stability,
    table1,
    table2,
    table3,
    touches,
    validation,
)
from slipbench_studies.biotac_stability_slip.grasps import Grasps
from slipbench_studies.biotac_stability_slip.touches import Touch, Window
from slipbench_studies.biotac_stability_slip.validation import (
    Answers,
    Examples,
    Network,
    RowsNetwork,
)
from slipbench_studies.result import Options

ELECTRODES = 24


def five():
    """Hold, hold, slip as 1, slip as 1, slip as 2; called 0, 1, 1, 0, 1."""
    return Answers(
        np.arange(5),
        np.array([0, 0, 1, 1, 2]),
        np.array([0, 1, 1, 0, 1]),
        np.array([0.1, 0.6, 0.9, 0.4, 0.7]),
    )


class Figures(unittest.TestCase):
    def test_answers_are_probabilities_and_classes(self):
        # Odds 1 : 2 : 1, so all classes but the first together have 3/4.
        [answer] = zip(
            *validation.answers_of(
                np.array([7]), np.array([2], np.uint8), np.log([[1.0, 2.0, 1.0]]).astype(np.float32)
            ),
            strict=True,
        )
        self.assertEqual(answer[:3], (7, 2, 1))
        self.assertAlmostEqual(answer[3], 0.75, delta=1e-6)

    def test_they_are_of_classes_and_of_slip(self):
        figures = validation.figures_of(five())
        self.assertAlmostEqual(figures["accuracy"], 2 / 5, delta=1e-12)
        self.assertAlmostEqual(figures["balanced_accuracy"], (1 / 2 + 1 / 2 + 0) / 3, delta=1e-12)
        self.assertAlmostEqual(
            figures["precision"], 2 / 3, delta=1e-12
        )  # of three called slip one holds; the kind of slip does not matter
        self.assertAlmostEqual(figures["recall"], 2 / 3, delta=1e-12)
        self.assertAlmostEqual(figures["f1"], 4 / 6, delta=1e-12)
        self.assertAlmostEqual(
            figures["auc"], 5 / 6, delta=1e-12
        )  # of six pairs only .4 against .6 is wrong
        none = five().chosen(np.zeros(5, bool))
        self.assertTrue(all(math.isnan(one) for one in validation.figures_of(none).values()))
        self.assertTrue(math.isnan(validation.figures_of(five().chosen(np.arange(1)))["auc"]))

    def test_scores_are_means_of_folds(self):
        # Examples 0 and 1 are fold 0: accuracy 1/2, no slip. The others: 1/3. Only 0 and 2: 1 and
        # 1.
        fold = np.array([0, 0, 1, 1, 1])
        scores = validation.scores_of(five(), fold)
        self.assertAlmostEqual(scores["accuracy"][0], 0.5 * (1 / 2 + 1 / 3), delta=1e-12)
        self.assertAlmostEqual(
            scores["recall"][0], 2 / 3, delta=1e-12
        )  # from the second fold alone
        self.assertTrue(math.isnan(scores["recall"][1]))
        some = validation.scores_of(five(), fold, np.array([True, False, True, False, False]))
        self.assertEqual(validation.cell(some["accuracy"]), "100.0 +- 0.0")
        self.assertEqual(validation.cell(scores["recall"]), "66.7")
        self.assertEqual(validation.cell((math.nan, math.nan)), "-")
        self.assertEqual(
            list(validation.figures_object(scores))[:4],
            ["accuracy", "accuracy_sd", "balanced_accuracy", "balanced_accuracy_sd"],
        )


class TrainedOn(unittest.TestCase):
    def test_networks_are_trained_on_what_they_are_told(self):
        # Two sets of +-1 that assign opposite classes to the sign: a network of the other set alone
        # is always wrong. Together there are five times as many of the other set.
        def signs(count, turned):
            positive = np.arange(count) % 2 == 0
            label = (positive != turned).astype(np.uint8)
            value = np.where(positive, 1, -1).astype(np.float32).reshape(-1, 1, 1)
            return Examples(value, label, np.arange(count) // 2 % 2)

        judged, other = signs(8, False), signs(40, True)
        validations = validation.Validations(Options(jobs=2))
        network = Network("lr", "lr", partial(RowsNetwork, 1, 2), 2000, 2)
        numbers = [
            validations.queue(network, judged, own=own, other=one)
            for own, one in ((True, None), (False, other), (True, other))
        ]
        validations.run("biotac-stability-slip/table2")
        self.assertEqual(
            [validation.figures_of(validations.answers(number))["accuracy"] for number in numbers],
            [1.0, 0.0, 0.0],
        )
        for number in numbers:
            self.assertEqual(validations.answers(number).example.tolist(), list(range(8)))

    def test_folds_keep_an_object_together(self):
        objects = ["a", "b", "a", "c", "b"]
        fold = validation.folds_by_object(objects, 3, 1)
        self.assertEqual(fold[0], fold[2])
        self.assertEqual(fold[1], fold[4])
        self.assertEqual(sorted(fold[[0, 1, 3]].tolist()), [0, 1, 2])
        with self.assertRaisesRegex(InputError, "3 objects are too few for 4 folds"):
            validation.folds_by_object(objects, 4, 1)
        with self.assertRaisesRegex(InputError, "1 object is too few for 2 folds"):
            validation.folds_by_object(["a"], 1, 1)

    def test_a_network_sees_all_rows_of_a_window(self):
        # 3 rows of 2 values: 6 weights and a bias per class; two answers to four rows.
        from torch import zeros

        network = RowsNetwork(2, 7, 3)
        self.assertEqual(sum(one.numel() for one in network.parameters()), 7 * (6 + 1))
        self.assertEqual(tuple(network(zeros(1, 4, 2)).shape), (1, 2, 7))
        hidden = RowsNetwork(2, 7, 3, 128)
        self.assertEqual(
            sum(one.numel() for one in hidden.parameters()), 128 * (6 + 1) + 2 * 128 + 7 * (128 + 1)
        )


class Refusals(unittest.TestCase):
    def test_what_cannot_be_is_refused(self):
        for table in (table1, fig12, table2, table3):
            with self.assertRaisesRegex(InputError, "--trials.*use --data without --trials"):
                table.study(Options(data="a.h5", trials=3))
            with self.assertRaisesRegex(InputError, "nowhere.h5"):
                table.study(Options(real="nowhere.h5"))
        with self.assertRaisesRegex(InputError, "did you mean 'lstm_2'"):
            table3.study(Options(only=("lstm2",)))


def three_fingers(params, rows, outcome=None):
    """Row r of finger f reads 1000 f + 100 r + e."""
    reading = 100.0 * np.arange(rows)[:, None] + np.arange(ELECTRODES)
    sensors = {}
    for f, name in enumerate(grasps.FINGERS):
        channels = {"electrodes": (1000.0 * f + reading).astype(np.float32)}
        sensors[name] = SimpleNamespace(
            type="biotac_sp", t=0.01 * np.arange(rows), channels=channels
        )
    return SimpleNamespace(trial=4, params=params, outcome=outcome or {}, sensors=sensors)


class GraspsOfTrials(unittest.TestCase):
    def test_an_imported_one_is_what_it_says(self):
        grasp = grasps.grasp_of(
            three_fingers({"object": "can", "palm": "side", "slipped": True}, 1)
        )
        self.assertIn("can", grasp.object)
        self.assertEqual(grasps.PALMS[grasp.palm].text, "90")
        self.assertIs(grasp.slipped, True)
        self.assertEqual(grasp.counts.shape, (3, ELECTRODES))
        self.assertEqual(grasp.counts[1, 3], 1003.0)  # E4 of mf

    def test_a_simulated_one_is_the_last_row_before_the_lift(self):
        # Three rows, 0 to 20 ms; the lift begins at 15 ms, so the second row is the snapshot.
        grasp = grasps.grasp_of(
            three_fingers(
                {"model": "hand_45.xml", "bodies.object.shape": "box"},
                3,
                {"held": True, "hold_from_s": 0.015},
            )
        )
        self.assertEqual(grasps.PALMS[grasp.palm].text, "45")
        self.assertIs(grasp.slipped, False)
        self.assertEqual([grasp.counts[0, 0], grasp.counts[2, 23]], [100.0, 2123.0])

    def test_others_are_refused(self):
        two = three_fingers({"object": "can", "palm": "45", "slipped": True}, 1)
        del two.sensors["th"]
        for trial, message in (
            (three_fingers({"object": "can", "palm": "up", "slipped": True}, 1), "palm is 'up'"),
            (three_fingers({"model": "hand_45.xml", "bodies.object.shape": "box"}, 1), "held"),
            (three_fingers({"palm": "45", "slipped": True}, 1), "no object"),
            (two, "biotac_sp 'th'"),
        ):
            with self.assertRaisesRegex(InputError, f"trial 4: .*{message}"):
                grasps.grasp_of(trial)

    def test_they_are_levelled_by_palm(self):
        # Two counts 40 apart are sqrt(1/2) from their mean, in units of their deviation 40
        # sqrt(1/2); equal counts, and a single one, are at 0.
        counts = np.full((3, 3, ELECTRODES), 100.0, np.float32)
        counts[1, 2, 23] = 140.0
        some = Grasps(counts, np.array(["a", "b", "c"]), np.array([0, 0, 1]), np.zeros(3, bool))
        found = grasps.levelled(some).counts
        np.testing.assert_allclose(found[:2, 2, 23], [-math.sqrt(0.5), math.sqrt(0.5)], rtol=1e-6)
        self.assertEqual(found[1, 0, 0], 0.0)
        self.assertTrue((found[2] == 0.0).all())
        self.assertEqual(some.text(), "3 grasps of 3 objects, 0 % lost")
        self.assertEqual(
            len(table1.judged(Grasps(counts, some.objects, np.array([0, 1, 2]), some.slipped))), 2
        )  # the last palm is 45

    def test_they_are_shown_as_list_image_and_graph(self):
        # Electrode e of finger f is 24 f + e. A node has the three fingers' values; in D3 E1 is at
        # the end of the first row of 7, E11 at its beginning.
        counts = np.arange(72, dtype=np.float32).reshape(1, 3, ELECTRODES)
        self.assertEqual(grasps.as_list(counts)[0, 0].tolist(), list(range(72)))
        self.assertEqual(
            grasps.as_graph(counts)[0, 0, [3 * 5, 3 * 5 + 2]].tolist(), [5.0, 48.0 + 5.0]
        )
        image = grasps.as_image(counts, IMAGES["D3"])
        self.assertEqual(image.shape, (1, 1, 3 * 4 * 7))
        self.assertEqual(image[0, 0, [6, 0, 2 * 28 + 6]].tolist(), [0.0, 10.0, 48.0])

    def test_sets_are_divided_by_sample_and_by_object(self):
        some = Grasps(
            np.zeros((20, 3, ELECTRODES), np.float32),
            np.array([f"{k % 5}" for k in range(20)]),
            np.zeros(20, np.int64),
            np.arange(20) % 2 == 0,
        )
        by_object = stability.examples_of(some, stability.cnn("D3", 8), True, 1)
        self.assertEqual(by_object.features.shape, (20, 1, 3 * 28))
        self.assertEqual(by_object.label.tolist(), [1, 0] * 10)
        self.assertEqual([len(set(by_object.fold[k::5])) for k in range(5)], [1] * 5)
        by_sample = stability.examples_of(some, stability.plain_network(), False, 1)
        self.assertEqual(np.bincount(by_sample.fold).tolist(), [4] * 5)


class Pictures(unittest.TestCase):
    def test_images_are_symmetric(self):
        # E11 to E20 are E1 to E10 on the other side of the finger, E23 is E22; E21 and E24 are in
        # the middle.
        for name, layout in IMAGES.items():
            (_, columns), places = layout

            def mirrored(e, places=places, columns=columns):
                return places[e][0], columns - 1 - places[e][1]

            for e in range(10):
                self.assertEqual(mirrored(e), places[e + 10], f"{name} E{e + 1}")
            for e, other in ((21, 22), (20, 20), (23, 23)):
                self.assertEqual(mirrored(e), places[other], name)
            self.assertEqual(
                sum(len(pixel) == 1 for pixel in pixels_of(layout)), ELECTRODES, name
            )  # no two on a pixel, none outside

    def test_graphs_are_of_the_nearest_electrodes(self):
        # E2 is 3.1 mm from E1, E22 6.2, E3 8.3.
        one = grasps.graph_of(1)
        self.assertEqual(one[0, :2].tolist(), [0.5, 0.5])
        for k in (1, 4, 23):
            np.testing.assert_allclose(grasps.graph_of(k).sum(axis=1), 1.0, atol=1e-12)
        self.assertTrue((grasps.graph_of(23) == 1.0 / 24.0).all())
        self.assertEqual(grasps.graph_of(0).tolist(), drawn_graph().tolist())


def climbing():
    """Six rows, the first without contact. Every electrode rises by 2 per row."""
    return Touch(
        (10.0 + 2.0 * np.arange(6)).repeat(ELECTRODES).reshape(6, ELECTRODES).astype(np.float32),
        np.array([MASKED, 3, 3, 3, 3, 3], np.uint8),
        "a",
    )


class Windows(unittest.TestCase):
    def test_they_are_those_in_contact(self):
        features, labels = touches.windows_of(climbing(), Window(2, 1))
        self.assertEqual(labels.tolist(), [3] * 4)
        self.assertEqual([features[0, 0, 0], features[3, 1, 23]], [12.0, 20.0])
        self.assertEqual(
            len(touches.windows_of(climbing(), Window(2, 3))[1]), 1
        )  # the other begins without contact
        self.assertEqual(
            touches.windows_of(climbing(), Window(7, 1, figures="sorted"))[0].shape,
            (0, 1, ELECTRODES),
        )  # longer than the recording

    def test_without_the_site_they_have_no_mean(self):
        features, _ = touches.windows_of(climbing(), Window(3, 2, site=False))
        self.assertEqual(features[:, :, 0].tolist(), [[-2.0, 0.0, 2.0]])  # of rows 2 to 4

    def test_images_have_a_value_a_pixel(self):
        window = Window(2, 1, image="D3")
        features, _ = touches.windows_of(climbing(), window)
        self.assertEqual(features.shape, (4, *window.shape))
        self.assertTrue((features[0] == [[12.0], [14.0]]).all())

    def test_they_come_to_deviations_and_slopes(self):
        # 12, 14, 16, 18, 20: the squared deviations from 16 sum to 40, over 4 that is 10.
        whole = climbing()
        touch = Touch(whole.counts[1:].copy(), whole.label[1:], "a")
        touch.counts[:, 0] = 7.0  # E1 is constant
        [[figures]], _ = touches.windows_of(touch, Window(5, 5, figures="by_electrode"))
        self.assertEqual(len(figures), 2 * ELECTRODES)
        np.testing.assert_allclose(
            figures[[0, 1, ELECTRODES, ELECTRODES + 1]], [0.0, math.sqrt(10.0), 0.0, 2.0], rtol=1e-6
        )
        touch.counts[2, 4] += (
            1.0  # 17 in the middle: mean 16.2, squared deviations sum to 40 + .8^2 + 4 x .2^2 = 40.8
        )
        [[figures]], _ = touches.windows_of(touch, Window(5, 5, figures="sorted"))
        self.assertEqual(figures[0], 0.0)
        self.assertAlmostEqual(figures[-1], math.sqrt(10.2), delta=1e-6)
        self.assertEqual(len(figures), ELECTRODES)


class Imported(unittest.TestCase):
    def test_they_have_their_own_labels_and_are_no_synthetic_ones(self):
        # Two files of three rows of 24 electrodes.
        with tempfile.TemporaryDirectory() as folder:
            for name in ("n/case1.csv", "t/pen2.csv"):
                file = Path(folder) / "set" / name
                file.parent.mkdir(parents=True)
                rows = [
                    [f"ff_e{e}" for e in range(1, 25)],
                    *([str(100 * e + row) for e in range(1, 25)] for row in range(3)),
                ]
                file.write_text("".join(",".join(row) + "\n" for row in rows))
            out = str(Path(folder) / "out.h5")
            slipbench.import_recordings(Path(folder) / "set", out, format="biotacsp-dos")
            found = touches.read_touches(out, Options())
            self.assertEqual([one.label.tolist() for one in found], [[1, 1, 1], [0, 0, 0]])
            self.assertEqual(found[0].counts[2, 3], 402.0)
            for table in (table1, table3):
                with self.assertRaisesRegex(InputError, "out.h5.*--data.*biotacsp-dos.*--real"):
                    table.study(Options(data=out))
            with self.assertRaisesRegex(InputError, "out.h5: trial 0: its palm is ''"):
                grasps.read_grasps(out, Options())


class Rows(unittest.TestCase):
    def test_table_2_has_each_palm(self):
        # Palm 0: one of two is right; palm 90: one of two; palm 45: the only one is called another
        # slip.
        counts = np.zeros((5, 3, ELECTRODES), np.float32)
        some = Grasps(counts, np.array(list("abcde")), np.array([0, 0, 1, 1, 2]), np.zeros(5, bool))
        cells, figures = table2.palm_cells(
            five(), Examples(counts, np.zeros(5, np.uint8), np.zeros(5, np.int64)), some
        )
        self.assertEqual(cells, ["40.0", "50.0", "50.0", "0.0", "66.7", "66.7", "66.7", "83.3"])
        self.assertEqual(list(figures), ["all", "palm_0", "palm_90", "palm_45"])

    def test_table_2_has_figures_of_real_grasps(self):
        one = {"real": {"accuracy": 0.8, "auc": 0.9}, "synthetic_to_real": {"auc": 0.7}}
        found = table2.real_figures({"gcn": one, "cnn": one, "lr_by_palm": one})
        self.assertEqual(
            [(figure.real, figure.ours) for figure in found],
            [(75.5, 80.0), (76.5, 80.0), (0.9, 0.7), (0.9, 0.7), (0.9, 0.7)],
        )

    def test_those_of_table_3(self):
        rows = table3.all_networks(False)
        self.assertEqual(
            list(rows),
            [
                "lr",
                "mlp",
                "lstm",
                "lstm_longer",
                "lstm_2",
                "convlstm",
                "lstm_500",
                "lr_no_site",
                "mlp_no_site",
                "lstm_no_site",
                "convlstm_no_site",
                "lstm_500_no_site",
                "sd_trend_no_site",
                "sorted_sd_no_site",
            ],
        )
        self.assertEqual(
            [row.columns for row in rows.values()], [6, 6, 6, 1, 3, 3, 2, 6, 6, 3, 2, 3, 6, 6]
        )
        self.assertEqual(rows["convlstm"].window.shape, (5, 132))
        self.assertEqual(
            {row.columns for name, row in table3.all_networks(True).items() if "conv" in name}, {6}
        )
        figures = {
            "lr": {"real": {"auc": 0.5}, "synthetic_to_real": {"auc": 0.25}},
            "lstm_longer": {"real": {"auc": 0.5}},
        }
        self.assertEqual(
            [(one.real, one.ours) for one in table3.real_figures(figures)], [(0.5, 0.25)]
        )

    def test_networks_take_what_they_are_shown(self):
        from torch import zeros

        for name, row in (table3.all_networks(False) | table3.all_networks(True)).items():
            module = row.network.make()
            self.assertEqual(tuple(module(zeros(2, *row.window.shape)).shape), (2, 1, 7), name)
        for one in (
            stability.logistic_regression(),
            stability.plain_network(4),
            stability.cnn("D2", 8),
            stability.gcn(2, "k2", ""),
        ):
            frames = one.shown(np.zeros((4, 3, ELECTRODES), np.float32))
            self.assertEqual(
                tuple(one.network.make()(zeros(*frames.shape)).shape), (4, 1, 2), one.network.name
            )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
