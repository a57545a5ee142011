"""Runs damaged copies of the shipped scenes.

Each exits with status 0, 1 or 2 and writes only finite values.

usage: mutation_test.py SLIPBENCH SCENES COUNT [FIRST]

A scene gets one to three mutations: another number, another unit, a key or a word of another scene,
a list shortened or doubled, a line removed, doubled or swapped with another. COUNT scenes, the same
ones in every run; FIRST is the number of the first. A valid scene that takes longer than SECONDS,
such as one with a box of some milligrams, is ended by a signal.
"""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

SECONDS = 10
# NaN where they do not apply (tools/dataset/trials.md).
MAY_BE_NAN = {
    "margin",
    "stuck_fraction",
    "slip_direction",
    "slip_centre",
    "onset_time_s",
    "micro_onset_time_s",
}
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
UNIT = re.compile(r"(?<=\d )[a-zA-Z%][\w/%2]*")
KEY = re.compile(r"[a-z]\w*(?=:)")
WORD = re.compile(r"(?<=: )[a-z]\w*")
LIST = re.compile(r"\[[^\[\]]*\]")
NUMBERS = [
    "0",
    "-1",
    "1",
    "-0.0",
    "1e-300",
    "5e-324",
    "1e-9",
    "1e9",
    "1e300",
    "-1e308",
    "inf",
    "-inf",
    "nan",
    "1e999",
    "99999999999999999999",
    "true",
    "~",
]


def words_of(texts):
    return {
        pattern: sorted({word for text in texts for word in pattern.findall(text)})
        for pattern in (UNIT, KEY, WORD)
    }


class Mutator:
    def __init__(self, draw, texts, words):
        self.draw = draw
        self.texts = texts
        self.words = words

    def replace(self, text, pattern, new):
        found = list(pattern.finditer(text))
        if not found:
            return text
        match = self.draw.choice(found)
        return text[: match.start()] + new(match.group()) + text[match.end() :]

    def number(self, old):
        if self.draw.random() < 0.5:
            return self.draw.choice(NUMBERS)
        return repr(float(old) * 10 ** self.draw.uniform(-6, 6) * self.draw.choice((1, 1, 1, -1)))

    def items(self, old):
        items = old[1:-1].split(",")
        place = self.draw.randrange(len(items))
        items[place : place + 1] = [] if self.draw.random() < 0.5 else [items[place]] * 2
        return "[" + ",".join(items) + "]"

    def lines(self, text):
        lines = text.split("\n")
        one, other = (self.draw.randrange(len(lines)) for _ in range(2))
        way = self.draw.randrange(4)
        if way == 0:
            del lines[one]
        elif way == 1:
            lines.insert(other, lines[one])
        elif way == 2:
            lines[one], lines[other] = lines[other], lines[one]
        else:
            lines.insert(other, self.draw.choice(self.draw.choice(self.texts).split("\n")))
        return "\n".join(lines)

    def mutant(self):
        text = self.draw.choice(self.texts)
        for _ in range(self.draw.randint(1, 3)):
            way = self.draw.randrange(10)
            if way < 4:
                text = self.replace(text, NUMBER, self.number)
            elif way == 4:
                text = self.replace(text, LIST, self.items)
            elif way < 8:
                pattern = (UNIT, KEY, WORD)[way - 5]
                text = self.replace(
                    text, pattern, lambda _, words=self.words[pattern]: self.draw.choice(words)
                )
            else:
                text = self.lines(text)
        return text


def not_finite(path):
    """Returns the names of arrays and attributes with invalid values."""
    bad = []

    def look(where, values):
        values = np.asarray(values)
        if values.dtype.kind != "f" or np.isfinite(values).all():
            return
        if where.split("/")[-1].split("@")[-1] not in MAY_BE_NAN or np.isinf(values).any():
            bad.append(where)

    def visit(name, item):
        for key, value in item.attrs.items():
            look(f"{name}@{key}", value)
        if isinstance(item, h5py.Dataset):
            look(name, item[()])

    with h5py.File(path) as file:
        file.visititems(visit)
    return bad


def run(program, scene, output):
    """Returns the exit status, and what is wrong with it.

    Status None: ended by a signal after SECONDS. Empty: nothing is wrong.
    """
    text = Path(scene).read_text(encoding="utf-8")
    grasp = re.search(r"^(box|grip|controller):", text, re.M)
    lift = ["motion.distance=1 mm"] if grasp and "guided" not in text else []  # ends at 1.6 s
    command = [
        program,
        "run",
        scene,
        "--set",
        f"duration={'1.7' if grasp else '0.05'} s",
        *lift,
        "-o",
        output,
        "--quiet",
    ]
    with subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        errors="replace",
    ) as child:
        try:
            _, errors = child.communicate(timeout=SECONDS)
        except subprocess.TimeoutExpired:
            child.send_signal(signal.SIGTERM)
            try:
                _, errors = child.communicate(timeout=SECONDS)
            except subprocess.TimeoutExpired:
                child.kill()
                return None, "takes too long and does not end at a signal"
            interrupted = child.returncode == 130 and "interrupted" in errors
            return (
                None,
                ""
                if interrupted
                else f"ended with {child.returncode} at a signal: {errors[-300:]}",
            )
    status = child.returncode
    if status not in (0, 1, 2):
        return status, f"ended with {status}: {errors[-300:]}"
    if status != 0 and not errors.strip():
        return status, f"ended with {status} and no word"
    bad = not_finite(output) if status == 0 else []
    return status, f"wrote what is not finite: {bad[:5]}" if bad else ""


def main(program, scenes, count, first=0):
    faults, done, long = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        copies = os.path.join(folder, "scenes")
        shutil.copytree(scenes, copies)
        texts = {}  # by folder, because a scene may name its models
        for root, _, names in sorted(os.walk(copies)):
            for name in sorted(names):
                if name.endswith(".yaml"):
                    with open(os.path.join(root, name), encoding="utf-8") as file:
                        texts.setdefault(root, []).append(file.read())
        words = words_of([text for some in texts.values() for text in some])
        for number in range(first, first + count):
            draw = random.Random(number)
            root = draw.choice(list(texts))
            text = Mutator(draw, texts[root], words).mutant()
            scene = os.path.join(root, "mutant.yaml")
            with open(scene, "w", encoding="utf-8") as file:
                file.write(text)
            status, wrong = run(program, scene, os.path.join(folder, "out.h5"))
            done += status == 0
            long += status is None
            if wrong:
                faults += 1
                print(f"scene {number}: {wrong}\n{text}\n", flush=True)
            for name in os.listdir(folder):
                if name.startswith("out"):
                    os.remove(os.path.join(folder, name))
    print(
        f"{count} damaged scenes: {done} ran, {long} took more than {SECONDS} s, the others were refused; {faults} not as they should"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], *(int(number) for number in sys.argv[3:])))
