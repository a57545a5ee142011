"""Files and messages of commands in Python: complete or absent files, one message for each error."""

import fcntl
import os
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import slipbench
from slipbench import _output
from slipbench._export import card
from slipbench._output import NewFiles, create_locked, write_whole
from slipbench._program import printable

ENTRY = "import sys\nfrom slipbench._program import run_command, write_result\ndef work():\n    {}\nsys.exit(run_command(work, needs='x', target='out.h5'))"


class OutputTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.victim = self.folder / "victim"
        self.victim.write_bytes(b"mine")
        self.path = self.folder / "a.bin"
        self.partial = self.folder / "a.bin.partial"

    def names(self):
        return sorted(path.name for path in self.folder.iterdir() if path != self.victim)

    def test_a_file_is_whole_or_absent(self):
        write_whole(self.path, b"new")
        self.assertEqual((self.path.read_bytes(), self.names()), (b"new", ["a.bin"]))
        with self.assertRaises(KeyError), NewFiles() as files:
            files.create(self.path).write(b"half")
            raise KeyError
        self.assertEqual((self.path.read_bytes(), self.names()), (b"new", ["a.bin"]))

    def test_links_are_not_written_through(self):
        """A symbolic link is refused. A hard link is replaced, as a file that a killed run left."""
        self.partial.symlink_to(self.victim)
        with self.assertRaisesRegex(slipbench.InputError, "a.bin.partial: it is a symbolic link"):
            write_whole(self.path, b"new")
        self.partial.unlink()
        os.link(self.victim, self.partial)
        write_whole(self.path, b"new")
        self.assertEqual((self.victim.read_bytes(), self.path.read_bytes()), (b"mine", b"new"))
        self.assertEqual(self.names(), ["a.bin"])

    def test_a_pipe_and_a_folder_are_refused(self):
        os.mkfifo(self.partial)
        with self.assertRaisesRegex(
            slipbench.InputError, "a.bin.partial: it is not a regular file"
        ):
            write_whole(self.path, b"new")
        self.partial.unlink()
        self.partial.mkdir()
        with self.assertRaises(OSError):
            write_whole(self.path, b"new")
        self.assertTrue(self.partial.is_dir())

    def test_one_run_writes_a_file_at_a_time(self):
        with create_locked(self.partial) as file:
            with self.assertRaisesRegex(
                slipbench.InputError, "a.bin.partial: another run is writing it"
            ):
                write_whole(self.path, b"new")
            file.write(b"kept")
            file.flush()
            self.assertEqual(self.partial.read_bytes(), b"kept")
        write_whole(self.path, b"new")  # the other run has ended without its file
        self.assertEqual(self.names(), ["a.bin"])

    def test_a_run_that_has_renamed_its_file_meanwhile_is_recognised(self):
        """The lock is on the file, not on its name: between open() and flock() the name may be of another file."""
        self.partial.write_bytes(b"left")
        lock = fcntl.flock

        def late(descriptor, kind):
            self.partial.unlink()
            self.partial.write_bytes(b"of the other run")
            lock(descriptor, kind)

        with (
            mock.patch.object(_output.fcntl, "flock", late),
            self.assertRaisesRegex(slipbench.InputError, "another run is writing it"),
        ):
            create_locked(self.partial)
        self.assertEqual(self.partial.read_bytes(), b"of the other run")

    def test_several_files_appear_together(self):
        other = self.folder / "b.bin"
        with NewFiles() as files:
            files.create(self.path).write(b"1")
            with files.create(other) as file:
                file.write(b"2")
            self.assertEqual(self.names(), ["a.bin.partial", "b.bin.partial"])
            files.publish()
        self.assertEqual(self.names(), ["a.bin", "b.bin"])
        # A full disk: 10 bytes at most in a file.
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (10, before[1]))
        try:
            with self.assertRaises(OSError), NewFiles() as files:
                files.create(self.path).write(b"3")
                files.create(other).write(bytes(20))
                files.publish()
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        self.assertEqual(
            (self.path.read_bytes(), other.read_bytes(), self.names()),
            (b"1", b"2", ["a.bin", "b.bin"]),
        )


