"""Checks what the program promises of its datasets, on files that it wrote.

bars.py PROGRAM CHECK, CHECK one of: onset, rotation, cone, content

Prints the worst value of each check; exits with 1 if it exceeds its limit.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
STAGE = HERE.parents[1] / "scenes" / "papillarray" / "stage.yaml"

COMPRESSION, START = 1e-3, 2.0
DROP = np.array([0.45, 0.20, 0.45, 0.20, 0.0, 0.20, 0.45, 0.20, 0.45]) * 1e-3  # of pillars 0..8
POSITION = (
    np.array([[7, 7], [0, 7], [-7, 7], [7, 0], [0, 0], [-7, 0], [7, -7], [0, -7], [-7, -7]]) * 1e-3
)


def run(program, *words):
    subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True)


def demos(path):
    with h5py.File(path) as file:
        for name in sorted(file["data"], key=lambda n: int(n.split("_")[1])):
            demo = file["data"][name]
            yield json.loads(demo.attrs["params"]), demo["labels/pad"]


def worst_onset(program, scene, expected, *changes):
    """Returns the largest relative error of a pillar's onset, and whether every order is right."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.h5"
        run(program, "sweep", HERE / scene, "-o", out, *changes)
        worst = 0.0
        compared = 0
        for params, pad in demos(out):
            unit = {
                key: np.asarray(pad.attrs[key]) for key in ("k_normal", "k_tangential", "mu_static")
            }
            load = unit["k_normal"] * (COMPRESSION - DROP)
            stretch = unit["mu_static"] * load / unit["k_tangential"]
            for key in ("micro_onset_time_s", "onset_time_s"):
                measured = np.asarray(pad.attrs[key]) - START
                # A bristle's share of load is 0.4 to 1.6 times the mean (a single bristle: 1).
                weight = (
                    1.0
                    if "bristles=6" not in " ".join(changes)
                    else (0.4 if key.startswith("micro") else 1.6)
                )
                wanted = expected(params, stretch * weight)
                reached = np.isfinite(wanted) & (wanted < 3.9)
                assert np.isfinite(measured[reached]).all(), (params, measured, wanted)
                assert not np.isfinite(measured[~np.isfinite(wanted)]).any(), (
                    params,
                    measured,
                    wanted,
                )
                error = np.abs(measured[reached] / wanted[reached] - 1.0)
                worst = max(worst, error.max(initial=0.0))
                compared += int(reached.sum())
                # The file must order two pillars as the closed form does wherever that separates
                # them by more than rounding.
                for a in np.flatnonzero(reached):
                    for b in np.flatnonzero(reached):
                        if wanted[a] < wanted[b] * (1 - 1e-9):
                            assert measured[a] < measured[b], (params, a, b)
        assert compared > 100, "too few onsets to speak of"
        return worst, compared


def onset(program):
    def expected(params, stretch):
        return stretch / params["motion.speed"]

    def expected_accelerating(params, stretch):
        # The scene's 50 mm/s2: s = a t^2/2 up to v^2/(2 a), then v (t - v/(2 a)).
        speed, acceleration = params["motion.speed"], 50e-3
        return np.where(
            stretch < speed**2 / (2 * acceleration),
            np.sqrt(2 * stretch / acceleration),
            stretch / speed + speed / (2 * acceleration),
        )

    ok = True
    worst, compared = worst_onset(
        program, "onset.yaml", expected_accelerating, "--set", "motion.acceleration=50 mm/s2"
    )
    print(f"onset, translation, at 50 mm/s2: {compared} onsets, worst error {100 * worst:.2g} %")
    ok &= worst < 1e-3
    for step in ("1 ms", "0.1 ms"):
        for bristles in ("1", "6"):
            worst, compared = worst_onset(
                program,
                "onset.yaml",
                expected,
                "--set",
                f"time_step={step}",
                "--set",
                f"sensors.pad.bristles={bristles}",
            )
            print(
                f"onset, translation, {bristles} bristle(s), step {step}: {compared} onsets, worst error {100 * worst:.2g} %"
            )
            ok &= worst < 1e-3
    return ok


def rotation(program):
    def expected(params, stretch):
        radius = np.hypot(*(POSITION - np.asarray(params["motion.pivot"])).T)
        with np.errstate(invalid="ignore", divide="ignore"):
            return 2.0 * np.arcsin(stretch / (2.0 * radius)) / abs(params["motion.rotation"])

    ok = True
    for step in ("1 ms", "0.1 ms"):
        worst, compared = worst_onset(
            program, "rotation.yaml", expected, "--set", f"time_step={step}"
        )
        print(f"onset, rotation, step {step}: {compared} onsets, worst error {100 * worst:.2g} %")
        ok &= worst < 1e-3
    return ok


def cone(program):
    ok = True
    motions = {
        "translation": [],
        "rotation": ["--set", "motion.speed=0", "--set", "motion.rotation=20 deg/s"],
        "both": ["--set", "motion.rotation=20 deg/s", "--set", "motion.pivot=[3 mm, 1 mm]"],
        "both, tilted": [
            "--set",
            "motion.rotation=20 deg/s",
            "--set",
            "motion.tilt=[1.5 deg, -1 deg]",
        ],
    }
    for name, changes in motions.items():
        for friction in ("{static: 0.5, kinetic: 0.5}", "{static: 0.6, kinetic: 0.4}"):
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder) / "out.h5"
                run(program, "run", STAGE, "-o", out, "--set", f"friction={friction}", *changes)
                for _, pad in demos(out):
                    force = pad["force"][:].astype(float)
                    state = pad["unit_state"][:]
                    f_t, f_n = np.hypot(force[..., 0], force[..., 1]), force[..., 2]
                    limit_s, limit_k = pad.attrs["mu_static"] * f_n, pad.attrs["mu_kinetic"] * f_n
                    stuck, slips = state == 1, state == 2
                    assert stuck.any() and slips.any()
                    over = (f_t[stuck] / limit_s[stuck] - 1.0).max()
                    off = np.abs(f_t[slips] / limit_k[slips] - 1.0).max()
                    print(
                        f"cone, {name}, friction {friction}: stuck over the limit by {max(over, 0):.1e}, slipping off it by {off:.1e}"
                    )
                    ok &= over < 1e-6 and off < 1e-6
    return ok


def same_content(program):
    scene = HERE / "onset.yaml"
    digests = set()
    with tempfile.TemporaryDirectory() as folder:
        for i, jobs in enumerate(("1", "2", "2")):
            out = pathlib.Path(folder) / f"{i}.h5"
            run(
                program,
                "sweep",
                scene,
                "-o",
                out,
                "--jobs",
                jobs,
                "--seed",
                "3",
                "--set",
                "effects=[patchy_friction, ageing]",
                "--set",
                "sensors.pad.electronics=typical",
                "--set",
                "duration=3 s",
            )
            with h5py.File(out) as file:  # the layout depends on when batches were finished
                digests.add(file.attrs["content_sha256"])
    print(f"content: jobs 1, 2 and 2 again: {len(digests)} different digest(s)")
    return len(digests) == 1


CHECKS = {"onset": onset, "rotation": rotation, "cone": cone, "content": same_content}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[2] not in CHECKS:
        sys.exit(__doc__)
    sys.exit(0 if CHECKS[sys.argv[2]](sys.argv[1]) else 1)
