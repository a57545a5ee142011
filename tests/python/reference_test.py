"""The reference has every public name with its docstring. Argument: the program."""

import inspect
import re
import sys
import unittest
from pathlib import Path

from public_names import functions, modules, offered

del sys.argv[1]
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs/reference"))
import reference  # noqa: E402


def words(text):
    """Returns letters and digits alone, which Markdown and HTML keep.

    The page writes the section "Args" as "Arguments".
    """
    return re.sub(r"[\W_]+", "", re.sub(r"^ *Args:$", "Arguments:", text, flags=re.MULTILINE))


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


if __name__ == "__main__":
    unittest.main()
