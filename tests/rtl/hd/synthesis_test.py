"""Synthesis of the report at a tenth of the dimension.

It must succeed without latches and use the smallest core's cells.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]

with tempfile.TemporaryDirectory() as folder:
    result = Path(folder) / "result.json"
    subprocess.run(
        [
            sys.executable,
            ROOT / "rtl/hd/syn/report.py",
            "--dimension",
            "100",
            "--only",
            "smallest",
            "--json",
            result,
        ],
        check=True,
    )
    figures = json.loads(result.read_text(encoding="utf-8"))["unrollings"]["smallest"]

assert figures["latches"] == 0, figures
# One pillar per cycle: the squares of x, y and z.
assert figures["dsp"] == 3, figures
# At least the query vector, in flip-flops or in shift registers of 20 bits, and the waiting sample:
# 8 pillars of 48 bits.
assert figures["ff"] + 20 * figures["cells"].get("SRLC32E", 0) >= 100 + 8 * 48, figures
# Nine ports of CIM, two per block RAM, and the history.
assert figures["bram36"] == (5 + 1) / 2, figures
assert figures["latency_cycles"] == 1 * 9 + 20 + 8, figures
assert sum(figures["longest_path"].values()) == figures["levels"] > 0, figures
