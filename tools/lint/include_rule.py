"""Checks which files may include which.

A detector that could include the simulation could read the truth; this check prevents that.

- sim/core, sim/api: themselves and the layers below, the standard library and Eigen; Random123,
  SLEEF with its vector type, the loader of libraries and system calls for files and threads in a
  .cc; in plugin_abi.h, which is C, <stddef.h>.
- sensors/X: sim/core, sim/api, sim/plugins, sensors/X, sensors/plugin_abi.h, and
  sensors/electronics, which every sensor uses.
- detectors, controllers: sim/core, sim/api without the truth (TRUTH), sim/plugins, and themselves.
- rtl: as detectors, and detectors, whose golden models it runs in lockstep.
- the rest of sim: itself and the layers below it (SIM_LAYERS). MuJoCo's headers: only sim/mujoco
  and its tests (also tests/stability and tests/install/consumer).
- tools: the folders of BASE, which know no scene, include sim/core, sim/api and each other; the
  others include all of the bench and tools, but not tools/studies.
- python: as tools, and python.
- tests: everything.

A header of the project is included in quotes, by its path from the root; sources end in .h and .cc.

A source has a header of its name, which it includes. Four kinds of sources have none:

- main.cc, and the tests;
- an entry of a catalogue, which includes the header that declares the entries of its folder
  (ENTRIES), and sensors/X/X.cc, the entry of the sensor X, which includes the header of sensor
  entries or is written as a library (SENSOR_ENTRY);
- a library that is loaded, whose functions are exported in C (LOADED, and every folder `example`);
- a variant: another implementation of what a header declares, for a build, a processor or a kind of
  pad (VARIANTS).
"""

import re

from tree import lines_of, main, project_files

INCLUDE = re.compile(r'#include (["<])([^">]+)[">]')
ANY_INCLUDE = re.compile(r"^\s*(?:/\*.*\*/\s*)?#\s*(?:include|\\$)")
STANDARD = re.compile(r"[a-z_0-9]+")
# The truth, and the interfaces that receive or return it.
TRUTH = (
    "sim/api/contact_frame.h",
    "sim/api/effect.h",
    "sim/api/element_columns.h",
    "sim/api/element_event.h",
    "sim/api/motion.h",
    "sim/api/sensor.h",
    "sim/api/simulation.h",
)
MUJOCO = (
    "sim/mujoco/",
    "tests/sim/mujoco/",
    "tests/stability/",
    "tests/install/consumer/",
)  # who may include its headers
TOP_FOLDERS = ("sim", "sensors", "detectors", "controllers", "rtl", "tools", "python", "tests")
# The layers of sim, as in sim/README.md, with the other layers that each may include.
SIM_LAYERS = {
    "core": (),
    "api": ("core",),
    "plugins": ("core", "api"),
    "contact": ("core", "api"),
    "effects": ("core", "api", "contact"),
    "motion": ("core", "api"),
    "scene": ("core",),
    "grasp": ("core", "api", "motion", "scene"),
    "stage": ("core", "api", "contact", "effects", "motion", "scene", "grasp"),
    "mujoco": ("core", "api", "contact", "effects", "motion", "scene", "grasp", "stage"),
}
# The folders of tools with sources: those that know no scene, and the tasks of the program.
BASE = ("dataset", "files", "page", "statistics", "workers")
TASKS = (
    "benchmark",
    "calibrate",
    "check",
    "cli",
    "cost",
    "demo",
    "doctor",
    "eval",
    "formats",
    "gym",
    "learning_data",
    "plugin",
    "reader",
    "registry",
    "report",
    "train",
    "trial",
    "verify",
    "view",
)
BENCH = ("sim/", "sensors/", "detectors/", "controllers/", "rtl/")
FOR_PARTS = ("sim/core/", "sim/api/", "sim/plugins/")  # for sensors, detectors and controllers

