"""The folder written by `slipbench cluster`: content, refusals, and its scripts run by hand.

Arguments: the project's root, the program.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()
STAGE = ROOT / "scenes/papillarray/stage.yaml"
SETTINGS = ("--set", "duration=320 ms", "sweep={motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}}", "motion.start=300 ms",
            "motion.compression=0.2 mm", "--seed", "3")  # fmt: skip
SWEEP = (*SETTINGS, "--trials", "6")


def content_sha256(path):
    with h5py.File(path) as file:
        return file.attrs["content_sha256"]


class FolderTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        shutil.copy(STAGE, self.folder / "a scene.yaml")

    def run_program(self, *words, status=0):
        result = subprocess.run(
            [PROGRAM, *map(str, words)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=300,
        )
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def cluster(self, name, shards, *words, trials=6):
        self.run_program(
            "cluster",
            "a scene.yaml",
            *SETTINGS,
            "--trials",
            trials,
            "-o",
            name,
            "--shards",
            shards,
            *words,
        )
        return self.folder / name

    def script(self, *words, status=0, environment=None):
        result = subprocess.run(
            ["bash", *map(str, words)],
            capture_output=True,
            text=True,
            timeout=300,
            env={**os.environ, **(environment or {})},
        )
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def test_scripts_by_hand_give_the_undivided_sweep(self):
        self.run_program("sweep", "a scene.yaml", *SWEEP, "-o", "whole.h5", "--quiet")
        cluster = self.cluster("a folder", 3)
        for k in (2, 1, 3):
            self.assertIn(
                f"shard {k}/3 is finished", self.script(cluster / "shard.sh", k, "by-hand").stdout
            )
        self.assertIn(
            "shard 2/3 exists, and its digests are correct",
            self.script(cluster / "shard.sh", 2, "again").stdout,
        )
        self.script(cluster / "merge.sh")
        self.assertEqual(
            content_sha256(cluster / "a scene.h5"), content_sha256(self.folder / "whole.h5")
        )
        self.assertEqual(list((cluster / "attempts").iterdir()), [])

    def test_the_path_of_the_program_may_contain_blanks(self):
        # The scripts start the program under its own path, here a copy's.
        scripts = {}
        for name, environment in (("plain", {}), ("words", {"SLIPBENCH": "env A=1  slipbench"})):
            result = subprocess.run([PROGRAM, "cluster", "a scene.yaml", *SETTINGS, "--trials", "2", "-o", name, "--shards", "2"],
                                    capture_output=True, text=True, cwd=self.folder, timeout=300,
                                    env={**{k: v for k, v in os.environ.items() if k != "SLIPBENCH"}, **environment})  # fmt: skip
            self.assertEqual(result.returncode, 0, result.stderr)
            scripts[name] = (self.folder / name / "shard.sh").read_text()
        self.assertRegex(scripts["words"], r"(?m)^slipbench=\(env '?A=1'? slipbench\)$")
        blank = self.folder / "a  b"
        blank.mkdir()
        (blank / "slipbench").write_text('#!/bin/sh\necho "started: $1"\nexit 1\n')
        (blank / "slipbench").chmod(0o755)
        line = re.search(r"(?m)^slipbench=\(.*\)$", scripts["plain"]).group()
        script = self.folder / "plain/shard.sh"
        script.write_text(scripts["plain"].replace(line, f"slipbench=('{blank}/slipbench')"))
        environment = {k: v for k, v in os.environ.items() if k != "SLIPBENCH"}
        result = subprocess.run(
            ["bash", script, "1", "first"],
            capture_output=True,
            text=True,
            timeout=300,
            env=environment,
        )
        self.assertIn("started: ", result.stdout)

    def test_a_damaged_shard_is_made_again(self):
        cluster = self.cluster("cluster", 2)
        self.script(cluster / "shard.sh", 1, "first")
        shard = cluster / "shards/1/shard.h5"
        whole = shard.read_bytes()
        shard.write_bytes(whole[:-100])
        self.assertIn(
            "shard 1/2 is finished", self.script(cluster / "shard.sh", 1, "second").stdout
        )
        self.assertEqual(shard.read_bytes(), whole)

    def test_an_attempt_that_still_runs_is_left_alone(self):
        cluster = self.cluster("cluster", 2)
        own = cluster / "attempts/1.same"
        own.mkdir(parents=True)
        # Without a fork: a sleep that continues would hold the test's output open, for which CTest
        # waits.
        with subprocess.Popen(["flock", "--no-fork", own, "sleep", "60"]) as earlier:
            while subprocess.run(["flock", "--nonblock", own, "true"], check=False).returncode == 0:
                pass
            self.script(cluster / "shard.sh", 1, "same")
            earlier.terminate()
        self.assertTrue((cluster / "shards/1/shard.h5").exists())
        self.assertEqual(list(own.iterdir()), [])

    def test_a_bad_scene_ends_the_shard_and_publishes_nothing(self):
        cluster = self.cluster("cluster", 2)
        (self.folder / "a scene.yaml").write_text("slipbench: 1\nduratoin: 1 s\n", encoding="ascii")
        self.assertIn(
            "unknown key 'duratoin'", self.script(cluster / "shard.sh", 1, "first", status=2).stderr
        )
        self.assertFalse((cluster / "shards/1").exists())
        self.assertNotEqual(
            subprocess.run(
                ["bash", cluster / "merge.sh"], capture_output=True, check=False
            ).returncode,
            0,
        )

    def test_another_way_to_start_the_program(self):
        cluster = self.cluster("cluster", 2)
        self.script(
            cluster / "shard.sh", 1, "first", environment={"SLIPBENCH": f"env NO_COLOR=1 {PROGRAM}"}
        )
        self.assertTrue((cluster / "shards/1/shard.h5").exists())
        self.script(cluster / "shard.sh", 2, "first", status=1, environment={"SLIPBENCH": "false"})

    def test_the_array(self):
        def array(cluster):
            return (cluster / "array.sbatch").read_text(encoding="utf-8")

        self.assertIn("#SBATCH --array=1-6%6\n", array(self.cluster("six", 6)))
        text = array(self.cluster("throttled", 6, "--throttle", 2, "--jobs", 4))
        self.assertIn("#SBATCH --array=1-6%2\n", text)
        self.assertIn("#SBATCH --cpus-per-task=4\n", text)
        self.assertIn("#SBATCH --requeue\n", text)
        # Slurm's default MaxArraySize is 1001, and an index must be less: 1,000 tasks run 2,500
        # shards, three or two each.
        text = array(self.cluster("many", 2500, trials=2500))
        self.assertIn("#SBATCH --array=1-1000%1000\n", text)
        loop = re.search(r"for \(\(.*?\)\); do", text)[0]
        ran = []
        for task in (1, 500, 501, 1000):
            ran.append(
                self.script(
                    "-c", f"SLURM_ARRAY_TASK_ID={task}; {loop} echo $k; done"
                ).stdout.split()
            )
        self.assertEqual(
            ran, [["1", "1001", "2001"], ["500", "1500", "2500"], ["501", "1501"], ["1000", "2000"]]
        )

    def test_what_is_refused(self):
        def refuse(told, *words):
            self.assertRegex(self.run_program("cluster", *words, status=2).stderr, told)

        out = ("-o", "cluster", "--shards")
        refuse("--shard.* 1/7, .* 6 trials", "a scene.yaml", *SWEEP, *out, 7)
        refuse("--shards.*'0'", "a scene.yaml", *out, 0)
        refuse("empty folder", "a scene.yaml", *SWEEP, "-o", ".", "--shards", 2)
        refuse("empty folder", "a scene.yaml", *SWEEP, "-o", "a scene.yaml", "--shards", 2)
        refuse("nothing.yaml", "nothing.yaml", *out, 2)
        refuse(
            "motion.start.*10 ms", "a scene.yaml", *SWEEP, "--set", "motion.start=10 ms", *out, 2
        )
        self.assertFalse((self.folder / "cluster").exists())

    def test_a_folder_that_a_killed_run_has_left_is_written_anew(self):
        out = ("cluster", "a scene.yaml", *SWEEP, "-o", "cluster", "--shards", 2)
        folder = self.folder / "cluster"
        (folder / "logs").mkdir(parents=True)
        (folder / "shard.sh.partial").write_text("#!/bin/")
        (folder / "README.md").write_text("half")
        self.run_program(*out)
        self.assertNotEqual((folder / "README.md").read_text(), "half")
        self.assertIn(
            "it is not empty", self.run_program(*out, status=2).stderr
        )  # the whole output

    def test_names_that_look_like_places_of_the_forms(self):
        # The scripts are forms with places such as @N@. A scene m@N@.yaml and folders named after places keep their names.
        folder = self.folder / "x@SWEEP@y"
        folder.mkdir()
        (self.folder / "a scene.yaml").rename(folder / "m@N@.yaml")
        words = (
            "cluster",
            "m@N@.yaml",
            *SETTINGS,
            "--trials",
            2,
            "-o",
            "@RAW_FOLDER@$(touch run)",
            "--shards",
            2,
        )
        subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, cwd=folder)
        cluster = folder / "@RAW_FOLDER@$(touch run)"
        for k in (1, 2):
            self.script(cluster / "shard.sh", k, "by-hand")
        self.script(cluster / "merge.sh")
        self.assertTrue((cluster / "m@N@.h5").exists())
        self.assertEqual(list(self.folder.rglob("run")), [])
        self.assertIn(
            f'--output="{cluster}/logs/%a.log"\n',
            (cluster / "array.sbatch").read_text(encoding="utf-8"),
        )

    def test_a_folder_that_no_longer_exists(self):
        gone = self.folder / "gone"
        gone.mkdir()
        words = f'rmdir "{gone}" && "{PROGRAM}" cluster "{self.folder}/a scene.yaml" -o "{self.folder}/out" --shards 2 --trials 2'
        result = subprocess.run(
            ["bash", "-c", words], cwd=gone, capture_output=True, text=True, check=False
        )
        self.assertEqual(result.returncode, 2)
        self.assertIn("current folder", result.stderr)
        self.assertNotIn("internal error", result.stderr)

    def test_scripts_pass_shellcheck(self):
        cluster = self.cluster("cluster", 2)
        for name in ("shard.sh", "merge.sh", "array.sbatch"):
            subprocess.run(["shellcheck", "--shell=bash", cluster / name], check=True)


if __name__ == "__main__":
    unittest.main()
