"""Checks which files may include which. A detector that could include the simulation could read the
truth; this check prevents that.

- sim/core: itself, the standard library and Eigen; Random123, SLEEF with its vector type, the
  loader of libraries and system calls for files and threads in a .cc; in plugin_abi.h, which is C,
  <stddef.h>.
- sensors/X: sim/core, sensors/X, sensors/plugin_abi.h, and sensors/electronics, which every sensor
  uses.
- detectors, controllers: sim/core without the truth (contact_frame.h, and sensor.h, which receives
  it), and themselves.
- rtl: as detectors, and detectors, whose golden models it runs in lockstep.
- the rest of sim: itself and the layers below it (SIM_LAYERS). MuJoCo's headers: only sim/mujoco
  and its tests (also tests/stability and tests/install/consumer).
- tools/base: sim/core and base itself. tools/program: all of the bench, base and program.
- tools/python: as tools/program, and python.
- tests: everything.

A header of the project is included in quotes, by its path from the root; sources end in .h and .cc.
"""

import re

from tree import lines_of, main, project_files

INCLUDE = re.compile(r'#include (["<])([^">]+)[">]')
ANY_INCLUDE = re.compile(r"^\s*(?:/\*.*\*/\s*)?#\s*(?:include|\\$)")
STANDARD = re.compile(r"[a-z_0-9]+")
TRUTH = ("sim/core/contact_frame.h", "sim/core/sensor.h")
MUJOCO = ("sim/mujoco/", "tests/sim/mujoco/", "tests/stability/", "tests/install/consumer/")  # who may include its headers
TOP_FOLDERS = ("sim", "sensors", "detectors", "controllers", "rtl", "tools", "tests")
# The layers of sim, as in sim/README.md, with the other layers that each may include.
SIM_LAYERS = {
    "core": (),
    "field": ("core",),
    "effects": ("core", "field"),
    "motion": ("core",),
    "scene": ("core",),
    "grasp": ("core", "motion", "scene"),
    "simulation": ("core", "field", "effects", "motion", "scene", "grasp"),
    "mujoco": ("core", "field", "effects", "motion", "scene", "grasp", "simulation"),
}
# The layers of tools, from the lowest up.
FLOORS = ("base", "program")
BESIDE = {"python": "program"}  # on top of a layer, but not a layer itself
BENCH = ("sim/", "sensors/", "detectors/", "controllers/", "rtl/")


def allowed_in_tools(path):
    """The same for a file in tools."""
    folder = path.parts[1]
    floor = BESIDE.get(folder, folder)
    if floor not in FLOORS:
        return None
    below = tuple(f"tools/{name}/" for name in (*FLOORS[:FLOORS.index(floor) + 1], folder))
    return (("sim/core/",) if floor == "base" else BENCH) + below


def allowed_folders(path):
    """Project folders that a file may include from; None if it is in no layer."""
    top = path.parts[0]
    if top == "sim":
        if path.parts[1] not in SIM_LAYERS:
            return None
        return tuple(f"sim/{layer}/" for layer in (path.parts[1], *SIM_LAYERS[path.parts[1]]))
    if top == "sensors":
        return ("sim/core/", f"sensors/{path.parts[1]}/", "sensors/electronics/", "sensors/plugin_abi.h")
    if top in ("detectors", "controllers"):
        return ("sim/core/", f"{top}/")
    if top == "rtl":
        return ("sim/core/", "detectors/", "rtl/")
    if top == "tools":
        return allowed_in_tools(path)
    return tuple(f"{folder}/" for folder in TOP_FOLDERS)


def fault_of(path, quoted, header):
    """Error of a file's include of a header, or None."""
    folder = path.parent.as_posix()
    allowed = allowed_folders(path)
    if allowed is None:
        return f'{folder} is no layer of sim ({", ".join(SIM_LAYERS)}) and no floor of tools ({", ".join(FLOORS)})'
    if quoted:
        if not header.endswith(".h"):
            return f'"{header}" is no header'
        if ".." in header.split("/") or not header.startswith(tuple(f"{top}/" for top in TOP_FOLDERS)):
            return f'"{header}" is not given from the project root'
        if not header.startswith(allowed):
            return f'{folder} may include {", ".join(allowed)} only, not "{header}"'
        if path.parts[0] in ("detectors", "controllers", "rtl") and header in TRUTH:
            return f'{folder} must not see the truth, found "{header}"'
        return None
    if header.split("/")[0] in TOP_FOLDERS:
        return f"<{header}> is of the project; allowed: in quotes"
    if header.startswith("mujoco/") and not f"{folder}/".startswith(MUJOCO):
        return f"only sim/mujoco may include <{header}>"
    if path.parts[:2] == ("sim", "core"):
        hidden = path.suffix == ".cc" and (header.startswith("Random123/") or header in ("sleef.h", "emmintrin.h", "dlfcn.h", "fcntl.h", "poll.h", "spawn.h", "sys/wait.h", "unistd.h"))
        in_c = path.name == "plugin_abi.h" and header == "stddef.h"
        if not (STANDARD.fullmatch(header) or header.startswith("Eigen/") or hidden or in_c):
            return f"sim/core may include the standard library and Eigen only, not <{header}>"
    return None


def check(root):
    for path in project_files(root):
        if path.parts[0] not in TOP_FOLDERS:
            continue
        if path.suffix in (".hpp", ".hh", ".hxx", ".inc", ".ipp", ".cpp", ".cxx", ".c") and path.name != "faults.c":  # faults.c is preloaded
            yield f"{path}: a source ends in .h or .cc"
        if path.suffix not in (".h", ".cc"):
            continue
        for number, line in lines_of(root, path):
            if not ANY_INCLUDE.match(line):
                continue
            include = INCLUDE.match(line)
            fault = fault_of(path, include[1] == '"', include[2]) if include else "an include that cannot be read"
            if fault:
                yield f"{path}:{number}: {fault}"


if __name__ == "__main__":
    main(check)
