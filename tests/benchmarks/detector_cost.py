"""A scene without a detector pays nothing for detectors: counts instructions of whole trials.

detector_cost.py VALGRIND SLIPBENCH SCENE DETECTOR_ARCHIVE...

1. Without a detector a trial executes no function defined in detectors/, and nothing of the loop
that would feed it.

2. With a detector it does; the cost per tick is printed.
"""

import sys

from effect_cost import count, defined_in


def main():
    valgrind, program, scene, *archives = sys.argv[1:]

    # A compiler may put copies of standard library functions into any archive.
    def own(name):
        return "slipbench::" in name

    detectors = set(filter(own, set().union(*(defined_in(archive) for archive in archives))))

    def spent(*settings):
        total, names = count(
            valgrind, "slipbench::run_trial(*", [program, "run", scene, "--quiet", *settings]
        )
        return total, sorted(
            name for name in names if name in detectors or "DelayedDetector::" in name
        )

    total, found = spent()
    total_with, found_with = spent("--set", "detector.type=force_ratio")
    ticks = 4000
    print(
        f"{total / ticks:.0f} instructions a tick, {(total_with - total) / ticks:.0f} more with force_ratio"
    )
    if not any("DelayedDetector::" in name for name in found_with) or not detectors & set(
        found_with
    ):
        sys.exit("the count saw no detector where there is one: nothing was measured")
    if found:
        sys.exit("instructions spent on detectors without any named: " + ", ".join(found))


if __name__ == "__main__":
    main()
