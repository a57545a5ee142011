"""The examples of the README pass mypy --strict with the types of the package. Argument: the project's root."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(sys.argv[1]).resolve()
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    text = (root / "tools/python/README.md").read_text(encoding="utf-8")
    for file, example in re.findall(r"```python (\S+)\n(.*?)```", text, re.DOTALL):
        (folder / file).write_text(example, encoding="utf-8")
    # An example for a reader leaves the types of its own functions out; all that it uses of the package has them.
    own = ["--allow-untyped-defs", "--allow-untyped-decorators", "--allow-untyped-calls"]
    print(sorted(path.name for path in folder.glob("*.py")))
    examples = subprocess.run([sys.executable, "-m", "mypy", "--strict", *own, *map(str, sorted(folder.glob("*.py")))], cwd=folder, check=False)
sys.exit(examples.returncode)
