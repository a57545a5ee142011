"""The package, the studies, the extension's types and the examples pass mypy --strict.

Arguments: the project's root, the package.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

root, package = (Path(word).resolve() for word in sys.argv[1:])
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    # Other libraries may lack types: h5py, pandas, scikit-learn.
    strict = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--disable-error-code=import-untyped",
        f"--cache-dir={folder / 'cache'}",
    ]
    text = "".join(
        page.read_text(encoding="utf-8") for page in sorted((root / "python").glob("*.md"))
    )
    for file, example in re.findall(r"```python (\S+)\n(.*?)```", text, re.DOTALL):
        (folder / file).write_text(example, encoding="utf-8")
    # Examples for readers may omit the types of their own functions; everything they use of the
    # package has types.
    own = ["--allow-untyped-defs", "--allow-untyped-decorators", "--allow-untyped-calls"]
    examples = [
        *sorted(folder.glob("*.py")),
        *sorted((root / "python/examples").glob("*.py")),
        root / "scenes/mujoco/robots/robots.py",
    ]
    print([path.name for path in examples])
    ends = [
        subprocess.run([*strict, *own, *map(str, examples)], cwd=folder, check=False).returncode
    ]
    # By name: the package of a build has links to its source folders.
    folders = sorted(
        init.parent for init in package.parent.glob("slipbench_studies/**/__init__.py")
    )
    studies = [file for folder in folders for file in sorted(folder.glob("*.py"))]
    parts = [
        file
        for part in ("_detect", "_export", "_import", "learning")
        for file in sorted((package / part).glob("*.py"))
    ]
    files = [
        *sorted(package.glob("*.py")),
        *studies,
        *parts,
        package / "bin/_core.pyi",
        package / "py.typed",
    ]
    print([path.name for path in files])
    ends.append(0 if files[-1].is_file() else "the package has no py.typed")
    ends.append(
        subprocess.run(
            [*strict, "--explicit-package-bases", *map(str, files[:-1])],
            cwd=package.parent,
            check=False,
        ).returncode
    )
sys.exit(next(filter(None, ends), 0))
