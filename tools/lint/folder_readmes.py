"""Every folder with sources has a README.md of at most a page (60 lines).

Folders of tests that mirror a source folder need none: that folder's README speaks for both. A folder inside another folder of
tests is explained there, and a trained classifier (a folder with model.txt, which may hold nothing else) in the folder above.
"""

from pathlib import Path

from tree import lines_of, main, project_files

PAGE = 60
SOURCES = (".h", ".cc", ".py", ".sh", ".cmake", ".txt", ".js", ".css", ".sv", ".yaml")


def explained(folder, files):
    """Whether a folder has a README.md or needs none of its own."""
    if folder / "README.md" in files:
        return True
    if folder.parts[0] == "tests" and len(folder.parts) > 1:
        mirrored = Path(*folder.parts[1:])
        if any(path.is_relative_to(mirrored) for path in files):
            return True
        return len(folder.parts) > 2 and explained(folder.parent, files)
    if folder / "model.txt" in files:
        return explained(folder.parent, files)
    return folder.parts[0] == "scenes" and len(folder.parts) > 1 and explained(folder.parent, files)


def check(root):
    files = set(project_files(root))
    folders = {path.parent for path in files if path.suffix in SOURCES and path.parent != Path(".")}
    for folder in sorted(folders):
        if not folder.parts[0].startswith(".") and not explained(folder, files):
            yield f"{folder}: no README.md"
    for path in sorted(files):
        if path.name == "README.md" and path.parent != Path("."):
            length = sum(1 for _ in lines_of(root, path))
            if length > PAGE:
                yield f"{path}: {length} lines, a page is {PAGE}"


if __name__ == "__main__":
    main(check)
