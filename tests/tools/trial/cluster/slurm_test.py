"""A sweep as a Slurm array merges to the content of the undivided sweep, despite kills and reruns.

usage: slurm_test.py SLIPBENCH ROUNDS

Each round runs an array of 8 shards on this machine: one task is killed in the middle with SIGKILL
and queued again, slurmd is stopped and started, one shard runs twice at once. Slurm and munge are
Debian's, with their own folder, ports and socket. Exits with 77 if it is not root.
"""

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from sweep_folder import SHARDS, SweepFolder, wait_for

CONFIGURATION = """ClusterName=slipbench
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
SlurmUser=root
SlurmctldPort={controller}
SlurmdPort={daemon}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
PROGRAMS = ("munged", "slurmctld", "slurmd")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm:
    """A controller, one node and munge, all on loopback."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        folder.chmod(0o755)
        configuration = folder / "slurm.conf"
        host = socket.gethostname().split(".")[0]
        text = CONFIGURATION.format(
            host=host, folder=folder, controller=free_port(), daemon=free_port()
        )
        configuration.write_text(text, encoding="ascii")
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}
        self.processes = {}

    def begin(self):
        folder = self.folder
        self.start("munged", "--foreground", "--force", f"--key-file={folder}/munge.key", f"--socket={folder}/munge.socket",
                   f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/munged.seed")  # fmt: skip
        wait_for("munged answers", lambda: (folder / "munge.socket").exists())
        self.start("slurmctld", "-D")
        wait_for(
            "slurmctld answers", lambda: self.run("scontrol", "ping", check=False).returncode == 0
        )
        self.start("slurmd", "-D")
        wait_for(
            "the node is up",
            lambda: "idle" in self.run("sinfo", "--noheader", "--format=%t").stdout,
        )

    def start(self, program, *words):
        with open(self.folder / f"{program}.out", "ab") as out:
            self.processes[program] = subprocess.Popen(
                [shutil.which(program), *words], env=self.environment, stdout=out, stderr=out
            )

    def stop(self, program):
        process = self.processes.pop(program)
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def close(self):
        self.run("scancel", "--user=root", check=False)
        for program in list(self.processes)[::-1]:
            self.stop(program)

    def run(self, *words, check=True, **options):
        return subprocess.run(
            words,
            env=self.environment,
            capture_output=True,
            text=True,
            check=check,
            timeout=60,
            **options,
        )

    def state(self, job):
        shown = self.run("scontrol", "show", "job", job, check=False).stdout
        return shown.partition("JobState=")[2].split(" ")[0]


def run_a_second_copy(sweep, cluster, k):
    """Waits until shard k runs; returns the exit status."""
    wait_for(f"shard {k} runs", lambda: sweep.sweep_process(cluster, k))
    return subprocess.run(
        ["bash", cluster / "shard.sh", str(k), "second"], stdout=subprocess.DEVNULL, check=False
    ).returncode


def do_round(slurm, sweep, beside, name):
    cluster = sweep.cluster(name)
    job = slurm.run("sbatch", "--parsable", "array.sbatch", cwd=cluster).stdout.strip()
    victim, twice = 2, 6
    second = beside.submit(run_a_second_copy, sweep, cluster, twice)
    sweep.kill_in_the_middle(cluster, victim)
    wait_for("the killed task has ended", lambda: slurm.state(f"{job}_{victim}") == "FAILED")
    slurm.run("scontrol", "requeue", f"{job}_{victim}")
    slurm.run("scontrol", "update", f"JobId={job}_{victim}", "StartTime=now", check=False)

    wait_for(
        "another task runs",
        lambda: any(sweep.sweep_process(cluster, k) for k in range(3, SHARDS + 1)),
    )
    slurm.stop("slurmd")
    slurm.start("slurmd", "-D")

    assert second.result() == 0, f"the second copy of shard {twice} ended with {second.result()}"
    wait_for("the queue is empty", lambda: not slurm.run("squeue", "--noheader").stdout.strip())
    left = [slurm.state(f"{job}_{k}") for k in range(1, SHARDS + 1)]
    assert left == ["COMPLETED"] * SHARDS, left
    log = (cluster / f"logs/{victim}.log").read_text(encoding="utf-8")
    assert "Killed" in log and "is finished" in log, log
    return sweep.merged_is_whole(cluster)


def main(program, rounds):
    if os.geteuid() != 0:
        print("skipped: Slurm wants root")
        return 77
    missing = [name for name in PROGRAMS if not shutil.which(name)]
    if missing:
        sys.exit(f"not installed: {', '.join(missing)}; get it with: tools/setup/setup.sh all")
    with tempfile.TemporaryDirectory() as folder:
        slurm_folder = Path(folder, "slurm")
        slurm_folder.mkdir()
        os.chmod(folder, 0o755)
        sweep = SweepFolder(program, folder)
        slurm = Slurm(slurm_folder)
        try:
            slurm.begin()
            with ThreadPoolExecutor(1) as beside:
                equal = [
                    do_round(slurm, sweep, beside, f"round-{number}") for number in range(rounds)
                ]
        except BaseException:
            for log in sorted(slurm_folder.glob("slurm*.log")):
                print(f"--- {log.name}", log.read_text(encoding="utf-8")[-3000:], sep="\n")
            raise
        finally:
            slurm.close()
    print(
        f"{rounds} arrays with a killed task, a restarted slurmd and a shard that ran twice: {sum(equal)} merged to the content of the whole sweep"
    )
    return 0 if all(equal) else 1


if __name__ == "__main__":
    os.environ["PATH"] += ":/usr/sbin"
    sys.exit(main(sys.argv[1], int(sys.argv[2])))
