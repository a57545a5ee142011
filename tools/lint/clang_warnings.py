"""Lists the warnings and errors of clang 16 in the product's sources: clang_warnings.py ROOT BUILD.

BUILD holds compile_commands.json: ROOT/build/clang, which is configured first, or any other folder
that has one.

The sources are only parsed, which takes a fifth of the time of a build. Tests are excluded: they
would double the time, and users do not compile them.
"""

import subprocess

from clang_tidy import check_compilations

PROGRAM = "clang++-16"


def warnings(_root, _build, _source, _folder, directory, command):
    """Output of clang for a source; empty if there is no warning."""
    output = command.index("-o")
    words = [
        word
        for word in command[:output] + command[output + 2 :]
        if word not in ("ccache", "/usr/bin/ccache")
    ]
    result = subprocess.run(
        [PROGRAM, *words[1:], "-fsyntax-only"],
        cwd=directory,
        capture_output=True,
        text=True,
        check=False,
    )
    return result.stderr or (
        "" if result.returncode == 0 else f"{words[-1]}: status {result.returncode}\n"
    )


if __name__ == "__main__":
    check_compilations("clang", warnings)
