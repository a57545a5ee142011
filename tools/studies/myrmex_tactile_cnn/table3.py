"""Table 3 of the Myrmex paper.

Confusion of nets 1 to 3 from 62.5 Hz, with ten folds by window, and by trial.
"""

from __future__ import annotations

from slipbench_studies.grid import check_only, chosen
from slipbench_studies.myrmex_tactile_cnn.bench import SOURCE
from slipbench_studies.myrmex_tactile_cnn.networks import (
    KINDS,
    TRIAL_FOLDS,
    Validations,
    network_row,
    percent,
    run_trials,
    setup_of,
    share,
    size_of,
)
from slipbench_studies.result import Options, Result, Table

NAME = "myrmex-tactile-cnn/table3"
WINDOW_FOLDS = 10  # the paper's
# [true][called] %
PUBLISHED = {
    1: ((90.79, 5.83, 3.38), (2.13, 92.58, 5.29), (2.15, 3.17, 94.68)),
    2: ((95.73, 2.54, 1.73), (1.26, 96.37, 2.37), (0.97, 1.56, 97.47)),
    3: ((97.57, 1.41, 1.02), (0.68, 97.73, 1.58), (0.51, 0.93, 98.56)),
}


def study(options: Options) -> Result:
    """myrmex-tactile-cnn/table3.

    Args:
        options: trials, only, full, seed, jobs, output, resume

    Returns:
        confusion of stable, translation and rotation

    Raises:
        InputError: for an unknown name of --only, too few trials, or saved networks of another run
    """
    size = size_of(options)
    rows = {row.name: row for row in (network_row(net, "high_pass") for net in PUBLISHED)}
    check_only(options.only, list(rows))
    rows = {name: rows[name] for name in chosen(list(rows), options.only)}
    trials = run_trials(options, size)
    validations = Validations(options, size, trials)
    asked = {
        name: (
            validations.queue(row, "window", WINDOW_FOLDS, WINDOW_FOLDS),
            validations.queue(row, "trial", TRIAL_FOLDS, TRIAL_FOLDS),
        )
        for name, row in rows.items()
    }
    validations.run(NAME)

    tables, figures = [], {}
    for name, row in rows.items():
        counts = [validations.figures(number).all for number in asked[name]]
        table = Table(
            f"{row.text}: share of the true class in %",
            [
                "true",
                *(
                    f"{where}: called {kind}"
                    for where in ("paper", "by window", "by trial")
                    for kind in KINDS
                ),
            ],
        )
        for label, kind in enumerate(KINDS):
            ours = [
                percent(share(one, label, called)) for one in counts for called in range(len(KINDS))
            ]
            table.rows.append([kind, *(f"{one:.1f}" for one in PUBLISHED[row.net][label]), *ours])
        tables.append(table)
        figures[name] = {"by_window": counts[0], "by_trial": counts[1]}
    return Result(
        title="Networks of the Myrmex array: confusion of the classes",
        source=f"Table 3 of {SOURCE}",
        figures=figures,
        tables=tables,
        setup=setup_of(options, size, trials),
        remarks=[
            'By window: ten folds, the test set is every tenth window of each class in turn. The ten chunks of the paper are "stored in an alternating'
            ' fashion", and it does not state how its windows are distributed over them.'
        ],
    )
