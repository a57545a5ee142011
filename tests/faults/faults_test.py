"""Makes the program's calls fail one after the other (faults.c), as SQLite's tests do.

usage: faults_test.py SLIPBENCH COMPILER FOLDER FAULTS [CASE ...]

For each case, kind of call and error up to FAULTS calls fail, evenly chosen; 0: all. Tested are a
call that fails alone, and one from which on all fail. README.md lists the requirements.
"""

import collections
import errno
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py

HERE = Path(__file__).resolve().parent
SECONDS = 60  # no command takes longer

# 0: half a write. Interrupted or partial writes must be continued.
KINDS = {
    "write": (errno.ENOSPC, errno.EIO, errno.EINTR, 0),
    "sync": (errno.EIO, errno.ENOSPC, errno.EINTR),
    "rename": (errno.EIO, errno.ENOSPC),
    "open": (errno.ENOSPC, errno.EIO, errno.EMFILE),
}
SURVIVED = (errno.EINTR, 0)

SCENE = """slipbench: 1
description: short slides
duration: 0.1 s
time_step: 1 ms
seed: 7
surface: {material: acrylic}
motion: {kind: stage, gap: 0 mm, compression: 0.1 mm, approach_speed: 10 mm/s, start: 50 ms, speed: 16 mm/s, acceleration: 1 m/s2}
sensors:
  pad: {type: papillarray, rate: 1 kHz, electronics: typical, bristles: 3}
sweep:
  motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}
  trials: 2
"""


