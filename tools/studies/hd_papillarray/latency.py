"""Section IV.C of the paper.

Time from a frame to its class, in software and in the register-level core.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, RandomStream
from slipbench.bin import _core
from slipbench_studies.hd_papillarray.core import CLOCK, FIGURES_FILE, CoreFigures, stored_figures
from slipbench_studies.result import Options, Result, Table

PAPER_CPU = "paper: C++ on a Core i7-10700"
PAPER_FPGA = "paper: FPGA"
GRIPPER_CORE = "published gripper core, as simulated"
PUBLISHED = {
    PAPER_CPU: 5985e-6,
    PAPER_FPGA: 0.42e-6,
    GRIPPER_CORE: 4.63e-6,
}  # s; the cores at CLOCK
PUBLISHED_CYCLES = {PAPER_FPGA: 42, GRIPPER_CORE: 463}

FRAMES, PASSES = 4096, 101
REFERENCE = "plain C++"  # slowest engine, a thousand times slower than the others
REFERENCE_FRAMES, REFERENCE_PASSES = 64, 11
PILLARS, LEVELS, CONTEXTS = 9, 21, 4


def random_levels() -> NDArray[np.uint8]:
    """[FRAMES, PILLARS + 1] levels of the pillars and the context.

    The time does not depend on the values; random ones do not favour the caches.
    """
    random = RandomStream(1, 0, "latency")
    bounds = [LEVELS] * PILLARS + [CONTEXTS]
    return np.array(
        [[random.integer(bound) for bound in bounds] for _ in range(FRAMES)], dtype=np.uint8
    )


def random_displacements() -> NDArray[np.float32]:
    """[FRAMES, 3 PILLARS] m, random as in random_levels()."""
    return (
        RandomStream(1, 1, "latency")
        .uniforms(FRAMES * 3 * PILLARS, -2e-3, 2e-3)
        .reshape(FRAMES, -1)
        .astype(np.float32)
    )


def software(options: Options) -> Iterator[tuple[str, float]]:
    """Times plain C++, and every kernel that this CPU supports.

    Yields the name and the time per frame [s].

    Args:
        options: progress output
    """
    levels, displacements = random_levels(), random_displacements()
    for engine in _core.hd_engines():
        if engine == REFERENCE:
            options.say(REFERENCE)
            yield (
                f"ours: {REFERENCE}, follows the equations",
                _core.hd_time(engine, levels[:REFERENCE_FRAMES], REFERENCE_PASSES),
            )
        else:
            options.say(f"kernel, {engine}")
            yield f"ours: kernel, {engine}", _core.hd_time(engine, levels, PASSES)
            yield (
                f"ours: kernel, {engine}, from displacements",
                _core.hd_time_from_displacements(engine, displacements, PASSES),
            )


def time_text(seconds: float) -> str:
    """A time for the table."""
    return f"{1e9 * seconds:.1f} ns" if seconds < 1e-6 else f"{1e6 * seconds:.2f} us"


def factor_text(factor: float) -> str:
    """A ratio of times for the table."""
    return f"{factor:.2g} x" if factor < 100.0 else f"{factor:.0f} x"


def _core_figures() -> CoreFigures | None:
    """Figures of the synthesis.

    None: the project has none, and the rows of the core are omitted.
    """
    try:
        _core.project_file(FIGURES_FILE)
    except InputError:
        return None
    return stored_figures()


def study(options: Options) -> Result:
    """hd-papillarray/latency.

    Args:
        options: progress output

    Returns:
        the time per frame of each engine and core with the published ones

    Raises:
        InputError: for an invalid file of the synthesis
    """
    core = _core_figures()
    unrollings = core.configurations if core else ()
    cycles = PUBLISHED_CYCLES | {f"ours: RTL core, {one.name}": one.cycles for one in unrollings}
    seconds = {
        PAPER_CPU: PUBLISHED[PAPER_CPU],
        **dict(software(options)),
        PAPER_FPGA: PUBLISHED[PAPER_FPGA],
        GRIPPER_CORE: PUBLISHED[GRIPPER_CORE],
        **{f"ours: RTL core, {one.name}": one.cycles / CLOCK for one in unrollings},
    }
    table = Table(
        "From a frame to its class",
        [
            "what",
            "cycles",
            "time per sample",
            "faster than the published CPU",
            "than the published FPGA",
        ],
        note="Software from levels to class unless the row says otherwise; medians. Cycles at 100 MHz.",
    )
    for what, time in seconds.items():
        factors = [factor_text(PUBLISHED[name] / time) for name in (PAPER_CPU, PAPER_FPGA)]
        table.rows.append([what, str(cycles.get(what, "-")), time_text(time), *factors])
    machine = json.loads(_core.machine())
    dimension, window = _core.hd_size()
    return Result(
        title="Latency of the hyperdimensional slip detector",
        source='Section IV.C and table III of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile '
        'Sensor": 5,985 us on a Core i7-10700 in C++, 0.42 us on an xc7a200t FPGA',
        figures=seconds,
        setup=[
            f"CPU: {machine['cpu']}; one thread.",
            f"Compiler: {machine['compiler']}, {machine['flags']}.",
            f"D = {dimension}, N = {window}, CL-gstHDC. Kernel: median of {PASSES} passes over {FRAMES} random frames; plain C++: median of {REFERENCE_PASSES} passes over {REFERENCE_FRAMES}.",
            f"RTL: cycles from {FIGURES_FILE if core else f'nowhere: there is no {FIGURES_FILE}'}.",
        ],
        tables=[table],
        remarks=[
            "The paper does not describe its C++ program. Our program that follows the equations computes the whole window of 15 frames anew at each "
            "sample, one entry of a vector at a time. The method does not require this: in the kernel the window advances by one frame, the graphs reduce "
            "to counts, and a word holds 64 entries. So the paper's factor of 10,000 compares two programs rather than two machines.",
            "The paper's 0.42 us is the time from levels to the class, without the feature, the bus and the transfer from the sensor. The cycles of our "
            "core begin with nine displacements and end with the class, so they include the feature; the software has a separate row for it. The sensor "
            "delivers a frame every 10 ms.",
        ],
    )
