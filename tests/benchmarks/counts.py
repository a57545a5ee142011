"""Counts instructions of the first trial of the reference scenes by callgrind.

Counted are set-up, simulation, sensors, detector and controller.

counts.py BUILD [-o FILE.json] [--compare FOLDER] [--jobs N]

-o writes the counts and adds a row to history.csv in the same folder: date, commit, build, and the
instructions of each scene. A count shows the cost of a change to 1e-5, even on a busy machine. It depends on what `build_of`
lists and on nothing else, because valgrind emulates a processor of its own. --compare takes the
file of this build in FOLDER, prints the changes by scene and function, and exits with 1 if a scene
takes over 2 % more, with 2 if no file is of this build.
"""

import argparse
import collections
import concurrent.futures
import csv
import datetime
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = (
    "papillarray/stage",  # rigid pillars, prescribed motion
    "piezo_skin/slide",  # masses that ring, 10 kHz, spectra
    "biotac_sp/slip",  # a skin of many elements
    "nib_pad/linear",  # MuJoCo's bodies on a lever bench
    "myrmex/slip",  # three sensors on one free body, images
    "grasp/lift",
)  # closed loop: detector and controller
LIMIT = 0.02
STORED, SHOWN = 40, 6  # functions with the most instructions of their own


def refuse(message) -> typing.NoReturn:
    print(f"counts.py: {message}", file=sys.stderr)
    sys.exit(2)


def build_of(build, valgrind):
    """Returns all that counts depend on."""
    doctor = subprocess.run(
        [build / "bin/slipbench", "doctor", "--json"], capture_output=True, text=True
    ).stdout
    found = {check["name"]: check["found"] for check in json.loads(doctor)["checks"]}
    found["flags"] = " ".join(word for word in found["flags"].split() if not word.startswith("-W"))
    unity = re.search(
        r"^CMAKE_UNITY_BUILD:\w+=(\w+)$", (build / "CMakeCache.txt").read_text(), re.M
    )
    found["sources"] = unity[1] if unity else "OFF"
    found["valgrind"] = subprocess.run(
        [valgrind, "--version"], capture_output=True, text=True
    ).stdout.strip()
    found["C library"] = os.confstr("CS_GNU_LIBC_VERSION")
    return {
        name: found[name]
        for name in (
            "compiler",
            "flags",
            "sources",
            "SIMD path",
            "valgrind",
            "C library",
            "Eigen",
            "yaml-cpp",
            "MuJoCo",
        )
    }


def own_instructions(text):
    """Returns the self cost by function from callgrind's output.

    Clones and recursion levels count as one.
    """
    names, own, function, of_a_call = {}, collections.Counter(), None, False
    for line in text.splitlines():
        named = re.fullmatch(r"(c?)fn=\((\d+)\)(?: (.+))?", line)
        if named:
            if named[3]:
                names[named[2]] = re.sub(r"(?: \[clone [^]]*\])*(?:'\d+)?$", "", named[3])
            function = function if named[1] else names[named[2]]
        elif line.startswith("calls="):
            of_a_call = True
        elif re.match(r"[-+*\d]", line):
            if not of_a_call:
                own[function] += int((line.split() + ["0"])[1])
            of_a_call = False
    total = int(re.search(r"^totals: (\d+)$", text, re.M)[1])
    if own.total() != total or total == 0:
        refuse(
            f"the functions add up to {own.total()} instructions of {total}; allowed: a program with its symbols, all of them counted"
        )
    return own


def count(build, valgrind, scene):
    with tempfile.TemporaryDirectory() as folder:
        command = [
            valgrind,
            "-q",
            "--vgdb=no",
            "--tool=callgrind",
            "--callgrind-out-file=profile",
            "--toggle-collect=slipbench::run_trial(*",
            build / "bin/slipbench",
            "run",
            ROOT / "scenes" / f"{scene}.yaml",
            "--trial",
            "0",
            "--jobs",
            "1",
            "--json",
        ]
        # Keeps only these: a user's settings of valgrind and the C library would change counts, as
        # would the loader's lazy look-ups.
        kept = {
            name: os.environ[name]
            for name in ("PATH", "LD_LIBRARY_PATH", "TMPDIR")
            if name in os.environ
        }
        run = subprocess.run(
            command, cwd=folder, env=kept | {"LD_BIND_NOW": "1"}, capture_output=True, text=True
        )
        if run.returncode != 0:
            refuse(
                f"{scene} under valgrind ended with {run.returncode}: {run.stderr.strip().splitlines()[-1:]}"
            )
        own = own_instructions((pathlib.Path(folder) / "profile").read_text())
    return {
        "simulated_s": json.loads(run.stdout)["simulated_s"],
        "instructions": own.total(),
        "functions": dict(own.most_common(STORED)),
    }


