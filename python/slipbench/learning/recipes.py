"""Recipes: networks with their input, training data and training.

`assumed` states values that the paper does not give.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import torch
from torch import Tensor, nn

from slipbench.bin import _core
from slipbench.learning import networks
from slipbench.learning._fit import Training
from slipbench.learning._input import Input
from slipbench.learning.biotac import IMAGES, drawn_graph, pixels_of

ROUNDING_DENSITY = (
    1 / 12 / (0.5 * 10e3)
)  # counts^2/Hz of the piezo skin's rounding to whole counts: finite in silence


@dataclass(frozen=True)
class Recipe:
    """A network with its input, its labels and its training.

    `dataclasses.replace` creates a custom recipe.

    Attributes:
        name: as in `train --recipe`
        summary: one line for lists
        source: paper, section, table
        assumed: values that the paper does not give, with the choice made
        input: input of the network
        network: creates the module from the numbers of values per frame and of classes
        training: parameters of the training
        scaling: of features: "standard" (mean 0, deviation 1 of each), "common" (one mean and
            deviation for all), "range" (0 to 1 of each), "none"
        members: number of networks whose probabilities are averaged, with consecutive seeds
        classes: "slip", "kind" or "direction" (`read_examples`)
        labels: rule of the labels (`read_examples`)
        split: property that differs between training and test: "trial", "material", "object" or
            "speed"
        at_most: maximum number of drawn frames per class and trial; 0: all
        turned: number of copies of each trial of an image sensor with turned images
    """

    name: str
    summary: str
    source: str
    assumed: str
    input: Input
    network: Callable[[int, int], nn.Module]
    training: Training
    scaling: str = "standard"
    members: int = 1
    classes: str = "slip"
    labels: str = "micro"
    split: str = "trial"
    at_most: int = 0
    turned: int = 0


SLIP_TRAINING = Training(
    steps=3000,
    batch=64,
    clip=150,
    learning_rate=3e-3,
    final_rate=0.02,
    validate_every=150,
    onset_frames=20,
)


def either_sign(clips: Tensor, generator: torch.Generator) -> Tensor:
    """Each clip, or with even odds its opposite, as if all forces were reversed."""
    signed: Tensor = clips.mul(
        torch.randint(2, (len(clips), 1, 1), generator=generator).mul(2).sub(1)
    )
    return signed


def _slip(
    name: str,
    summary: str,
    frames: Input,
    network: Callable[[int, int], nn.Module],
    training: Training = SLIP_TRAINING,
    scaling: str = "standard",
    members: int = 1,
    labels: str = "tightened",
) -> Recipe:
    """A recipe of scenes/learn: slip while a part of a unit slips, or by another rule."""
    return Recipe(
        name,
        summary,
        "none published: for scenes/learn, where device, load, friction and motion differ from trial to trial",
        "all of it; on a stage frames that stick again after a slip are left out of the training, except by the rule slides; Adam at 3e-3",
        frames,
        network,
        training,
        scaling,
        members,
        labels=labels,
    )


def _piezo() -> list[Recipe]:
    """Recipes with the paper's clips of 128 frames.

    Its RMSProp at 8e-4 needs thousands of steps for the result of Adam at a greater rate after
    hundreds.
    """
    signal = Input(sensor="piezo_skin", rate=10e3, channels=["signal"], stride=100)
    spectra = replace(
        signal,
        window=200,
        centre=True,
        transform="log_psd",
        low=50.0,
        high=600.0,
        floor=ROUNDING_DENSITY,
    )

    def recipe(
        name: str,
        summary: str,
        row: str,
        network: Callable[[int, int], nn.Module],
        steps: int,
        batch: int,
        rate: float,
        frames: Input = spectra,
    ) -> Recipe:
        return Recipe(
            name,
            summary,
            f"Piezoelectric skin, FFT-GRU slip detection: Ayral et al., IEEE/ASME AIM 2023, sections IV.A and IV.B, Table I: {row}",
            "four layers, which give the numbers of parameters printed; weights of classes in place of balanced drawing, no label smoothing, no penalty "
            "of changes; steps of Adam, whose rate falls to a fiftieth, in place of 200 epochs of RMSProp at 8e-4",
            frames,
            network,
            Training(
                steps=steps,
                batch=batch,
                clip=128,
                learning_rate=rate,
                final_rate=0.02,
                validate_every=steps // 20,
            ),
            labels="paper",
        )

    return [
        recipe(
            "piezo_mlp",
            "Single spectra of 20 ms through four layers of 32",
            "MLP 32",
            partial(networks.PiezoMlp, width=32),
            1000,
            64,
            1e-2,
        ),
        recipe(
            "piezo_mlp_128",
            "Single spectra of 20 ms through four layers of 128",
            "MLP 128",
            partial(networks.PiezoMlp, width=128),
            500,
            64,
            3e-3,
        ),
        recipe(
            "piezo_tcn",
            "The latest 29 spectra through four causal convolutions of 128, kernel 8",
            "TCN 128, kernel 8",
            networks.PiezoTcn,
            800,
            16,
            1e-3,
        ),
        recipe(
            "piezo_fft_gru",
            "Spectra of 20 ms, one after the other, through four GRUs of 32",
            "FFT GRU 32",
            networks.PiezoGru,
            300,
            64,
            4e-3,
        ),
        recipe(
            "piezo_raw_gru",
            "The signal at 100 Hz through four GRUs of 32",
            "raw GRU 32",
            networks.PiezoGru,
            300,
            64,
            4e-3,
            signal,
        ),
        _slip(
            "piezo_slip",
            "The level of the signal, its changes and its spectrum in 20 ms, through two GRUs at 100 Hz",
            frames=replace(signal, window=200),
            network=networks.PiezoSlip,
            scaling="common",
        ),
        _slip(
            "piezo_force",
            "How the force on the skin continues or breaks off over 5 to 160 ms, and its spectrum, through a GRU at 200 Hz",
            frames=replace(signal, window=50, stride=50),
            network=networks.PiezoForce,
            scaling="none",
            training=replace(
                SLIP_TRAINING,
                steps=2400,
                batch=48,
                clip=200,
                validate_every=400,
                onset_frames=40,
                augment=either_sign,
            ),
        ),
        _slip(
            "piezo_grasp",
            "Level of the signal and its changes over 2 to 100 ms, through two GRUs at 100 Hz",
            frames=replace(
                signal, window=100, transform="levels", spans=(20, 100, 300, 1000), floor=3.0
            ),
            network=partial(networks.FrameGru, layers=2),
        ),
    ]


def _papillarray() -> list[Recipe]:
    outer = [value for pillar in (0, 1, 2, 3, 5, 6, 7, 8) for value in (3 * pillar, 3 * pillar + 1)]
    one = Recipe(
        "papillarray_gru",
        "Tangential forces of the eight outer pillars, 40 ms at a time, through a GRU",
        "RedmondLabUCD/Incipient-Slip-Detection-PapillArray: its network, its median filter of 21 rows and its stacks of 40 rows at 1 kHz",
        "Adam, rate, steps and batch; weights of classes; the label latched until contact is lost, since after a brake true slip ends under full shear",
        Input(
            sensor="papillarray",
            rate=1000.0,
            channels={"force": outer},
            median=21,
            window=40,
            stride=40,
        ),
        networks.PapillarrayGru,
        Training(steps=300, batch=64, clip=9, learning_rate=1e-3, validate_every=15, patience=8),
        scaling="common",
        labels="latched",
    )
    spans = (10, 20, 40, 80, 160)
    return [
        one,
        replace(
            one,
            name="papillarray_gru5",
            summary="Five networks of papillarray_gru, whose probabilities are averaged in one graph",
            members=5,
        ),
        Recipe(
            "grasp_gru",
            "Forces and displacements of all nine pillars at 100 Hz through a GRU: slip in a grasp",
            "none published: for scenes/grasp, where the published detector detects almost no slip",
            "all of it; the label is the truth, so that slip ends when the grip holds again, and tightening stops",
            Input(sensor="papillarray", rate=100.0, channels=["force", "displacement"]),
            networks.FrameGru,
            Training(steps=600, batch=32, clip=100, learning_rate=3e-3, validate_every=30),
        ),
        _slip(
            "slip_gru",
            "Any sensor: axes of each unit, their ratio and rates through shared weights, pooled, through a GRU",
            frames=Input(
                sensor="papillarray",
                rate=1000.0,
                channels=["force"],
                window=10,
                stride=10,
                transform="units",
                spans=spans,
                floor=1e-3,
            ),
            network=partial(networks.SlipGru, features=2 + 3 * len(spans)),
            scaling="common",
            training=Training(
                steps=5000,
                batch=32,
                clip=150,
                learning_rate=3e-3,
                validate_every=250,
                onset_frames=20,
            ),
        ),
        _slip(
            "papillarray_slip",
            "Departure of the pillars from a rigid motion over 10 to 300 ms, through a GRU at 100 Hz",
            frames=Input(sensor="papillarray", rate=1000.0, channels=["displacement"], stride=10),
            network=partial(
                networks.RigidSlip, columns=3, rows=3, upwards=True, lags=(1, 3, 10, 30), noise=2e-6
            ),
            scaling="none",
            training=replace(SLIP_TRAINING, steps=3000),
        ),
    ]


def _taxels() -> list[Recipe]:
    # The forces of taxels that lean like springs are proportional to displacements.
    return [
        _slip(
            "taxels_slip",
            "Departure of the forces of a grid of 4 x 4 taxels from a rigid motion over 10 to 300 ms, through a GRU at 100 Hz",
            frames=Input(sensor="taxels", rate=200.0, channels=["force"], stride=2),
            network=partial(networks.RigidSlip, columns=4, rows=4, lags=(1, 3, 10, 30), noise=5e-3),
            scaling="none",
            training=replace(SLIP_TRAINING, steps=4000),
        )
    ]


def _magnetic_skin() -> list[Recipe]:
    # 33 Hz: a recorded uSkin has 34 to 41 Hz, and new values at 9.6 Hz only.
    return [
        _slip(
            "skin_slip",
            "Departure of a magnetic skin's readings from a common change over 0.1 to 0.6 s, through a GRU at 33 Hz",
            frames=Input(sensor="magnetic_skin", rate=100.0, channels=["field"], stride=3),
            network=partial(networks.SkinSlip, lags=(3, 6, 10, 20), noise=5.0),
            scaling="none",
            training=replace(
                SLIP_TRAINING,
                steps=500,
                batch=32,
                clip=100,
                label_smoothing=0.05,
                validate_every=75,
                onset_frames=0,
            ),
            labels="slides",
        )
    ]


def _myrmex() -> list[Recipe]:
    inner = [row * 16 + column for row in range(2, 14) for column in range(2, 14)]
    frames = Input(
        sensor="myrmex",
        rate=1000.0,
        channels={"taxels": inner},
        window=64,
        stride=8,
        transform="amplitude",
        low=0.0,
        high=31 * 1000 / 64,
    )

    def recipe(row: str, summary: str, convolutions: int, hidden: int) -> Recipe:
        return Recipe(
            "myrmex_" + row.replace(" ", ""),
            summary,
            f"Myrmex, slip classification by spectra and a CNN: Meier et al., ICANN 2016, section 4, Table 2: {row}",
            "32 and 32 channels, images padded by 1, Adam at 1e-3, 600 steps; stable, translation and rotation are the truth: of the rigid motion that "
            "fits the slip best, the part with more energy; at most 60 frames of a class and trial",
            frames,
            partial(networks.MyrmexCnn, convolutions=convolutions, hidden=hidden),
            Training(
                steps=600,
                batch=64,
                clip=1,
                learning_rate=1e-3,
                balance="drawing",
                validate_every=50,
            ),
            classes="kind",
            at_most=60,
        )

    return [
        recipe("net 1", "Spectra of 12 x 12 taxels through one convolution and 512 units", 1, 512),
        recipe("net 2", "Spectra of 12 x 12 taxels through two convolutions and 512 units", 2, 512),
        recipe(
            "net 3", "Spectra of 12 x 12 taxels through two convolutions and 1024 units", 2, 1024
        ),
    ]


def _nib() -> list[Recipe]:
    frames = Input(sensor="nib_pad", rate=300.0, channels=["si", "fl", "fr"], stride=3)
    return [
        _slip(
            "nib_slip",
            "Size and direction of the change of all electrodes over 0.1 and 0.3 s, through a GRU at 100 Hz",
            frames=replace(frames, window=3, transform="spreads", spans=(90, 30), floor=1.0),
            network=networks.FrameGru,
            training=replace(SLIP_TRAINING, steps=1500),
        ),
        _slip(
            "nib_rigid",
            "Departure of a nib pad's taxels from a rigid motion over 30 to 600 ms, through a GRU at 100 Hz",
            frames=frames,
            network=networks.NibRigid,
            scaling="none",
            training=replace(SLIP_TRAINING, steps=2000),
        ),
    ]


def _gel() -> list[Recipe]:
    return [
        _slip(
            "gel_slip",
            "Departure of a gel's markers from a rigid motion, at 25 Hz, through a GRU",
            frames=Input(sensor="gel_markers", rate=25.0, channels=["displacement"]),
            network=partial(networks.RigidSlip, columns=9, rows=7, lags=(1, 2), noise=1e-5),
            scaling="none",
            training=replace(
                SLIP_TRAINING, steps=4000, batch=32, clip=50, validate_every=250, onset_frames=8
            ),
        )
    ]


def _biotac() -> list[Recipe]:
    rows = Input(sensor="biotac_sp", rate=100.0, channels=["electrodes"])
    image = replace(rows, pixels=pixels_of(IMAGES["D1"]))
    training = Training(
        steps=600, batch=64, clip=1, learning_rate=1e-3, balance="drawing", validate_every=50
    )
    stability = "one finger and its own state, hold or slip, in each frame, since a file is the detector of one sensor; Adam at 1e-3, 600 steps of 64"
    direction = "the class is the commanded motion in each frame in contact, as each public recording is of one class; Adam at 1e-3"

    def recipe(
        name: str,
        summary: str,
        section: str,
        assumed: str,
        frames: Input,
        network: Callable[[int, int], nn.Module],
        classes: str = "slip",
        steps: int = 600,
    ) -> Recipe:
        return Recipe(
            name,
            summary,
            f"BioTac SP, grasp stability and direction of slip: Zapata-Impata et al., Robotics 8(4), 2019, {section}",
            assumed,
            frames,
            network,
            replace(training, steps=steps),
            scaling="range",
            classes=classes,
        )

    changes = replace(
        rows,
        window=2,
        channels=["electrodes", "pdc", "pac"],
        transform="levels",
        spans=(2, 4, 8, 30),
        floor=3.0,
        stride=1,
    )
    return [
        recipe(
            "biotac_cnn",
            "The electrodes as an image of 12 x 11 through a convolution of 32 and 1024 units",
            "section 5.1, Table 2",
            stability,
            image,
            networks.BiotacCnn,
        ),
        recipe(
            "biotac_gcn",
            "The electrodes as a graph through convolutions of 8, 8, 16, 16, 32 units",
            "section 5.1, Table 2 and Fig. 12",
            stability,
            rows,
            partial(networks.BiotacGcn, adjacency=drawn_graph()),
        ),
        recipe(
            "biotac_lstm",
            "Five rows at 100 Hz through five LSTMs of 32; direction of slip, seven classes",
            "section 5.2, Table 3",
            direction,
            rows,
            networks.BiotacLstm,
            "direction",
            1000,
        ),
        recipe(
            "biotac_convlstm",
            "Five images of 12 x 11 at 100 Hz through convolutional LSTMs; direction of slip, seven classes",
            "section 5.2, Table 3",
            f"{direction}; two layers of 8 filters, not five of 32, which take 30 times as long to train",
            image,
            networks.BiotacConvLstm,
            "direction",
            1000,
        ),
        Recipe(
            "biotac_gru",
            "Change and drift of each electrode over 0.1, 0.2 and 0.5 s, through a GRU at 20 Hz; direction of slip, seven classes",
            "none published: levels, by which devices differ, are not used; spreads in ascending order do not depend on where the finger is touched",
            "all of it; the label is touch until more than half of the contact slips, then the class of the commanded motion until contact is lost; Adam at 3e-3",
            replace(rows, window=10, stride=5, transform="spreads", spans=(10, 20, 50), floor=3.0),
            partial(networks.FrameGru, width=32),
            Training(
                steps=2400,
                batch=32,
                clip=30,
                learning_rate=3e-3,
                label_smoothing=0.1,
                validate_every=150,
            ),
            members=3,
            classes="direction",
            labels="latched",
        ),
        replace(
            _slip(
                "biotac_slip",
                "Size and course of the changes of the electrodes over 0.1 to 0.5 s, in any order, through a GRU at 20 Hz",
                frames=replace(rows, window=5, stride=5),
                network=networks.BiotacSlip,
                scaling="none",
                training=replace(
                    SLIP_TRAINING, steps=2000, batch=32, clip=30, validate_every=200, onset_frames=0
                ),
            ),
            labels="moved",
        ),
        _slip(
            "biotac_grasp",
            "Signed changes of each electrode and the pressure over 20 to 300 ms, through two GRUs at 100 Hz",
            frames=changes,
            network=networks.BiotacGrasp,
        ),
    ]


RECIPES: dict[str, Recipe] = {
    recipe.name: recipe
    for family in (
        _piezo(),
        _papillarray(),
        _taxels(),
        _magnetic_skin(),
        _myrmex(),
        _nib(),
        _gel(),
        _biotac(),
    )
    for recipe in family
}


def find_recipe(name: str) -> Recipe:
    """Returns a recipe by its name.

    Raises:
        InputError: an unknown name; the message has the nearest one
    """
    if name in RECIPES:
        return RECIPES[name]
    near: Sequence[str] = difflib.get_close_matches(name, RECIPES, 1)
    hint = f"did you mean {near[0]!r}?" if near else "allowed: " + ", ".join(RECIPES)
    raise _core.InputError(f"recipe: unknown {name!r}; {hint}")
