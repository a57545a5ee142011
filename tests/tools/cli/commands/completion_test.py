"""Completion scripts in the shells that they are for, and the manual page under its checkers.

A shell or checker that is not installed is left out. Argument: the program.
"""

import contextlib
import os
import pty
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = sys.argv.pop(1)
# Typed text, and the text after a tabulator.
COMPLETED = {
    "slipbench swe": "slipbench sweep",
    "slipbench hd rep": "slipbench hd replay",
    "slipbench help repo": "slipbench help report",
    "slipbench sweep --resu": "slipbench sweep --resume",
    "slipbench export --format train": "slipbench export --format training-csv",
    "slipbench run scene.yaml --record=out": "slipbench run scene.yaml --record=outcome",
    "slipbench describe papilla": "slipbench describe papillarray",
    "slipbench run s": "slipbench run scene.yaml",
    "slipbench check --set seed=1 s": "slipbench check --set seed=1 scene.yaml",
    "slipbench report s": "slipbench report slide.h5",
    "slipbench eval force_ratio s": "slipbench eval force_ratio slide.h5",
    "slipbench export slide.h5 -o o": "slipbench export slide.h5 -o outputs",
    "slipbench sweep scene.yaml --jobs ": "slipbench sweep scene.yaml --jobs",
}
BASH = """PS1='ready> '
source ./script
keep_line() { printf %s "$READLINE_LINE" >../line.new; mv ../line.new ../line; }
bind -x '"\\C-xk": keep_line'
touch ../ready
"""
ZSH = """PS1='ready> '
autoload -Uz compinit
compinit -u -D
source ./script
keep_line() { print -rn -- "$BUFFER" >../line.new; mv ../line.new ../line }
zle -N keep_line
bindkey '^Xk' keep_line
touch ../ready
"""


def made(*words):
    return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout


class Terminal:
    """A shell at a terminal in a folder of its own, with the files that there are to complete."""

    def __init__(self, folder, shell, set_up, script):
        self.folder = Path(folder)
        inside = self.folder / "inside"
        (inside / "outputs").mkdir(parents=True)
        for name in ("scene.yaml", "slide.h5", "slip.txt", "start.csv"):
            (inside / name).touch()
        (inside / "script").write_text(script, encoding="utf-8")
        (inside / ".set_up").write_text(set_up, encoding="utf-8")
        self.process, self.descriptor = pty.fork()
        if self.process == 0:
            os.chdir(inside)
            os.environ.update(TERM="dumb", HOME=str(folder))
            os.execvp(shell[0], shell)
        os.set_blocking(self.descriptor, False)
        self.type("source ./.set_up\r")
        self.wait_for(self.folder / "ready", "ready> ")

    def type(self, text):
        os.write(self.descriptor, text.encode())

    def wait_for(self, file, shown=""):
        """Until `file` is there and the terminal shows a text."""
        seen = b""
        for _ in range(6000):
            there = file.exists()
            with contextlib.suppress(BlockingIOError):
                seen += os.read(self.descriptor, 65536)
            if there and shown.encode() in seen:
                return
            time.sleep(0.01)
        raise AssertionError(f"no file {file} after a minute; the terminal shows {seen!r}")

    def complete(self, line):
        kept = self.folder / "line"
        kept.unlink(missing_ok=True)
        self.type(line + "\t\x18k")
        self.wait_for(kept)
        self.type("\x15")  # an empty line for the next
        return kept.read_text(encoding="utf-8")

    def close(self):
        os.close(self.descriptor)
        os.waitpid(self.process, 0)


class Completion(unittest.TestCase):
    def check_at_terminal(self, shell, set_up):
        if shutil.which(shell[0]) is None:
            self.skipTest(f"{shell[0]} is not installed")
        with tempfile.TemporaryDirectory() as folder:
            terminal = Terminal(folder, shell, set_up, made("completion", shell[0]))
            for typed, completed in COMPLETED.items():
                with self.subTest(shell=shell[0], typed=typed):
                    self.assertEqual(terminal.complete(typed).rstrip(" /"), completed)
            terminal.close()

    def test_bash(self):
        self.check_at_terminal(["bash", "--norc", "--noprofile", "-i"], BASH)

    def test_zsh(self):
        self.check_at_terminal(["zsh", "-f", "-i"], ZSH)

    def test_fish(self):
        if shutil.which("fish") is None:
            self.skipTest("fish is not installed")
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "script").write_text(made("completion", "fish"), encoding="utf-8")
            for name in ("scene.yaml", "slide.h5"):
                Path(folder, name).touch()

            def offered(line):
                command = ["fish", "--no-config", "-c", f"source ./script; complete -C '{line}'"]
                found = subprocess.run(
                    command,
                    cwd=folder,
                    env=os.environ | {"HOME": folder},
                    check=True,
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(found.stderr, "")
                return [word.split("\t")[0] for word in found.stdout.splitlines()]

            self.assertEqual(offered("slipbench swe"), ["sweep"])
            self.assertEqual(offered("slipbench hd rep"), ["replay"])
            self.assertEqual(offered("slipbench sweep --resu"), ["--resume"])
            self.assertEqual(offered("slipbench export --format train"), ["training-csv"])
            self.assertEqual(offered("slipbench run s")[0], "scene.yaml")
            self.assertEqual(offered("slipbench report s")[0], "slide.h5")

    def test_scripts_name_every_option(self):
        """The help is written by CLI11 and the scripts by us: both name the same."""
        commands = [
            line.split()[0]
            for line in made("--help").split("Subcommands:")[1].splitlines()
            if line.startswith("  ")
        ]
        self.assertGreater(len(commands), 20)
        for shell in ("bash", "zsh"):
            script = made("completion", shell)
            for command in commands:
                options = [
                    word
                    for line in made(command, "--help").splitlines()
                    if line.startswith("  -")
                    for word in line.split()[0].split(",")
                ]
                self.assertIn("--json", options)
                for option in options:
                    self.assertIn(option, script, f"{shell}: {command}")


class Manual(unittest.TestCase):
    def check_by(self, words):
        if shutil.which(words[0]) is None:
            self.skipTest(f"{words[0]} is not installed")
        with tempfile.NamedTemporaryFile("w", suffix=".1", encoding="utf-8") as page:
            page.write(made("man"))
            page.flush()
            found = subprocess.run(
                [*words, page.name],
                env=os.environ | {"LC_ALL": "C.UTF-8"},
                check=False,
                capture_output=True,
                text=True,
            )
        self.assertEqual(found.stderr, "")
        return found.stdout

    def test_mandoc_finds_no_fault(self):
        faults = self.check_by(["mandoc", "-T", "lint", "-W", "warning"]).splitlines()
        # A date would change the page where the program has not changed.
        self.assertEqual([fault for fault in faults if "missing date" not in fault], [])

    def test_man_shows_it(self):
        shown = self.check_by(["man", "--warnings", "-l"])
        for word in ("slipbench sweep", "--resume", "HDF5", "slipbench hd replay"):
            self.assertIn(word, shown)


if __name__ == "__main__":
    unittest.main()
