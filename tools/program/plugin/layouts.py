"""layouts.py [--check] RELEASE=FOLDER...: writes mujoco_layouts.h and mujoco_calls.h anew, from the headers in FOLDER/mujoco/include of each release of
MuJoCo that libslipbench_mujoco-others.so works in; with --check compares its rows with these headers, of whatever releases. Needs g++."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
SIM = HERE.parents[2] / "sim/mujoco"
PADS = SIM / "pads"

# All that sim/mujoco's pads read and write of MuJoCo's structures. A member after a colon stands in where a release has none of the first name.
COUNTS = ("nv nbody njnt ngeom nsite npair nexclude ntendon nsensor nplugin nactuator:nu").split()
MODEL = {
    "int*": "actuator_plugin body_dofadr body_dofnum body_jntnum body_parentid body_rootid body_treeid body_weldid dof_bodyid dof_parentid "
            "exclude_signature geom_bodyid geom_conaffinity geom_contype geom_dataid geom_group geom_type jnt_bodyid jnt_qposadr mesh_face mesh_faceadr "
            "mesh_facenum mesh_vertadr mesh_vertnum name_pluginadr pair_geom1 pair_geom2 plugin plugin_stateadr plugin_statenum sensor_adr sensor_plugin "
            "site_bodyid tendon_adr tendon_num wrap_objid wrap_type",
    "mjtNum*": "dof_damping geom_rbound geom_size site_pos site_quat site_size tendon_damping",
    "float*": "mesh_vert",
    "char*": "names",
}
OPTION = {"int": "disableflags enableflags integrator iterations noslip_iterations solver", "mjtNum": "timestep"}
DATA = {
    "int": "efm_active nefmcon",
    "mjtNum": "time",
    "int*": "efm_con_ind",
    "mjtNum*": "cdof cvel efm_con_val geom_xmat geom_xpos plugin_state qM qacc qfrc_applied qfrc_passive qvel sensordata site_xmat site_xpos subtree_com "
               "xmat xpos",
    "uintptr_t*": "plugin_data",
}
# Numbers that the releases do not have alike; PASSIVE was both springs and dampers, and before there was sleep nothing slept.
NUMBERS = {"mjDSBL_SPRING": "mjDSBL_PASSIVE", "mjDSBL_DAMPER": "mjDSBL_PASSIVE", "mjDSBL_EULERDAMP": "0", "mjDSBL_FILTERPARENT": "0", "mjENBL_SLEEP": "0"}


def calls():
    """The functions of MuJoCo in the sources that know one."""
    names = re.search(r"set\(pad_sources\n(.*?)\)", (PADS / "CMakeLists.txt").read_text(encoding="utf-8"), re.DOTALL)[1].split()
    files = [*(PADS / name for name in names), SIM / "mujoco_call.h", SIM / "mujoco_differences.h"]
    code = "".join(re.sub(r"//.*|\"[^\"\n]*\"", "", file.read_text(encoding="utf-8")) for file in files)
    return sorted(set(re.findall(r"\b(mj[upv]?_\w+)\b", code)))


def members():
    """(kind, type, place in mjModel or mjData, what stands in) of each."""
    for count in COUNTS:
        name, _, other = count.partition(":")
        yield "count", "Count", name, other
    for kind, prefix, groups in (("model", "", MODEL), ("option", "opt.", OPTION), ("data", "", DATA)):
        for type_name, names in groups.items():
            for name in names.split():
                yield kind, type_name, prefix + name, ""
    yield "force", "float", "vis.map.force", ""


def layout(folder):
    """{name: number} of one release's headers."""
    lines = ["#include <cstddef>", "#include <cstdio>", "#include <type_traits>", "#include <mujoco/mujoco.h>", "template <class M, class D> void show() {"]
    for kind, type_name, place, other in members():
        struct = "D" if kind == "data" else "M"
        expected = "decltype(t.nv)" if kind == "count" else type_name
        lines.append(f"  if constexpr (requires({struct} t) {{ t.{place}; }}) {{ [] <class T>(const T& t) {{ "
                     f"static_assert(std::is_same_v<decltype(t.{place}), {expected}>); }}(*static_cast<const {struct}*>(nullptr)); "
                     f"std::printf(\"{place} %zu\\n\", offsetof({struct}, {place})); }} else ")
        lines.append(f"    std::printf(\"{place} %ld\\n\", {f'static_cast<long>(offsetof({struct}, {other}))' if other else '-1L'});")
    text = "".join(file.read_text(encoding="utf-8") for file in (folder / "mujoco/include/mujoco").glob("*.h"))
    lines += ["}", "int main() {", "  show<mjModel, mjData>();"]
    for name, other in NUMBERS.items():
        lines.append(f"  std::printf(\"{name} %d\\n\", static_cast<int>({name if re.search(rf'{name}[^A-Z]', text) else other}));")
    lines += ["  std::printf(\"count_bytes %zu\\n\", sizeof(mjModel::nv));", "  std::printf(\"geom_bytes %zu\\n\", sizeof(mjvGeom));", "}"]
    with tempfile.TemporaryDirectory() as work:
        source, program = Path(work) / "layout.cc", Path(work) / "layout"
        source.write_text("\n".join(lines), encoding="utf-8")
        subprocess.run(["g++", "-std=c++20", "-w", "-I", folder / "mujoco/include", source, "-o", program], check=True)
        said = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    return {name: int(number) for name, number in (line.split() for line in said.splitlines())}


