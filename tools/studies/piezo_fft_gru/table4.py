"""Table IV of the piezo paper.

Training with and without recordings of motors only, by the motors' vibration.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from slipbench import InputError
from slipbench_studies.grid import check_only
from slipbench_studies.piezo_fft_gru.bench import BENCH_LEVEL, PUBLISHED_SPECTRA, RULES, Recording
from slipbench_studies.piezo_fft_gru.networks import (
    GRU_32,
    MLP_32,
    SOURCE,
    Row,
    Validations,
    figures_of,
    on_all,
    on_slip,
    recordings_for,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, Result, Table

NAME = "piezo-fft-gru/table4"
USUAL_RECORDINGS = 120  # per level
LEVELS = (0.0, 0.5, 1.0, BENCH_LEVEL, 4.0, 8.0)
NO_LEVEL = "as recorded"  # for a dataset without swept levels
STEPS = 400  # of the MLP, per level
# The paper's bench as assumed: only the motors that move the tip run.
GRU_32_TIP = replace(GRU_32, name="gru_32_tip", text=f"{GRU_32.text}, no motor but the tip's")
MLP_32_OF_LEVELS = replace(MLP_32, training=replace(MLP_32.training, steps=STEPS))

Levels = Mapping[str, list[Recording]]


def level_name(level: float) -> str:
    """Name of a level in the tables: 2.0 is "2".

    A negative level means a dataset without levels.
    """
    return NO_LEVEL if level < 0.0 else repr(level).removesuffix(".0")


def by_level(recordings: Iterable[Recording]) -> Levels:
    """Recordings by the name of their level, ascending; those without a level first."""
    levels: dict[float, list[Recording]] = {}
    for one in recordings:
        levels.setdefault(-1.0 if math.isnan(one.level) else one.level, []).append(one)
    return {level_name(level): levels[level] for level in sorted(levels)}


@dataclass(frozen=True)
class Point:
    """A network at one level.

    Attributes:
        row: the network
        rule: name of a rule in RULES
        level: name of the level
        both: number of the validation with training on all recordings
        slip_alone: number of the validation with training on recordings with contact only
    """

    row: Row
    rule: str
    level: str
    both: int
    slip_alone: int

    def cells(self, validations: Validations) -> list[str]:
        """The label, and the cells of begun_table()."""
        both, alone = validations.counts(self.both), validations.counts(self.slip_alone)
        gap = on_all(alone).accuracy[0] - on_slip(alone).accuracy[0]
        found = (on_all(both), on_slip(both), on_all(alone), on_slip(alone))
        return [RULES[self.rule], *(one.cell() for one in found), f"{gap:+.1f}"]


def begun_table(title: str, first: str) -> Table:
    """A table whose first column is named `first`."""
    return Table(
        title,
        [
            first,
            "label",
            "learnt slip + noise: on slip + noise",
            "on slip",
            "learnt slip: on slip + noise",
            "on slip",
            "slip to slip + noise",
        ],
    )


def wanted(options: Options, row: Row) -> bool:
    """True if the options ask for a network."""
    return not options.only or row.name in options.only


def chosen(
    options: Options, tip: list[Recording], levels: Levels, bench: str
) -> Iterator[tuple[Row, str, str, list[Recording]]]:
    """Network, rule, name of the level and recordings of each validation.

    Args:
        options: only, full
        tip: recordings in which only the motors of the tip run; may be empty
        levels: recordings by the name of their level
        bench: name of the bench's level
    """
    for row, recordings in ((GRU_32_TIP, tip), (GRU_32, levels[bench])):
        for rule in RULES if recordings and wanted(options, row) else ():
            yield row, rule, bench, recordings
    for rule in RULES if wanted(options, MLP_32) else ():
        for level, recordings in levels.items():
            if options.full or rule == "paper" or level == bench:
                yield MLP_32_OF_LEVELS, rule, level, recordings


def queued(
    validations: Validations, row: Row, rule: str, level: str, recordings: list[Recording]
) -> Point:
    """Queues the validations of a network at one level."""
    both = validations.queue_folds(recordings, row, rule)
    alone = validations.queue_folds(recordings, row, rule, slip_alone=True)
    return Point(row, rule, level, both, alone)


def tables_of(
    points: list[Point], bench: str, validations: Validations
) -> tuple[Table, Table, dict[str, dict[str, dict[str, Any]]]]:
    """The table at the level `bench`, the curve against the level, and the figures of both."""
    table = begun_table(f"Table IV: motor level {bench}", "network")
    table.rows.append(
        [
            "paper, GRU 32",
            "position",
            "98.5, 0.974",
            "98.2, 0.977",
            "86.5, 0.678",
            "98.6, 0.983",
            "-12.1",
        ]
    )
    curve = begun_table("MLP 32 against the motors' level", "motor level")
    figures: dict[str, dict[str, dict[str, Any]]] = {}
    for point in points:
        cells = point.cells(validations)
        if point.level == bench:
            table.rows.append([point.row.text, *cells])
        if point.row.name == MLP_32.name:
            curve.rows.append([point.level, *cells])
        both, alone = (
            figures_of(validations.counts(number)) for number in (point.both, point.slip_alone)
        )
        of_row = figures.setdefault(RULES[point.rule], {}).setdefault(point.row.name, {})
        of_row[point.level] = {"slip_and_noise": both, "slip": alone}
    return table, curve, figures


def study(options: Options) -> Result:
    """piezo-fft-gru/table4.

    Args:
        options: data, trials, only, full, seed, jobs, output, resume

    Returns:
        accuracy and F1 of networks trained with and without recordings of motors only

    Raises:
        InputError: for an unknown name of --only, as size_of() and recordings_for(), or for saved
            networks of another run
    """
    size = size_of(options, USUAL_RECORDINGS)
    check_only(options.only, [GRU_32_TIP.name, GRU_32.name, MLP_32.name])
    if options.data and GRU_32_TIP.name in options.only:
        raise InputError(
            f"reproduce: --only {GRU_32_TIP.name} needs its own recordings; leave --data out"
        )

    levels = by_level(recordings_for(options, size, LEVELS, [PUBLISHED_SPECTRA]))
    bench = level_name(BENCH_LEVEL) if level_name(BENCH_LEVEL) in levels else next(iter(levels))
    # A dataset keeps the motors of its recording.
    tip: list[Recording] = []
    if wanted(options, GRU_32_TIP) and not options.data:
        tip = recordings_for(options, size, [BENCH_LEVEL], [PUBLISHED_SPECTRA], others_too=False)
    validations = Validations(options, size)
    points = [
        queued(validations, row, rule, level, recordings)
        for row, rule, level, recordings in chosen(options, tip, levels, bench)
    ]
    validations.run(NAME)
    table, curve, figures = tables_of(points, bench, validations)
    heard = (
        "In half of the recordings with contact a motor runs that does not move the tip, so the training set of a network trained only on slip also "
        "contains motors without a slip."
    )
    return Result(
        title="Networks of the piezoelectric skin trained with and without recordings of motors alone",
        source=f"Table IV of {SOURCE}",
        figures=figures,
        tables=[table, curve] if curve.rows else [table],
        setup=[
            *setup_of(options, size, len(levels[bench])),
            f"The number of recordings is that of each level; the MLP has {STEPS} steps.",
            *(
                []
                if options.full
                else [
                    "With the true label it is trained at one level; with `--full` at all levels."
                ]
            ),
        ],
        remarks=[
            "As here, the noise in the paper comes from the motors that move its tip. It does not state their level; the curve shows its effect.",
            heard + (' The row "no motor but the tip\'s" does not contain it.' if tip else ""),
        ],
    )
