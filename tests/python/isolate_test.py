"""Misbehaving detectors in Python: trials in separate processes contain the damage.

Argument: the program, which is not used.
"""

import ctypes
import os
import signal
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import slipbench

LIMIT = 2.0  # s, above the time of an honest trial on a busy machine
HONEST = False
KEPT = []


def recurse(depth=0):
    return recurse(depth + 1) + 1


def loop():
    while True:
        pass


def be_deaf():
    for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:
        signal.signal(number, signal.SIG_IGN)
    loop()


KILLED_BY = "its worker process was killed by "
LATE = f"its worker process was still running at the limit of {LIMIT:g} s"
# Each deed, and words in the failed trial's message; None: no failure.
DEEDS = [
    (lambda: os._exit(0), "its worker process ended with status 0 before its work was done"),
    (lambda: ctypes.string_at(0), KILLED_BY + "SIGSEGV"),
    (os.abort, KILLED_BY + "SIGABRT"),
    (lambda: os.kill(os.getpid(), signal.SIGKILL), KILLED_BY + "SIGKILL"),
    (loop, LATE),
    (be_deaf, LATE),
    (lambda: KEPT.append(bytearray(1 << 46)), "MemoryError"),
    (recurse, "RecursionError"),
    (sys.exit, "SystemExit"),
    (lambda: [][int("\udce9", 36)], "ValueError"),
    (lambda: os.closerange(3, 1 << 16), "its worker process ended with status 1"),
    (lambda: os.chdir("/"), None),
    (lambda: print("said"), None),
    (lambda: threading.Thread(target=loop, daemon=True).start(), None),
    (os.fork, None),
]


@slipbench.detector("misbehaves")
class Misbehaves:
    """Does what its parameter names in its hundredth update."""

    parameters = {"deed": -1}

    def __init__(self, source, deed):
        self.deed, self.updates = int(deed), 0

    def update(self, frame):
        self.updates += 1
        if self.deed >= 0 and self.updates == 100 and not HONEST:
            DEEDS[self.deed][0]()
        return slipbench.State.NON_SLIP


SCENE = """slipbench: 1
duration: 0.3 s
time_step: 1 ms
motion: {kind: stage, gap: 0 mm, compression: 0.1 mm, approach_speed: 10 mm/s, start: 0.1 s, speed: 4 mm/s}
sensors: {pad: {type: papillarray, rate: 1 kHz, bristles: 3}}
detector: {type: misbehaves}
"""


class IsolateTest(unittest.TestCase):
    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "scene.yaml").write_text(SCENE, encoding="ascii")
        self.file = folder / "out.h5"
        self.scene = slipbench.Scene.load(folder / "scene.yaml")

    def digests(self, deeds, **options):
        summary = self.scene.set({"sweep": {"detector.deed": deeds}}).write(self.file, **options)
        with slipbench.open(self.file) as data:
            return {trial: data[trial].sha256 for trial in data.trials}, {
                one["trial"]: one["message"] for one in summary["failed"]
            }

    def test_a_deed_fails_its_trial_alone(self):
        global HONEST
        deeds = [value for deed in range(len(DEEDS)) for value in (-1, deed)] + [-1]
        HONEST = True
        honest, failed = self.digests(deeds, isolate=False)
        HONEST = False
        self.assertEqual(failed, {})
        digests, failed = self.digests(deeds, trial_limit=LIMIT)
        expected = {2 * deed + 1: text for deed, (_, text) in enumerate(DEEDS) if text}
        self.assertEqual(set(failed), set(expected), failed)
        for trial, text in expected.items():
            self.assertIn(text, failed[trial])
        self.assertEqual(
            digests, {trial: digest for trial, digest in honest.items() if trial not in failed}
        )

    def test_is_the_default_and_its_limit_is_kept_to_a_second(self):
        self.assertEqual(set(self.digests([-1, 0])[1]), {1})
        alone = self.scene.set({"detector.deed": 0}).write(self.file, trials=1, isolate=True)
        self.assertIn("ended with status 0", alone["failed"][0]["message"])
        begin = time.monotonic()
        _, failed = self.digests([-1, 4], trial_limit=1.0, jobs=1)
        self.assertEqual(set(failed), {1})
        self.assertLess(
            time.monotonic() - begin, 1.0 + 1.0 + 1.0
        )  # the limit, what is allowed beyond it, and the honest trial

    def test_limits_are_checked(self):
        for options in ({"trial_limit": 0.0}, {"trial_limit": 1.0, "isolate": False}):
            with self.assertRaises(slipbench.InputError):
                self.scene.write(self.file, **options)


if __name__ == "__main__":
    del sys.argv[1]
    unittest.main()