# Folders of entries of a catalogue: the headers that declare them.
ENTRIES = {
    "controllers": ("controllers/controller_kinds.h", "controllers/grip.h"),
    "detectors": ("detectors/detector_kinds.h",),
    "detectors/network": ("detectors/detector_kinds.h",),
    "detectors/spectral": ("detectors/detector_kinds.h",),
    "detectors/yardstick": ("detectors/detector_kinds.h",),
    "python": ("python/module.h",),
    "rtl/verilated": ("detectors/detector_kinds.h",),
    "sensors/electronics": ("sensors/electronics/part_kind.h",),
    "sim/effects": ("sim/effects/effect_catalogue.h",),
    "sim/motion": ("sim/motion/motion_catalogue.h",),
    "tools/cli/commands/detectors": ("tools/cli/commands/detectors/detector_commands.h",),
    "tools/cli/commands/simulation": ("tools/cli/commands/simulation/simulation_commands.h",),
    "tools/formats/export": ("tools/formats/export/formats.h",),
    "tools/formats/import": ("tools/formats/import/source_table.h",),
}
SENSOR_ENTRY = ("sim/api/sensor_kind.h", "sensors/plugin_abi.h")
# Libraries that are loaded.
LOADED = (
    "detectors/network/openvino_engine.cc",
    "rtl/verilated/verilated_core.cc",
    "sensors/plugins/bundled_kind.cc",
    "tools/plugin/mujoco_plugin.cc",
    "tools/plugin/static_parts.cc",
)
# Variants: the header that declares what they implement.
VARIANTS = {
    "detectors/hd/kernel/kernel.cc": "detectors/hd/engine.h",
    "detectors/hd/kernel/kernel_avx2.cc": "detectors/hd/kernel/kernel_body.h",
    "detectors/hd/kernel/kernel_avx512.cc": "detectors/hd/kernel/kernel_body.h",
    "detectors/hd/kernel/kernel_portable.cc": "detectors/hd/kernel/kernel_body.h",
    "detectors/hd/reference.cc": "detectors/hd/engine.h",
    "sim/mujoco/pads/own_plugin.cc": "sim/mujoco/pads/register_plugin.h",
    "sim/mujoco/releases/own_mujoco.cc": "sim/mujoco/releases/mujoco_library.h",
    "tools/trial/mujoco/no_mujoco_simulation.cc": "tools/trial/mujoco/mujoco_simulation.h",
}
# Headers that sources of sim/core and sim/api may include, but not their headers.
IN_SOURCES = (
    "sleef.h",
    "emmintrin.h",
    "dlfcn.h",
    "fcntl.h",
    "poll.h",
    "spawn.h",
    "sys/wait.h",
    "unistd.h",
)


def entry_headers(path):
    """Headers of which a source without a header of its name must include one; empty: none do."""
    if path.as_posix() in VARIANTS:
        return (VARIANTS[path.as_posix()],)
    if path.parts[0] == "sensors" and path.stem == path.parent.name:
        return SENSOR_ENTRY
    return ENTRIES.get(path.parent.as_posix(), ())


def without_header(path, included):
    """Error of a source that has no header of its name, or None.

    `included`: the headers that it includes.
    """
    if (
        path.name == "main.cc"
        or path.parts[0] == "tests"
        or path.parent.name == "example"
        or path.as_posix() in LOADED
    ):
        return None
    declared_in = entry_headers(path)
    if included.intersection(declared_in):
        return None
    entries = f", or an include of {' or '.join(declared_in)}" if declared_in else ""
    return f'a source has a header of its name: "{path.with_suffix(".h").as_posix()}"{entries}'


def allowed_in_tools(path):
    """The same for a file in tools."""
    if path.parts[1] in BASE:
        return ("sim/core/", "sim/api/", *(f"tools/{folder}/" for folder in BASE))
    if path.parts[1] in TASKS:
        return (*BENCH, *(f"tools/{folder}/" for folder in (*BASE, *TASKS)))
    return None


