"""Checks that no two headers define a type of the same name in the same namespace: the linker would
silently keep one of them."""

import re
from collections import defaultdict

from tree import lines_of, main, project_files

NAMESPACE = re.compile(r"namespace ([\w:]+) \{")
# A definition at the outermost level: the project does not indent inside its namespace.
DEFINITION = re.compile(
    r"(?:template .*)?(?:struct|class|enum class|enum|union) (\w+)(?: final)?\s*(?::[^:;]*)?\{"
)


def check(root):
    places = defaultdict(list)
    for path in project_files(root):
        if path.suffix != ".h":
            continue
        namespace = ""
        for number, line in lines_of(root, path):
            opened = NAMESPACE.match(line)
            if opened:
                namespace = opened[1] + "::"
            definition = DEFINITION.match(line)
            if definition:
                places[namespace + definition[1]].append(f"{path}:{number}")
    for name, where in sorted(places.items()):
        if len(where) > 1:
            yield f"{name} is defined more than once: {', '.join(where)}"


if __name__ == "__main__":
    main(check)
