"""`slipbench detect`: alarms of recordings with and without labels, as tables and as a page."""

import json
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import slipbench

RATE = 100  # Hz
MAP = """{{sensor: pad, type: papillarray, time: {{column: t}},
 channels: {{force: {{unit: N, components: 3, columns: [f0 .. f26]}}}}{labels}}}"""
LABELS = ", state: {column: slip, values: {0: non_slip, 1: gross}, rule: by hand}"


def write_log(path):
    """3 s of nine pillars under 1 N each, with 0.1 N of shear, 0.6 N from 1 s to 2 s.

    The label says slip from 1.1 s to 2 s.
    """
    time = np.arange(3 * RATE) / RATE
    shear = np.where((time >= 1) & (time < 2), 0.6, 0.1)
    columns = {"t": time}
    for k in range(27):
        columns[f"f{k}"] = [shear, 0 * time, 0 * time + 1][k % 3]
    columns["slip"] = ((time >= 1.1) & (time < 2)).astype(int)
    pd.DataFrame(columns).to_csv(path, index=False)


class DetectTest(unittest.TestCase):
    """One log, imported with and without its labels; the detector alarms where shear exceeds 0.35 of the load."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.place = Path(cls.folder.name)
        write_log(cls.place / "log.csv")
        for name, labels in (("labelled", LABELS), ("plain", "")):
            (cls.place / f"{name}.yaml").write_text(MAP.format(labels=labels))
            slipbench.import_recordings(
                cls.place / "log.csv", cls.place / f"{name}.h5", map=cls.place / f"{name}.yaml"
            )

    def detect(self, name, output=""):
        return slipbench.detect(
            "force_ratio",
            self.place / f"{name}.h5",
            output and self.place / output,
            parameters={"ratio": 0.35},
        )

    def test_a_long_gap_is_interpolated_only_when_asked(self):
        log = pd.read_csv(self.place / "log.csv")
        log[(log.index < 100) | (log.index >= 140)].to_csv(
            self.place / "gap.csv", index=False
        )  # a step of 0.41 s
        with self.assertWarnsRegex(UserWarning, "not evenly spaced"):
            slipbench.import_recordings(
                self.place / "gap.csv", self.place / "gap.h5", map=self.place / "labelled.yaml"
            )
        for judge in (slipbench.detect, slipbench.evaluate):
            with self.assertRaisesRegex(
                slipbench.InputError,
                "sensor 'pad': a step of 410 ms, 990 ms after the first sample, .*--resample",
            ):
                judge("deviation", self.place / "gap.h5")
            notice = judge("deviation", self.place / "gap.h5", resample=True)["notice"]
            resampled, threshold = notice.rsplit("; the ", 1)
            self.assertEqual(
                resampled,
                "resampled evenly at 100 Hz for deviation; 1 gap of at most 410 ms bridged; the figures are of interpolated data",
            )
            self.assertIn("default threshold", threshold)

    def test_samples_that_import_made_up_are_stated(self):
        # Every third sample, 33.3 Hz. At 100 Hz from 0 to 2.97 s: 298 samples, of which 100 are recorded.
        log = pd.read_csv(self.place / "log.csv")
        log.iloc[:298:3].to_csv(self.place / "slow.csv", index=False)
        with self.assertWarnsRegex(UserWarning, "above the 33.3333 Hz"):
            slipbench.import_recordings(
                self.place / "slow.csv",
                self.place / "faster.h5",
                map=self.place / "labelled.yaml",
                rate="100 Hz",
            )
        for judge in (slipbench.detect, slipbench.evaluate):
            notice = judge("force_ratio", self.place / "faster.h5")["notice"]
            self.assertEqual(
                notice,
                "`import --rate` interpolated 198 of 298 samples; the figures are of interpolated data",
            )
        # At its own rate, 30 of 300 samples lie in a gap, of which one in ten may.
        log[(log.index < 100) | (log.index >= 130)].to_csv(self.place / "hole.csv", index=False)
        with self.assertWarnsRegex(UserWarning, "in gaps of the recording"):
            slipbench.import_recordings(
                self.place / "hole.csv",
                self.place / "filled.h5",
                map=self.place / "labelled.yaml",
                rate="100 Hz",
            )
        self.assertEqual(
            slipbench.detect("force_ratio", self.place / "filled.h5")["notice"],
            "`import --rate` interpolated 30 of 300 samples, in gaps",
        )
        self.assertEqual(self.detect("labelled")["notice"], "")

    def test_missing_values_are_not_taken_for_readings(self):
        log = pd.read_csv(self.place / "log.csv")
        log.loc[150:159, "f3"] = np.nan  # 1.5 s to 1.59 s
        log.to_csv(self.place / "missing.csv", index=False)
        (self.place / "missing.yaml").write_text(MAP.format(labels=LABELS + ", missing: nan"))
        with self.assertWarnsRegex(UserWarning, "10 of 300 samples have missing values"):
            slipbench.import_recordings(
                self.place / "missing.csv",
                self.place / "missing.h5",
                map=self.place / "missing.yaml",
            )
        for judge in (slipbench.detect, slipbench.evaluate):
            with self.assertRaisesRegex(
                slipbench.InputError,
                r"trial 0: sensor pad: value 4 of channel force \(f3\) is missing at 1.5 s; .* missing: gap",
            ):
                judge("force_ratio", self.place / "missing.h5")

    def test_a_dead_element_is_named_with_the_way_out(self):
        log = pd.read_csv(self.place / "log.csv")
        log[["f3", "f4", "f5"]] = np.nan  # the second pillar
        log.to_csv(self.place / "dead.csv", index=False)
        described = MAP.format(labels=LABELS + ", missing: nan")
        ways = {
            "dead": described,
            "without": described.replace("f0 .. f26", "f0 .. f2, f6 .. f26"),
            "neighbour": described.replace("f0 .. f26", "f0 .. f2, f0 .. f2, f6 .. f26"),
        }
        for name, text in ways.items():
            (self.place / f"{name}.yaml").write_text(text)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of the missing values
                slipbench.import_recordings(
                    self.place / "dead.csv",
                    self.place / f"{name}.h5",
                    map=self.place / f"{name}.yaml",
                )
        message = r"value 4 of channel force \(f3\) is missing in all samples; in the map, leave out the column of a defective element, or name the column of a neighbour"
        for judge in (slipbench.detect, slipbench.evaluate):
            with self.assertRaisesRegex(slipbench.InputError, message):
                judge("force_ratio", self.place / "dead.h5")
        alarms = self.detect("labelled")["trials"][0]["alarms"]
        for name in ("without", "neighbour"):  # all pillars of the log have equal readings
            self.assertEqual(self.detect(name)["trials"][0]["alarms"], alarms)

    def test_an_unknown_detector_is_named_without_another_command(self):
        for judge in (slipbench.detect, slipbench.evaluate):
            with self.assertRaisesRegex(
                slipbench.InputError, "^unknown detector 'nope'; allowed: force_ratio, "
            ):
                judge("nope", self.place / "plain.h5")
            with self.assertRaisesRegex(
                slipbench.InputError, "^no network is given; use FILE.onnx"
            ):
                judge("network", self.place / "plain.h5")

    def test_alarms_are_those_of_eval_with_or_without_labels(self):
        judged = slipbench.evaluate(
            "force_ratio", self.place / "labelled.h5", parameters={"ratio": 0.35}
        )
        self.assertEqual(judged["labels"], "recorded")
        labelled, plain = self.detect("labelled")["trials"][0], self.detect("plain")["trials"][0]
        self.assertEqual(labelled["alarms"], plain["alarms"])
        self.assertEqual(labelled["samples"]["state"], plain["samples"]["state"])
        self.assertEqual(len(plain["alarms"]), 1)
        self.assertEqual(plain["alarms"][0]["begin_s"], judged["trials"][0]["alarm_time_s"])
        self.assertAlmostEqual(
            plain["alarms"][0]["begin_s"], 1.0, delta=0.05
        )  # the shear rises at 1 s
        self.assertEqual(
            labelled["wrong_share"], judged["trials"][0]["wrong"] / judged["trials"][0]["frames"]
        )
        self.assertIsNone(plain["wrong_share"])
        self.assertIsNone(plain["samples"]["label"])
        self.assertAlmostEqual(
            plain["alarms_per_minute"], 60 / 2.99
        )  # one alarm from the first sample to the last, 2.99 s

    def test_tables_and_json_hold_the_same(self):
        result = self.detect("labelled", "a.csv")
        self.assertEqual([Path(file).name for file in result["files"]], ["a.csv", "a_samples.csv"])
        self.detect("labelled", "a.parquet")
        for name in ("a", "a_samples"):
            table = pd.read_parquet(self.place / f"{name}.parquet")
            texts = pd.read_csv(
                self.place / f"{name}.csv", keep_default_na=False, na_values={"probability": ""}
            )
            self.assertEqual(list(table), list(texts))
            for column in ("trial", "begin_s", "end_s", "time_s", "state", "slip", "label"):
                if column in table:
                    self.assertEqual(table[column].tolist(), texts[column].tolist(), column)
        self.detect("labelled", "b.json")
        self.assertEqual(
            json.loads((self.place / "b.json").read_text())["trials"], result["trials"]
        )

    def test_the_page_shows_signals_and_alarms(self):
        self.detect("plain", "a.html")
        page = (self.place / "a.html").read_text()
        for part in (
            "have no labels",
            "force, component 3 of 3: the 8 of 9 values that change the most",
            "force [N]",
            "time [s]",
            "bar alarm",
            ">detector</text>",
            "trial 0",
        ):
            self.assertIn(part, page)

    def test_only_its_own_files_are_replaced(self):
        for name in ("c.csv", "c.json", "c.html", "c.parquet"):
            (self.place / name).write_text("mine")
            with self.assertRaisesRegex(slipbench.InputError, name):
                self.detect("plain", name)
            self.assertEqual((self.place / name).read_text(), "mine")
        with self.assertRaisesRegex(
            slipbench.InputError, r"ends with \.txt; allowed: \.csv, \.json, \.html or \.parquet"
        ):
            self.detect("plain", "a.txt")

    def test_the_program_writes_parquet(self):
        words = [
            "detect",
            "force_ratio",
            "plain.h5",
            "--set",
            "ratio=0.35",
            "-o",
            "d.parquet",
            "--json",
        ]
        done = subprocess.run(
            [sys.executable, "-m", "slipbench", *words],
            cwd=self.place,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["files"], ["d.parquet", "d_samples.parquet"])
        self.assertEqual(len(pd.read_parquet(self.place / "d.parquet")), 1)

    def test_neither_table_is_half_written(self):
        (self.place / "e_samples.parquet.partial").mkdir()  # the second file cannot be written
        with self.assertRaisesRegex(slipbench.InputError, "cannot write .*e.parquet"):
            self.detect("plain", "e.parquet")
        self.assertEqual(
            sorted(path.name for path in self.place.glob("e*.parquet*")),
            ["e_samples.parquet.partial"],
        )

    def test_a_planted_link_is_not_written_through(self):
        victim = self.place / "victim"
        victim.write_text("mine")
        for name in ("f.parquet", "f_samples.parquet", "f.csv", "f_samples.csv"):
            link = self.place / f"{name}.partial"
            link.symlink_to(victim)
            with self.assertRaisesRegex(slipbench.InputError, "symbolic link"):
                self.detect("plain", name.replace("_samples", ""))
            link.unlink()
        (self.place / "f.parquet").symlink_to(victim)
        with self.assertRaisesRegex(slipbench.InputError, "f.parquet: it is a symbolic link"):
            self.detect("plain", "f.parquet")
        self.assertEqual((victim.read_text(), len(list(self.place.glob("f[._]*")))), ("mine", 1))

    def test_a_full_disk_leaves_both_tables_or_none(self):
        """The table of samples is longer than that of alarms: a limit between both emulates the full disk."""
        for ending in ("csv", "parquet"):
            self.detect("plain", f"g.{ending}")
            sizes = [
                (self.place / name).stat().st_size
                for name in (f"g.{ending}", f"g_samples.{ending}")
            ]
            self.assertLess(sizes[0], sizes[1])
            command = [
                sys.executable,
                "-m",
                "slipbench",
                "detect",
                "force_ratio",
                "plain.h5",
                "--set",
                "ratio=0.35",
                "-o",
                f"h.{ending}",
            ]
            limit = (sizes[0] + sizes[1]) // 2
            done = subprocess.run(
                command,
                cwd=self.place,
                capture_output=True,
                text=True,
                check=False,
                preexec_fn=lambda limit=limit: (
                    signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
                ),
            )
            self.assertEqual(
                (done.returncode, [path.name for path in self.place.glob("h*")]), (2, [])
            )
            self.assertRegex(
                done.stderr, r"^slipbench: cannot write h(_samples)?\.\w+: File too large\n$"
            )

    def test_a_name_is_no_address(self):
        """PyArrow would take b:c.parquet for an address of a file system b."""
        command = [
            sys.executable,
            "-m",
            "slipbench",
            "detect",
            "force_ratio",
            "plain.h5",
            "--set",
            "ratio=0.35",
            "-o",
            "b:c.parquet",
        ]
        for _ in range(2):  # the second run replaces the files of the first
            done = subprocess.run(
                command, cwd=self.place, capture_output=True, text=True, check=False
            )
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run(
                command, cwd=self.place, stdout=full, stderr=subprocess.PIPE, text=True, check=False
            )
        self.assertEqual(
            (done.returncode, done.stderr),
            (2, "slipbench: cannot write to standard output: No space left on device\n"),
        )

    def test_a_recording_counts_once(self):
        with self.assertRaisesRegex(
            slipbench.InputError, r"\./plain\.h5: was given twice; give each recording once"
        ):
            slipbench.detect(
                "force_ratio",
                [self.place / "plain.h5", f"{self.place}/./plain.h5"],
                parameters={"ratio": 0.35},
            )


if __name__ == "__main__":
    del sys.argv[1]
    unittest.main()
