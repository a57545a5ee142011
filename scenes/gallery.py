"""Draws the pictures of GALLERY.md: one run of a scene of each folder. Argument: output folder, default: this folder.

Needs the package slipbench and matplotlib: PYTHONPATH=build/release/python build/venv/bin/python scenes/gallery.py
"""

import sys
from pathlib import Path

import matplotlib
import mujoco
import numpy as np
import slipbench
import slipbench.mujoco
from matplotlib import pyplot as plt
from matplotlib.colors import ListedColormap
from PIL import Image

SCENES = Path(__file__).resolve().parent
STATES = ("no contact", "sticks", "slips", "slips in part")  # of a unit
PAD_STATES = ("no contact", "all stick", "some slip", "all slip")
COLOURS = ("#dde1e6", "#2f6fb0", "#d1495b", "#edae49")
PAD_COLOURS = ("#dde1e6", "#2f6fb0", "#edae49", "#d1495b")


def explain(picture, names, colours):
    patches = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in colours]
    picture.legend(patches, names, loc="outside lower center", ncols=4, fontsize=8, frameon=False)


def figure(title):
    """Axes for the pad on the left, for the reading on the right, and for the truth in a strip below the reading."""
    picture = plt.figure(figsize=(7, 3), dpi=100, layout="constrained")
    picture.suptitle(title, fontsize=10)
    explain(picture, STATES, COLOURS)
    grid = picture.add_gridspec(2, 2, width_ratios=(1, 2), height_ratios=(4, 1))
    reading = picture.add_subplot(grid[0, 1])
    shares = picture.add_subplot(grid[1, 1], sharex=reading)
    reading.tick_params(labelbottom=False)
    return picture, picture.add_subplot(grid[:, 0]), reading, shares


def draw_units(axes, places, states, size):
    """Draws the units of the pad at their positions in mm."""
    axes.scatter(
        *(1000 * places.T),
        c=[COLOURS[state] for state in states],
        s=size,
        edgecolors="#5b6470",
        linewidths=0.6,
    )
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    axes.margins(0.2)


def draw_shares(axes, time, states):
    """Draws the share of units in each state over time."""
    axes.stackplot(
        time,
        *[(states == state).mean(axis=1) for state in (1, 3, 2, 0)],
        colors=[COLOURS[state] for state in (1, 3, 2, 0)],
    )
    axes.set(
        xlabel="time (s)", ylabel="units", ylim=(0, 1), yticks=(0, 1), xlim=(time[0], time[-1])
    )


def mixed(states):
    """Sample at which the states of the units differ most."""
    return int(
        np.argmax(
            np.minimum((states == 1).sum(axis=1), ((states == 2) | (states == 3)).sum(axis=1))
        )
    )


def mark(axes, time, words):
    axes.axvline(time, color="#d1495b", linewidth=1.2)
    begin, end = axes.dataLim.intervalx
    room = time - begin > (end - begin) / 4  # space for the text left of the line
    axes.annotate(
        words,
        (time, 0.96),
        xycoords=("data", "axes fraction"),
        xytext=(-4 if room else 4, 0),
        textcoords="offset points",
        ha="right" if room else "left",
        va="top",
        fontsize=8,
        color="#d1495b",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1},
    )


def trial_picture(title, scene, sensor, draw_reading, *, draw_pad=None, trial=0):
    record = slipbench.Scene.load(SCENES / scene).run(trial=trial)
    pad = record.sensors[sensor]
    states = record.labels[pad.name].unit_state
    at = mixed(states)
    picture, left, reading, shares = figure(f"{title} ({scene})")
    if draw_pad:
        draw_pad(left, record, pad, at)
    else:
        draw_units(left, record.labels[pad.name].unit_positions, states[at], 3000 / len(states[at]))
        left.set_title(f"pad at {pad.t[at]:.2f} s", fontsize=9)
    draw_reading(reading, record, pad)
    mark(
        reading,
        record.outcome.get("judged_slip_time_s") or record.outcome["first_slip_time_s"],
        "slip begins",
    )
    draw_shares(shares, pad.t, states)
    return picture


def tangential(axes, record, pad):
    axes.plot(pad.t, np.linalg.norm(record.labels[pad.name].force[:, :, :2], axis=2), linewidth=1)
    axes.set_ylabel("tangential force\nof a pillar (N)")


def whole(axes, record, pad):
    axes.plot(pad.t, np.linalg.norm(record.labels[pad.name].force[:, :, :2].sum(axis=1), axis=1))
    axes.set_ylabel("tangential\nforce (N)")


def counts(channel, words):
    def draw(axes, _, pad):
        time = pad.channel_time.get(channel, pad.t)
        values = pad.channels[channel].reshape(len(time), -1)
        axes.plot(time, values[:, np.argsort(-np.ptp(values, axis=0))[:6]], linewidth=0.8)
        axes.set_ylabel(f"{words}\n(counts)")

    return draw


