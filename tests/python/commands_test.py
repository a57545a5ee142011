"""The commands on dataset files as functions, and the pytest plugin. Argument: the program."""

import gc
import json
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path
from unittest import mock

import numpy as np
import slipbench
from slipbench import _export, _import
from slipbench.bin import _core

PROGRAM = str(Path(sys.argv.pop(1)).resolve())


def told(*words):
    """Returns the program's output with --json."""
    return json.loads(
        subprocess.run(
            [PROGRAM, *words, "--json"], check=False, capture_output=True, text=True
        ).stdout
    )


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.place = Path(cls.folder.name)
        cls.path = cls.place / "speeds.h5"
        cls.sets = {
            "sweep": {"motion.speed": ["2 mm/s", "3 mm/s", "4 mm/s", "5 mm/s"], "trials": 1},
            "split": {"by": "trial", "shares": [0.5, 0.25, 0.25]},
        }
        slipbench.Scene.load("papillarray/stage.yaml").set(cls.sets).write(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_a_report_is_the_programs(self):
        self.assertEqual(
            slipbench.report(self.path, self.place / "a.html", trial=np.int64(1)),
            {"report": str(self.place / "a.html")},
        )
        told("report", str(self.path), "--trial", "1", "-o", str(self.place / "b.html"))
        self.assertEqual((self.place / "a.html").read_bytes(), (self.place / "b.html").read_bytes())

    def test_an_export_is_the_programs(self):
        ours = slipbench.export(
            self.path,
            self.place / "ours",
            format="csv",
            labels="strict",
            sensors=["pad"],
            rate=100,
            trial=1,
            compress=True,
        )
        theirs = told(
            "export",
            str(self.path),
            "--format",
            "csv",
            "--labels",
            "strict",
            "--rate",
            "100",
            "--trial",
            "1",
            "--compress",
            "-o",
            str(self.place / "theirs"),
        )
        self.assertEqual(
            [Path(file).name for file in ours["files"]],
            [Path(file).name for file in theirs["files"]],
        )
        for one, other in zip(ours["files"], theirs["files"], strict=True):
            self.assertEqual(Path(one).read_bytes(), Path(other).read_bytes())

    def test_recordings_are_imported(self):
        slipbench.export(self.path, self.place / "logs", format="vendor-csv")
        ours = self.place / "ours.h5"
        slipbench.import_recordings(self.place / "logs", ours, format="papillarray-csv", seed=3)
        told(
            "import",
            str(self.place / "logs"),
            "--format",
            "papillarray-csv",
            "--seed",
            "3",
            "-o",
            str(self.place / "theirs.h5"),
        )
        with slipbench.open(ours) as one, slipbench.open(self.place / "theirs.h5") as other:
            self.assertEqual(
                [trial.sha256 for trial in one.values()], [trial.sha256 for trial in other.values()]
            )
            self.assertGreater(len(one), 0)
            pad = one[0].sensors[next(iter(one[0].sensors))]
            self.assertEqual(
                len(pad.force), len(pad.t)
            )  # an imported sensor has the attributes of any other
            self.assertFalse(hasattr(one[0].labels.get(pad.name), "margin"))

    def test_counts_are_in_the_singular_and_the_plural(self):
        log = self.place / "log.csv"
        for rows, text in (
            (2, "1 recording of 1 file, 2 samples"),
            (1, "1 sample; at least two are needed"),
        ):
            log.write_text("t,f\n" + "".join(f"{k / 100:.2f},{k}\n" for k in range(rows)))
            (self.place / "map.yaml").write_text(
                "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}}\n"
            )
            done = subprocess.run(
                [PROGRAM, "import", log, "--map", self.place / "map.yaml"],
                check=False,
                capture_output=True,
                text=True,
            )
            self.assertIn(text, done.stdout + done.stderr)

    def test_windows_of_a_recording_have_its_own_rule(self):
        slipbench.export(self.path, self.place / "recorded", format="vendor-csv")
        slipbench.import_recordings(
            self.place / "recorded", self.place / "recorded.h5", format="papillarray-csv"
        )
        with slipbench.open(self.place / "recorded.h5") as data:
            for labels in ("strict", "micro", "paper"):
                with self.assertRaisesRegex(
                    slipbench.InputError,
                    f"^trial 0: labels '{labels}': the recording has 'recorded'; pass labels='recorded'$",
                ):
                    data.windows(length=4, labels=labels)
            self.assertGreater(len(data.windows(length=4, labels="recorded")), 0)
            self.assertIn("state_paper", dir(data[0].labels[next(iter(data[0].labels))]))
            self.assertNotIn("margin", dir(data[0].labels[next(iter(data[0].labels))]))
        with (
            slipbench.open(self.path) as data,
            self.assertRaisesRegex(
                slipbench.InputError,
                "^trial 0: labels 'recorded': the simulated trial has 'strict', 'micro', 'paper'; pass labels='strict' or ",
            ),
        ):
            data.windows(length=4, labels="recorded")
        with self.assertRaisesRegex(
            slipbench.InputError, "--labels paper needs the truth, .*; use --labels recorded"
        ):
            slipbench.export(
                self.place / "recorded.h5", self.place / "never", format="npz", labels="paper"
            )
        self.assertFalse((self.place / "never").exists())
        slipbench.export(
            self.place / "recorded.h5", self.place / "again", format="npz", labels="recorded"
        )
        with np.load(self.place / "again/demo_0.npz") as archive:
            self.assertEqual(
                [name for name in archive if name.startswith("labels/") and "state" in name],
                ["labels/pad/state_recorded"],
            )
            self.assertEqual(
                json.loads(archive["about"].item())["codes"]["labels/pad/state_recorded"][
                    "incipient"
                ],
                2,
            )
        self.assertRegex(
            (self.place / "again/README.md").read_text(), r"`state_recorded` .* 3 gross; rule: \w+"
        )

    def test_zero_is_passed_on(self):
        one = slipbench.export(self.path, self.place / "one", format="csv", trial=0)
        told(
            "export",
            str(self.path),
            "--format",
            "csv",
            "--trial",
            "0",
            "-o",
            str(self.place / "first"),
        )
        self.assertEqual(
            sorted(path.name for path in (self.place / "one").iterdir()),
            sorted(path.name for path in (self.place / "first").iterdir()),
        )
        self.assertLess(
            len(one["files"]),
            len(slipbench.export(self.path, self.place / "all", format="csv")["files"]),
        )
        with self.assertRaisesRegex(slipbench.InputError, "rate"):
            slipbench.export(self.path, self.place / "never", format="csv", rate=0)
        for key, call in (
            (
                "trial",
                lambda: slipbench.export(self.path, self.place / "never", format="csv", trial=True),
            ),
            (
                "label_speed",
                lambda: slipbench.export(
                    self.path, self.place / "never", format="csv", label_speed=False
                ),
            ),
            (
                "seed",
                lambda: slipbench.import_recordings(self.place, format="csv", seed=np.bool_(True)),
            ),
        ):
            with (
                self.subTest(key=key),
                self.assertRaisesRegex(
                    slipbench.InputError,
                    f"^{key}: expected a number or a text, found (True|False)$",
                ),
            ):
                call()
        self.assertFalse((self.place / "never").exists())

    def test_shards_are_merged_and_verified(self):
        scene, words = (
            str(slipbench.scenes() / "papillarray/stage.yaml"),
            [
                word
                for path, value in self.sets.items()
                for word in ("--set", f"{path}={json.dumps(value)}")
            ],
        )
        shards = [self.place / f"shard-{k}.h5" for k in (1, 2)]
        for k, shard in enumerate(shards, 1):
            told("sweep", scene, *words, "--shard", f"{k}/2", "-o", str(shard))
        merged = self.place / "merged.h5"
        slipbench.merge(shards, merged)
        with slipbench.open(merged) as one, slipbench.open(self.path) as other:
            self.assertEqual(
                [trial.sha256 for trial in one.values()], [trial.sha256 for trial in other.values()]
            )
        self.assertTrue(slipbench.verify(merged)["holds"])
        self.assertEqual(slipbench.verify([merged]), told("verify", str(merged)))

    def test_wrong_input_is_the_programs_message(self):
        for call, words in (
            (
                lambda: slipbench.merge([self.path], self.place / "m.h5"),
                "is not a shard of a sweep",
            ),
            (lambda: slipbench.verify("/nope.h5"), "^/nope.h5: no such file"),
            (
                lambda: slipbench.merge(str(self.path), self.place / "m.h5"),
                f"^{self.path}: .*is not a shard of a sweep",
            ),
            (
                lambda: slipbench.merge(None, self.place / "m.h5"),
                "^shards: expected a path or a list of paths, found NoneType None",
            ),
            (
                lambda: slipbench.verify([3]),
                "^datasets: expected a path or a list of paths, found int 3",
            ),
            (
                lambda: slipbench.export(self.path, self.place / "x", format="cvs"),
                "unknown format 'cvs'; allowed: csv",
            ),
            (lambda: slipbench.report(self.path, trial=1j), "^trial: expected a number"),
            (lambda: slipbench.report(self.path, trial=7), "7"),
        ):
            with self.assertRaisesRegex(slipbench.InputError, words):
                call()

    def test_a_value_of_a_wrong_type_is_refused_by_the_name_of_its_argument(self):
        def export(**values):
            return slipbench.export(
                **{"dataset": self.path, "output": "x", "format": "npz"} | values
            )

        for call, words in (
            (lambda: export(format=3), "format: expected the name of a format, .*, found int 3"),
            (lambda: export(split=3), "split: expected 'train', 'valid', 'test' .*, found int 3"),
            (lambda: export(sensors=3), "sensors: expected a name or a list of names, found int 3"),
            (lambda: export(sensors=["pad", None]), "sensors: .*, found NoneType None"),
            (lambda: export(labels=["strict"]), "labels: .*, found list "),
            (lambda: export(licence=None), "licence: .*, found NoneType None"),
            (lambda: export(dataset=3), "dataset: expected a path, found int 3"),
            (lambda: export(output=None), "output: expected a path, found NoneType None"),
            (lambda: slipbench.report(3), "dataset: expected a path, found int 3"),
            (lambda: slipbench.import_recordings("a", format=3), "format: .*, found int 3"),
            (lambda: slipbench.import_recordings("a", map=3), "map: expected a path, found int 3"),
            (
                lambda: slipbench.import_recordings("", map="xela_ros"),
                "sources: expected a path or a list of paths, found str ''",
            ),
            (lambda: slipbench.verify([self.path, ""]), "datasets: .*, found str ''"),
        ):
            with self.assertRaisesRegex(slipbench.InputError, f"^{words}"):
                call()

    def test_the_program_names_an_empty_source(self):
        for words in (["--map", "xela_ros"], ["--format", "training-csv"]):
            done = subprocess.run(
                [PROGRAM, "import", "", *words], check=False, capture_output=True, text=True
            )
            self.assertEqual(done.returncode, 2)
            self.assertIn("import: the name of a source is empty", done.stderr)

    def test_warnings_of_an_import_are_warned_of_and_returned(self):
        """As many as the program prints are Python warnings, then one with the number of the rest."""
        logs = self.place / "uneven"
        logs.mkdir()
        for name in range(12):
            rows = "".join(f"{time},{k}\n" for k, time in enumerate((0.0, 0.01, 0.02, 0.5, 0.51)))
            (logs / f"{name}.csv").write_text("t,f\n" + rows)
        (self.place / "uneven.yaml").write_text(
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}}\n"
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = slipbench.import_recordings(logs, map=self.place / "uneven.yaml")
        texts = [str(one.message) for one in caught]
        self.assertEqual(len(result["warnings"]), 12)
        self.assertIn("not evenly spaced", texts[0])
        self.assertEqual(texts[:10], [one["text"] for one in result["warnings"]][:10])
        self.assertIn("2 more warnings", texts[10])
        self.assertEqual(len(texts), 11)
        self.assertEqual({one.filename for one in caught}, {__file__})


