"""The studies by name, with their options."""

from __future__ import annotations

import difflib
from dataclasses import dataclass

from slipbench import InputError
from slipbench_studies.result import Options

RUNS = ("--trials", "--seed", "--jobs")
ROWS = ("--trials", "--only", "--seed", "--jobs")
GRASPS = ("--real", "--data", "--trials", "--full", "--seed", "--jobs", "--resume")
TRAINS = ("--data", "--trials", "--full", "--seed", "--jobs", "--resume")
TRAINS_ROWS = ("--data", "--trials", "--only", "--full", "--seed", "--jobs", "--resume")


@dataclass(frozen=True)
class Study:
    """A study, in the module `module_of(name)`.

    Attributes:
        name: PAPER/TABLE
        summary: one line
        options: options besides --output, --json and --quiet
    """

    name: str
    summary: str
    options: tuple[str, ...]


STUDIES = (
    Study(
        "biotac-stability-slip/table1",
        "grasps held or lost by the layout of the tactile image, real and synthetic",
        GRASPS,
    ),
    Study(
        "biotac-stability-slip/fig12",
        "the same by the graph of the GCN: drawn by hand, or nearest neighbours",
        GRASPS,
    ),
    Study(
        "biotac-stability-slip/table2",
        "grasps held or lost on new objects: GCN, CNN and plainer networks; trained on real, synthetic or both",
        GRASPS,
    ),
    Study(
        "biotac-stability-slip/table3",
        "direction of slip on new objects, with and without the position of the contact; trained on real, synthetic or both",
        ("--real", "--data", "--trials", "--only", "--full", "--seed", "--jobs", "--resume"),
    ),
    Study(
        "hd-papillarray/table1",
        "ablation of the encoders, by sequence and by frame, and its causes",
        ("--data", "--seed", "--jobs"),
    ),
    Study(
        "hd-papillarray/table2",
        "grasp and lift in the closed loop: drops, slip and grip force of every detector and controller",
        ("--trials", "--only", "--memories", "--seed", "--jobs"),
    ),
    Study(
        "hd-papillarray/table3",
        "the published recurrent network on the same protocol: balanced accuracy, delay, early and missed",
        ("--only", "--seed", "--jobs"),
    ),
    Study(
        "hd-papillarray/latency",
        "time from a frame to its class, in software and in the register-level core",
        (),
    ),
    Study(
        "hd-papillarray/resources",
        "share of the published FPGA that the core uses, for each degree of unrolling",
        ("--synthesise",),
    ),
    Study(
        "learned/grasp_loop",
        "detectors trained on simulated grasps, in the published loop: drops, slip and force, with an oracle and two controls",
        ("--data", "--trials", "--only", "--seed", "--jobs"),
    ),
    Study(
        "learned/scaling",
        "score, delay and alarms on slip-4 against the number of training trials and, with --full, against what they vary",
        ("--trials", "--only", "--full", "--seed", "--jobs", "--resume"),
    ),
    Study(
        "myrmex-tactile-cnn/onset_label",
        "onset labelled by a third sensor on the object, compared with the true onset: 64 trials, several "
        "readings of the rule",
        RUNS,
    ),
    Study(
        "myrmex-tactile-cnn/table2",
        "nets 1 to 3 of the Myrmex array by the paper's split, by trial and by object, compared with what the static "
        "image or a clock reveal",
        ("--trials", "--only", "--full", "--seed", "--jobs", "--resume"),
    ),
    Study(
        "myrmex-tactile-cnn/table3",
        "confusion of stable, translation and rotation, by window and by trial",
        ("--trials", "--only", "--full", "--seed", "--jobs", "--resume"),
    ),
    Study(
        "nib-reconfigurable/table1",
        "calibration of the nib pad: force and moment from 36 capacitances, under uniform and partial loads, and the causes "
        "of its errors",
        ("--seed", "--jobs"),
    ),
    Study(
        "nib-reconfigurable/table2",
        "Algorithm 1 while the grasp is slowly released, on four surfaces; influences on its figures, and the origin "
        "of the energy at 0 to 8 Hz",
        RUNS,
    ),
    Study(
        "nib-reconfigurable/slip_kinds",
        "no slip, linear and rotational slip distinguished by FL, FR and curl",
        RUNS,
    ),
    Study(
        "nib-reconfigurable/table3",
        "a box turned upright by rotational slip and released: weights, centres of mass, surfaces, thresholds",
        ROWS,
    ),
    Study(
        "piezo-fft-gru/table1",
        "networks on the piezoelectric skin, compared with what a clock, the contact or the motors reveal",
        TRAINS_ROWS,
    ),
    Study("piezo-fft-gru/table2", "the FFT-GRU by the band of its spectrum", TRAINS),
    Study("piezo-fft-gru/table3", "networks tested on a tip outside their training", TRAINS),
    Study(
        "piezo-fft-gru/table4",
        "networks trained with and without motor recordings, against the motors' vibration",
        TRAINS_ROWS,
    ),
    Study(
        "piezo-fft-gru/delay",
        "delay of the FFT-GRU from the position label and from the true first slip, and how early the label itself is",
        TRAINS,
    ),
    Study(
        "piezo-fft-gru/slip_against_hold",
        "slip and hold distinguished by the power of one frame, against the motors' vibration, and the wrong frames",
        RUNS,
    ),
    Study(
        "real",
        "shipped detectors and yardsticks on public recordings of real sensors: AUC, slips found, false alarms",
        ("--recordings", "--only"),
    ),
    Study(
        "realism",
        "published figures of real devices compared with those of the studies",
        ("--real", "--trials", "--only", "--full", "--seed", "--jobs"),
    ),
)


def find_study(name: str) -> Study:
    """Returns the study of this name.

    Args:
        name: PAPER/TABLE

    Returns:
        its entry of STUDIES

    Raises:
        InputError: an unknown name; the message has the nearest one
    """
    for one in STUDIES:
        if one.name == name:
            return one
    names = [one.name for one in STUDIES]
    near = difflib.get_close_matches(name, names, 1, 0.7)
    meant = f" did you mean '{near[0]}'?" if near else ""
    raise InputError(f"reproduce: unknown name '{name}';{meant} allowed: {', '.join(names)}")


def check_options(study: Study, options: Options) -> None:
    """Rejects an option that the study does not use, which would be a misunderstanding.

    Args:
        study: study to run
        options: requested options

    Raises:
        InputError: for an option that the study does not use, and for --resume without an output
            page, next to which networks are saved
    """
    given = {
        "--data": options.data,
        "--real": options.real,
        "--recordings": options.recordings,
        "--full": options.full,
        "--seed": options.seed is not None,
        "--jobs": options.jobs,
        "--resume": options.resume,
        "--synthesise": options.synthesise,
        "--trials": options.trials,
        "--only": options.only,
        "--memories": options.memories,
    }
    for option, is_given in given.items():
        if is_given and option not in study.options:
            raise InputError(
                f"reproduce: {study.name} does not take {option}; allowed: {', '.join(study.options) or '--output, --json, --quiet'}"
            )
    if options.resume and not options.output:
        raise InputError("reproduce: --resume continues a run with -o, so it needs -o")