def image(axes, _, pad, at):
    shown = axes.imshow(pad.channels["taxels"][at], cmap="viridis", origin="lower")
    axes.set_title(f"taxels at {pad.t[at]:.2f} s", fontsize=9)
    axes.figure.colorbar(shown, ax=axes, shrink=0.6, label="counts")


def closer(axes, record, pad, _):
    onset = record.labels[pad.name].onset_time[0]
    chosen = abs(pad.t - onset) < 0.03
    axes.plot(1000 * (pad.t[chosen] - onset), pad.channels["signal"][chosen, 0], linewidth=0.8)
    axes.axvline(0, color="#d1495b", linewidth=1.2)
    axes.set(xlabel="time after slip (ms)", ylabel="signal (counts)")


def markers(axes, record, pad, at):
    draw_units(
        axes, record.labels[pad.name].unit_positions, record.labels[pad.name].unit_state[at], 30
    )
    places, moved = pad.channels["pixel"][0], 1000 * pad.channels["displacement"][at]
    scale = 16.0 / np.ptp(places[:, 0])  # mm per pixel: nine markers span 16 mm
    axes.quiver(
        scale * (places[:, 0] - 160),
        scale * (120 - places[:, 1]),
        *moved.T[:2],
        angles="xy",
        scale_units="xy",
        scale=0.2,
        width=0.012,
        zorder=3,
    )
    axes.set_title("markers' motion, five-fold", fontsize=9)
    axes.set(xlim=(-7, 7), ylim=(-7, 7))


def grip(axes, record, _):
    axes.plot(record.control.t, record.control.grip_force, label="grip force (N)")
    box = record.bodies["box"]
    axes.plot(box.t, 100 * (box.pose[:, 2] - box.pose[0, 2]), label="height (cm)")
    axes.legend(fontsize=8, loc="center right")


def speed(axes, record, pad):
    body = record.bodies[pad.name]
    axes.plot(body.t, np.linalg.norm(body.velocity[:, :2], axis=1))
    axes.set_ylabel("speed (m/s)")


def soft_skin():
    """soft_skin/sphere.yaml half way to sliding, and its force compared with Cattaneo and Mindlin's law."""
    scene = slipbench.Scene.load(SCENES / "soft_skin/sphere.yaml")
    record = scene.run()
    pad = record.sensors["skin"]
    radius, depth, friction, modulus = 40.0, 0.15, 0.8, 0.15  # mm, N/mm^2: values of the scene
    reach = np.sqrt(radius * depth)
    load = 16 / 3 * modulus * np.sqrt(radius) * depth**1.5
    slides = (
        9 * friction * load / (32 * modulus * reach)
    )  # mm, displacement at which the whole contact slides
    body = record.bodies["pad"]
    way = 1000 * np.interp(pad.t, body.t, body.pose[:, 0])
    there = slice(np.argmax(way > 0), np.argmax(way))
    picture, left, reading, shares = figure(
        "A sphere is pushed along a soft skin (soft_skin/sphere.yaml)"
    )
    at = there.start + np.argmax(way[there] > 0.6 * slides)
    draw_units(
        left,
        record.labels[pad.name].unit_positions,
        record.labels[pad.name].unit_state[at],
        3000 / 256,
    )
    angle, stuck = np.linspace(0, 2 * np.pi, 100), reach * np.sqrt(0.4)
    left.plot(stuck * np.cos(angle), stuck * np.sin(angle), color="black", linewidth=1)
    left.set_title("at 0.6 of the way; line: theory", fontsize=9)
    reading.plot(
        pad.t[there],
        np.linalg.norm(record.labels[pad.name].force[there, :, :2].sum(axis=1), axis=1),
        label="tangential force (N)",
    )
    reading.plot(
        pad.t[there],
        friction * load * (1 - np.clip(1 - way[there] / slides, 0, 1) ** 1.5),
        "k--",
        linewidth=1,
        label="theory",
    )
    reading.legend(fontsize=8, loc="lower right")
    draw_shares(shares, pad.t[there], record.labels[pad.name].unit_state[there])
    return picture