class InProcess(unittest.TestCase):
    """The commands work in the process that calls them."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.path = self.folder / "a.h5"
        slipbench.Scene.load("papillarray/stage.yaml").set(sweep={"trials": 2}).write(self.path)

    def test_an_empty_list_of_files_is_refused(self):
        out = self.folder / "out.h5"
        for call, key in (
            (lambda: slipbench.verify([]), "datasets"),
            (lambda: slipbench.merge([], out), "shards"),
            (lambda: slipbench.import_recordings([], out, format="training-csv"), "sources"),
        ):
            with self.assertRaisesRegex(slipbench.InputError, f"{key}: .* an empty list"):
                call()
        self.assertFalse(out.exists())

    def test_no_process_is_started(self):
        """Neither Python nor the program: the check of a file's structure has slipbench-reader."""
        started = []

        def audit(event, arguments):
            if event in ("subprocess.Popen", "os.exec", "os.posix_spawn", "os.fork"):
                started.append((event, arguments))

        sys.addaudithook(audit)
        slipbench.export(self.path, self.folder / "parquet", format="parquet")
        slipbench.export(self.path, self.folder / "csv", format="csv")
        slipbench.report(self.path)
        slipbench.verify(self.path)
        self.assertEqual(started, [])

    def test_errors_of_the_system_are_the_programs_message(self):
        """A limit on a file's size emulates a full disk."""
        unraisable = self.enterContext(mock.patch("sys.unraisablehook"))
        whole = slipbench.export(self.path, self.folder / "whole", format="parquet")["files"]
        limit = max(Path(file).stat().st_size for file in whole) // 2
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
        try:
            with self.assertRaisesRegex(slipbench.InputError, "^cannot write .*: File too large$"):
                slipbench.export(self.path, self.folder / "out", format="parquet")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        gc.collect()
        unraisable.assert_not_called()  # such as the destructor of a writer that is not closed
        self.assertFalse((self.folder / "out").exists())

    def test_a_missing_package_is_named(self):
        with (
            mock.patch.dict(sys.modules, {"rosbags.rosbag2": None}),
            self.assertRaisesRegex(
                slipbench.InputError,
                r"^export: --format rosbag2 needs the Python package rosbags.*slipbench\[export\]",
            ),
        ):
            sys.modules.pop("slipbench._export.rosbag2", None)
            slipbench.export(self.path, self.folder / "out", format="rosbag2")
        self.assertFalse((self.folder / "out").exists())

    def test_a_note_is_a_warning(self):
        """At the line that called the function."""
        dataset = self.folder / "two.h5"
        told("run", str(slipbench.scenes() / "grasp/two_skins.yaml"), "-o", str(dataset))
        with self.assertWarnsRegex(UserWarning, "^skin has no points: the forces or ") as warned:
            slipbench.export(dataset, self.folder / "out", format="lerobot", points=True)
        self.assertEqual(warned.filename, __file__)

    def test_functions_run_in_threads(self):
        """HDF5 is not thread-safe: an import by a map and other functions wait for one another."""
        files = slipbench.export(self.path, self.folder / "logs", format="vendor-csv")["files"]
        logs = [file for file in files if file.endswith(".csv")]
        (self.folder / "map.yaml").write_text(
            "{sensor: pad, type: own, time: {column: T_us, unit: us}, channels: {force: {unit: N, columns: [S0_GG_FX]}}, "
            "object: {file: '(demo_[0-9])'}}\n"
        )
        counts = []

        def read(k):
            for _ in range(5):
                made = slipbench.import_recordings(
                    logs, self.folder / f"{k}.h5", map=self.folder / "map.yaml"
                )
                counts.append(made["trials"])

        threads = [threading.Thread(target=read, args=(k,)) for k in range(3)]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            self.assertTrue(slipbench.verify(self.path)["holds"])
        self.assertEqual(counts, [len(logs)] * 15)

    def test_a_signal_leaves_nothing(self):
        """A signal has come before the work: the first look at it ends the work."""
        files = slipbench.export(self.path, self.folder / "logs", format="vendor-csv")["files"]
        logs = [file for file in files if file.endswith(".csv")]
        (self.folder / "map.yaml").write_text(
            "{sensor: pad, type: own, time: {column: T_us, unit: us}, channels: {force: {unit: N, columns: [S0_GG_FX]}}}\n"
        )
        shards = [self.folder / f"shard-{k}.h5" for k in (1, 2)]
        scene = str(slipbench.scenes() / "papillarray/stage.yaml")
        for k, shard in enumerate(shards, 1):
            told(
                "sweep", scene, "--set", "sweep={trials: 2}", "--shard", f"{k}/2", "-o", str(shard)
            )
        before = sorted(self.folder.rglob("*"))
        out = self.folder / "out"
        for name, work in {
            "report": lambda: slipbench.report(self.path, out),
            "verify": lambda: slipbench.verify(self.path),
            "merge": lambda: slipbench.merge(shards, out),
            "import": lambda: slipbench.import_recordings(logs, out, format="papillarray-csv"),
            "import by a map": lambda: slipbench.import_recordings(
                logs, out, map=self.folder / "map.yaml"
            ),
            **{
                format: lambda format=format: slipbench.export(self.path, out, format=format)
                for format in ("csv", "robomimic", "parquet", "lerobot", "mcap", "rosbag2")
            },
        }.items():
            with (
                self.subTest(name),
                self.assertRaises(KeyboardInterrupt),
                _core.Interrupt("a test stops"),
            ):
                signal.raise_signal(signal.SIGINT)
                work()
            self.assertEqual(sorted(self.folder.rglob("*")), before, name)
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        with self.assertRaises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)  # reaches Python again

        def late(function):
            """The function, with a signal when it has written its files."""

            def run(*arguments):
                result = function(*arguments)
                signal.raise_signal(signal.SIGTERM)
                return result

            return run

        with (
            self.assertRaises(KeyboardInterrupt),
            mock.patch.object(_export, "write", late(_export.write)),
        ):
            slipbench.export(self.path, out, format="csv")
        with (
            self.assertRaises(KeyboardInterrupt),
            mock.patch.object(_import, "read_mapped", late(_import.read_mapped)),
        ):
            slipbench.import_recordings(logs, out / "a.h5", map=self.folder / "map.yaml")


