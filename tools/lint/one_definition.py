"""No two headers define a type of the same name: they share one namespace, so the linker would silently keep one of the two."""

import re
from collections import defaultdict

from tree import lines_of, main, project_files

# A definition at the outermost level: this project does not indent inside its namespace.
DEFINITION = re.compile(r"(?:template .*)?(?:struct|class|enum class|enum|union) (\w+)(?: final)?\s*(?::[^:;]*)?\{")


def check(root):
    places = defaultdict(list)
    for path in project_files(root):
        if path.suffix != ".h":
            continue
        for number, line in lines_of(root, path):
            definition = DEFINITION.match(line)
            if definition:
                places[definition[1]].append(f"{path}:{number}")
    for name, where in sorted(places.items()):
        if len(where) > 1:
            yield f"{name} is defined more than once: {', '.join(where)}"


if __name__ == "__main__":
    main(check)