def rows(name, kind, layouts):
    """#define NAME(X), one X(type, name, number of each release) a member."""
    lines = [f"#define {name}(X)"]
    for member_kind, type_name, place, _ in members():
        if member_kind == kind:
            lines.append(f"  X({type_name}, {place.split('.')[-1]}, {', '.join(str(one[place]) for one in layouts)})")
    return " \\\n".join(lines) + "\n"


def write(releases):
    head = "// Made by layouts.py of this folder: do not edit.\n// clang-format off\n#pragma once\n\n"
    layouts = [layout(folder) for folder in releases.values()]
    text = head + "#define SLIPBENCH_MUJOCO_RELEASES " + ", ".join(f'"{release}"' for release in releases) + "\n\n"
    text += "// X(type, member, its place [bytes] in each of these releases): -1 where it has none.\n"
    for kind in ("count", "model", "option", "force", "data"):
        text += rows(f"SLIPBENCH_{kind.upper()}_MEMBERS", kind, layouts) + "\n"
    text += "// X(name, its value in each of these releases)\n#define SLIPBENCH_MUJOCO_NUMBERS(X)"
    for name in (*NUMBERS, "count_bytes", "geom_bytes"):
        text += f" \\\n  X({name.removeprefix('mj')}, {', '.join(str(one[name]) for one in layouts)})"
    (HERE / "mujoco_layouts.h").write_text(text + "\n", encoding="utf-8")
    text = head + "#define SLIPBENCH_MUJOCO_CALLS(X)" + "".join(f" \\\n  X({name})" for name in calls()) + "\n\n"
    text += "#include \"tools/program/plugin/any_mujoco.h\"\n\n"
    text += "".join(f"#define {name} (*slipbench::any_mujoco::calls.{name}_)\n" for name in calls())
    text += "".join(f"#undef {name}\n#define {name} slipbench::any_mujoco::number(slipbench::any_mujoco::{name[2:]}_number)\n" for name in NUMBERS)
    (HERE / "mujoco_calls.h").write_text(text, encoding="utf-8")


def check(releases):
    """Names each number of mujoco_layouts.h that these headers contradict."""
    text = (HERE / "mujoco_layouts.h").read_text(encoding="utf-8")
    known = re.findall(r'"([\d.]+)"', text)
    table = {row[0]: [int(word) for word in row[1].split(", ")] for row in re.findall(r"X\((?:[\w*]+, )?([A-Za-z]\w*), (-?\d[-\d, ]*)\)", text)}
    wrong = []
    for release, folder in releases.items():
        if release not in known:
            wrong.append(f"{release} is not in mujoco_layouts.h")
            continue
        for name, number in layout(folder).items():
            row = table[name.removeprefix("mj").split(".")[-1]]
            if row[known.index(release)] != number:
                wrong.append(f"{release}: {name} is {number}, and mujoco_layouts.h says {row[known.index(release)]}")
    return wrong


if __name__ == "__main__":
    words = sys.argv[1:]
    named = {word.partition("=")[0]: Path(word.partition("=")[2]) for word in words if "=" in word}
    if len(named) != len([word for word in words if word != "--check"]) or not named:
        sys.exit("layouts.py: " + (" ".join(words) or "no release") + "; allowed: [--check] RELEASE=FOLDER..., as setup.sh mujoco installs them")
    if "--check" in words:
        sys.exit("\n".join(check(named)) or 0)
    write(named)
