"""Training in PyTorch: recipes, custom networks, files that a loop accepts, resuming after a kill.

Argument: the program.
"""

import dataclasses
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import slipbench
import torch
from slipbench import InputError, _recipe, learning
from slipbench.learning import networks
from slipbench.learning._fit import answers_to_all
from slipbench.learning.biotac import drawn_graph
from torch import nn

PROGRAM = str(Path(sys.argv.pop(1)).resolve())
# 24 trials of 0.4 s: pressed 0.6 mm until 0.2 s, then slid at two speeds, twelve draws of direction
# and friction each.
SMALL = """slipbench: 1
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
# Values per frame of each recipe's input, with the published sensors.
INPUTS = {
    "piezo_mlp": 12,
    "piezo_mlp_128": 12,
    "piezo_tcn": 12,
    "piezo_fft_gru": 12,
    "piezo_raw_gru": 1,
    "piezo_slip": 200,
    "piezo_force": 50,
    "piezo_grasp": 5,
    "papillarray_gru": 640,
    "papillarray_gru5": 640,
    "grasp_gru": 54,
    "slip_gru": 153,
    "myrmex_net1": 4608,
    "myrmex_net2": 4608,
    "myrmex_net3": 4608,
    "nib_slip": 160,
    "nib_rigid": 40,
    "gel_slip": 189,
    "papillarray_slip": 27,
    "taxels_slip": 48,
    "skin_slip": 48,
    "biotac_cnn": 132,
    "biotac_gcn": 24,
    "biotac_lstm": 24,
    "biotac_convlstm": 132,
    "biotac_gru": 120,
    "biotac_slip": 120,
    "biotac_grasp": 225,
}


class Own(nn.Module):
    """Answers by the latest three frames."""

    history = 3

    def __init__(self, inputs, classes):
        super().__init__()
        self.layer = nn.Conv1d(inputs, classes, 3)

    def forward(self, frames):
        return self.layer(frames.transpose(1, 2)).transpose(1, 2)


class BothWays(nn.Module):
    """A GRU that reads the frames in both directions."""

    def __init__(self, inputs, classes):
        super().__init__()
        self.memory, self.last = (
            nn.GRU(inputs, 8, batch_first=True, bidirectional=True),
            nn.Linear(16, classes),
        )

    def forward(self, frames):
        return self.last(self.memory(frames)[0])


class Forgetful(nn.Module):
    """A GRU that does not return its state."""

    def __init__(self, inputs, classes):
        super().__init__()
        self.memory, self.last = nn.GRU(inputs, 8, batch_first=True), nn.Linear(8, classes)

    def forward(self, frames):
        return self.last(self.memory(frames)[0])


class Returns(nn.Module):
    """Returns the result of `make` for logits."""

    def __init__(self, inputs, classes, make):
        super().__init__()
        self.last, self.make = nn.Linear(inputs, classes), make

    def forward(self, frames):
        return self.make(self.last(frames))


def short(recipe="papillarray_gru", **more):
    """A recipe of four steps."""
    found = learning.find_recipe(recipe)
    return dataclasses.replace(
        found,
        training=dataclasses.replace(found.training, steps=4, validate_every=2, batch=4),
        **more,
    )


class TrainingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.data = cls.write("data.h5")

    @classmethod
    def write(cls, name, **values):
        (cls.folder / "scene.yaml").write_text(SMALL)
        slipbench.Scene.load(cls.folder / "scene.yaml").set(values).write(str(cls.folder / name))
        return str(cls.folder / name)

    def train(self, recipe=None, **more):
        return learning.train(
            more.pop("dataset", self.data),
            recipe=recipe or short(),
            output=more.pop("output", str(self.folder / "detector.onnx")),
            every_trial=more.pop("every_trial", True),
            **more,
        )


class Training(TrainingTest):
    # 24 trials: 5 are for judging, 4 of the other 19 for validation (a fifth, rounded up). 0.4 s
    # are ten stacks of 40 rows, so 15 trials are 150 frames.
    def test_the_file_says_what_it_has_seen(self):
        steps = []
        trained = self.train(progress=lambda member, report: steps.append(report.step))
        self.assertEqual(steps, [2, 4])
        self.assertEqual(trained.parts, {"learns": 15, "validates": 4, "judges": 5})
        described = learning.Engine(trained.path).description
        self.assertEqual(learning.Engine(trained.path).inputs, 640)  # 40 rows of 16 forces
        self.assertEqual(
            (described["input"]["sensor"], described["input"]["window"]), ("papillarray", 40)
        )
        self.assertEqual(described["states"], [{"input": "state_0", "output": "state_0_next"}])
        facts = described["trained"]
        self.assertEqual(
            (facts["recipe"], facts["labels"], facts["seed"], facts["frames"]),
            ("papillarray_gru", "latched", 1, 150),
        )
        self.assertEqual((len(facts["sha256_seen"]), len(facts["trials_judged"])), (19, 5))
        with slipbench.open(self.data) as data:
            seen = {data[trial].sha256 for trial in facts["trials_judged"]} & set(
                facts["sha256_seen"]
            )
        self.assertEqual(seen, set())
        self.assertEqual([path.name for path in self.folder.glob("detector*")], ["detector.onnx"])

    def test_the_same_seed_gives_the_same_bytes_also_after_a_kill(self):
        class Killed(Exception):
            pass

        def kill(member, report):
            if member == 1:
                raise Killed

        five = short("papillarray_gru5", members=2)
        whole = Path(self.train(five).path).read_bytes()
        again = str(self.folder / "again.onnx")
        with self.assertRaises(Killed):
            self.train(five, output=again, progress=kill)
        self.assertFalse(Path(again).exists())
        with self.assertRaisesRegex(InputError, r"again.onnx.checkpoint-0.*with resume=True,"):
            self.train(five, output=again)
        with self.assertRaisesRegex(InputError, r"of another training.*without resume=True$"):
            self.train(five, output=again, resume=True, seed=2)
        self.train(five, output=again, resume=True)
        self.assertEqual(Path(again).read_bytes(), whole)
        with self.assertRaisesRegex(
            InputError, r"checkpoint-0: does not exist.*without resume=True$"
        ):
            self.train(five, output=again, resume=True)
        self.assertNotEqual(Path(self.train(five, output=again, seed=2).path).read_bytes(), whole)

    def test_any_number_of_false_alarms_leaves_each_frame_to_itself(self):
        described = self.train(alarms=math.inf).description
        self.assertEqual(described["alarm"], {"on": 1, "off": 1, "least": 1})
        self.assertIsNone(described["trained"]["alarms_asked_per_minute"])

    # Each trial slips by millimetres, so there are no trials without slip for a specificity.
    def test_a_score_chooses_the_operating_point(self):
        facts = self.train(by_score=True, specificity=0.5).description["trained"]
        self.assertTrue(facts["by_score"])
        self.assertIsNone(facts["alarms_asked_per_minute"])
        validation = facts["validation"]
        self.assertLessEqual(validation["score"], 1.0)
        self.assertEqual((validation["specificity"], validation["specificity_asked"]), (None, 0.5))

    def test_a_damaged_checkpoint_is_refused(self):
        output = str(self.folder / "damaged.onnx")
        Path(output + ".checkpoint-0").write_bytes(b"x" * 100)
        with self.assertRaisesRegex(InputError, "is damaged"):
            self.train(output=output, resume=True)

    # Shares of 1/2, 1/4 and 1/4 of 24 trials.
    def test_a_datasets_own_split_counts(self):
        data = self.write("split.h5", split={"by": "trial", "shares": [0.5, 0.25, 0.25]})
        trained = self.train(dataset=data, every_trial=False)
        self.assertEqual((trained.own_split, trained.judged_from), (True, (data, "test")))
        with slipbench.open(data) as stored:
            for part, key in (
                ("train", "trials_learnt"),
                ("valid", "trials_validated"),
                ("test", "trials_judged"),
            ):
                self.assertEqual(trained.description["trained"][key], list(stored.mask(part)))
        self.assertEqual(trained.parts, {"learns": 12, "validates": 6, "judges": 6})
        with self.assertRaisesRegex(InputError, "split.h5.*every_trial=True, which divides"):
            self.train(dataset=data, every_trial=False, split="trial")

    # Twice 24 trials: 10 are for judging, a fifth of the other 38, rounded up, for validation.
    def test_several_datasets(self):
        trained = self.train(dataset=[self.data, self.write("more.h5", seed=6)])
        self.assertEqual(trained.parts, {"learns": 30, "validates": 8, "judges": 10})

    def test_a_trial_counts_once(self):
        copy = self.folder / "copy.h5"
        shutil.copy(self.data, copy)
        with self.assertRaisesRegex(
            InputError, f"{copy}: trial 0 is also in {self.data}; give each trial once"
        ):
            self.train(dataset=[self.data, copy])

    def test_what_does_not_fit_is_refused(self):
        for more, message in (
            ({"recipe": short("piezo_fft_gru")}, "papillarray.*1000 Hz.*piezo_skin at 10000"),
            ({"sensor": "thumb"}, "thumb"),
            ({"split": "material"}, "does not sweep material"),
            ({"recipe": "papillarray_gr"}, "did you mean 'papillarray_gru'"),
            ({"turned": 2}, "^turned=2: is for images, and .* reads none of a "),
            (
                {"by_score": True, "alarms": "1/min"},
                "^by_score=True and alarms='1/min' cannot be combined",
            ),
            ({"alarms": "often"}, "1/min"),
            ({"specificity": 0.9}, "^specificity=0.9 needs by_score=True$"),
            (
                {"by_score": True, "labels": "recorded"},
                "^by_score=True needs simulated trials.*labels='recorded' use alarms$",
            ),
            ({"output": "m"}, ".onnx"),
            ({"labels": "felt"}, "label rule 'felt'"),
            ({"network": nn.Linear(640, 3)}, r"Linear returns logits \[2, 3, 3\].*\[2, 3, 2\]"),
        ):
            with self.subTest(more=more), self.assertRaisesRegex(InputError, message):
                self.train(**more)
        still = self.write(
            "still.h5", **{"sweep.motion.speed": ["0.001 mm/s", "0.002 mm/s"]}
        )  # at most 0.4 um: nothing slips
        with self.assertRaisesRegex(InputError, "150 hold, 0 slip"):
            self.train(dataset=still)
        mine = self.folder / "mine.onnx"
        mine.write_text("mine")
        with self.assertRaisesRegex(InputError, "exists and is not a detector"):
            self.train(output=str(mine))
        self.assertEqual(mine.read_text(), "mine")

    def test_arguments_out_of_range_are_refused(self):
        for more, message in (
            ({"steps": 0}, "^steps: expected 1 or more, found 0"),
            ({"steps": 1.5}, "^steps: expected a whole number"),
            ({"seed": -1}, "^seed: expected 0 to 18446744073709551615, found -1"),
            ({"seed": 2**64}, "^seed: "),
            ({"seed": "1"}, "^seed: expected a whole number"),
            ({"turned": -1}, "^turned: expected 0 or more"),
            ({"held_out": 0.6}, "^held_out: expected a number from 0 to 0.5, found 0.6"),
            ({"held_out": math.nan}, "^held_out: "),
            ({"held_out": "0.2"}, "^held_out: "),
            (
                {"by_score": True, "specificity": 95},
                "^specificity: expected a number from 0 to 1, found 95",
            ),
            ({"rates": (3,)}, r"^rates=\(3,\): expected the lowest"),
            ({"rates": (5, 2)}, r"^rates=\(5, 2\): "),
            ({"rates": "1"}, "^rates='1': "),
            ({"dataset": []}, "^dataset: .*empty list"),
            ({"recipe": 3}, "^recipe: .*found int 3"),
            ({"network": 3}, "^network: .*found int 3"),
            ({"network": lambda inputs, classes: None}, "^network: .*NoneType"),
            (
                {"recipe": short("myrmex_net1"), "alarms": "1/min"},
                r"^alarms='1/min': .*leave alarms out$",
            ),
        ):
            with self.subTest(more=more), self.assertRaisesRegex(InputError, message):
                self.train(**more)

    # The recipe reads 1 kHz, as its median needs every sample.
    def test_a_range_of_rates_is_stated_and_read(self):
        slow = self.write("slow.h5", **{"sensors.pad.rate": "100 Hz"})
        ranged = self.train(rates=(100, 1000), output=str(self.folder / "ranged.onnx"))
        self.assertEqual(
            learning.Engine(ranged.path).description["input"]["rates"], [100.0, 1000.0]
        )
        result = slipbench.evaluate(ranged.path, slow)
        self.assertEqual(
            (result["notice"], result["reads_hz"]),
            (
                "interpolated from 100 Hz to 1 kHz for ranged.onnx",
                {"frames": 1000.0, "least": 100.0},
            ),
        )
        with self.assertRaisesRegex(
            InputError,
            "sensor 'pad' has 100 Hz, but the network reads 1 kHz, 10 times as much; .*--resample",
        ):
            slipbench.evaluate(self.train().path, slow)

    # The greatest seed: the second of two members wraps to 0.
    def test_whole_numbers_of_numpy_are_taken(self):
        trained = self.train(
            short("papillarray_gru5", members=2),
            steps=np.int64(2),
            seed=np.uint64(2**64 - 1),
            turned=np.int8(0),
            held_out=np.float32(0.25),
        )
        facts = trained.description["trained"]
        self.assertEqual(
            (facts["seed"], facts["held_out"], trained.parts["judges"]), (2**64 - 1, 0.25, 6)
        )  # 24/4

    def test_a_network_that_a_loop_could_not_run_is_refused(self):
        for network, message in (
            (BothWays, "^network: BothWays is not causal"),
            (Forgetful, r"^network: Forgetful answers differently.*\(logits, state\)"),
            (
                lambda i, c: nn.Linear(i + 1, c),
                r"^network: Linear does not take frames \[2, 3, 640\]: mat1 and mat2",
            ),
            (
                lambda i, c: Returns(i, c, lambda logits: {"logits": logits}),
                "^network: Returns returns a dict; expected a tensor",
            ),
            (
                lambda i, c: Returns(i, c, lambda logits: (logits, 1)),
                "^network: Returns returns a tuple; expected a tensor",
            ),
            (
                lambda i, c: Returns(i, c, lambda logits: (logits,)),
                "^network: Returns returns a tuple; expected a tensor",
            ),
        ):
            with self.subTest(message=message), self.assertRaisesRegex(InputError, message):
                self.train(network=network, output=str(self.folder / "refused.onnx"))
        self.assertEqual(list(self.folder.glob("refused*")), [])

    def test_a_training_that_diverges_leaves_no_checkpoint(self):
        base = short()

        def with_training(**values):
            return dataclasses.replace(base, training=dataclasses.replace(base.training, **values))

        # The first step's loss is finite; weights of 1e30 overflow in the products of the second.
        # Infinite weights after the only step have had a finite loss.
        for recipe, message in (
            (
                with_training(learning_rate=1e30, validate_every=4),
                "^step 2: the loss is not finite; .*lower learning rate",
            ),
            (
                with_training(learning_rate=math.inf, steps=1),
                "^step 1: a weight is not finite; .*lower learning rate",
            ),
        ):
            with self.subTest(message=message), self.assertRaisesRegex(InputError, message):
                self.train(recipe, output=str(self.folder / "diverged.onnx"))
            self.assertEqual(list(self.folder.glob("diverged*")), [])

    def test_the_package_offers_it(self):
        trained = slipbench.train(
            self.data, recipe=short(), output=self.folder / "offered.onnx", every_trial=True
        )
        self.assertEqual(Path(trained.path).read_bytes(), Path(self.train().path).read_bytes())
        script = (
            "import sys, slipbench; assert 'torch' not in sys.modules and callable(slipbench.train)"
        )
        subprocess.run([sys.executable, "-c", script], check=True)

    # A constant answer has 1/2. The small scene slips within some 30 ms of its start, so nearly all
    # of its frames can be classified.
    def test_slip_gru_learns_from_a_few_trials(self):
        found = learning.find_recipe("slip_gru")
        few = dataclasses.replace(
            found,
            training=dataclasses.replace(found.training, steps=60, validate_every=10, batch=8),
        )
        self.assertGreater(self.train(few).judged["all_classes_balanced_accuracy"], 0.8)

    # Six taxels at 500 Hz, so that 10 ms are five samples.
    def test_slip_gru_learns_from_any_sensor_of_units(self):
        data = self.write(
            "taxels.h5",
            **{
                "sensors.pad": {
                    "type": "taxels",
                    "rate": "500 Hz",
                    "rows": 2,
                    "columns": 3,
                    "pitch": "4 mm",
                }
            },
        )
        frames = self.train(short("slip_gru"), dataset=data).description["input"]
        self.assertEqual(
            (frames["sensor"], frames["rate"], frames["window"], frames["stride"]),
            ("taxels", 500, 5, 5),
        )
        self.assertEqual((frames["spans"], len(frames["scale"])), ([5, 10, 20, 40, 80], 1))

    # A skin at 100 Hz has one sample in 10 ms, of which spans take 2, 3, 4, 8 and 16; markers at 50
    # Hz 2, 3, 4, 5 and 8. The floor is a thousandth of the greatest value of the first trial. The
    # skin's counts minus the unloaded ones are its field.
    def test_slip_gru_reads_three_axes_of_counts_and_of_markers(self):
        for sensor, rate, channel, unit, spans in (
            ({"type": "magnetic_skin", "noise": 2.2}, 100, "field", "uT", [2, 3, 4, 8, 16]),
            ({"type": "gel_markers", "rate": "50 Hz"}, 50, "displacement", "m", [2, 3, 4, 5, 8]),
            (
                {"type": "taxels", "rate": "100 Hz", "channels": {"moved": "displacement"}},
                100,
                "moved",
                "m",
                [2, 3, 4, 8, 16],
            ),
        ):
            with self.subTest(sensor=sensor["type"]):
                data = self.write(f"{sensor['type']}-{channel}.h5", **{"sensors.pad": sensor})
                frames = self.train(short("slip_gru"), dataset=data).description["input"]
                self.assertEqual(
                    (frames["sensor"], frames["rate"], frames["window"], frames["stride"]),
                    (sensor["type"], rate, 2, 1),
                )
                self.assertEqual(
                    (frames["channels"], frames["spans"]),
                    ([{"name": channel, "unit": unit}], spans),
                )
                with slipbench.open(data) as opened:
                    largest = np.abs(opened[0].sensors["pad"][channel][:]).max()
                self.assertAlmostEqual(frames["floor"] / largest, 1e-3, 9)

    # In the loop of a grasp: the network sees all frames, at the rate of the skin, and its answers
    # reach the controller.
    def test_slip_gru_of_a_magnetic_skin_runs_in_a_grasps_loop(self):
        scene = slipbench.Scene.load("magnetic_skin/creep.yaml").set({"duration": "5 s"})
        data = str(self.folder / "creep.h5")
        scene.write(data, draws=8)
        model = self.train(short("slip_gru"), dataset=data).path
        looped = scene.set(
            {
                "detector": {"type": "network", "model": model},
                "controller": {"type": "step_on_slip"},
            }
        )
        control = looped.run().control
        self.assertEqual(control.sensor, "skin")
        self.assertTrue(np.isin([1, 2, 3], control.detector_class).any())

    def test_a_module_of_ones_own(self):
        trained = self.train(network=Own)
        described = learning.Engine(trained.path).description
        self.assertEqual((described["input"]["history"], described["states"]), (3, []))
        self.assertIs(self.train(network=trained.networks[0]).networks[0], trained.networks[0])

    def test_augmentation_is_repeated(self):
        def noise(clips, random):
            return clips + 0.1 * torch.randn(clips.shape, generator=random)

        base = short()
        noisy = dataclasses.replace(
            base, training=dataclasses.replace(base.training, augment=noise)
        )
        plain, first, second = (
            Path(self.train(one).path).read_bytes() for one in (base, noisy, noisy)
        )
        self.assertEqual(first, second)
        self.assertNotEqual(first, plain)


class Command(TrainingTest):
    def run_program(self, *words, **environment):
        # PyTorch 2.6 leaves a temporary folder until the interpreter ends, which warns about it.
        environment["PYTHONWARNINGS"] = "error,ignore::ResourceWarning"
        return subprocess.run(
            [
                PROGRAM,
                "train",
                self.data,
                "--all",
                "--recipe",
                "papillarray_gru",
                "--steps",
                "4",
                *words,
            ],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | environment,
        )

    def test_the_command_is_the_function(self):
        output = str(self.folder / "command.onnx")
        done = self.run_program("-o", output, "--json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        summary = json.loads(done.stdout)
        every = learning.train(
            self.data,
            recipe="papillarray_gru",
            steps=4,
            every_trial=True,
            output=str(self.folder / "function.onnx"),
        )
        self.assertEqual(Path(output).read_bytes(), Path(every.path).read_bytes())
        self.assertEqual(summary["output"], output)
        self.assertEqual(summary["validation"]["balanced_accuracy"], every.validation)
        self.assertEqual(set(summary["alarm"]), {"on", "off", "least"})
        text = self.run_program("-o", output)
        self.assertIn("papillarray_gru, labels latched", text.stdout)
        self.assertIn("15 trials for training, 4 for validation", text.stdout)
        self.assertIn(
            f"next: {PROGRAM} eval {output} {self.data} --sensor pad --labels latched", text.stdout
        )
        self.assertIn("step 4/4, loss", text.stderr)

    def test_the_command_names_options_and_the_function_arguments(self):
        for words, message in (
            (("--turned", "2"), "^slipbench: --turned 2: is for images, and .* reads none of a "),
            (("--resume",), "train without --resume$"),
        ):
            with self.subTest(words=words):
                done = self.run_program("-o", str(self.folder / "named.onnx"), *words)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr.strip().splitlines()[-1], message)

    def test_without_torch_it_says_so_before_it_reads(self):
        without = self.folder / "without/torch"
        without.mkdir(parents=True)
        (without / "__init__.py").write_text(
            "raise ModuleNotFoundError(\"No module named 'torch'\", name='torch')\n"
        )
        done = self.run_program("-o", "x.onnx", PYTHONPATH=str(without.parent))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "needs PyTorch.*pip install torch.*apt install python3-torch")
        self.assertNotIn("reading", done.stderr)


class Recipes(unittest.TestCase):
    def test_the_program_lists_and_describes_them(self):
        listed = json.loads(
            subprocess.run(
                [PROGRAM, "list", "recipes", "--json"], capture_output=True, check=True
            ).stdout
        )["recipes"]
        self.assertEqual(
            [(one["name"], one["summary"]) for one in listed],
            [(name, recipe.summary) for name, recipe in learning.RECIPES.items()],
        )
        for name, recipe in learning.RECIPES.items():
            with self.subTest(name):
                facts = _recipe.facts_of(recipe)
                self.assertIn(recipe.input.sensor, facts["Input"])
                self.assertIn("slipbench.learning.networks.", facts["Network"])
                self.assertTrue(
                    all(
                        len(line) <= 100
                        for text in facts.values()
                        for line in _recipe.wrapped(text, 100).split("\n")
                        if "|" not in line
                    )
                )

    def test_every_network_runs_in_the_engine(self):
        self.assertEqual(set(INPUTS), set(learning.RECIPES))
        with tempfile.TemporaryDirectory() as folder:
            for name, recipe in learning.RECIPES.items():
                with self.subTest(name=name):
                    classes = {"slip": 2, "kind": 3, "direction": 7}[recipe.classes]
                    torch.manual_seed(1)
                    members = [recipe.network(INPUTS[name], classes) for _ in range(recipe.members)]
                    frames = (
                        np.random.default_rng(1).normal(size=(40, INPUTS[name])).astype(np.float32)
                    )
                    described = learning.describe_file(
                        recipe.input,
                        [(f"class {i}", "gross" if i else "non_slip") for i in range(classes)],
                    )
                    path = f"{folder}/{name}.onnx"
                    learning.write_detector(path, members, INPUTS[name], described)
                    self.assertLess(learning.check_engine(path, members, frames), 1e-5)

    # Weights and biases. A GRU of u units has 3 u (inputs + u + 2), in PyTorch two biases; Table I
    # prints 3.6k, 51k and 23k.
    def test_networks_have_the_papers_parameters(self):
        counts = {
            name: sum(
                one.numel() for one in learning.RECIPES[name].network(INPUTS[name], 2).parameters()
            )
            for name in ("piezo_mlp", "piezo_mlp_128", "piezo_fft_gru", "papillarray_gru")
        }
        self.assertEqual(counts["piezo_mlp"], (12 + 1) * 32 + 3 * (32 + 1) * 32 + (32 + 1) * 2)
        self.assertEqual(
            counts["piezo_mlp_128"], (12 + 1) * 128 + 3 * (128 + 1) * 128 + (128 + 1) * 2
        )
        self.assertEqual(
            counts["piezo_fft_gru"], 96 * (12 + 34) + 3 * 96 * (32 + 34) + (32 + 1) * 2
        )
        dense = sum(
            (before + 1 + 2) * after
            for before, after in ((640, 1024), (1024, 128), (128, 256), (256, 128))
        )
        self.assertEqual(counts["papillarray_gru"], dense + 384 * (128 + 130) + (128 + 1) * 2)

    def test_slip_gru_does_not_care_which_unit_is_which(self):
        torch.manual_seed(1)
        network = networks.SlipGru(9 * 17, 2, 17).eval()
        some = torch.randn(1, 4, 9, 17)
        logits = network(some.flatten(2))[0]
        self.assertTrue(torch.allclose(network(some.flip(2).flatten(2))[0], logits, atol=1e-6))
        some[0, 0, 0, 0] += 1.0
        self.assertFalse(torch.allclose(network(some.flatten(2))[0], logits, atol=1e-6))

    # A force that rises by 3 counts a sample for 0.1 s, through a high-pass of first order at 3 Hz: its
    # changes over 5 and 10 ms while it rises, and after it has stopped, when the signal still decays.
    def test_piezo_force_inverts_the_amplifier(self):
        network = networks.PiezoForce(50, 2, lags=(1, 2)).eval()
        force = np.concatenate((np.zeros(1000), 3.0 * np.arange(1000), np.full(1000, 3000.0)))
        decay, signal = math.exp(-2 * math.pi * 3 * 1e-4), np.zeros(3000)
        for i in range(1, 3000):
            signal[i] = decay * signal[i - 1] + (force[i] - force[i - 1]) * (1 + decay) / 2
        frames = torch.tensor((signal / 70).reshape(1, 60, 50).tolist())
        features = network.measures(
            torch.cat((torch.zeros(1, 3, 50), frames), 1),
            torch.cat((torch.zeros(1, 4), frames.mean(2)), 1),
        )[0]
        rising, stopped = features[35, :2].expm1(), features[50, :2].expm1()
        # A mean of 50 samples has a noise of 70/sqrt(50) counts, a change over 5 ms sqrt(2) times as much.
        np.testing.assert_allclose(
            rising.tolist(), np.array([150, 300]) / (70 / 50**0.5 * 2**0.5), rtol=0.01
        )
        self.assertLess(float(stopped.abs().max()), 0.01)

    # Nine units that move as a rigid body, each with its own depth, and one that is not in contact;
    # then the third that is pressed least slips back by a half, from one frame to the next.
    def test_rigid_slip_measures_the_departure_from_a_rigid_motion(self):
        network = networks.RigidSlip(27, 2, columns=3, rows=3, lags=(1,), noise=1e-5).eval()
        columns, rows = np.meshgrid(np.arange(3) - 1.0, 1.0 - np.arange(3))
        moved = np.zeros((2, 3, 3, 3))
        moved[..., 0], moved[..., 1] = 2e-4 - 1e-5 * rows, 1e-4 + 1e-5 * columns
        moved[..., 2] = 4e-4 + 2e-4 * columns
        moved[:, 0, 2] = 0.0

        def whole(fields):
            frames = torch.tensor(fields.reshape(1, 2, 27).tolist())
            values = network.measures(frames, torch.zeros(1, 1, 27))[2][0, 1]
            return [math.copysign(math.expm1(abs(float(one))), float(one)) for one in values]

        size, change, turn, _, departure, departure_now, slope, *_ = whole(moved)
        self.assertAlmostEqual(size, math.hypot(20, 10), delta=0.5)  # in units of the noise
        self.assertAlmostEqual(turn, 1.0, delta=1e-3)
        self.assertLess(max(departure, departure_now, abs(slope), change), 0.11)
        moved[1, :, 0, :2] *= 0.5
        _, _, _, _, departure, departure_now, slope, *_ = whole(moved)
        # Three of eight units are 10 less along X, which neither a translation nor a turn fits: 10 sqrt(3/8 5/8) = 4.8.
        self.assertGreater(min(departure, departure_now), 4.5)
        self.assertGreater(slope, 0.3)

    # Readings of 16 units that grow by a fifth, each in proportion: the middle is 1.1 of those before. The
    # 16 that are added to the load of 24,640 lower the common change of 0.2/1.1 by 0.07 %, which
    # counts as a moved load of 0.27 times that, 3.2e-5. Then one unit
    # passes 100 to another, and the shear of a third changes by 60 along X and by 0, 20 or 90 along Y.
    def test_skin_slip_measures_the_departure_from_a_common_change(self):
        network = networks.SkinSlip(48, 2, lags=(1,), noise=1.0).eval()
        normal = 500.0 + 120.0 * np.arange(16)
        before = np.stack((0.1 * normal, -0.05 * normal, normal), 1)

        def changes(now):
            frames = torch.tensor(np.stack((before, now)).reshape(1, 2, 48).tolist())
            return network.measures(frames, torch.zeros(1, 1, 48))[0, 1].expm1().mul(1e-3).tolist()

        common, moved, turned = changes(1.2 * before)
        self.assertAlmostEqual(common, 0.2 / 1.1, delta=2e-4)
        self.assertLess(max(moved, turned), 4e-5)
        now = before.copy()
        now[3, 2] -= 100.0
        now[4, 2] += 100.0
        now[[3, 4], :2] *= now[[3, 4], 2:] / before[[3, 4], 2:]  # the ratios stay
        now[9, 0] -= 60.0
        load = normal.sum() + 16
        for along_y, least in ((0.0, 0.0), (20.0, 20.0 / load), (90.0, 60.0 / load)):
            now[9, 1] = before[9, 1] + along_y
            common, moved, turned = changes(now)
            self.assertLess(common, 1e-6)
            self.assertAlmostEqual(moved, 100 * 2**0.5 / load, delta=1e-5)
            self.assertAlmostEqual(turned, least, delta=1e-5)

    # A translation and a turn of the plate, with counts at rest that differ between electrodes; then
    # the taxel in the middle stays behind.
    def test_nib_rigid_measures_the_departure_from_a_rigid_motion(self):
        network = networks.NibRigid(40, 2, lags=(1,)).eval()
        columns, rows = np.meshgrid(np.arange(3) - 1.0, 1.0 - np.arange(3))
        east, north = (20 - 5 * rows).reshape(9), (10 + 5 * columns).reshape(9)
        rest = 7000.0 + 3.0 * np.arange(40)
        leant = rest.copy()
        leant[:36] += np.stack((-east, north, east, -north), 1).reshape(36) / 2

        def departure(now):
            before = torch.tensor(rest.reshape(1, 1, 40).tolist())
            return math.expm1(
                float(
                    network.measures(torch.tensor(now.reshape(1, 1, 40).tolist()), before)[2][
                        0, 0, 2
                    ]
                )
            )

        self.assertAlmostEqual(departure(leant), 1.0, delta=1e-2)  # the noise
        leant[16:20] = rest[16:20]
        self.assertGreater(departure(leant), 5.0)

    # Rows of the adjacency for a node with d neighbours: 1/sqrt((d + 1)(d_j + 1)). E1 has one
    # neighbour, E2, which has two.
    def test_the_graph_is_normalised(self):
        graph = drawn_graph()
        self.assertEqual(tuple(graph.shape), (24, 24))
        self.assertAlmostEqual(float(graph[0, 0]), 1 / 2, 6)
        self.assertAlmostEqual(float(graph[0, 1]), 1 / math.sqrt(2 * 3), 6)


class Pieces(unittest.TestCase):
    def test_balanced_accuracy_leaves_masked_frames_out(self):
        called, labels = [np.array([0, 0, 1, 1], np.uint8)], [np.array([0, 1, 1, 255], np.uint8)]
        self.assertEqual(learning.balanced_accuracy(called, labels), (1.0 + 0.5) / 2)
        self.assertTrue(math.isnan(learning.balanced_accuracy([], [])))

    def test_scales(self):
        frames = [
            np.array([[0.0, 5.0], [2.0, 5.0]], np.float32)
        ]  # means 1 and 5, deviations 1 and 0
        for scaling, offset, scale in (
            ("standard", [1, 5], [1, 1]),
            ("range", [0, 5], [0.5, 1]),
            ("common", [3], [1 / math.sqrt(4.5)]),
            ("none", [0], [1]),
        ):
            found = learning.scale_of(frames, scaling)
            np.testing.assert_allclose(found[0], offset)
            np.testing.assert_allclose(found[1], scale, rtol=1e-6)
        with self.assertRaisesRegex(InputError, "scaling: 'unit'"):
            learning.scale_of(frames, "unit")

    # With history 3, 600 frames have 598 answers: 256, 256 and 86 of one sequence. 100 frames have
    # 98, so 2 x 98 answers are processed together, because a third sequence would make 294.
    def test_windows_go_through_256_at_a_time(self):
        class Recording(Own):
            def forward(self, frames):
                sizes.append(len(frames) * (frames.shape[1] - 2))
                return super().forward(frames)

        torch.manual_seed(1)
        network = Recording(1, 2)
        random = np.random.default_rng(1)
        for length, expected in ((600, [256, 256, 86] * 3), (100, [196, 98])):
            sizes = []
            sequences = [random.normal(size=(length, 1)).astype(np.float32) for _ in range(3)]
            together = answers_to_all(network, sequences)
            self.assertEqual(sizes, expected)
            for one, logits in zip(sequences, together, strict=True):
                np.testing.assert_allclose(logits, learning.answers(network, one), atol=1e-6)

    # Each seed of CUDA's generator would be stored in a list, with a stack trace, until CUDA is
    # first used.
    def test_a_training_seeds_no_generator_of_cuda(self):
        sequences = [(np.zeros((8, 1), np.float32), np.array([0, 1] * 4, np.uint8))]
        with mock.patch("torch.cuda.manual_seed_all") as seeded:
            learning.fit(
                Own(1, 2), sequences, [], learning.Training(steps=3, batch=2, clip=4), classes=2
            )
        seeded.assert_not_called()

    # One sequence of five frames, whose last three are slip: clips of two answers begin at frames 0
    # to 3; for each a class is drawn.
    def test_clips_are_drawn_around_a_class(self):
        frames = np.arange(5, dtype=np.float32)[:, None]
        clips = learning.Clips(
            [(frames, np.array([0, 0, 1, 1, 1], np.uint8))],
            learning.Training(batch=200, clip=2, balance="drawing"),
            1,
            2,
        )
        features, classes = clips.draw(1, 0)
        first = sorted({int(one) for one in features[:, 0, 0]})
        self.assertEqual(first, [0, 1, 2, 3])
        self.assertTrue(torch.equal(features[:, 1, 0], features[:, 0, 0] + 1))
        self.assertTrue(torch.equal(classes, (features[:, :, 0] >= 2).long()))
        self.assertTrue(torch.equal(clips.weights(), torch.ones(2)))
        uniform = learning.Clips(
            [(frames, np.array([0, 0, 1, 1, 1], np.uint8))], learning.Training(), 1, 2
        )
        np.testing.assert_allclose(
            [float(one) for one in uniform.weights()], [5 / 4, 5 / 6], rtol=1e-6
        )  # all/(classes x count)

    # A short sequence is one clip; its last frame is repeated without training (-100).
    def test_a_short_sequence_fills_its_clip(self):
        sequences = [
            (np.array([[1.0], [2.0]], np.float32), np.array([0, 1], np.uint8)),
            (np.zeros((4, 1), np.float32), np.array([0, 0, 1, 1], np.uint8)),
        ]
        features, classes = learning.Clips(
            sequences, learning.Training(batch=50, clip=9), 1, 2
        ).draw(1, 0)
        shorter = [row for row in range(50) if float(features[row, 0, 0]) == 1.0]
        self.assertGreater(len(shorter), 0)
        self.assertEqual(features[shorter[0], :, 0].tolist(), [1, 2, 2, 2])
        self.assertEqual(classes[shorter[0]].tolist(), [0, 1, -100, -100])

    # The first three of 25 successive frames of slip are trained on, then the 10th and the 20th.
    def test_the_onset_of_a_slip_trains(self):
        labels = np.array([0] * 5 + [1] * 25, np.uint8)
        clips = learning.Clips(
            [(np.zeros((30, 1), np.float32), labels)],
            learning.Training(batch=1, clip=30, onset_frames=3),
            1,
            2,
        )
        _, classes = clips.draw(1, 0)
        self.assertEqual(
            [t for t, one in enumerate(classes[0].tolist()) if one == 1], [5, 6, 7, 14, 24]
        )

    def test_frames_are_those_of_the_loop(self):
        frames = learning.Frames(
            learning.Input("papillarray", 1000.0, {"force": [2, 5]}, window=3, stride=2),
            "papillarray",
            1000.0,
            {"force": (9, 3)},
        )
        force = np.arange(7 * 27, dtype=np.float32).reshape(7, 9, 3)
        found, ends = frames.all({"force": force})
        self.assertEqual((frames.size, list(ends)), (6, [2, 4, 6]))
        flat = force.reshape(7, 27)[:, [2, 5]]
        np.testing.assert_array_equal(found, [flat[end - 2 : end + 1].ravel() for end in ends])
        with self.assertRaisesRegex(InputError, "taxels"):
            learning.Frames(
                learning.Input("papillarray", 1000.0, ["force"]),
                "taxels",
                1000.0,
                {"force": (9, 3)},
            )


if __name__ == "__main__":
    unittest.main()