def of_this_build(folder, build):
    """Returns the content of the file in `folder` that is of this build."""
    others = ""
    for path in sorted(folder.glob("*.json")):
        found = json.loads(path.read_text())
        differ = [
            f"{name} ({found['build'].get(name)} there, {here} here)"
            for name, here in build.items()
            if found["build"].get(name) != here
        ]
        if not differ:
            return found["scenes"]
        others += f"; {path.name} is of another {', '.join(differ)}"
    refuse(
        f"no results of this build in {folder}{others}; to add them: counts.py BUILD -o {folder}/NAME.json"
    )


def append_history(path, name, day, commit, scenes):
    """Adds a row to the history of counts.

    A new scene adds a column, in which earlier rows are empty. `name`: the build.
    """
    rows = list(csv.DictReader(path.open(newline=""))) if path.exists() else []
    columns = list(rows[0]) if rows else ["date", "commit", "build"]
    columns += [scene for scene in scenes if scene not in columns]
    rows.append(
        {
            "date": day,
            "commit": commit,
            "build": name,
            **{scene: counted["instructions"] for scene, counted in scenes.items()},
        }
    )
    partial = path.with_name(path.name + ".partial")
    with partial.open("w", newline="") as file:
        table = csv.DictWriter(file, columns, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    partial.replace(path)


def commit_of(root):
    """Returns the commit that the tree `root` is built from, with "-dirty" if files differ from it."""
    described = subprocess.run(
        ["git", "-C", root, "describe", "--always", "--dirty", "--exclude=*"],
        capture_output=True,
        text=True,
    )
    return described.stdout.strip() or "unknown"


def compared(before, now):
    """Prints the changes; returns the names of the scenes that take over LIMIT more."""
    grew = []
    for scene, counted in now.items():
        if scene not in before:
            print(f"{scene:20} is new, and not compared")
            continue
        was = before[scene]["instructions"]
        growth = counted["instructions"] / was - 1.0
        print(
            f"{scene:20} {was:>15,} before {counted['instructions']:>15,} now  {100 * growth:+.2f} %",
            "GREW" if growth > LIMIT else "",
        )
        if growth > LIMIT:
            grew.append(scene)
        if abs(growth) < 1e-4:
            continue
        old, new = before[scene]["functions"], counted["functions"]
        # A function that is not among the stored ones cost at most as much as the least of them.
        least = {name: min(kept.values()) for name, kept in (("old", old), ("new", new))}
        change = {
            name: new.get(name, least["new"]) - old.get(name, least["old"])
            for name in old.keys() | new.keys()
        }
        for name in sorted(change, key=lambda name: (-abs(change[name]), name))[:SHOWN]:
            about = "" if name in old and name in new else " at least"
            print(
                f"  {change[name]:+15,}{about} ({100 * change[name] / was:+.2f} % of the scene) {name}"
            )
    return grew


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path)
    parser.add_argument("--compare", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    valgrind = shutil.which("valgrind") or refuse(
        "valgrind is not on PATH; it is after: apt-get install --yes --no-install-recommends valgrind"
    )
    folder = options.build.resolve()
    build = build_of(folder, valgrind)
    before = of_this_build(options.compare, build) if options.compare else None
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as threads:
        scenes = dict(
            zip(
                SCENES,
                threads.map(lambda scene: count(folder, valgrind, scene), SCENES),
                strict=True,
            )
        )
    if options.output:
        partial = options.output.with_name(options.output.name + ".partial")
        partial.write_text(json.dumps({"build": build, "scenes": scenes}, indent=1) + "\n")
        partial.replace(options.output)
        append_history(
            options.output.with_name("history.csv"),
            options.output.stem,
            datetime.date.today().isoformat(),
            commit_of(ROOT),
            scenes,
        )
    if before is None:
        for scene, counted in scenes.items():
            print(
                f"{scene:20} {counted['instructions']:>15,} instructions, {counted['instructions'] / counted['simulated_s']:>15,.0f} a simulated second"
            )
    else:
        grew = compared(before, scenes)
        if grew:
            print(
                f"{len(grew)} of {len(scenes)} scenes grew by more than {100 * LIMIT:g} %; where that is wanted: counts.py BUILD -o FILE.json"
            )
            sys.exit(1)


if __name__ == "__main__":
    main()
