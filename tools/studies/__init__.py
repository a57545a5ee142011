"""Reproduces tables of papers: started by `slipbench reproduce PAPER/TABLE`.

There is one folder per paper and one module per table. The module of `nib-reconfigurable/table3` is
`slipbench_studies.nib_reconfigurable.table3`, and its function `study(options)` returns a `Result`
(result.py). Shared modules are in this folder: grid.py runs scenes, statistics.py computes
intervals, page.py and text.py show a result.
"""
