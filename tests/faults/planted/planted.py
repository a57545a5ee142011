"""Plants the faults of faults.py in a copy of the tree, one at a time.

Reports which ones the suite finds.

All faults are compiled at once: each site reads the number of the active fault from the environment
variable SLIPBENCH_FAULT. For each fault the script runs the tests of the folder that mirrors the
source, then the others of the suite, until one fails. A test that also fails without a fault ends
the script with an error. So do too few found faults, unless --only chooses some.
"""

import argparse
import filecmp
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from faults import FAULTS

ROOT = Path(__file__).resolve().parents[3]
HEADER = "tests/faults/planted/planted_fault.h"
VARIABLE = "SLIPBENCH_FAULT"
READS_VARIABLE = f"""#pragma once

#include <cstdlib>

// Number of the active fault, from 1 on; 0: none.
inline const int planted_fault = [] {{
  const char* const number = std::getenv("{VARIABLE}");
  return number == nullptr ? 0 : std::atoi(number);
}}();
"""
# Tests of texts, of the installation and of costs: planted code changes them.
LEFT_OUT = ("arm64", "benchmarks", "docs", "install", "style")
LEAST_FOUND = 0.9  # of all faults
LONGEST = 600  # s, of a program; a fault may make it run for ever


def planted(text, number, old_text):
    """The text with fault `number` planted; `old_text`: BEFORE@@OLD@@NEW@@AFTER."""
    before, old, new, after = old_text.split("@@")
    found = text.count(before + old + after)
    if found != 1:
        raise ValueError(f"found {found} times, expected once: {before}{old}{after}")
    if old.endswith(";"):
        site = f"{{ if (planted_fault == {number}) {{ {new} }} else {{ {old} }} }}"
    else:
        site = f"(planted_fault == {number} ? ({new}) : ({old}))"
    return text.replace(before + old + after, before + site + after)


def planted_files(root):
    """{file: text with all its faults}; ends with an error for texts that are not found once."""
    texts, errors = {}, []
    for number, (file, old_text, _) in enumerate(FAULTS, start=1):
        text = texts.get(file) or (root / file).read_text(encoding="utf-8")
        try:
            texts[file] = planted(text, number, old_text)
        except ValueError as error:
            errors.append(f"fault {number}: {file}: {error}")
    if errors:
        sys.exit("\n".join(errors))
    return {HEADER: READS_VARIABLE} | {
        file: f'#include "{HEADER}"\n{text}' for file, text in texts.items()
    }


def copy_tree(root, tree, texts):
    """Copies the project's files that differ, so that only these are compiled again."""
    listed = subprocess.run(
        ["git", "-C", root, "ls-files", "-z"], capture_output=True, text=True, check=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        copy = tree / name
        if name in texts or not (root / name).is_file():
            continue
        if not copy.is_file() or not filecmp.cmp(root / name, copy, shallow=False):
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, copy)
    for name, text in texts.items():
        path = tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    venv = tree / "build/venv"
    venv.parent.mkdir(exist_ok=True)
    if not venv.exists():
        venv.symlink_to((root / "build/venv").resolve())