def allowed_folders(path):
    """Project folders that a file may include from; None if it is in no layer."""
    top = path.parts[0]
    if top == "sim":
        if path.parts[1] not in SIM_LAYERS:
            return None
        return tuple(f"sim/{layer}/" for layer in (path.parts[1], *SIM_LAYERS[path.parts[1]]))
    if top == "sensors":
        return (
            *FOR_PARTS,
            f"sensors/{path.parts[1]}/",
            "sensors/electronics/",
            "sensors/plugin_abi.h",
        )
    if top in ("detectors", "controllers"):
        return (*FOR_PARTS, f"{top}/")
    if top == "rtl":
        return (*FOR_PARTS, "detectors/", "rtl/")
    if top == "tools":
        return allowed_in_tools(path)
    if top == "python":
        return (*BENCH, *(f"tools/{folder}/" for folder in (*BASE, *TASKS)), "python/")
    return tuple(f"{folder}/" for folder in TOP_FOLDERS)


def fault_of(path, quoted, header):
    """Error of a file's include of a header, or None."""
    folder = path.parent.as_posix()
    allowed = allowed_folders(path)
    if allowed is None:
        return f"{folder} is no layer of sim ({', '.join(SIM_LAYERS)}) and no folder of tools ({', '.join((*BASE, *TASKS))})"
    if quoted:
        return fault_of_own(path, header, allowed)
    return fault_of_foreign(path, header)


def fault_of_own(path, header, allowed):
    """Error of an include in quotes; `allowed`: beginnings of allowed headers."""
    folder = path.parent.as_posix()
    if not header.endswith(".h"):
        return f'"{header}" is no header'
    if ".." in header.split("/") or not header.startswith(tuple(f"{top}/" for top in TOP_FOLDERS)):
        return f'"{header}" is not given from the project root'
    if not header.startswith(allowed):
        return f'{folder} may include {", ".join(allowed)} only, not "{header}"'
    if path.parts[0] in ("detectors", "controllers", "rtl") and header in TRUTH:
        return f'{folder} must not see the truth, found "{header}"'
    return None


def fault_of_foreign(path, header):
    """Error of an include in angle brackets."""
    folder = path.parent.as_posix()
    if header.split("/")[0] in TOP_FOLDERS:
        return f"<{header}> is of the project; allowed: in quotes"
    if header.startswith("mujoco/") and not f"{folder}/".startswith(MUJOCO):
        return f"only sim/mujoco may include <{header}>"
    if path.parts[:2] in (("sim", "core"), ("sim", "api")):
        hidden = path.suffix == ".cc" and (header.startswith("Random123/") or header in IN_SOURCES)
        in_c = path.name == "plugin_abi.h" and header == "stddef.h"
        if not (STANDARD.fullmatch(header) or header.startswith("Eigen/") or hidden or in_c):
            return f"{folder} may include the standard library and Eigen only, not <{header}>"
    return None


def check(root):
    files = project_files(root)
    headers = set(files)
    for path in files:
        if path.parts[0] not in TOP_FOLDERS:
            continue
        if path.suffix in (
            ".hpp",
            ".hh",
            ".hxx",
            ".inc",
            ".ipp",
            ".cpp",
            ".cxx",
            ".c",
        ) and path.name not in ("faults.c", "layout.c"):  # preloaded; compiled by users in C
            yield f"{path}: a source ends in .h or .cc"
        if path.suffix not in (".h", ".cc"):
            continue
        included = set()
        for number, line in lines_of(root, path):
            if not ANY_INCLUDE.match(line):
                continue
            include = INCLUDE.match(line)
            included.add(include[2] if include else "")
            fault = (
                fault_of(path, include[1] == '"', include[2])
                if include
                else "an include that cannot be read"
            )
            if fault:
                yield f"{path}:{number}: {fault}"
        own = path.with_suffix(".h")
        if path.suffix == ".cc" and path.parts[0] != "tests" and own in headers:
            fault = (
                None
                if own.as_posix() in included
                else f'a source includes the header of its name: "{own.as_posix()}"'
            )
        else:
            fault = without_header(path, included) if path.suffix == ".cc" else None
        if fault:
            yield f"{path}: {fault}"


if __name__ == "__main__":
    main(check)
