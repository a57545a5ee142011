"""Median CPU times of the benchmarks, as ratios to one of them, with machine and flags.

times.py BUILD [-o FILE.json] [--compare FILE.json] [--repetitions N] [--only PROGRAM ...]

BUILD is a build folder with benchmarks in BUILD/bin, e.g. build/release. Each program runs between two runs of the yardstick,
field_bench's step of 54 elements; a ratio is a benchmark's median over the mean of these two, so that a machine that slows down
for minutes, or is slower altogether, changes ratios less than times. A ratio is as uncertain as `spread` says: the coefficients
of variation of the benchmark and of the yardsticks, and how far these two lie apart, added in squares.

--compare prints the benchmarks whose ratio is outside of three times both spreads, and exits with 1 where one is dearer.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys

YARDSTICK = ("field_bench", "field_step_54")


def refuse(message):
    print(f"times.py: {message}", file=sys.stderr)
    sys.exit(2)


def medians(program, repetitions, only=None):
    """Name -> (median CPU time [ns], coefficient of variation) of a Google Benchmark program, or of one benchmark in it."""
    command = [str(program), "--benchmark_format=json", f"--benchmark_repetitions={repetitions}",
               "--benchmark_report_aggregates_only=true"]
    if only:
        command.append(f"--benchmark_filter=^{only}$")
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode != 0:
        refuse(f"{program} ended with {result.returncode}: {result.stderr.strip().splitlines()[-1:]}")
    units = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
    median, spread = {}, {}
    try:
        found = json.loads(result.stdout)["benchmarks"]
    except (ValueError, KeyError, TypeError):
        refuse(f"{program}: what it printed are no results of Google Benchmark")
    for row in found:
        if row.get("aggregate_name") == "median":
            median[row["run_name"]] = row["cpu_time"] * units[row["time_unit"]]
        elif row.get("aggregate_name") == "cv":
            spread[row["run_name"]] = row["cpu_time"]
    if not median or median.keys() != spread.keys():
        refuse(f"{program}: its medians and coefficients of variation are missing")
    return {name: (median[name], spread[name]) for name in median}


def measure(bin_folder, programs, repetitions):
    """Program -> benchmark -> median [ns], ratio to the yardstick, spread of the ratio."""
    def yardstick():
        return medians(bin_folder / YARDSTICK[0], repetitions, YARDSTICK[1])[YARDSTICK[1]]

    times = {}
    before = yardstick()
    for program in programs:
        found = medians(bin_folder / program, repetitions)
        after = yardstick()
        unit = 0.5 * (before[0] + after[0])
        drift = abs(after[0] - before[0]) / unit
        times[program] = {
            name: {"cpu_ns": float(f"{median:.4g}"), "ratio": float(f"{median / unit:.4g}"),
                   "spread": float(f"{math.sqrt(cv**2 + 0.5 * (before[1]**2 + after[1]**2) + drift**2):.2g}")}
            for name, (median, cv) in found.items()}
        before = after
    return times


def changes(old, new):
    """Benchmarks of both whose ratio changed by more than three times both spreads: (name, relative change, limit)."""
    found = []
    for program in sorted(old.keys() & new.keys()):
        for name in sorted(old[program].keys() & new[program].keys()):
            was, now = old[program][name], new[program][name]
            limit = 3.0 * math.hypot(was["spread"], now["spread"])
            change = now["ratio"] / was["ratio"] - 1.0
            if abs(change) > limit:
                found.append((f"{program}: {name}", change, limit))
    return found


def stored(path):
    """What an earlier -o wrote."""
    try:
        times = json.loads(pathlib.Path(path).read_text())["times"]
        for benchmarks in times.values():
            for row in benchmarks.values():
                if not (row["ratio"] > 0 and row["spread"] >= 0):
                    refuse(f"{path}: a ratio is {row['ratio']}, a spread {row['spread']}; allowed: above zero, not negative")
    except OSError as error:
        refuse(f"{path}: {error.strerror}")
    except (ValueError, KeyError, TypeError, AttributeError):
        refuse(f"{path}: not what times.py -o writes")
    return times


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path)
    parser.add_argument("--compare")
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--only", nargs="+")
    options = parser.parse_args()
    bin_folder = options.build / "bin"
    if options.output and not options.output.parent.is_dir():
        refuse(f"cannot write {options.output}: there is no folder {options.output.parent}")
    if options.repetitions < 2:
        refuse(f"--repetitions is {options.repetitions}; allowed: 2 or more, since a spread is told")
    old = stored(options.compare) if options.compare else None
    programs = options.only or sorted(path.name for path in bin_folder.glob("*_bench")) + sorted(
        path.name for path in bin_folder.glob("*_speed"))
    for program in {YARDSTICK[0], "slipbench", *programs}:
        if not (bin_folder / program).is_file():
            refuse(f"{bin_folder / program}: there is no such program; build everything first")
    doctor = subprocess.run([bin_folder / "slipbench", "doctor", "--json"], capture_output=True, text=True).stdout
    checks = json.loads(doctor)["checks"]
    context = {check["name"]: check["found"] for check in checks if check["group"] in ("program", "machine", "libraries")}
    times = measure(bin_folder, programs, options.repetitions)
    for program, benchmarks in times.items():
        for name, row in benchmarks.items():
            print(f"{program:16} {name:44} {row['cpu_ns']:12.4g} ns  {row['ratio']:10.4g} +- {100 * row['spread']:.1f} %")
    if options.output:
        text = json.dumps({"yardstick": ": ".join(YARDSTICK), "context": context, "times": times}, indent=1)
        temporary = options.output.with_name(options.output.name + ".partial")
        temporary.write_text(text + "\n")
        temporary.replace(options.output)
    if old is not None:
        found = changes(old, times)
        for name, change, limit in found:
            print(f"{'DEARER' if change > 0 else 'cheaper'}  {name}  {100 * change:+.1f} %, spread explains {100 * limit:.1f} %")
        if any(change > 0 for _, change, _ in found):
            sys.exit(1)


if __name__ == "__main__":
    main()
