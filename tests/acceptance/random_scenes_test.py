"""Random scenes with extreme values: each runs or is refused with file and line, and its recording obeys the laws.

Arguments: the program, the number of scenes. With `--seed K` it prints scene K and runs only that scene.

Every recording is checked twice: by `slipbench verify`, and by label_laws.py, which reads the arrays and knows only the laws. A worker
process runs the scenes, so that a crash names the seed of its scene.
"""

import argparse
import functools
import json
import re
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import h5py
import slipbench
from label_laws import LAWS, faults
from scene_draw import Draw

BATCH = 50  # recordings that are verified at once
LEAST_RUN = 0.5  # share of the scenes that must run: otherwise the draws have become too wild to check anything
TRIAL_LIMIT = 3.0  # s
FOLDER = slipbench.scenes() / "bodies"  # of the model that scenes name
AT_A_LINE = re.compile(r"<text>:\d+: ")


@functools.cache
def schema(program):
    return json.loads(subprocess.run([program, "schema"], check=True, capture_output=True).stdout)


def drawn(program, seed):
    return Draw(schema(program), seed).scene()


def text_of(scene):
    return json.dumps(scene, indent=1)


def run(scene, path, applied):
    """Returns how the scene ended ("ran", "refused", "ended", "slow", "broken"), and a list of faults. Counts laws in `applied`."""
    try:
        summary = slipbench.Scene.from_text(text_of(scene), folder=FOLDER).write(
            path, trial_limit=TRIAL_LIMIT
        )
    except slipbench.InputError as error:
        return "refused", [] if AT_A_LINE.search(str(error)) else [
            f"refused without file and line: {error}"
        ]
    except Exception as error:  # noqa: BLE001  an internal error
        return "broken", [f"{type(error).__name__}: {error}"]
    if not summary["failed"]:
        with h5py.File(path) as file:
            return "ran", [
                f"a law is violated: {fault}"
                for fault in faults(file["data/demo_0"], scene, applied)
            ]
    message = summary["failed"][0]["message"]
    if "still running at the limit" in message:
        return "slow", []
    return "ended", [] if AT_A_LINE.search(message) else [f"ended without file and line: {message}"]


def verified(paths):
    """Returns the failures that `slipbench verify` finds, by file."""
    found = {}
    for dataset in slipbench.verify(paths)["datasets"] if paths else []:
        failures = [
            f"verify: {one['check']} {one['array']} {one['sample']}: {one['what']}"
            for one in dataset.get("failures", [])
        ]
        if "error" in dataset:
            failures.append(f"verify: {dataset['error']}")
        found[Path(dataset["file"])] = failures
    return found


def work(program, first, end):
    """Runs scenes and prints JSON lines.

    {"begin": seed}, and {"seed", "how", "faults"} after a run and after its verification; after a
    run also "applied", the number of samples by law.
    """

    def say(**values):
        print(json.dumps(values), flush=True)

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        seeds = {}
        for seed in range(first, end):
            say(begin=seed)
            path = Path(folder) / f"{seed}.h5"
            applied = Counter()
            how, wrong = run(drawn(program, seed), path, applied)
            say(seed=seed, how=how, faults=wrong, applied=applied)
            if how == "ran":
                seeds[path] = seed
            if len(seeds) == BATCH or seed == end - 1:
                for one, failures in verified(list(seeds)).items():
                    say(seed=seeds[one], how="", faults=failures)
                for one in seeds:
                    one.unlink()
                seeds = {}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program")
    parser.add_argument("scenes", type=int, nargs="?", default=3000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first scene")
    parser.add_argument("--seed", type=int, help="run this scene only, and print it")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    first, end = (
        (given.first, given.first + given.scenes)
        if given.seed is None
        else (given.seed, given.seed + 1)
    )
    if given.worker:
        work(given.program, first, end)
        return
    if given.seed is not None:
        print(text_of(drawn(given.program, given.seed)))
    how, bad, applied = run_all(given.program, first, end)
    sys.exit(0 if report(given, how, bad, applied) else 1)


def run_all(program, first, end):
    """Runs scenes in workers, each of which continues after a scene that ended the one before.

    Returns the number of scenes by how they ended, the faults by seed, and the samples by law.
    """
    how, bad, applied = Counter(), {}, Counter()
    while first < end:
        words = [sys.executable, __file__, program, str(end - first)]
        words += ["--first", str(first), "--worker"]
        begun = first
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as worker:
            for line in worker.stdout:
                event = json.loads(line)
                begun = event.get("begin", begun)
                how.update([event["how"]] if event.get("how") else [])
                applied.update(event.get("applied", {}))
                if event.get("faults"):
                    bad.setdefault(event["seed"], []).extend(event["faults"])
        if worker.returncode == 0:
            break
        bad.setdefault(begun, []).append(
            f"the process that ran it ended with status {worker.returncode}"
        )
        first = begun + 1
    return how, bad, applied


def report(given, how, bad, applied):
    """Prints the results of run_all(); returns True if they are as they should be."""
    for seed, wrong in sorted(bad.items()):
        print(f"scene {seed}: {text_of(drawn(given.program, seed))}")
        for fault in wrong:
            print(f"scene {seed}: {fault}")
    print(", ".join(f"{count} {word}" for word, count in how.most_common()))
    for law in LAWS:
        print(f"{law}: applied to {applied[law]:,} samples")
    unused = [law for law in LAWS if not applied[law]] if given.seed is None else []
    if unused:
        print(f"never applied: {', '.join(unused)}")
    enough = given.seed is not None or how["ran"] >= LEAST_RUN * how.total()
    if not enough:
        print(f"{how['ran']} scenes ran; expected at least {LEAST_RUN:.0%}")
    return enough and not bad and not unused


if __name__ == "__main__":
    main()
