"""Tables of papers beside ours, and what decides them: started by `slipbench reproduce PAPER/TABLE`.

A folder a paper, a module a table. The module of `nib-reconfigurable/table3` is `slipbench_studies.nib_reconfigurable.table3`, and its function
`study(options)` returns a `Result` (result.py). What several studies share stands beside this file: grid.py runs scenes, statistics.py has intervals,
page.py and text.py show a result.
"""
