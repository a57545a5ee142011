"""Table II of the piezo paper: the FFT-GRU by the band of its spectrum."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from slipbench_studies.piezo_fft_gru.bench import BENCH_LEVEL, RULES, spectra_of
from slipbench_studies.piezo_fft_gru.networks import (
    GRU_32,
    SOURCE,
    USUAL_RECORDINGS,
    Validations,
    figures_of,
    on_all,
    on_slip,
    recordings_for,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, Result, Table

NAME = "piezo-fft-gru/table2"
# Hz, first and last bin: published F1 and accuracy in %.
BANDS = {
    (0, 5000): (0.9589, 97.40),
    (0, 600): (0.9777, 98.67),
    (50, 400): (0.9769, 98.40),
    (50, 450): (0.9784, 98.80),
    (50, 500): (0.9783, 98.79),
    (50, 600): (0.9782, 98.74),
    (50, 1000): (0.9774, 98.63),
}
FEW = ((0, 5000), (0, 600), (50, 400), (50, 600))


def study(options: Options) -> Result:
    """piezo-fft-gru/table2.

    Args:
        options: data, trials, full, seed, jobs, output, resume

    Returns:
        accuracy and F1 of each band

    Raises:
        InputError: as size_of() and recordings_for(), or for saved networks of another run
    """
    size = size_of(options, USUAL_RECORDINGS)
    bands = list(BANDS) if options.full else list(FEW)
    rules = list(RULES) if options.full else ["paper"]
    recordings = recordings_for(options, size, [BENCH_LEVEL], [spectra_of(*band) for band in bands])
    validations = Validations(options, size)
    rows = [
        replace(
            GRU_32,
            name=f"{low}-{high}",
            text=f"{low} to {high} Hz",
            input=number,
            f1=BANDS[low, high][0],
            accuracy=BANDS[low, high][1],
        )
        for number, (low, high) in enumerate(bands)
    ]
    asked = [
        {rule: validations.queue_folds(recordings, row, rule) for rule in rules} for row in rows
    ]
    validations.run(NAME)

    table = Table(
        "Table II: GRU 32",
        [
            "band",
            "bins",
            "paper",
            *(name for rule in rules for name in (f"{RULES[rule]} label: all", "with contact")),
        ],
    )
    figures: dict[str, dict[str, Any]] = {RULES[rule]: {} for rule in rules}
    for row, numbers in zip(rows, asked, strict=True):
        cells = []
        for rule, number in numbers.items():
            counts = validations.counts(number)
            cells += [on_all(counts).cell(), on_slip(counts).cell()]
            figures[RULES[rule]][row.name] = figures_of(counts)
        table.rows.append(
            [
                row.text,
                str(recordings[0].inputs[row.input].features.shape[1]),
                row.published(),
                *cells,
            ]
        )
    return Result(
        title="The FFT-GRU by the band of its spectrum",
        source=f"Table II of {SOURCE}",
        figures=figures,
        tables=[table],
        setup=[
            *setup_of(options, size, len(recordings)),
            *([] if options.full else ["`--full` has all seven bands, and the true label."]),
        ],
    )
