"""The reference has every public name with its docstring, and docstrings are complete. Argument:
the program.
"""

import ast
import dataclasses
import enum
import inspect
import re
import sys
import textwrap
import typing
import unittest
from pathlib import Path

import numpy as np
from public_names import functions, modules, offered

del sys.argv[1]
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs/reference"))
import reference  # noqa: E402


def words(text):
    """Returns letters and digits alone, which Markdown and HTML keep. The page writes the section
    "Args" as "Arguments".
    """
    return re.sub(r"[\W_]+", "", re.sub(r"^ *Args:$", "Arguments:", text, flags=re.MULTILINE))


def attributes(documented):
    """Parses the section `Attributes` of a class's docstring: name to description."""
    section = re.search(
        r"^Attributes:\n((?:    .*\n?)+)", inspect.getdoc(documented) or "", re.MULTILINE
    )
    return dict(re.findall(r"^    (\w+): (.+)$", section[1], re.MULTILINE)) if section else {}


class ThePage(unittest.TestCase):
    def test_it_has_every_name_with_its_docstring(self):
        page = reference.page()
        places = re.split(r"^#+ (\S+) \{#[^}]+\}$", page, flags=re.MULTILINE)
        told = {name: words(part) for name, part in zip(places[1::2], places[2::2], strict=True)}
        self.assertIn("slip_velocity: NDArray[float32]", page)
        self.assertNotIn("ndarray", page)  # as numpy would call it
        documented = {
            **{module.__name__: module for module in modules()},
            **offered(),
            **dict(functions()),
        }
        self.assertGreater(len(documented), 50)
        for name, value in documented.items():
            with self.subTest(name=name):
                self.assertIn(
                    words(
                        re.sub(
                            r"^( *)Args:",
                            r"\1Arguments:",
                            inspect.getdoc(value),
                            flags=re.MULTILINE,
                        )
                    ),
                    told[name],
                )


class Docstrings(unittest.TestCase):
    def test_every_function_names_its_parameters(self):
        classes = [(name, value) for name, value in offered().items() if inspect.isclass(value)]
        constructors = [
            (name, value.__init__)
            for name, value in classes
            if getattr(value.__init__, "__doc__", None) and value.__module__ == "slipbench.gym"
        ]
        for name, function in [*functions(), *constructors]:
            with self.subTest(name=name):
                self.assertTrue(function.__doc__)
                for parameter in list(inspect.signature(function).parameters):
                    if parameter not in ("self", "cls"):
                        self.assertRegex(function.__doc__, rf"\b{parameter}\b")
        self.assertEqual(len(constructors), 3)

    def test_every_class_names_its_attributes_and_nothing_else(self):
        for name, value in offered().items():
            if (
                not inspect.isclass(value)
                or not value.__module__.startswith("slipbench.")
                or issubclass(value, Exception)
            ):
                continue
            if "__dataclass_fields__" in vars(value):
                own = {field.name for field in dataclasses.fields(value)}
            elif issubclass(value, enum.Enum):
                own = set(value.__members__)
            else:
                body = (
                    ast.walk(ast.parse(textwrap.dedent(inspect.getsource(value.__init__))))
                    if "__init__" in vars(value)
                    else []
                )
                stored = {
                    node.attr
                    for node in body
                    if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
                }
                inherited = {
                    name
                    for base in value.__mro__[1:]
                    for name in (*vars(base), *inspect.get_annotations(base))
                }
                own = {
                    attribute for attribute in stored - inherited if not attribute.startswith("_")
                }
            with self.subTest(name=name):
                self.assertEqual(set(attributes(value)), own)

    def test_every_array_of_a_trial_has_its_shape(self):
        count = 0
        for name, value in offered().items():
            for field in dataclasses.fields(value) if "__dataclass_fields__" in vars(value) else []:
                if typing.get_origin(typing.get_type_hints(value)[field.name]) is np.ndarray:
                    count += 1
                    self.assertRegex(
                        attributes(value)[field.name],
                        r"^\[[TNE](, [N\d])*\]",
                        f"{name}.{field.name}",
                    )
        self.assertGreater(count, 25)


if __name__ == "__main__":
    unittest.main()
