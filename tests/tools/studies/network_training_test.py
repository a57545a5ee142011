"""Shared code of studies that train networks: folds, stored networks.

Argument: the program, which is not used.
"""

import multiprocessing
import os
import signal
import sys
import tempfile
import time
import unittest
from contextlib import redirect_stderr
from dataclasses import asdict, replace
from io import StringIO
from pathlib import Path
from unittest import mock

import numpy as np
from slipbench import InputError
from slipbench.learning import Training
from slipbench_studies import __main__ as program
from slipbench_studies.kept import KeptNetworks, kept_path, remove_kept
from slipbench_studies.network_training import folds, train_all, train_and_answer
from slipbench_studies.result import Options
from torch import nn

NAME = "myrmex-tactile-cnn/table3"


class Folds(unittest.TestCase):
    def test_all_have_as_many_of_each_group(self):
        groups = np.array([0] * 10 + [1] * 7)
        fold_of = folds(groups, 5, 1)
        self.assertEqual(np.bincount(fold_of[:10]).tolist(), [2] * 5)
        self.assertEqual(sorted(np.bincount(fold_of[10:]).tolist()), [1, 1, 1, 2, 2])
        self.assertTrue((fold_of == folds(groups, 5, 1)).all())
        self.assertFalse((fold_of == folds(groups, 5, 2)).all())
        with self.assertRaises(ValueError):
            folds(groups, 1, 1)


class Learning(unittest.TestCase):
    def test_what_can_be_told_is_told(self):
        # Three classes at -1, 0 and 1 of one value.
        features = np.array([[k % 3 - 1] for k in range(60)], np.float32)
        labels = np.array([k % 3 for k in range(60)], np.uint8)
        logits = train_and_answer(
            lambda: nn.Sequential(nn.Linear(1, 32), nn.Tanh(), nn.Linear(32, 3)),
            [(features, labels)],
            [np.array([[1], [-1], [0]], np.float32)],
            Training(steps=300, clip=1, learning_rate=1e-2),
            classes=3,
            seed=1,
        )
        self.assertEqual(logits[0].argmax(axis=1).tolist(), [2, 0, 1])


class Kept(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.options = Options(output=str(Path(self.folder.name) / "table.html"), jobs=2)

    def tearDown(self):
        self.folder.cleanup()

    def test_what_is_done_is_not_done_again(self):
        def fails(index):
            if index == 2:
                raise InputError("the third")
            return {"index": index}

        with self.assertRaisesRegex(InputError, "the third"):
            train_all(NAME, ["a"] * 3, replace(self.options, jobs=1), fails)
        kept = kept_path(self.options.output)
        self.assertEqual(
            sorted(path.name for path in kept.iterdir()), ["0.json", "1.json", "identity.txt"]
        )
        with self.assertRaisesRegex(InputError, "contains 2 networks.*--resume"):
            train_all(NAME, ["a"] * 3, self.options, fails)
        with self.assertRaisesRegex(InputError, "belongs to other options"):
            train_all(NAME, ["a"] * 3, replace(self.options, resume=True, seed=2), fails)
        said = train_all(
            NAME, ["a"] * 3, replace(self.options, resume=True), lambda index: {"index": -index}
        )
        self.assertEqual(said, [{"index": 0}, {"index": 1}, {"index": -2}])
        (kept / "1.json").write_text((kept / "1.json").read_text() + " ")
        with self.assertRaisesRegex(InputError, "1.json: is damaged"):
            train_all(NAME, ["a"] * 3, replace(self.options, resume=True), fails)
        remove_kept(self.options.output)
        self.assertFalse(kept.exists())

    def test_a_folder_without_a_network_goes(self):
        def fails(index):
            raise InputError(f"{index}")

        with self.assertRaises(InputError):
            train_all(NAME, ["a"], self.options, fails)
        self.assertFalse(kept_path(self.options.output).exists())

    def test_what_is_no_networks_is_left_alone(self):
        kept = kept_path(self.options.output)
        kept.mkdir()
        (kept / "letter.txt").write_text("dear")
        with self.assertRaisesRegex(InputError, "does not contain networks of a study"):
            KeptNetworks(self.options, NAME)
        remove_kept(self.options.output)
        self.assertEqual((kept / "letter.txt").read_text(), "dear")

    def test_an_interrupt_states_what_is_kept(self):
        request = asdict(self.options) | {"name": NAME, "json": True, "quiet": True, "install": ""}
        del request["say"]

        def interrupted(study):
            """Returns the message of `reproduce` with this study."""
            with (
                mock.patch.object(program, "catch_signals"),
                mock.patch.object(program, "run", study),
                redirect_stderr(StringIO()) as said,
            ):
                self.assertEqual(program.main(dict(request)), 130)
            return said.getvalue()

        def train(networks):
            def study(_, options):
                train_all(NAME, ["a"] * networks, options, lambda index: index)
                raise KeyboardInterrupt

            return study

        self.assertEqual(interrupted(train(0)), "slipbench: interrupted; nothing is kept\n")
        kept = kept_path(self.options.output)
        self.assertEqual(
            interrupted(train(2)),
            f"slipbench: interrupted; 2 networks are kept in {kept}; continue by the same command with --resume\n",
        )

    def test_an_error_ends_the_others_which_remove_their_files(self):
        with tempfile.TemporaryDirectory() as folder:

            def work(index):
                if index == 0:
                    while not any(Path(folder).glob("*/started")):
                        time.sleep(0.01)
                    raise InputError("the first")
                with tempfile.TemporaryDirectory(dir=folder) as own:
                    (Path(own) / "started").touch()
                    time.sleep(300)

            with self.assertRaisesRegex(InputError, "the first"):
                train_all(NAME, ["a", "a"], Options(jobs=2), work)
            self.assertEqual(multiprocessing.active_children(), [])
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_a_process_that_is_killed_is_an_error(self):
        with self.assertRaisesRegex(RuntimeError, "network 1 ended with exit status -9"):
            train_all(
                NAME,
                ["a"] * 3,
                Options(jobs=2),
                lambda index: index if index != 1 else os.kill(os.getpid(), signal.SIGKILL),
            )
        self.assertEqual(multiprocessing.active_children(), [])

    def test_results_are_in_order_whatever_the_jobs(self):
        for jobs in (1, 2):
            self.assertEqual(
                train_all(NAME, ["a"] * 5, Options(jobs=jobs), lambda index: index), list(range(5))
            )


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
