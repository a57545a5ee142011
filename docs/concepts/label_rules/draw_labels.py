"""Draws labels.svg: one trial by all label rules. Argument: output folder, default: this folder.

Needs the package slipbench and matplotlib: PYTHONPATH=build/release/python build/venv/bin/python
docs/concepts/label_rules/draw_labels.py
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np
import slipbench
from matplotlib import pyplot as plt

STATES = ("no contact", "hold", "slip", "left out")
COLOURS = ("#dde1e6", "#2f6fb0", "#d1495b", "#ffffff")
NO_CONTACT, HOLD, SLIP, LEFT_OUT = range(4)


def classes(states):
    """No contact, hold or slip from a pad's states: incipient and gross slip are slip."""
    return np.where(states == 0, NO_CONTACT, np.where(states >= 2, SLIP, HOLD))


def after_slip(micro, filled):
    """`micro`, with `filled` where the pad holds after a slip without having lost contact."""
    result, slipped = micro.copy(), False
    for at, state in enumerate(micro):
        slipped = state != NO_CONTACT and (slipped or state == SLIP)
        if slipped and state == HOLD:
            result[at] = filled
    return result


def braked():
    """Simulates a pad that is pressed, moves sideways, is braked and is lifted off.

    It moves at 4 mm/s from 0.6 s and is braked 0.7 s later under constant load.
    """
    return slipbench.Scene.from_dict(
        {
            "slipbench": 1,
            "duration": "2.2 s",
            "friction": {"static": 0.9, "kinetic": 0.8},
            "motion": {
                "kind": "stage",
                "compression": "1 mm",
                "start": "0.6 s",
                "speed": "4 mm/s",
                "stop": "700 ms",
                "retract": "1.9 s",
            },
            "sensors": {
                "pad": {"type": "papillarray", "rate": "1 kHz", "bristles": 6, "profile": "hexapod"}
            },
        }
    ).run()


def picture(trial):
    """Draws the tangential force of each pillar, and below a strip for each rule."""
    sensor, labels = trial.sensors["pad"], trial.labels["pad"]
    micro = classes(labels.state_micro)
    rules = {
        "strict": classes(labels.state),
        "micro": micro,
        "paper": classes(labels.state_paper),
        "latched": after_slip(micro, SLIP),
        "masked": after_slip(micro, LEFT_OUT),
    }
    figure, axes = plt.subplots(
        1 + len(rules),
        figsize=(7, 4),
        dpi=100,
        layout="constrained",
        sharex=True,
        height_ratios=(4, *len(rules) * [1]),
    )
    axes[0].plot(sensor.t, np.hypot(labels.force[:, :, 0], labels.force[:, :, 1]), linewidth=1)
    axes[0].set_ylabel("tangential force\nof a pillar (N)")
    colours = matplotlib.colors.ListedColormap(COLOURS)
    for axis, (name, states) in zip(axes[1:], rules.items(), strict=True):
        axis.imshow(
            states[None],
            aspect="auto",
            cmap=colours,
            vmin=0,
            vmax=3,
            interpolation="nearest",
            extent=(sensor.t[0], sensor.t[-1], 0, 1),
        )
        axis.set(yticks=[])
        axis.set_ylabel(name, rotation=0, ha="right", va="center")
    axes[-1].set_xlabel("time (s)")
    patches = [
        plt.Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor="#5b6470", linewidth=0.5)
        for colour in COLOURS
    ]
    figure.legend(patches, STATES, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    return figure, rules


if __name__ == "__main__":
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "slipbench"  # reproducible ids
    drawn, shares = picture(braked())
    drawn.savefig(
        Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent) / "labels.svg",
        metadata={"Date": None},
    )
    print({name: f"{(states == SLIP).mean():.1%}" for name, states in shares.items()})
