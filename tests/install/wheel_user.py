"""First steps of a user of the wheel: wheel_user.py ROOT [WHEEL].

With WHEEL installs it. ROOT is read for its texts alone. The last printed line is JSON: `said`, the
output of each Python line and digests of trials, and `figures`. Fails if a step does.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT, WHEEL = Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else None
# Scripts that act at random, or need the renderer.
RANDOM = ("grasp.py", "grasps.py")
# Scripts that need PyTorch, which takes gigabytes. tests/python/examples_test.py runs them.
WITH_PYTORCH = ("train.py",)
EPISODE = """
import gymnasium, slipbench.gym
env = gymnasium.make("slipbench/GraspLift-v0")
env.reset(seed=1)
done = False
while not done:
    _, _, terminated, truncated, info = env.step(-0.4)
    done = terminated or truncated
print(info["outcome"]["dropped"], info["outcome"]["max_grip_force_N"])
"""
DIGESTS = """
import slipbench
for name in ("papillarray/stage.yaml", "papillarray/hexapod.yaml", "grasp/lift.yaml", "myrmex/slip.yaml", "bodies/held_box.yaml"):
    print(name, slipbench.Scene.load(name).run().sha256)
"""
KEPT = """
slipbench: 1
duration: 1.2 s
surface: {material: rubber}
motion: {compression: 1 mm, start: 0.5 s, speed: 4 mm/s}
sensors: {pad: {type: papillarray, rate: 1 kHz}}
expect: {gross_slip_by: 1.1 s}
"""
NEWER = """
import slipbench.mujoco
try: slipbench.mujoco.plugin_path("3.18.0")
except slipbench.InputError as error: print(str(error).partition(" To add")[0])
"""


def run(*command, status=0, **more):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **more)
    if done.returncode != status:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + (done.stderr if status else "")


def timed(*command):
    start = time.monotonic()
    run(*command)
    return time.monotonic() - start


def install():
    pip = (sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    figures = {"install_s": timed(*pip, WHEEL)}
    # The best of five, without Python's own start, because the machine is shared.
    bare, imported = (
        min(timed(sys.executable, "-c", code) for _ in range(5))
        for code in ("pass", "import slipbench")
    )
    figures["import_s"] = imported - bare
    program = str(Path(sys.executable).with_name("slipbench"))
    run(program, "sweep", "papillarray/hexapod.yaml", "-o", "hexapod.h5")
    run(sys.executable, "-m", "slipbench", "report", "hexapod.h5", "-o", "hexapod.html")
    if "<html" not in Path("hexapod.html").read_text(encoding="utf-8")[:200]:
        sys.exit("report wrote no page")
    refused = run(
        program,
        "train",
        "hexapod.h5",
        "--recipe",
        "papillarray_gru",
        "--steps",
        "1",
        "-o",
        "small.onnx",
        status=2,
    )
    if "pip install torch" not in refused.splitlines()[-1]:
        sys.exit(f"train without PyTorch says: {refused}")
    run(*pip, f"{WHEEL}[gym,pandas,render]", "pytest")
    use_commands(program)
    return figures


def use_commands(program):
    """Runs the commands that need no build of the source tree, in the folder with hexapod.h5."""
    for line in (
        "describe gst_hd",
        "schema",
        "detect force_ratio hexapod.h5 -o alarms.csv",
        "export hexapod.h5 --format npz -o npz",
        "reproduce list",
        "reproduce hd-papillarray/resources",
    ):
        run(program, *line.split())
    Path("kept.yaml").write_text(KEPT, encoding="utf-8")
    if "1 passed" not in run(sys.executable, "-m", "pytest", "kept.yaml"):
        sys.exit("pytest collects no scene")


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        figures = install() if WHEEL else {}
        said = {
            "episode": run(sys.executable, "-c", EPISODE),
            "digests": run(sys.executable, "-c", DIGESTS),
            "newer": run(sys.executable, "-c", NEWER),
        }
        pages = "".join(
            page.read_text(encoding="utf-8") for page in sorted((ROOT / "python").glob("*.md"))
        )
        for name, code in re.findall(r"```python (\S+\.py)\n(.*?)```", pages, re.DOTALL):
            if name in WITH_PYTORCH:
                continue
            Path(name).write_text(code, encoding="utf-8")
            printed = run(sys.executable, name)
            if name not in RANDOM:
                said[name] = printed
    print(json.dumps({"said": said, "figures": figures}))


if __name__ == "__main__":
    main()
