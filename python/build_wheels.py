"""build_wheels.py [-o FOLDER]: builds the wheels of the package `slipbench`.

One is for Python 3.11, one for 3.12 and later. They need only glibc 2.36 from the system. Writes
them to FOLDER, default build/wheel, from build/release, with all libraries and licences inside.
Needs Debian 12 and tools/setup/setup.sh build test python test-python wheel. Debian 12 has
no Python after 3.11, so the headers of Debian 13 are fetched.
"""

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = ROOT / "build/wheel"
BUILD = ROOT / "build/release"
TOOLS = WORK / "tools"
VENV = ROOT / "build/venv"
ABI3_HEADERS = "libpython3.13-dev"
# Libraries from other packages: glibc and GCC's libraries as in every manylinux, OpenVINO from its
# own package, MuJoCo from its search folder.
NOT_INSIDE = ("libopenvino.so.*", "libmujoco.so.*")


def run(*command, **more):
    environment = {
        **os.environ,
        "PYTHONPATH": str(TOOLS),
        "PATH": f"{TOOLS / 'bin'}:{os.environ['PATH']}",
        **more.pop("env", {}),
    }
    return subprocess.run(
        [str(word) for word in command], check=True, text=True, env=environment, **more
    )


def output_of(*command, **more):
    return run(*command, capture_output=True, **more).stdout


def fetch_headers():
    """Fetches Python 3.13's headers from Debian 13 to build/wheel/headers.

    The folders of apt are separate.
    """
    folder = WORK / "headers"
    if folder.exists():
        return
    apt = WORK / "apt"
    shutil.rmtree(apt, ignore_errors=True)
    for name in ("lists/partial", "cache/archives/partial"):
        (apt / name).mkdir(parents=True)
    (apt / "status").touch()
    mirrors = output_of("apt-get", "indextargets", "--format", "$(REPO_URI)").split()
    mirror = next(
        (mirror for mirror in mirrors if mirror.rstrip("/").endswith("/debian")),
        "http://deb.debian.org/debian",
    )
    (apt / "sources.list").write_text(
        f"deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] {mirror} trixie main\n",
        encoding="utf-8",
    )
    options = [
        f"-oDir::Etc::sourcelist={apt}/sources.list",
        "-oDir::Etc::sourceparts=-",
        f"-oDir::State::lists={apt}/lists",
        f"-oDir::State::status={apt}/status",
        f"-oDir::Cache={apt}/cache",
        "-oAPT::Sandbox::User=",
    ]
    run("apt-get", *options, "-qq", "update")
    run("apt-get", *options, "-qq", "download", ABI3_HEADERS, cwd=apt)
    run("dpkg", "-x", next(apt.glob("*.deb")), apt / "headers")
    (apt / "headers").rename(folder)


def stage(folder):
    """Puts the packages slipbench, without its module, and slipbench_studies below `folder`.

    Returns their paths and the path of the wheel's metadata.
    """
    package, studies = folder / "slipbench", folder / "slipbench_studies"
    shutil.copytree(
        ROOT / "python/slipbench", package, ignore=shutil.ignore_patterns("__pycache__")
    )
    run(
        "cmake",
        "--install",
        BUILD,
        "--component",
        "python",
        "--prefix",
        package,
        stdout=subprocess.DEVNULL,
    )
    for module in (package / "bin").glob("_core*.so"):
        module.unlink()
    run(
        "patchelf",
        "--set-rpath",
        "$ORIGIN/../../../openvino/libs",
        package / "lib/slipbench/libslipbench_network.so",
    )
    made = output_of(
        sys.executable,
        "-c",
        "import sys; from scikit_build_core.build import prepare_metadata_for_build_wheel as prepare; "
        "print(prepare(sys.argv[1]))",
        folder,
        cwd=ROOT,
    )
    return package, studies, folder / made.split()[-1]