class EntryTest(unittest.TestCase):
    """Every command in Python ends as the program ends: a status, and one message."""

    def run_entry(self, body, **options):
        return subprocess.run(
            [sys.executable, "-c", ENTRY.format(body)],
            capture_output=True,
            text=True,
            check=False,
            **options,
        )

    def test_every_error_is_one_message(self):
        for body, status, message in (
            ("return 0", 0, ""),
            (
                "from slipbench import InputError; raise InputError('a.csv:1: no')",
                2,
                "slipbench: a.csv:1: no\n",
            ),
            (
                "raise OSError(28, 'No space left on device')",
                2,
                "slipbench: cannot write out.h5: No space left on device\n",
            ),
            ("open('no/file')", 2, "slipbench: no/file: No such file or directory\n"),
            ("raise MemoryError", 2, "slipbench: out of memory\n"),
            ("raise KeyboardInterrupt", 130, "slipbench: interrupted; nothing is kept\n"),
            (
                "import no_such_package",
                2,
                f"slipbench: x needs the Python package no_such_package, which {sys.executable} does not have; install it: pip install no_such_package\n",
            ),
            (
                "raise RuntimeError('one\\ntwo')",
                2,
                "slipbench: internal error, please report it: RuntimeError: one",
            ),
            (
                "work()",
                2,
                "slipbench: internal error, please report it: RecursionError: maximum recursion depth exceeded",
            ),
            (
                "from slipbench import InputError; raise InputError('\\x1b[31m \\u202e')",
                2,
                "slipbench: \\x1b[31m ",
            ),
        ):
            with self.subTest(body):
                done = self.run_entry(body)
                self.assertEqual((done.returncode, done.stdout), (status, ""))
                self.assertEqual(done.stderr[: len(message)], message)
                self.assertEqual(done.stderr.count("\n"), 1 if message else 0)
                self.assertNotIn("\x1b", done.stderr)

    def test_an_internal_error_names_its_place(self):
        done = self.run_entry("import slipbench._values as v; v.plain(1, 2).x")
        self.assertRegex(
            done.stderr,
            r"^slipbench: internal error, please report it: AttributeError: 'int' object has no attribute 'x', at _program\.py:\d+\n$",
        )

    def test_a_result_that_cannot_be_printed_is_an_error(self):
        body = "return write_result(lambda: print('x' * 100000))"
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run(
                [sys.executable, "-c", ENTRY.format(body)],
                stdout=full,
                stderr=subprocess.PIPE,
                text=True,
                check=False,
            )
        self.assertEqual(
            (done.returncode, done.stderr),
            (2, "slipbench: cannot write to standard output: No space left on device\n"),
        )
        done = subprocess.run(
            ["sh", "-c", '"$0" -c "$1" >&-', sys.executable, ENTRY.format(body)],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(
            (done.returncode, done.stderr),
            (2, "slipbench: cannot write to standard output: Bad file descriptor\n"),
        )
        # The reader has closed the pipe: SIGPIPE ends the process, without a message.
        reading, writing = os.pipe()
        os.close(reading)
        done = subprocess.run(
            [sys.executable, "-c", ENTRY.format(body)],
            stdout=writing,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        os.close(writing)
        self.assertEqual((done.returncode, done.stderr), (-signal.SIGPIPE, ""))
        # Messages that cannot be written do not change the status.
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run(
                [sys.executable, "-c", ENTRY.format("raise MemoryError")], stderr=full, check=False
            )
        self.assertEqual(done.returncode, 2)


class TextTest(unittest.TestCase):
    def test_texts_from_outside_are_escaped(self):
        self.assertEqual(printable("a\x1b[2Jb\x7f\u0085"), "a\\x1b[2Jb\\x7f\\xc2\\x85")
        self.assertEqual(printable("a\nb"), "a\\x0ab")
        self.assertEqual(printable("a\nb", lines=True), "a\nb")
        self.assertEqual(
            printable("\udce9.h5"), "\\udce9.h5"
        )  # the name of a file that is not UTF-8

    def test_cards_hold_no_html_links_or_code_of_a_dataset(self):
        # By CommonMark, "<" begins HTML, "[" a link or an image, "`" ends a code span that it began.
        self.assertEqual(
            card._text("<script>&[a](b)`c`\n\x1b"), "&lt;script&gt;&amp;\\[a\\](b)\\`c\\` \\\\x1b"
        )
        self.assertEqual(card._code("force"), "`force`")
        self.assertEqual(card._code("a`<b>"), "``a`<b>``")
        self.assertEqual(card._code("`a``"), "``` `a`` ```")
        self.assertEqual(
            card._yaml("slipbench recordings of papillarray, taxels"),
            "slipbench recordings of papillarray, taxels",
        )
        self.assertEqual(card._yaml("x\nlicense: mit"), '"x\\nlicense: mit"')


if __name__ == "__main__":
    del sys.argv[1]
    unittest.main()
