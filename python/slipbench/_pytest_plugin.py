"""Pytest plugin: scenes with the key `expect` are tests.

pip registers it as an entry point; otherwise use `pytest -p slipbench._pytest_plugin`.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from slipbench import Check, InputError, Scene


class _Failed(Exception):
    """A scene that misses an expectation; its text is the output of `slipbench check`."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.getgroup("slipbench").addoption(
        "--slipbench-draws",
        type=int,
        default=0,
        metavar="N",
        help="Trials of each cell of a scene's sweep (default: of the scene)",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collects YAML files with the keys `slipbench` and `expect` at the beginning of a line.

    Each scene has the key `slipbench`.
    """
    if file_path.suffix not in (".yaml", ".yml"):
        return None
    text = file_path.read_text(encoding="utf-8", errors="replace")
    if not all(re.search(rf"^{key}\s*:", text, re.MULTILINE) for key in ("slipbench", "expect")):
        return None
    return _SceneFile.from_parent(parent, path=file_path)


class _SceneFile(pytest.File):
    def collect(self) -> Iterator[pytest.Item]:
        yield _SceneItem.from_parent(self, name="check")


class _SceneItem(pytest.Item):
    def runtest(self) -> None:
        result = _checked(self.path, self.config, {})
        if not result.passed:
            raise _Failed(result.table.rstrip())

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        # The program's messages name file and line; a traceback would hide them.
        return (
            str(excinfo.value)
            if isinstance(excinfo.value, (_Failed, InputError))
            else super().repr_failure(excinfo, style)
        )

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.path.name}: expect"


def _checked(
    scene: Scene | str | os.PathLike[str], config: pytest.Config, options: dict[str, Any]
) -> Check:
    scene = scene if isinstance(scene, Scene) else Scene.load(scene)
    return scene.check(**{"draws": config.getoption("--slipbench-draws"), **options})


@pytest.fixture
def slipbench_check(pytestconfig: pytest.Config) -> Callable[..., Check]:
    """A function that checks a scene: `slipbench_check(scene, draws=4)`.

    It takes a `Scene` or a path, and the options of `Scene.check()`, and returns the `Check`. It
    fails the test with the table of `slipbench check` if an expectation is missed, the scene has no
    expectations, or its negative control keeps all of them, and with the program's message if the
    scene is unreadable or cannot run.
    """

    def check(scene: Scene | str | os.PathLike[str], **options: Any) -> Check:
        try:
            result = _checked(scene, pytestconfig, options)
        except InputError as error:
            pytest.fail(str(error), pytrace=False)
        if not result.passed:
            pytest.fail(result.table.rstrip(), pytrace=False)
        return result

    return check
