"""A sweep by Snakemake with a killed worker merges to the content of the undivided sweep.

usage: snakemake_test.py SLIPBENCH ROUNDS
"""

import subprocess
import sys
import tempfile

from sweep_folder import PATIENCE, SweepFolder


def do_round(sweep, name):
    cluster = sweep.cluster(name)
    command = ["snakemake", "--cores", "2", "--nolock"]
    with subprocess.Popen(
        command, cwd=cluster, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as snakemake:
        sweep.kill_in_the_middle(cluster, 3)
        output = snakemake.communicate(timeout=PATIENCE)[0]
    assert snakemake.returncode == 0, output
    assert "Trying to restart job" in output, output
    whole = sweep.merged_is_whole(cluster)
    assert (
        "Nothing to be done"
        in subprocess.run(
            command, cwd=cluster, capture_output=True, text=True, check=True, timeout=PATIENCE
        ).stderr
    )
    return whole


def main(program, rounds):
    with tempfile.TemporaryDirectory() as folder:
        sweep = SweepFolder(program, folder)
        equal = [do_round(sweep, f"round-{number}") for number in range(rounds)]
    print(
        f"{rounds} runs of Snakemake with a killed worker: {sum(equal)} merged to the content of the whole sweep"
    )
    return 0 if all(equal) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2])))
