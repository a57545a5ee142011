"""The piezo paper's tables on artificial and simulated recordings.

Inputs, figures and alarms by hand.

Argument: the program, which is not used.
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
from slipbench import InputError, RandomStream
from slipbench.bin import _core
from slipbench.learning import MASKED, Training, find_recipe
from slipbench.learning import networks as published
from slipbench_studies.piezo_fft_gru import (
    SCENE,
    bench,
    delay,
    networks,
    table1,
    table2,
    table3,
    table4,
)
from slipbench_studies.piezo_fft_gru.bench import (
    PUBLISHED_SPECTRA,
    SIGNAL_AT_100_HZ,
    LabelledFrames,
    Recording,
)
from slipbench_studies.piezo_fft_gru.networks import MOTORS_ALONE, WITH_SLIP, Row, Size
from slipbench_studies.result import Options
from torch import nn

HOLD, SLIP = 0, 1


def recording(
    values=((1.0,), (2.0,), (3.0,)), true=(0, 0, 1), position=(0, 1, 1), motors_only=False, **more
):
    """Frames of one value, of which the last slips; by the position the second slips, too."""
    count = len(values)
    frames = LabelledFrames(
        np.array(values, np.float32),
        {"paper": np.array(position, np.uint8), "micro": np.array(true, np.uint8)},
    )
    plain = {
        "level": 2.0,
        "tip": "",
        "slip_time": math.nan,
        "label_time": math.nan,
        "time": 0.02 + 0.01 * np.arange(count),
        "contact": np.arange(count) > 0,
        "motors": np.array([0.5, 0.0, 0.25] * count, np.float32)[:count],
    }
    return Recording(motors_only=motors_only, inputs=[frames], **{**plain, **more})


def per_frame(inputs, classes):
    return nn.Linear(inputs, classes)


def row(network=per_frame, **more):
    return Row("one", "one", network, **more)


class PaddedRecordings(unittest.TestCase):
    def one(self, row, rule):
        [found] = networks.padded([recording()], row, rule)
        return found.features.tolist(), found.labels.tolist()

    def test_of_one_frame_are_the_frames(self):
        self.assertEqual(self.one(row(), "paper"), ([[1], [2], [3]], [0, 1, 1]))

    def test_look_back_to_the_first_frame(self):
        # A kernel of 3 looks back to 2 frames before the first.
        convolution = row(partial(published.PiezoTcn, channels=1, kernel=3, layers=1))
        self.assertEqual(
            self.one(convolution, "micro"), ([[1], [1], [1], [2], [3]], [MASKED, MASKED, 0, 0, 1])
        )

    def test_that_have_seen_later_frames_judge_earlier_ones(self):
        # A kernel of three frames, one of them later: each answer is for the middle frame. So the
        # answer after frame k is at k + 2, with the label of k - 1.
        later = row(partial(published.PiezoTcn, channels=1, kernel=3, layers=1), later=1)
        self.assertEqual(
            self.one(later, "micro"), ([[1], [1], [2], [3], [3]], [MASKED, MASKED, 0, 0, 1])
        )

    def test_of_a_shortcut_are_what_it_is_told(self):
        features, labels = self.one(row(shortcuts=("time", "contact", "motors", "kind")), "micro")
        np.testing.assert_allclose(
            features, [[0.02, 0, 0.5, 0], [0.03, 1, 0, 0], [0.04, 1, 0.25, 0]], rtol=1e-6
        )
        self.assertEqual(labels, [0, 0, 1])


class Figures(unittest.TestCase):
    # Two folds. With contact: all right, and half of each right. Motors: 3 of 4 and 1 of 4 frames
    # right. All, fold 1: slip 1/1, hold (1 + 3)/5 = 0.8; 90 %. Fold 2: slip 1/2, hold (1 + 1)/6;
    # 41.7 %. [fold, group, true, called]
    counts = np.array([[[[1, 0], [0, 1]], [[3, 1], [0, 0]]], [[[1, 1], [1, 1]], [[1, 3], [0, 0]]]])

    def test_they_are_means_of_folds(self):
        on_slip, on_all = networks.on_slip(self.counts), networks.on_all(self.counts)
        self.assertAlmostEqual(on_slip.accuracy[0], 75.0)
        self.assertAlmostEqual(
            on_slip.accuracy[1], 50.0 / math.sqrt(2.0)
        )  # of two: their distance over the root of 2
        self.assertAlmostEqual(on_slip.f1[0], 0.75)  # 1, and 2/(2 + 1 + 1)
        self.assertAlmostEqual(
            on_all.accuracy[0], 0.5 * (90.0 + 100.0 * 0.5 * (1.0 / 2.0 + 2.0 / 6.0))
        )
        self.assertAlmostEqual(networks.motors_right(self.counts)[0], 50.0)
        self.assertEqual(on_slip.cell(), "75.0 +- 35.4, 0.750")
        self.assertEqual(networks.on_slip(self.counts[:1]).cell(), "100.0, 1.000")
        self.assertEqual(networks.figures_of(self.counts)["motors_right"], 0.5)

    def test_there_is_none_without_frames_of_a_class(self):
        empty = networks.on_slip(np.zeros_like(self.counts))
        self.assertEqual((empty.cell(), networks.cell(empty.accuracy)), ("-", "-"))


class Sizes(unittest.TestCase):
    def test_the_papers_has_200_epochs(self):
        # 3,200 recordings: a fifth is for judging, a fifth of the others for validation; 2,048 are
        # 64 steps of 32 clips.
        full = Size(3200, True)
        training = full.training(networks.GRU_32)
        self.assertEqual(
            (training.steps, training.validate_every, training.batch, training.clip),
            (200 * 64, 64, 32, 128),
        )
        self.assertEqual((training.optimiser, training.learning_rate), ("rmsprop", 8e-4))
        self.assertAlmostEqual(full.validated, 0.2)

    def test_the_usual_one_is_the_recipes(self):
        usual = Size(200, False)
        self.assertEqual(usual.training(networks.MLP_32), find_recipe("piezo_mlp").training)
        self.assertEqual(usual.validated, 0.0)

    def test_architectures_have_the_parameters_that_are_printed(self):
        # MLP 32: 12 x 32 + 32, three times 32 x 32 + 32, 32 x 2 + 2. GRU: three gates of (inputs +
        # 32) x 32 and two biases of 32 each, four times.
        self.assertEqual(networks.MLP_32.parameters(12), 416 + 3 * 1056 + 66)
        self.assertEqual(
            networks.GRU_32.parameters(12), 3 * (44 * 32 + 64) + 3 * 3 * (64 * 32 + 64) + 66
        )
        self.assertEqual(
            set(table1.network_rows(True)) - set(table1.network_rows(False)),
            {"gru_128", "tcn_128_1", "tcn_128_32", "tcn_128_32_later"},
        )


def many():
    """Ten recordings with slip and ten without, of 40 frames.

    Slipping frames are greater by 1 than holding ones, with noise of that size.
    """
    random = RandomStream(1, 0, "recordings")
    made = []
    for number in range(20):
        slips = [number % 2 == 1 and frame > 20 for frame in range(40)]
        made.append(
            recording(
                [[random.normal(float(one), 1.0)] for one in slips], slips, slips, number % 2 == 0
            )
        )
    return made


class Validations(unittest.TestCase):
    # A network's answers depend on every bit of its weights if frames are near the threshold; here
    # a third of them are.
    def calls(self, jobs, full=False, slip_alone=False):
        training = Training(steps=30, batch=8, clip=16, learning_rate=3e-3)
        gru = row(partial(published.PiezoGru, units=8, layers=1), training=training)
        recordings = many()
        validations = networks.Validations(Options(jobs=jobs), Size(len(recordings), full))
        number = validations.queue_folds(recordings, gru, "paper", slip_alone)
        validations.run("piezo-fft-gru/table1")
        counts = validations.counts(number)
        self.assertEqual(counts.shape, (5, 2, 2, 2))
        self.assertEqual(counts[:, MOTORS_ALONE].sum(axis=0).tolist()[SLIP], [0, 0])
        self.assertEqual(counts[:, WITH_SLIP, SLIP].sum(), 10 * 19)  # frames 21 to 39
        self.assertEqual(counts.sum(), 20 * 40)
        return [one.tolist() for one in validations.calls(number)]

    def test_they_do_not_depend_on_the_jobs(self):
        alone = self.calls(1)
        self.assertEqual([len(one) for one in alone], [40] * 20)
        self.assertEqual(self.calls(3), alone)

    def test_networks_that_know_no_motors_call_other_frames(self):
        self.assertNotEqual(self.calls(2, slip_alone=True), self.calls(2))


class Refusals(unittest.TestCase):
    def test_what_makes_no_folds(self):
        for table in (table1, table2, table3, table4, delay):
            with self.assertRaisesRegex(InputError, "--trials 9: .*even numbers, 10 or more"):
                table.study(Options(trials=9))
            with self.assertRaisesRegex(InputError, "--trials applies to simulated recordings"):
                table.study(Options(trials=10, data="a.h5"))

    def test_names_that_are_not_there(self):
        for table in (table1, table4):
            with self.assertRaisesRegex(InputError, "did you mean 'gru_32'"):
                table.study(Options(only=("gru_23",)))
        with self.assertRaisesRegex(InputError, "gru_32_tip needs its own recordings"):
            table4.study(Options(only=("gru_32_tip",), data="a.h5"))


def skin_trial(slips, params, **more):
    """400 samples of a skin at 10 kHz, three frames.

    With slip it is in contact, and slips from sample 250 on; by the position from 350 on.
    """
    number = np.arange(400)
    touches = np.full(400, int(slips), np.uint8)
    labels = SimpleNamespace(
        state=touches,
        state_micro=np.where(slips & (number >= 250), 3, touches),
        state_paper=np.where(slips & (number >= 350), 3, touches),
        micro_onset_time=np.array([0.025, math.nan] if slips else [math.nan] * 2),
    )
    sensor = SimpleNamespace(
        type="piezo_skin",
        rate=10e3,
        t=1e-4 * number,
        channels={"signal": np.linspace(0.0, 5.0, 400, dtype=np.float32)[:, None]},
    )
    return SimpleNamespace(
        trial=2,
        params=params,
        sensors={"pad": sensor},
        labels={"pad": labels},
        **{"bodies": {}, **more},
    )


class Recordings(unittest.TestCase):
    def test_they_say_what_was_swept_and_what_slips(self):
        swept = {
            "motion.vibration": 0.5,
            "friction.static": 0.9,
            "motion.speed": 0.01,
            "effects": ["asperities", {"roughness": 3e-6}],
        }
        one = bench.recording_of(skin_trial(True, swept), [PUBLISHED_SPECTRA, SIGNAL_AT_100_HZ])
        self.assertEqual(one.level, 0.5)
        self.assertEqual(one.tip, 'friction.static=0.9 effects=["asperities",{"roughness":3e-06}]')
        self.assertFalse(one.motors_only)
        spectra, signal = one.inputs
        self.assertEqual(
            spectra.labels["micro"].tolist(), [0, 1, 1]
        )  # frames end with samples 199, 299, 399
        self.assertEqual(spectra.labels["paper"].tolist(), [0, 0, 1])
        self.assertEqual(spectra.features.shape, (3, 12))
        self.assertEqual(signal.labels["micro"].tolist(), [0, 0, 0, 1])  # samples 0, 100, 200, 300
        self.assertEqual(signal.features.shape, (4, 1))
        np.testing.assert_allclose(one.time, [0.0199, 0.0299, 0.0399], rtol=1e-12)
        self.assertEqual(one.contact.tolist(), [1, 1, 1])
        self.assertEqual(one.slip_time, 0.025)
        self.assertAlmostEqual(one.label_time, 0.035)

    def test_motors_alone_touch_nothing(self):
        one = bench.recording_of(
            skin_trial(False, {}), [PUBLISHED_SPECTRA, bench.spectra_of(0, 5000)]
        )
        self.assertTrue(
            math.isnan(one.level) and math.isnan(one.slip_time) and math.isnan(one.label_time)
        )
        self.assertEqual((one.tip, one.motors_only, one.contact.tolist()), ("", True, [0, 0, 0]))
        self.assertEqual(one.inputs[1].features.shape, (3, 101))  # 0 to 5 kHz by 50 Hz

    def test_they_say_which_motors_run(self):
        # The bench moves by 3 mm/s along the surface and 1 mm/s along the normal; from 0.03 s on an
        # idle motor of 20 mm/s runs, too.
        body = SimpleNamespace(
            t=1e-4 * np.arange(400),
            velocity=np.tile(np.array([-3e-3, 0, 1e-3, 9, 9, 9], np.float32), (400, 1)),
        )
        trial = skin_trial(
            True, {"motion.idle_speed": 0.02, "motion.idle_start": 0.03}, bodies={"pad": body}
        )
        np.testing.assert_allclose(
            bench.recording_of(trial, [PUBLISHED_SPECTRA]).motors, [4e-3, 4e-3, 24e-3], atol=1e-8
        )

    def test_other_sensors_are_refused(self):
        trial = skin_trial(True, {})
        trial.sensors["pad"].type = "myrmex"
        with self.assertRaisesRegex(InputError, "trial 2: .*piezo_skin.*myrmex"):
            bench.recording_of(trial, [PUBLISHED_SPECTRA])
        imported = skin_trial(True, {})
        del imported.labels["pad"].state_micro
        with self.assertRaisesRegex(InputError, "pad has no labels micro"):
            bench.recording_of(imported, [PUBLISHED_SPECTRA])

    def test_frames_and_labels_are_those_of_training(self):
        # `slipbench train` makes its examples by example_of(), also for a dataset's trials.
        scene = slipbench.Scene.load(SCENE.removeprefix("scenes/"))
        inputs = [PUBLISHED_SPECTRA, SIGNAL_AT_100_HZ]
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "piezo.h5")
            scene.write(path, draws=1)
            stored = bench.read_recordings(path, inputs)
        trials = list(scene.sweep(draws=1))
        self.assertEqual(len(stored), len(trials))
        for one, trial in zip(stored, trials, strict=True):
            for frames, made in zip(inputs, one.inputs, strict=True):
                for rule, labels in made.labels.items():
                    example = _core.example_of(
                        trial._simulated, "pad", frames.text(), rule, "slip", 0
                    )
                    np.testing.assert_array_equal(made.features, example["features"])
                    np.testing.assert_array_equal(labels, example["labels"])
                    if rule == "micro":
                        np.testing.assert_equal(one.slip_time, example["onset"])
            self.assertEqual(one.motors_only, not one.contact.any())
        with self.assertRaisesRegex(InputError, "recordings with contact are too few for 5 folds"):
            networks.recordings_for(Options(seed=1), Size(2, False), [2.0], inputs)

    def test_other_motors_run_only_where_they_are_asked_for(self):
        # At 0.89 s the tip is at rest: it is pressed by then (0.6 mm at 0.7 mm/s), and slides from
        # 0.9 s on or later. Any running motor is another one.
        def running(others_too):
            found = [
                one
                for one in bench.run_recordings(
                    [2.0], 30, [SIGNAL_AT_100_HZ], Options(seed=1), others_too
                )
                if not one.motors_only
            ]
            self.assertEqual(len(found), 15)
            return sum(one.motors[np.searchsorted(one.time, 0.89) - 1] > 0.0 for one in found)

        self.assertEqual(running(False), 0)
        self.assertGreater(running(True), 0)


TIME = 0.01 * np.arange(1, 7)  # s


class AlarmDelay(unittest.TestCase):
    def test_it_is_of_the_alarm_that_is_on_or_of_the_next(self):
        for called, onset, expected in (
            ((1, 0, 0, 0, 1, 1), 0.025, 0.025),  # the alarm of 0.01 has ended
            ((0, 1, 1, 1, 0, 1), 0.042, -0.022),  # on since 0.02
            ((1, 1, 1, 1, 0, 1), 0.042, -0.032),  # on since the first frame
            ((0, 0, 0, 1, 0, 0), 0.04, 0.0),
            ((0, 1, 0, 0, 0, 0), 0.001, 0.019),  # no frame is complete yet
        ):
            self.assertAlmostEqual(delay.alarm_delay(TIME, called, onset), expected, delta=1e-12)
        self.assertTrue(math.isnan(delay.alarm_delay(TIME, (1, 1, 0, 0, 0, 0), 0.03)))
        self.assertTrue(math.isnan(delay.alarm_delay(TIME, (0, 0, 0, 0, 0, 0), 0.03)))

    def test_alarms_are_counted_by_both_rules(self):
        alarms = delay.Alarms()
        alarms.add(TIME, (1, 0, 0, 0, 1, 1), 0.025)  # early by its first alarm, 25 ms by the next
        alarms.add(TIME, (0, 0, 0, 1, 1, 1), 0.025)  # 15 ms by both
        alarms.add(TIME, (0, 0, 0, 0, 0, 0), 0.025)  # missed, silent
        alarms.add(TIME, (0, 0, 1, 0, 0, 0), math.nan)  # a false alarm
        alarms.add(TIME, (0, 0, 0, 0, 0, 0), math.nan)
        self.assertEqual(
            (
                alarms.early,
                alarms.missed,
                alarms.silent,
                alarms.false_alarms,
                alarms.slipping,
                alarms.recordings,
            ),
            (1, 1, 1, 1, 3, 5),
        )
        np.testing.assert_allclose(alarms.delay, [0.015], atol=1e-12)
        np.testing.assert_allclose(alarms.near, [0.025, 0.015], atol=1e-12)
        self.assertEqual(
            alarms.cells(),
            ["15 (15 to 15)", "1 of 3", "1 of 3", "20 (16 to 24)", "20.0 +- 7.1, 25", "1 of 3"],
        )

    def test_a_spread_is_in_closed_form(self):
        # Values from 0 to 10 ms in steps of 1 ms: the 10 % quantile is 1 ms, the 90 % quantile 9
        # ms. The variance of n = 11 consecutive integers is n (n + 1)/12 = 11.
        spread = delay.spread_of([1e-3 * k for k in range(10, -1, -1)])
        np.testing.assert_allclose(
            spread, [5e-3, 1e-3 * math.sqrt(11.0), 5e-3, 1e-3, 9e-3, 10e-3], atol=1e-12
        )
        self.assertEqual(spread.cell(), "5 (1 to 9)")
        self.assertEqual(delay.spread_of([]).cell(), "-")

    def test_the_label_is_early_against_the_true_slip(self):
        times = ((0.5, 0.53), (0.5, 0.55), (0.5, math.nan), (math.nan, 0.5), (math.nan, math.nan))
        table, figures = delay.label_table(
            [recording(label_time=label, slip_time=slip) for label, slip in times]
        )
        self.assertEqual(table.rows, [["40 (32 to 48)", "40.0 +- 14.1", "1", "1"]])
        self.assertEqual(
            (
                figures["recordings"],
                figures["labelled_without_slip"],
                figures["slip_without_label"],
            ),
            (2, 1, 1),
        )


class Levels(unittest.TestCase):
    def test_recordings_are_gathered_by_level(self):
        levels = table4.by_level([recording(level=level) for level in (8.0, 0.5, 2.0, 0.5)])
        self.assertEqual(
            {name: len(some) for name, some in levels.items()}, {"0.5": 2, "2": 1, "8": 1}
        )
        self.assertEqual(list(table4.by_level([recording(level=math.nan)])), [table4.NO_LEVEL])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
