"""Force against displacement of a real PapillArray, and the filter before its converter.

Both are compared with the electronics `typical`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Floats = NDArray[np.float64]

DEVICES = (
    8  # simulated, one per seed: the rms coupling of a device of nine pillars scatters by 15 %
)
IN_CONTACT = 0.5  # N, normal force of the device's own contact flag
LEAST_SNAPSHOTS = 100  # per pillar, for a fit of its stiffness
# From axes_of() for 1,635 snapshots of one device (Contactile_Data, cable_tension_vec.csv, 2022):
# pillars 0, 3, 6 and 7. Pillars 1 and 4 seem damaged, the others are not loaded. Other choices of
# snapshots give 2.2 to 2.8 N/mm; with pillars 1 and 4 the normal stiffness scatters by up to 28 %.
REAL_SHEAR_TO_NORMAL, REAL_NORMAL_TO_SHEAR, REAL_SHEAR_TO_SHEAR = 2.19, 0.45, 0.63  # N/mm
REAL_RESIDUAL, REAL_MATRIX_RESIDUAL = 35.0, 12.0  # %
REAL_NORMAL_SCATTER, REAL_TANGENTIAL_SCATTER = 20.0, 23.0  # %
SNAPSHOTS = "scenes/papillarray/snapshots.yaml"
FORCE_CARRIES = "unknown whether force or displacement carries it"
FEW_PILLARS = "four real pillars: known to 40 %"

CORNER = 235.0  # Hz, data sheet of version 2.1
POLE = (
    2.0 * np.pi * CORNER / np.sqrt(np.sqrt(2.0) - 1.0)
)  # rad/s, of two equal poles with -3 dB there
HALF_OF_STEP = 1.6783 / POLE * 1e3  # ms: (1 + u) exp(-u) = 1/2 at u = 1.6783
VIBRATION = 400.0  # Hz
AMPLITUDE = 1.0 / (1.0 + (2.0 * np.pi * VIBRATION / POLE) ** 2)
NORMAL_STIFFNESS, TANGENTIAL_STIFFNESS = 7.1, 3.9  # N/mm, of the profile gripper
FINE_STEP = 1e-4  # s
FILTER = "[low_pass]"
CENTRE = 4
SETUP = (
    "Real: a PapillArray of version 2.1 on a finger, 1,635 shuffled snapshots of a pulled cable, pillars 0, 3, 6 and 7; the filter's figures follow from the "
    f"data sheet. Ours: {SNAPSHOTS}, {DEVICES} devices of 40 loads each at 100 Hz; the filter: scenes/papillarray/stage.yaml with low_pass alone at 1 kHz. "
    "Assumed: coupling in force and uniform within its limits, loads of similar size, friction that holds every shear."
)


@dataclass
class Axes:
    """Relation between forces and displacements of a device, for the sufficiently loaded pillars.

    Attributes:
        stiffness: [p, 3, 3] N/mm, row: axis of the force; least squares without a constant
        residual: [p] rms of FZ minus one stiffness times DZ, divided by the rms of FZ
        matrix_residual: [p] likewise, with all three displacements
    """

    stiffness: Floats
    residual: Floats
    matrix_residual: Floats


def axes_of(force: Floats, displacement: Floats) -> Axes:
    """Fits force to displacement over the snapshots with a pillar's contact flag.

    Args:
        force: [n, pillars, 3] N
        displacement: [n, pillars, 3] mm

    Returns:
        the fits for pillars with at least LEAST_SNAPSHOTS such snapshots

    Raises:
        InputError: there is no such pillar
    """
    stiffness, residual, matrix_residual = list[Floats](), list[float](), list[float]()
    for pillar in range(force.shape[1]):
        pressed = force[:, pillar, 2] >= IN_CONTACT
        if np.count_nonzero(pressed) < LEAST_SNAPSHOTS:
            continue
        f, d = force[pressed, pillar], displacement[pressed, pillar]
        matrix = np.linalg.lstsq(d, f, rcond=None)[0].T
        size = np.linalg.norm(f[:, 2])
        single = d[:, 2] @ f[:, 2] / (d[:, 2] @ d[:, 2])
        stiffness.append(matrix)
        residual.append(float(np.linalg.norm(f[:, 2] - single * d[:, 2]) / size))
        matrix_residual.append(float(np.linalg.norm(f[:, 2] - d @ matrix[2]) / size))
    if not stiffness:
        raise InputError(
            f"reproduce: realism: no pillar has {LEAST_SNAPSHOTS} snapshots with at least {IN_CONTACT} N of normal force"
        )
    return Axes(np.array(stiffness), np.array(residual), np.array(matrix_residual))


def summary_of(axes: Axes) -> Floats:
    """The seven figures of a device, in the order of the constants REAL_*.

    Args:
        axes: fits of a device

    Returns:
        [7] rms coupling shear to normal, normal to shear, shear to shear [N/mm]; median residual of
        FZ with one stiffness and with a matrix [%]; scatter of normal and tangential stiffness over
        the pillars, the latter as rms of X and Y [%]
    """
    k = axes.stiffness

    def rms(*entries: Floats) -> float:
        return float(np.sqrt(np.mean(np.square(entries))))

    def scatter(values: Floats) -> float:
        return float(100.0 * values.std(ddof=1) / values.mean())

    return np.array(
        [
            rms(k[:, 2, 0], k[:, 2, 1]),
            rms(k[:, 0, 2], k[:, 1, 2]),
            rms(k[:, 0, 1], k[:, 1, 0]),
            100.0 * np.median(axes.residual),
            100.0 * np.median(axes.matrix_residual),
            scatter(k[:, 2, 2]),
            np.hypot(scatter(k[:, 0, 0]), scatter(k[:, 1, 1])) / np.sqrt(2.0),
        ]
    )


def _readings(_: Cell, trial: Trial) -> tuple[Floats, Floats]:
    [pad] = trial.sensors.values()
    return pad.channels["force"].astype(float), 1e3 * pad.channels["displacement"].astype(float)


def device_summaries(options: Options) -> Floats:
    """summary_of() of DEVICES simulated devices in the scene of snapshots.

    Args:
        options: seed of the first device (default: 1), jobs

    Returns:
        [DEVICES, 7]

    Raises:
        InputError: a trial fails
    """
    summaries = list[Floats]()
    for device in range(DEVICES):
        [trials] = run_grid(
            [Cell("snapshots.yaml", SNAPSHOTS)],
            replace(options, seed=options.draws_seed + device),
            _readings,
        )
        force, displacement = (np.concatenate(parts) for parts in zip(*trials, strict=True))
        summaries.append(summary_of(axes_of(force, displacement)))
    return np.array(summaries)


def vibration_amplitude(options: Options) -> float:
    """Transmission of the filter for a shear of VIBRATION, sampled at 1 kHz.

    Sticking strokes of 10 um, 8 mm/s back and forth.

    Args:
        options: jobs

    Returns:
        measured amplitude divided by that of the force; a triangle of +-5 um has 8/pi^2 of its
        amplitude in the fundamental

    Raises:
        InputError: the trial fails
    """
    travel, start = 10e-3, 0.4  # mm, s
    changes = {
        "sensors.pad.electronics": FILTER,
        "friction": "{static: 20, kinetic: 20}",
        "time_step": "0.01 ms",
        "duration": "0.53 s",
        "motion": f"{{kind: stage, compression: 1 mm, start: {start} s, speed: {2.0 * travel * VIBRATION} mm/s, travel: {travel} mm, strokes: 100, "
        "acceleration: inf}",
    }
    [[(force, _)]] = run_grid(
        [Cell("vibration", "scenes/papillarray/stage.yaml", changes)],
        replace(options, jobs=1),
        _readings,
    )
    shear = force[
        int(1e3 * start) + 10 : int(1e3 * start) + 110, CENTRE, 0
    ]  # 0.1 s: 40 periods, after the transient
    at = np.exp(-2j * np.pi * VIBRATION * 1e-3 * np.arange(len(shear)))
    read = 2.0 * abs(np.mean(at * (shear - shear.mean())))
    return float(read / (8.0 / np.pi**2 * TANGENTIAL_STIFFNESS * 0.5 * travel))


def half_time(after: Sequence[float], read: Sequence[float], level: float) -> float:
    """Time at which a rising signal reaches half of its level.

    Args:
        after: times after the step, in any order
        read: values at these times
        level: final level of the step

    Returns:
        the time, interpolated linearly between the two nearest samples
    """
    order = np.argsort(after)
    t, y = np.array(after)[order], np.array(read)[order]
    k = int(np.argmax(y >= 0.5 * level))
    return float(t[k] - (y[k] - 0.5 * level) / (y[k] - y[k - 1]) * (t[k] - t[k - 1]))


def step_half(options: Options) -> float:
    """Time at which a step of normal force is at half, sampled at 1 kHz.

    Ten presses of 0.2 mm at 10 m/s, each 0.1 ms later, combined.

    Args:
        options: jobs

    Returns:
        ms after the middle of the press, which takes 20 us

    Raises:
        InputError: a trial fails
    """
    speed, depth = 10e3, 0.2  # mm/s, mm
    cells, touches = list[Cell](), list[float]()
    for shift in range(10):
        touches.append(
            1e3 * (5e-3 + FINE_STEP * (shift - 0.5))
        )  # ms, halfway between two steps of the simulation
        motion = f"{{kind: stage, compression: {depth} mm, gap: {1e-3 * touches[-1] * speed - 0.5 * depth} mm, approach_speed: 10 m/s, acceleration: inf, start: 25 ms}}"
        cells.append(
            Cell(
                "step",
                "scenes/papillarray/stage.yaml",
                {
                    "sensors.pad.electronics": FILTER,
                    "time_step": "0.1 ms",
                    "duration": "30 ms",
                    "motion": motion,
                },
            )
        )
    presses = run_grid(cells, replace(options, jobs=1), _readings)
    after, read = list[float](), list[float]()
    for touch, [(force, _)] in zip(touches, presses, strict=True):
        for k in range(20):
            after.append(float(k) - touch)
            read.append(float(force[k, CENTRE, 2]))
    return half_time(after, read, NORMAL_STIFFNESS * depth)


def figures(options: Options) -> list[RealFigure]:
    """Properties of a PapillArray, with ours.

    Coupling between the axes of its pillars, scatter of their stiffness, and the filter before its
    converter.

    Args:
        options: seed of the first device (default: 1), jobs

    Returns:
        the figures; ours are medians over DEVICES simulated devices

    Raises:
        InputError: a trial fails
    """
    ours = np.median(device_summaries(options), axis=0)
    real = [
        REAL_SHEAR_TO_NORMAL,
        REAL_NORMAL_TO_SHEAR,
        REAL_SHEAR_TO_SHEAR,
        REAL_RESIDUAL,
        REAL_MATRIX_RESIDUAL,
        REAL_NORMAL_SCATTER,
        REAL_TANGENTIAL_SCATTER,
    ]
    what = [
        ("coupling of shear to FZ, rms over the pillars, N/mm", FORCE_CARRIES),
        ("coupling of DZ to FX and FY, rms, N/mm", FORCE_CARRIES),
        ("coupling between X and Y, rms, N/mm", FORCE_CARRIES),
        (
            "residual of FZ with one stiffness per pillar and axis, %",
            "fitted by the coupling alone",
        ),
        (
            "residual of FZ with a 3 x 3 matrix per pillar, %",
            "not modelled: stiffness that depends on the load",
        ),
        ("scatter of the normal stiffness over the pillars, %", FEW_PILLARS),
        ("scatter of the tangential stiffness over the pillars, %", FEW_PILLARS),
    ]
    return [
        *(
            RealFigure(text, its, float(value), note)
            for (text, note), its, value in zip(what, real, ours, strict=True)
        ),
        RealFigure(
            "step of force at 1 kHz, time to half, ms",
            float(HALF_OF_STEP),
            step_half(options),
            "real: by the data sheet's filter",
        ),
        RealFigure(
            f"amplitude of a vibration of {VIBRATION:.0f} Hz at 1 kHz",
            float(AMPLITUDE),
            vibration_amplitude(options),
            "real: by the data sheet's filter",
        ),
    ]
