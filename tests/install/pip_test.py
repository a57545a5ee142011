"""`pip install .`: its metadata, and the builds that it refuses.

Arguments: the project's root. The build backend is loaded with a stand-in for scikit-build-core,
which the tests' environment does not have.
"""

import importlib.util
import os
import re
import sys
import tempfile
import tomllib
import types
import unittest
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(sys.argv[1])
del sys.argv[1:]
ABOUT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = ABOUT["project"]


def pinned():
    """Returns {package: version} of the packages that the program is built with."""
    text = (ROOT / "tools/setup/requirements.in").read_text(encoding="utf-8")
    return dict(re.findall(r"^([\w-]+)==(\S+)$", text, re.MULTILINE))


def backend():
    """Loads the build backend that pyproject.toml names."""
    system = ABOUT["build-system"]
    made = types.ModuleType("scikit_build_core.build")
    for name in (
        "build_editable",
        "build_sdist",
        "build_wheel",
        "get_requires_for_build_sdist",
        "prepare_metadata_for_build_editable",
        "prepare_metadata_for_build_wheel",
    ):
        setattr(made, name, None)
    made.get_requires_for_build_wheel = made.get_requires_for_build_editable = lambda settings: [
        "cmake>=3.25"
    ]
    package = types.ModuleType("scikit_build_core")
    package.build = made
    sys.modules.update({"scikit_build_core": package, "scikit_build_core.build": made})
    found = importlib.util.spec_from_file_location(
        "backend", ROOT / system["backend-path"][0] / f"{system['build-backend']}.py"
    )
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


@contextmanager
def stand_in(name, body):
    """Puts a program of this name before those of the machine."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / name
        program.write_text(f"#!/bin/bash\n{body}\n", encoding="utf-8")
        program.chmod(0o755)
        before = os.environ["PATH"]
        os.environ["PATH"] = f"{folder}:{before}"
        try:
            yield
        finally:
            os.environ["PATH"] = before


class Metadata(unittest.TestCase):
    def test_licence_is_an_expression_with_files(self):
        self.assertEqual(PROJECT["license"], "Apache-2.0")  # an SPDX identifier
        for name in PROJECT["license-files"]:
            self.assertTrue((ROOT / name).is_file(), name)
        self.assertFalse(
            [line for line in PROJECT.get("classifiers", []) if line.startswith("License ::")]
        )

    def test_urls(self):
        self.assertLessEqual({"Repository", "Issues", "Changelog"}, PROJECT["urls"].keys())
        for address in PROJECT["urls"].values():
            self.assertTrue(address.startswith(PROJECT["urls"]["Repository"]), address)
        self.assertTrue((ROOT / PROJECT["urls"]["Changelog"].rpartition("/")[2]).is_file())

    def test_networks_run_without_an_extra(self):
        self.assertIn(f"openvino=={pinned()['openvino']}", PROJECT["dependencies"])


class Build(unittest.TestCase):
    def test_requires_mujoco_and_openvino(self):
        with stand_in("dpkg-query", 'for word in "${@:4}"; do echo "$word installed"; done'):
            for name in ("get_requires_for_build_wheel", "get_requires_for_build_editable"):
                self.assertEqual(
                    getattr(backend(), name)(),
                    [
                        "cmake>=3.25",
                        *(f"{package}=={version}" for package, version in pinned().items()),
                    ],
                )

    def test_missing_packages_end_it_with_the_command(self):
        with stand_in(
            "dpkg-query",
            'for word in "${@:4}"; do [[ $word == g++ || $word == libonnx-dev ]] || echo "$word installed"; done',
        ):
            with self.assertRaises(SystemExit) as end:
                backend().get_requires_for_build_wheel()
            self.assertTrue(
                str(end.exception).endswith(
                    "apt-get install --yes --no-install-recommends g++ libonnx-dev"
                ),
                end.exception,
            )


if __name__ == "__main__":
    unittest.main()
