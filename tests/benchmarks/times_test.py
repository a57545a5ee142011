"""times.py with programs that say what the test wants: ratios, spreads, comparisons, exit statuses. times_test.py TIMES_PY"""

import json
import pathlib
import subprocess
import sys
import tempfile

PROGRAM = """#!/bin/sh
case "$*" in
  *filter*) cat "${0%/*}/yardstick.json" ;;
  *) cat "${0%/*}/rows.json" ;;
esac
"""
DOCTOR = """#!/bin/sh
echo '{"checks": [{"group": "machine", "name": "processor", "found": "a made-up one"}]}'
"""


def rows(name, median, cv, unit="ns"):
    return {"benchmarks": [{"run_name": name, "aggregate_name": "mean", "cpu_time": 7.0 * median, "time_unit": unit},
                           {"run_name": name, "aggregate_name": "median", "cpu_time": median, "time_unit": unit},
                           {"run_name": name, "aggregate_name": "cv", "cpu_time": cv, "time_unit": unit}]}


class Build:
    """A build folder with a yardstick and one benchmark."""

    def __init__(self, folder, script):
        self.folder, self.bin, self.script = folder, folder / "bin", script
        self.bin.mkdir()
        for name, text in (("field_bench", PROGRAM), ("one_bench", PROGRAM), ("slipbench", DOCTOR)):
            (self.bin / name).write_text(text)
            (self.bin / name).chmod(0o700)

    def say(self, yardstick, median):
        (self.bin / "yardstick.json").write_text(json.dumps(rows("field_step_54", yardstick, 0.003)))
        (self.bin / "rows.json").write_text(json.dumps(rows("image/ideal", median, 0.004, "us")))

    def run(self, *words):
        command = [sys.executable, self.script, self.folder, "--only", "one_bench", *words]
        return subprocess.run(command, capture_output=True, text=True)


def expect(found, wanted, what):
    if found != wanted:
        sys.exit(f"{what}: {found!r}, expected {wanted!r}")


def main():
    with tempfile.TemporaryDirectory() as name:
        build = Build(pathlib.Path(name), sys.argv[1])
        first = str(build.folder / "first.json")
        build.say(200.0, 1.5)
        expect(build.run("-o", first).returncode, 0, "status")
        stored = json.loads(pathlib.Path(first).read_text())
        # 1,500 ns over 200 ns; sqrt(0.004^2 + 0.003^2) = 0.005, without a drift of the yardstick.
        expect(stored["times"], {"one_bench": {"image/ideal": {"cpu_ns": 1500.0, "ratio": 7.5, "spread": 0.005}}}, "times")
        expect(stored["context"], {"processor": "a made-up one"}, "context")

        build.say(400.0, 3.0)  # a machine half as fast
        slow = build.run("--compare", first)
        expect((slow.returncode, "DEARER" in slow.stdout), (0, False), "a slower machine")
        # Three times both spreads are 3 sqrt(2) 0.005 = 2.1 %.
        build.say(200.0, 1.53)
        expect(build.run("--compare", first).returncode, 0, "2 % dearer")
        build.say(200.0, 1.56)
        dearer = build.run("--compare", first)
        expect((dearer.returncode, "DEARER  one_bench: image/ideal  +4.0 %" in dearer.stdout), (1, True), "4 % dearer")
        build.say(200.0, 1.44)
        cheaper = build.run("--compare", first)
        expect((cheaper.returncode, "cheaper  one_bench" in cheaper.stdout), (0, True), "4 % cheaper")

        expect(build.run("--compare", str(build.folder / "nowhere.json")).returncode, 2, "no file")
        (build.folder / "note.json").write_text("[]")
        wrong = build.run("--compare", str(build.folder / "note.json"))
        expect((wrong.returncode, "not what times.py -o writes" in wrong.stderr), (2, True), "another file")
        (build.bin / "rows.json").write_text('{"benchmarks": []}')
        expect(build.run().returncode, 2, "a program without medians")
        (build.bin / "rows.json").write_text("hello")
        expect(build.run().returncode, 2, "a program that is no benchmark")
        expect(build.run("--repetitions", "1").returncode, 2, "one repetition")
        expect(build.run("-o", str(build.folder / "nowhere/a.json")).returncode, 2, "no folder")
        (build.bin / "one_bench").unlink()
        missing = build.run()
        expect((missing.returncode, "build everything first" in missing.stderr), (2, True), "no program")


if __name__ == "__main__":
    main()
