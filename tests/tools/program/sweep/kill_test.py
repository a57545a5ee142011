"""Kills sweeps at random instants: what was counted as finished is readable, and --resume gives the bytes of an undisturbed run.

usage: kill_test.py SLIPBENCH KILLS SEED

Half of the kills are SIGKILL; of the others a part is a disk that is full (a limit on the file's size), a part SIGTERM.
"""
import hashlib
import os
import pty
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

from short_sweep import scene_text


# Reads every array and attribute of every trial, and prints how many trials there are.
READ_ALL = """
import h5py, sys
def read(name, item):
    dict(item.attrs)
    if isinstance(item, h5py.Dataset):
        item[()]
with h5py.File(sys.argv[1]) as file:
    for demo in file["data"].values():
        dict(demo.attrs)
        demo.visititems(read)
    print(len(file["data"]))
"""
SECONDS = 60  # no reader and no run takes longer


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def counted(terminal):
    """The highest number of finished trials that a progress bar has shown."""
    text = b""
    while True:
        try:
            block = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not block:
            break
        text += block
    return max([int(done) for done in re.findall(rb"(\d+)/90 ", text)], default=0)


def is_dataset(path):
    # A file that begins with zeros was killed before it began.
    return os.path.exists(path) and os.path.getsize(path) > 0 and open(path, "rb").read(8) != bytes(8)


def readable_trials(path):
    result = subprocess.run([sys.executable, "-c", READ_ALL, path], capture_output=True, text=True, timeout=SECONDS)
    assert result.returncode == 0, f"{path}: {result.stderr}"
    return int(result.stdout)


def main(program, kills, seed):
    draw = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        scene, whole, out = (os.path.join(folder, name) for name in ("scene.yaml", "whole.h5", "out.h5"))
        with open(scene, "w", encoding="ascii") as file:
            file.write(scene_text(trials=30))
        begin = time.monotonic()
        subprocess.run([program, "sweep", scene, "-o", whole, "--quiet"], check=True, timeout=SECONDS)
        duration = time.monotonic() - begin
        size = os.path.getsize(whole)
        lost = 0
        for attempt in range(kills):
            way = ("kill", "full", "kill", "term")[attempt % 4]
            limit = draw.randrange(size // 20, size) if way == "full" else resource.RLIM_INFINITY
            ours, theirs = pty.openpty()
            sweep = subprocess.Popen(
                [program, "sweep", scene, "-o", out, "--jobs", str(1 + attempt % 2)],
                stdout=subprocess.DEVNULL,
                stderr=theirs,
                preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
            )
            os.close(theirs)
            if way != "full":
                time.sleep(draw.uniform(0.0, 1.2 * duration))
                sweep.send_signal(signal.SIGKILL if way == "kill" else signal.SIGTERM)
            shown = counted(ours)
            os.close(ours)
            status = sweep.wait(timeout=SECONDS)
            if way == "full":
                assert status == 2, f"attempt {attempt}: a full disk ended the sweep with {status}"
            places = (out, out + ".partial", os.path.join(folder, "out.partial.h5"))
            held = max((readable_trials(path) for path in places if is_dataset(path)), default=0)
            if held < shown:
                lost += 1
                print(f"attempt {attempt} ({way}): {shown} trials were counted as finished, {held} are readable")
            resume = [program, "sweep", scene, "-o", out, "--quiet", "--resume"]
            if way == "term":  # a --resume that is ended keeps what there was
                with subprocess.Popen(resume, stderr=subprocess.DEVNULL) as ended:
                    time.sleep(draw.uniform(0.0, 0.5 * duration))
                    ended.send_signal(signal.SIGTERM)
                    assert ended.wait(timeout=SECONDS) in (0, 130, -signal.SIGTERM), ended.returncode
                kept = max((readable_trials(path) for path in places if is_dataset(path)), default=0)
                if kept < held:
                    lost += 1
                    print(f"attempt {attempt}: {held} trials were left, and {kept} by a --resume that was ended")
            subprocess.run(resume, check=True, timeout=SECONDS, capture_output=True)
            if digest(out) != digest(whole):
                lost += 1
                print(f"attempt {attempt} ({way}, {held} trials were left): --resume gave other bytes")
            left = sorted(os.listdir(folder))
            assert left == ["out.h5", "scene.yaml", "whole.h5"], left
            os.remove(out)
    print(f"{kills} runs were ended at random instants; {lost} lost a trial or were not resumed to the same bytes")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
