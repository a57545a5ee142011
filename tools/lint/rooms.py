"""Checks the folders: none has more than 30 sources, and the includes between folders have no
cycles. ARCHITECTURE.svg must match the includes; `rooms.py ROOT --fix` draws it again."""

import re
import sys
from collections import Counter, defaultdict
from graphlib import TopologicalSorter
from html import escape
from pathlib import Path

from tree import main, project_files

MOST = 30
PICTURE = "ARCHITECTURE.svg"
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
WIDTH, HEIGHT, GAP, ROW = 128, 34, 16, 72  # of a box, between boxes, between rows


def includes(root, files):
    """{folder: folders that its sources include from}"""
    found = defaultdict(set)
    for path in files:
        for header in INCLUDE.findall((Path(root) / path).read_text(encoding="utf-8")):
            found[path.parent.as_posix()].add(Path(header).parent.as_posix())
    return {
        folder: {other for other in others if other != folder} for folder, others in found.items()
    }


def way_back(graph, start):
    """The folders on the shortest include cycle through `start`; empty if there is none."""
    ways = [[start]]
    seen = set()
    for way in ways:
        for other in sorted(graph.get(way[-1], ())):
            if other == start:
                return [*way, start]
            if other not in seen:
                seen.add(other)
                ways.append([*way, other])
    return None


def ways_back(graph):
    """Each include cycle once, from the first of its folders."""
    return [
        way for folder in sorted(graph) if (way := way_back(graph, folder)) and folder == min(way)
    ]


def group_of(folder):
    """Box of a folder in the picture: the layers of sim and of tools are separate, other top
    folders whole."""
    parts = folder.split("/")
    return "/".join(parts[:2] if parts[0] in ("sim", "tools") else parts[:1])


def groups_of(graph):
    """{group: groups that its folders include from}"""
    below = defaultdict(set)
    for folder, others in graph.items():
        below[group_of(folder)] |= {group_of(other) for other in others} - {group_of(folder)}
    return below


def picture(files, graph):
    """Draws a box for each group, above all groups that it includes, with lines to included groups;
    transitive lines are omitted."""
    below = {group_of(path.parent.as_posix()): set() for path in files} | groups_of(graph)
    reach, depth = {}, {}
    for group in TopologicalSorter(below).static_order():
        others = below.setdefault(group, set())
        reach[group] = others.union(*(reach[other] for other in others))
        depth[group] = 1 + max((depth[other] for other in others), default=-1)
    direct = {
        group: below[group] - set().union(*(reach[other] for other in below[group]))
        for group in below
    }
    rows = [
        [group for group in sorted(below) if depth[group] == level]
        for level in range(1 + max(depth.values()))
    ]
    width = max(map(len, rows)) * (WIDTH + GAP) + GAP
    place = {}
    for level, row in enumerate(
        rows
    ):  # each above the middle of the groups that it includes, as far as space permits
        middle = {
            group: sum(place[other][0] for other in direct[group]) / len(direct[group])
            if level
            else width / 2
            for group in row
        }
        row.sort(key=lambda group: (middle[group], group))
        at = []
        for group in row:
            at.append(max([middle[group], *(x + WIDTH + GAP for x in at[-1:])]))
        shift = sum(middle[group] - x for group, x in zip(row, at)) / len(row)
        for group, x in zip(row, at):
            place[group] = (x + shift, GAP + (len(rows) - 1 - level) * ROW)
    left, right = (
        min(x for x, _ in place.values()) - WIDTH / 2 - GAP,
        max(x for x, _ in place.values()) + WIDTH / 2 + GAP,
    )
    place = {group: (x - left, y) for group, (x, y) in place.items()}
    width = round(right - left)
    lines = []
    for group in sorted(below):
        for other in sorted(direct[group]):
            (x, y), (to_x, to_y) = place[group], place[other]
            lines.append(f'<path d="M{x:.0f} {y + HEIGHT} L{to_x:.0f} {to_y}"/>')
    boxes = [
        f'<rect x="{x - WIDTH / 2:.0f}" y="{y}" width="{WIDTH}" height="{HEIGHT}"/><text x="{x:.0f}" y="{y + 22}">{escape(group)}</text>'
        for group, (x, y) in sorted(place.items())
    ]
    style = (
        "text{font:13px sans-serif;text-anchor:middle;fill:#1d2733}rect{fill:#eef3f8;stroke:#54708c;rx:5px}"
        "path{stroke:#54708c;fill:none}.back{fill:#fff;stroke:none}"
    )
    height = len(rows) * ROW + GAP
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">',
            f'<style>{style}</style><rect class="back" width="{width}" height="{height}"/>',
            *lines,
            *boxes,
            "</svg>",
            "",
        ]
    )


def graph_of(root):
    """The sources without the tests, and the includes of their folders."""
    files = [
        path
        for path in project_files(root)
        if path.suffix in (".h", ".cc") and path.parts[0] != "tests"
    ]
    return files, includes(root, files)


def check(root):
    sources = Counter(
        path.parent.as_posix() for path in project_files(root) if path.suffix in (".h", ".cc")
    )
    for folder, count in sorted(sources.items()):
        if count > MOST:
            yield f"{folder}: {count} sources; allowed: {MOST}, so that a folder is seen whole"
    files, graph = graph_of(root)
    ways = ways_back(graph) or ways_back(groups_of(graph))
    for way in ways:
        yield f"{way[0]}: includes lead back to it: {' -> '.join(way)}"
    there = Path(root) / PICTURE
    if not ways and not (
        there.exists() and there.read_text(encoding="utf-8") == picture(files, graph)
    ):
        yield f"{PICTURE}: not what the includes are; draw it with: tools/lint/rooms.py . --fix"


if __name__ == "__main__":
    if sys.argv[2:] == ["--fix"]:
        (Path(sys.argv[1]) / PICTURE).write_text(picture(*graph_of(sys.argv[1])), encoding="utf-8")
    else:
        main(check)