class Suite:
    """The tests of the suite, as programs: the tests of a GoogleTest program are one run."""

    def __init__(self, tree):
        build = tree / "build/release"
        listed = subprocess.run(
            ["ctest", "--preset", "release", "--show-only=json-v1"],
            cwd=tree,
            capture_output=True,
            text=True,
            check=True,
        )
        self.programs = {}  # {(folder, program, arguments): GoogleTest's filters}
        self.environments = {}
        for test in json.loads(listed.stdout)["tests"]:
            values = {item["name"]: item["value"] for item in test["properties"]}
            folder = Path(values["WORKING_DIRECTORY"])
            place = folder.relative_to(build) if folder.is_relative_to(build) else Path("tests")
            if "command" not in test or place.parts[1:2] and place.parts[1] in LEFT_OUT:
                continue
            command = test["command"]
            filters = [word for word in command if word.startswith("--gtest_filter=")]
            rest = () if filters else tuple(command[1:])
            key = (str(folder), command[0], rest)
            self.environments[key] = dict(
                word.split("=", 1) for word in values.get("ENVIRONMENT", ())
            )
            self.programs.setdefault(key, []).extend(
                word.removeprefix("--gtest_filter=") for word in filters
            )
        self.build = build
        self.healthy = {}  # {run: message of its failure without a fault, "" for none}
        self.turns = {key: threading.Lock() for key in self.programs}
        self.alone = defaultdict(set)  # {run: tests that must be the only ones of their process}
        self.lock = threading.Lock()

    def near(self, file):
        """The runs of the folder that mirrors `file`, and of its subfolders.

        Without such a folder, those of the nearest one above.
        """
        mirror, runs = self.build / "tests" / Path(file).parent, []
        while not runs:
            runs = [key for key in self.programs if Path(key[0]).is_relative_to(mirror)]
            mirror = mirror.parent
        return runs

    def far(self, file):
        """The other runs: those of the nearest folders first, scripts last."""
        mirror = str(self.build / "tests" / Path(file).parent)

        def distance(key):
            return not self.programs[key], -len(os.path.commonprefix([key[0], mirror]))

        return sorted(self.programs.keys() - set(self.near(file)), key=distance)

    def run(self, key, fault):
        """The name of a test that fails under the fault, "" if none does."""
        filters = self.programs[key]
        while True:
            together = [test for test in filters if test not in self.alone[key]]
            failed = "" if filters and not together else self.run_together(key, fault, together)
            if not failed or not filters or " " not in failed:
                break
            test = failed.split()[1]
            if self.run_together(key, fault, [test]):
                return failed
            self.alone[key].add(test)  # it fails only behind other tests of its program
        alone = (self.run_together(key, fault, [test]) for test in sorted(self.alone[key]))
        return failed or next(filter(None, alone), "")

    def run_together(self, key, fault, filters):
        folder, program, arguments = key
        command = [program, *arguments]
        if filters:
            command += [f"--gtest_filter={':'.join(filters)}", "--gtest_fail_fast"]
        environment = {**os.environ, **self.environments[key]}
        environment.pop(VARIABLE, None)
        if fault:
            environment[VARIABLE] = str(fault)
        name = Path(arguments[0] if arguments and not filters else program).name
        with self.turns[key]:  # some tests write into the folder of their build
            return self.outcome(name, command, folder, environment, bool(filters))

    def outcome(self, name, command, folder, environment, is_googletest):
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
        try:
            output, _ = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return f"{name}: longer than {LONGEST} s"
        if process.returncode == 0:
            return ""
        # A test that ends the program does not report its failure.
        begun = re.findall(r"^\[ RUN      \] (\S+)", output, re.MULTILINE)
        failed = re.findall(r"^\[  FAILED  \] ([^\s,]+)", output, re.MULTILINE) or begun[-1:]
        return f"{name} {failed[0]}" if is_googletest and failed else name

    def fails_healthy(self, key, failed):
        """True if the test that failed under a fault fails without one, too."""
        only = failed.split()[1:] if self.programs[key] and ":" not in failed else []
        with self.lock:
            if (key, *only) not in self.healthy:
                self.healthy[key, *only] = self.run_together(key, 0, only or self.programs[key])
            return bool(self.healthy[key, *only])


def judge(suite, number, runs):
    """The first test of the runs that finds the fault, "" if none does."""
    for key in runs:
        failed = suite.run(key, number)
        if failed and suite.fails_healthy(key, failed):
            raise RuntimeError(f"{failed} also fails without a fault")
        if failed:
            return failed
    return ""


def report(number, found):
    file, _, why = FAULTS[number - 1]
    print(f"{number:3} {file}: {why}: {found or 'SURVIVED'}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument(
        "--tree", type=Path, default=ROOT / "build/planted", help="where the copy is [%(default)s]"
    )
    parser.add_argument("--only", type=int, nargs="+", help="numbers of faults [all]")
    parser.add_argument("--check", action="store_true", help="only check that each text is there")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="[%(default)s]")
    options = parser.parse_args()
    texts = planted_files(ROOT)
    if options.check:
        return
    copy_tree(ROOT, options.tree, texts)
    # A shell starts jobs in the background with SIGINT ignored; tests would inherit that and fail.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for step in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release"]):
        subprocess.run(step, cwd=options.tree, check=True, stdout=sys.stderr)
    suite = Suite(options.tree)
    chosen = options.only or range(1, len(FAULTS) + 1)
    found = {}
    with ThreadPoolExecutor(options.jobs) as pool:
        for runs_of in (suite.near, suite.far):  # most faults need only the first
            left = [number for number in chosen if not found.get(number)]

            def judged(number, runs_of=runs_of):
                return judge(suite, number, runs_of(FAULTS[number - 1][0]))

            for number, test in zip(left, pool.map(judged, left), strict=True):
                found[number] = test
                if test or runs_of == suite.far:
                    report(number, test)
    killed, total = Counter(), Counter()
    for number in chosen:
        file = FAULTS[number - 1][0]
        area = "/".join(Path(file).parts[: 2 if file.startswith(("sim", "tools")) else 1])
        total[area] += 1
        killed[area] += bool(found[number])
    for area, count in total.items():
        print(f"{area}: {killed[area]} of {count}")
    print(f"found: {killed.total()} of {total.total()}")
    if not options.only and killed.total() < LEAST_FOUND * total.total():
        sys.exit(f"expected at least {LEAST_FOUND:.0%} of the faults to be found")


if __name__ == "__main__":
    main()
