"""Effects that a scene does not name cost nothing: counts instructions with callgrind.

effect_cost.py VALGRIND STAGE_STEPS STAGE_STEPS_ONE_MORE EFFECTS_ARCHIVE

1. Stepping the bench without effects executes no function defined in sim/effects.

2. The instructions of a step do not change if the catalogue holds one more effect.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile


def count(valgrind, function, command):
    """Returns a command's instructions inside a function, and the names of its functions.

    These are all functions that executed any of the instructions.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind.out"
        subprocess.run(
            [
                valgrind,
                "--tool=callgrind",
                f"--callgrind-out-file={out}",
                f"--toggle-collect={function}",
                *command,
            ],
            check=True,
            capture_output=True,
            env=os.environ | {"LD_BIND_NOW": "1"},
        )  # else the loader's look-ups count too
        text = out.read_text()
    total = int(re.search(r"^(?:summary|totals): (\d+)", text, re.M).group(1))
    names = set(re.findall(r"^c?fn=\(\d+\) (.+)$", text, re.M))
    return total, names


def defined_in(archive):
    """Returns demangled names of the functions that the archive defines.

    Functions that a header could have put there are left out.
    """
    listing = subprocess.run(
        ["nm", "-C", "--defined-only", archive], check=True, capture_output=True, text=True
    ).stdout
    return {match.group(1) for match in re.finditer(r"^[0-9a-f]+ [Tt] (.+)$", listing, re.M)}


def main():
    valgrind, plain, one_more, archive = sys.argv[1:]
    ticks = 2000
    step = "slipbench::StageSimulation::step()"
    short, _ = count(valgrind, step, [plain, str(ticks)])
    total, names = count(valgrind, step, [plain, str(2 * ticks)])
    total_more, _ = count(valgrind, step, [one_more, str(2 * ticks)])
    if not any("Field::step" in name for name in names):
        sys.exit("the count saw no Field::step: nothing was measured")
    print(
        f"{(total - short) / ticks:.0f} instructions a step, {(total_more - total) / (2 * ticks):+.2f} with one effect more"
    )
    spent = sorted(names & defined_in(archive))
    if spent:
        sys.exit("instructions spent in sim/effects without any effect named: " + ", ".join(spent))
    if total_more != total:
        sys.exit(
            f"{2 * ticks} steps take {total} instructions, and {total_more} with one effect more in the catalogue"
        )


if __name__ == "__main__":
    main()