def carry_licences(files, info):
    """Copies the files about the licences and versions of a wheel's packages.

    These are Debian's copyright file of every package that NOTICE.md names or whose library `files`
    load, nanobind's and d3's licences, and the packages' versions.
    """
    folder = info / "licenses"
    folder.mkdir(exist_ok=True)
    loaded = {
        os.path.realpath(path)
        for file in files
        for path in re.findall(r"=> (/\S+)", output_of("ldd", file))
    }
    # By file name: dpkg lists some under /lib, which is /usr/lib.
    for line in output_of(
        "dpkg-query",
        "--search",
        *(f"*/{Path(path).name}" for path in sorted(loaded) if path.startswith("/usr/")),
    ).splitlines():
        name = line.split(":")[0]
        shutil.copy(f"/usr/share/doc/{name}/copyright", folder / f"{name}.txt")
    for name in re.findall(r"[\w.+-]+", (ROOT / "NOTICE.md").read_text(encoding="utf-8")):
        text = Path(f"/usr/share/doc/{name}/copyright")
        if text.exists():
            shutil.copy(text, folder / f"{name}.txt")
    there = [path.stem for path in folder.glob("*.txt")]
    (folder / "libraries.txt").write_text(
        output_of("dpkg-query", "--show", *sorted(there)), encoding="utf-8"
    )
    shutil.copy(
        next(VENV.glob("lib/python3*/site-packages/nanobind-*.dist-info/licenses/LICENSE")),
        folder / "nanobind.txt",
    )
    shutil.copy(ROOT / "tools/page/d3/d3_licence.txt", folder / "d3.txt")
    for name in ("LICENSE", "NOTICE.md"):
        shutil.copy(ROOT / name, folder)


def make(out, module, tag):
    folder = WORK / tag
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    package, studies, info = stage(folder)
    shutil.copy(module, package / "bin")
    run("patchelf", "--set-rpath", "$ORIGIN/../lib/slipbench/mujoco", package / "bin" / module.name)
    carry_licences([module, *(BUILD / "lib/slipbench").glob("libslipbench_[cn]*.so")], info)
    # With FFTW inside, the wheel is under GPL-3.0-or-later: NOTICE.md.
    metadata = (info / "METADATA").read_text(encoding="utf-8")
    (info / "METADATA").write_text(
        re.sub("(?m)^License-Expression: .*$", "License-Expression: GPL-3.0-or-later", metadata),
        encoding="utf-8",
    )
    text = re.sub(
        r"Tag: .*",
        f"Tag: {tag}-linux_{platform.machine()}",
        (info / "WHEEL").read_text(encoding="utf-8"),
    )
    (info / "WHEEL").write_text(text, encoding="utf-8")
    (folder / "raw").mkdir()
    tree = folder / "tree"
    tree.mkdir()
    for part in (package, studies, info):
        part.rename(tree / part.name)
    run(
        sys.executable,
        "-m",
        "wheel",
        "pack",
        tree,
        "--dest-dir",
        folder / "raw",
        stdout=subprocess.DEVNULL,
    )
    excluded = [word for name in NOT_INSIDE for word in ("--exclude", name)]
    run(
        sys.executable,
        "-m",
        "auditwheel",
        "repair",
        "--plat",
        f"manylinux_2_36_{platform.machine()}",
        *excluded,
        "--wheel-dir",
        out,
        *(folder / "raw").glob("*.whl"),
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "-o", dest="out", type=Path, default=WORK, help="where the wheels are written"
    )
    out = parser.parse_args().out.resolve()
    if platform.freedesktop_os_release().get("VERSION_ID") != "12":
        sys.exit("build_wheels.py: needs Debian 12, whose glibc 2.36 is in the name of the wheels")
    if not TOOLS.exists():
        sys.exit(
            "build_wheels.py: auditwheel is missing; install it with: tools/setup/setup.sh wheel"
        )
    fetch_headers()
    run("cmake", "--preset", "release", cwd=ROOT, stdout=subprocess.DEVNULL)
    run(
        "cmake",
        "--build",
        "--preset",
        "release",
        "--target",
        "slipbench_python",
        "slipbench_python_stub",
        "slipbench_scene_schema",
        "slipbench_python_abi3",
        cwd=ROOT,
    )
    make(out, next((BUILD / "bin").glob("_core.cpython-311-*.so")), "cp311-cp311")
    make(out, BUILD / "abi3/_core.abi3.so", "cp312-abi3")
    for wheel in sorted(out.glob("slipbench-*.whl")):
        print(f"{wheel} {wheel.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