def benchmark():
    """Draws the truth of one recording of each sensor."""
    picture, axes = plt.subplots(5, figsize=(7, 3), dpi=100, layout="constrained")
    picture.suptitle(
        "What slip detectors are judged by: the truth of one recording a sensor (benchmark/slip-4)",
        fontsize=10,
    )
    for axis, name in zip(
        axes, ("papillarray", "nib_pad", "piezo_skin", "myrmex", "gel_markers"), strict=True
    ):
        record = slipbench.Scene.load(SCENES / f"benchmark/slip-4/open_{name}.yaml").run(
            trial=1
        )  # odd ones slip
        pad = next(iter(record.sensors.values()))
        axis.imshow(
            record.labels[pad.name].state[None],
            aspect="auto",
            cmap=ListedColormap(PAD_COLOURS),
            vmin=0,
            vmax=3,
            interpolation="nearest",
            extent=(pad.t[0], pad.t[-1], 0, 1),
        )
        axis.set_yticks([])
        axis.set_ylabel(name, rotation=0, ha="right", va="center", fontsize=9)
        axis.tick_params(labelsize=7)
    axes[-1].set_xlabel("time (s)")
    explain(picture, PAD_STATES, PAD_COLOURS)
    return picture


def plain_mujoco():
    """hold.xml in the package mujoco: the fingers open slowly."""
    model = mujoco.MjModel.from_xml_path(str(SCENES / "mujoco/hold.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("grasped").id)
    pad = slipbench.mujoco.pads(model)["left"]
    time, forces, states = [], [], []
    while data.time < 1.5:
        data.ctrl[:] = 4.0 - 3.2 * max(0.0, data.time - 0.5)
        mujoco.mj_step(model, data)
        read = pad.read(data)
        (
            time.append(data.time),
            forces.append(np.array(read.force)),
            states.append(np.array(read.unit_state, dtype=int).ravel()),
        )
    time, forces, states = np.array(time), np.array(forces), np.array(states)
    at = mixed(states)
    places = 0.007 * np.stack(np.meshgrid((1, 0, -1), (1, 0, -1)), axis=-1).reshape(-1, 2)
    picture, left, reading, shares = figure(
        "Two pads in plain MuJoCo let a box slip (mujoco/hold.xml)"
    )
    draw_units(left, places, states[at], 330)
    left.set_title(f"left pad at {time[at]:.2f} s", fontsize=9)
    reading.plot(time, forces[:, :, 2].sum(axis=1), label="normal force (N)")
    reading.plot(
        time, np.linalg.norm(forces[:, :, :2].sum(axis=1), axis=1), label="tangential force (N)"
    )
    reading.legend(fontsize=8, loc="center left")
    mark(reading, time[np.argmax((states == 2).any(axis=1))], "slip begins")
    draw_shares(shares, time, states)
    return picture


PICTURES = {
    "benchmark": benchmark,
    "biotac_sp": lambda: trial_picture(
        "BioTac SP slides and turns",
        "biotac_sp/slip.yaml",
        "pad",
        counts("electrodes", "six electrodes"),
    ),
    "bodies": lambda: trial_picture(
        "A block on a pad comes to rest", "bodies/sliding_block.yaml", "sole", speed
    ),
    "gel_markers": lambda: trial_picture(
        "A sphere is dragged over a gel with markers",
        "gel_markers/gelsight_mini.yaml",
        "gel",
        whole,
        draw_pad=markers,
    ),
    "grasp": lambda: trial_picture("A gripper lifts a box", "grasp/lift.yaml", "pad", grip),
    "magnetic_skin": lambda: trial_picture(
        "A ball drags a magnetic skin",
        "magnetic_skin/uskin.yaml",
        "skin",
        counts("counts", "six axes"),
    ),
    "mujoco": plain_mujoco,
    "myrmex": lambda: trial_picture(
        "Two arms let an object slip", "myrmex/slip.yaml", "left", whole, draw_pad=image
    ),
    "nib_pad": lambda: trial_picture(
        "A plate turns under a nib pad",
        "nib_pad/rotational.yaml",
        "pad",
        counts("fr", "two clusters"),
    ),
    "papillarray": lambda: trial_picture(
        "Press and slide of nine pillars", "papillarray/stage.yaml", "pad", tangential
    ),
    "piezo_skin": lambda: trial_picture(
        "A tip slides over a piezoelectric skin",
        "piezo_skin/slide.yaml",
        "pad",
        counts("signal", "signal"),
        draw_pad=closer,
    ),
    "learn": lambda: trial_picture(
        "A BioTac SP waits, then slides",
        "learn/biotac_sp.yaml",
        "pad",
        counts("electrodes", "six electrodes"),
        trial=760,
    ),
    "soft_skin": soft_skin,
}


def main(folder):
    matplotlib.use("Agg")
    for name, draw in PICTURES.items():
        place = folder / name / "gallery.png"
        place.parent.mkdir(parents=True, exist_ok=True)
        picture = draw()
        picture.canvas.draw()
        Image.fromarray(np.asarray(picture.canvas.buffer_rgba())).convert("RGB").quantize(256).save(
            place, optimize=True
        )
        plt.close(picture)
        print(place)


if __name__ == "__main__":
    if any(word.startswith("-") for word in sys.argv[1:]) or len(sys.argv) > 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else SCENES)