class Bench:
    def __init__(self, program, compiler, folder):
        self.program, self.folder = program, folder
        self.shim, self.count = folder / "faults.so", folder / "count"
        subprocess.run(
            [
                compiler,
                "-O1",
                "-shared",
                "-fPIC",
                "-Wall",
                "-Werror",
                "-o",
                self.shim,
                HERE / "faults.c",
                "-ldl",
            ],
            check=True,
        )
        scene = self.path("scene.yaml")
        Path(scene).write_text(SCENE, encoding="ascii")
        self.made("sweep", scene, "-o", self.path("two.h5"))
        self.made(
            "sweep",
            scene,
            "--trials",
            "12",
            "--set",
            "duration=0.6 s",
            "motion.start=0.3 s",
            "motion.compression=0.6 mm",
            "-o",
            self.path("many.h5"),
        )
        for k in ("1", "2"):
            self.made("sweep", scene, "--shard", f"{k}/2", "-o", self.path(f"shard-{k}.h5"))
        self.made(
            "export", self.path("two.h5"), "--format", "vendor-csv", "-o", self.path("vendor")
        )
        self.made(
            "sweep",
            HERE / "../../scenes/biotac_sp/slip.yaml",
            "--trials",
            "1",
            "--set",
            "duration=100 ms",
            "sweep={}",
            "-o",
            self.path("biotac.h5"),
        )
        self.made(
            "sweep",
            HERE / "../../scenes/myrmex/slip.yaml",
            "--trials",
            "1",
            "--set",
            "duration=50 ms",
            "sweep={}",
            "-o",
            self.path("myrmex.h5"),
        )

    def path(self, name):
        return str(self.folder / name)

    def made(self, *words):
        subprocess.run([self.program, *words], check=True, capture_output=True, timeout=SECONDS)

    def run(self, words, where, kind=None, error=0, span=(0, 0)):
        """Returns the status, the text on stderr and the number of calls of the kind."""
        env = {**os.environ, "TMPDIR": str(where)}
        if kind:
            self.count.write_bytes(bytes(8))
            env |= {
                "LD_PRELOAD": str(self.shim),
                "FAULT_UNDER": f"{where}/",
                "FAULT_KIND": kind,
                "FAULT_ERROR": str(error),
                "FAULT_FROM": str(span[0]),
                "FAULT_TO": str(span[1]),
                "FAULT_COUNT": str(self.count),
            }
        try:
            done = subprocess.run(
                [self.program, *words],
                capture_output=True,
                env=env,
                timeout=SECONDS,
                cwd=where,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return "hang", "", 0
        return (
            done.returncode,
            done.stderr.decode(errors="replace"),
            int.from_bytes(self.count.read_bytes(), sys.byteorder) if kind else 0,
        )


def cases(bench):
    """Returns the commands: their words, and the words added to continue.

    OUT is the folder they write to.
    """
    scene, two = bench.path("scene.yaml"), bench.path("two.h5")
    found = {
        "run": (["run", scene, "--trials", "2", "-o", "OUT/a.h5", "--quiet"], ["--resume"]),
        "sweep": (["sweep", scene, "--jobs", "2", "-o", "OUT/a.h5", "--quiet"], ["--resume"]),
        "six": (
            ["sweep", scene, "--trials", "6", "--jobs", "1", "-o", "OUT/a.h5", "--quiet"],
            ["--resume"],
        ),
        "isolate": (["sweep", scene, "--isolate", "-o", "OUT/a.h5", "--quiet"], ["--resume"]),
        "resume": (["sweep", scene, "--trials", "4", "-o", "OUT/a.h5", "--quiet", "--resume"], []),
        "merge": (
            ["merge", bench.path("shard-1.h5"), bench.path("shard-2.h5"), "-o", "OUT/a.h5"],
            [],
        ),
        "import": (
            ["import", bench.path("vendor"), "--format", "papillarray-csv", "-o", "OUT/a.h5"],
            [],
        ),
        "train_hd": (["train-hd", bench.path("many.h5"), "-o", "OUT/memories"], []),
        "recipe": (
            [
                "train",
                bench.path("many.h5"),
                "--recipe",
                "papillarray_gru",
                "--steps",
                "2",
                "-o",
                "OUT/a.onnx",
            ],
            [],
        ),
        "report": (["report", two, "-o", "OUT/a.html"], []),
        "benchmark": (
            [
                "benchmark",
                "--sensor",
                "biotac_sp",
                "--trials",
                "1",
                "--quiet",
                "--submit",
                "OUT/a.json",
                "-o",
                "OUT/board.html",
            ],
            [],
        ),
    }
    of_sensor = {"slip-csv": "biotac.h5", "myrmex-csv": "myrmex.h5", "myrmex-rotated": "myrmex.h5"}
    for format in (
        "csv",
        "npz",
        "robomimic",
        "vendor-csv",
        "training-csv",
        "slip-csv",
        "myrmex-csv",
        "myrmex-rotated",
        "parquet",
        "mcap",
        "rosbag2",
        "lerobot",
    ):
        out = "OUT/a.h5" if format == "robomimic" else "OUT/out"
        found[f"export {format}"] = (
            ["export", bench.path(of_sensor.get(format, "two.h5")), "--format", format, "-o", out],
            [],
        )
    return found


class Case:
    def __init__(self, bench, name, words, resume):
        self.bench, self.where, self.resume = bench, bench.folder / "out", resume
        self.words = [word.replace("OUT", str(self.where)) for word in words]
        self.begin = bench.folder / f"begin-{name}"  # content of the folder before the command runs
        self.begin.mkdir()
        if name == "resume":
            self.leave_half(self.begin)
        status, told, _ = self.run()
        assert status == 0, f"{words}: {told}"
        self.right, self.recovered = contents(self.where), {}
        assert self.right, words

    def calls(self, kind):
        return self.run(kind)[2]

    def leave_half(self, folder):
        """Interrupts a sweep after its first trials."""
        words = [
            word.replace(str(self.where), str(folder)) for word in self.words if word != "--resume"
        ]
        for _ in range(100):
            shutil.rmtree(folder)
            folder.mkdir()
            with subprocess.Popen(
                [self.bench.program, *words, "--jobs", "1"], stderr=subprocess.PIPE, text=True
            ) as sweep:
                while sweep.poll() is None and not list(
                    folder.glob("a.h5.partial/batch*")
                ):  # the first trial is written
                    time.sleep(0.001)
                sweep.send_signal(signal.SIGINT)
                told = sweep.communicate(timeout=SECONDS)[1]
            if re.search("[1-3] of 4 trials", told):
                return
        raise AssertionError(told)

    def run(self, *fault):
        shutil.rmtree(self.where, ignore_errors=True)
        shutil.copytree(self.begin, self.where)
        return self.bench.run(self.words, self.where, *fault)

    def wrong(self, kind, error, span):
        """Returns what is wrong with the command under this fault, empty if nothing is.

        None if it makes no such call.
        """
        status, told, calls = self.run(kind, error, span)
        if status == "hang":
            return "hang"
        if calls < span[0]:
            return None
        if status < 0:
            return f"signal {-status}"
        if found := self.wrong_files():
            return found
        if status == 0:
            return "" if self.left() == self.right else "status 0, and files are missing"
        return self.wrong_message(status, told, error) or self.wrong_next_run(told)

    def left(self):
        """Contents of the files under a final name."""
        return {
            name: content
            for name, content in contents(self.where).items()
            if ".partial" not in name and "checkpoint" not in name
        }

    def wrong_files(self):
        """Returns what is wrong with the files, empty if nothing is."""
        before = contents(self.begin)
        complete = all(
            content in (self.right.get(name), before.get(name))
            for name, content in self.left().items()
        )
        return "" if complete else "other bytes under a final name"

    def wrong_message(self, status, told, error):
        """Returns what is wrong with the end of a command that failed, empty if nothing is."""
        if error in SURVIVED:
            return f"not survived: {told.strip()}"
        message = told[told.rfind("slipbench: ") :].strip()
        if status not in (1, 2) or not message or "internal error" in told or "Traceback" in told:
            return f"status {status}: {told.strip()}"
        if os.strerror(error) not in message or str(self.where) not in message:
            return f"file or reason not named: {message}"
        return ""

    def wrong_next_run(self, told):
        """Returns what is wrong with the next run after one that failed, empty if nothing is."""
        held = re.search(r"holds? (\d+) of", told)
        checkpoint = (
            ["--resume"]
            if any(name.endswith("checkpoint-0") for name in contents(self.where))
            else []
        )
        again = [*self.words, *self.resume, *checkpoint, *(["--json"] if held else [])]
        there = hash((*again, *sorted(contents(self.where).items())))
        if there not in self.recovered:  # equal files continue in the same way
            done = subprocess.run(
                [self.bench.program, *again], capture_output=True, timeout=SECONDS, check=False
            )
            if done.returncode != 0 or contents(self.where) != self.right:
                return f"the next one ends with {done.returncode}: {done.stderr.decode().strip()}"
            self.recovered[there] = json.loads(done.stdout)["resumed"] if held else 0
        if held and self.recovered[there] < int(held[1]):
            return f"finished trials are lost: {told.strip()}"
        return ""


def content_of(path):
    """Returns a dataset's digest, because joined datasets differ in layout; otherwise the bytes."""
    data = path.read_bytes()
    try:
        with h5py.File(io.BytesIO(data)) as file:
            return file.attrs["content_sha256"]
    except (OSError, KeyError, RuntimeError):
        return data


def contents(folder):
    return {
        str(path.relative_to(folder)): content_of(path)
        for path in folder.rglob("*")
        if path.is_file()
    }


def chosen(calls, most):
    """Returns up to `most` of the calls 1 to `calls`, evenly spaced; 0: all."""
    return (
        range(1, calls + 1)
        if most == 0 or calls <= most
        else sorted({1 + i * (calls - 1) // max(1, most - 1) for i in range(most)})
    )


def main(program, compiler, folder, most, only):
    with tempfile.TemporaryDirectory(dir=folder) as made:
        folder = Path(made).resolve()
        bench = Bench(Path(program).resolve(), compiler, folder)
        faults, wrong = collections.Counter(), collections.Counter()
        for name, (words, resume) in cases(bench).items():
            if only and name not in only:
                continue
            case = Case(bench, name, words, resume)
            for kind, errors in KINDS.items():
                calls = case.calls(kind)
                for error in errors:
                    for last in (
                        (0,) if error in SURVIVED else (0, 1 << 40)
                    ):  # once, and from then on
                        for call in chosen(calls, most):
                            found = case.wrong(kind, error, (call, last or call))
                            if found is None:
                                break
                            faults[name, kind] += 1
                            if found:
                                wrong[name, kind] += 1
                                print(
                                    f"{name}: {kind} {call}{' and all after' if last else ''}, {errno.errorcode.get(error, 'half')}: {found}".replace(
                                        str(folder), "DIR"
                                    ),
                                    flush=True,
                                )
                print(
                    f"{name}: {kind}: {calls} calls, {faults[name, kind]} faults, {wrong[name, kind]} violations",
                    flush=True,
                )
        print(f"{faults.total()} faults, {wrong.total()} violations")
        return 1 if wrong or not faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4]), sys.argv[5:]))