class Pytest(unittest.TestCase):
    def pytest(self, files, *words):
        """Returns exit status and output of pytest in a folder with these files."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                (Path(folder) / name).write_text(text, encoding="utf-8")
            done = subprocess.run(
                [
                    sys.executable,
                    "-m",
                    "pytest",
                    "-p",
                    "slipbench._pytest_plugin",
                    "-p",
                    "no:cacheprovider",
                    *words,
                ],
                cwd=folder,
                check=False,
                capture_output=True,
                text=True,
            )
            return done.returncode, done.stdout + done.stderr

    def test_scenes_with_expectations_are_collected(self):
        lift = (slipbench.scenes() / "grasp/lift.yaml").read_text(encoding="utf-8")
        brief = lift + "\nexpect: {dropped: false, control: none}\n"
        foreign = "name: a test of another tool\nexpect: {status: 200}\n"
        status, output = self.pytest(
            {"good.yaml": brief, "without.yaml": lift, "other.txt": brief, "foreign.yaml": foreign},
            "-v",
        )
        self.assertEqual(status, 0, output)
        self.assertIn("good.yaml::check PASSED", output)
        self.assertIn("1 passed", output)

    def test_a_failure_prints_the_table_of_check(self):
        lift = (slipbench.scenes() / "grasp/lift.yaml").read_text(encoding="utf-8")
        status, output = self.pytest(
            {
                "bad.yaml": lift + "\nexpect: {max_slip: 1 um}\n",
                "wrong.yaml": lift + "\nexpect: {max_slop: 1 um}\n",
            },
            "--slipbench-draws",
            "2",
        )
        self.assertEqual(status, 1, output)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "bad.yaml"
            path.write_text(lift + "\nexpect: {max_slip: 1 um}\n", encoding="utf-8")
            table = subprocess.run(
                [PROGRAM, "check", "bad.yaml", "--trials", "2"],
                cwd=folder,
                check=False,
                capture_output=True,
                text=True,
            ).stdout
        rows = [line.strip() for line in table.splitlines() if line.startswith("  max_slip")]
        self.assertEqual(len(rows), 1, table)
        self.assertIn(rows[0], output)
        self.assertRegex(output, "replay: slipbench run .*bad.yaml")
        self.assertRegex(output, r"wrong.yaml:\d+: .*max_slop")
        self.assertNotIn("Traceback", output)

    def test_the_readmes_example_passes(self):
        readme = (Path(__file__).resolve().parents[2] / "python/README.md").read_text(
            encoding="utf-8"
        )
        example = re.search(r"^```py\n(.*?)^```$", readme, re.MULTILINE | re.DOTALL)[1]
        status, output = self.pytest({"test_readme.py": example})
        self.assertEqual(status, 0, output)
        self.assertIn("1 passed", output)

    def test_the_fixture_checks_a_scene(self):
        test = """
import pytest, slipbench
def scene(**expect):
    return slipbench.Scene.load("grasp/lift.yaml").set(expect=expect)
def test_good(slipbench_check):
    assert slipbench_check(scene(dropped=False, control="none"), draws=1).passed
def test_bad(slipbench_check):
    slipbench_check(scene(max_slip="1 um"))
def test_nothing(slipbench_check):
    slipbench_check("grasp/lift.yaml")
def test_missing(slipbench_check):
    slipbench_check("gone.yaml")
@slipbench.controller("still")
class Still:
    def __init__(self, source):
        pass
    def act(self, frame, slip):
        return 100
def test_own(slipbench_check):
    slipbench_check(scene(max_slip="1 um").set(controller={"type": "still"}))
"""
        status, output = self.pytest({"test_grasp.py": test})
        self.assertEqual(status, 1)
        self.assertIn("4 failed, 1 passed", output)
        self.assertIn("gone.yaml: cannot be read", output)
        self.assertNotIn("Traceback", output)
        self.assertNotIn("_pytest_plugin.py", output)
        self.assertRegex(output, r"max_slip +at most 1 um")
        self.assertIn("the scene has no expectations", output)
        # The program does not know the controller of test_own, so only Python can repeat its trial.
        self.assertRegex(
            output,
            r"replay: in Python, .*slipbench\.Scene\.load\(\"[^\n]*still[^\n]*\)\.run\(0, seed=\d+\)",
        )
        self.assertRegex(output, r"replay: .*slipbench run ")


if __name__ == "__main__":
    unittest.main()
