"""Formats of `slipbench export` that are written in Python: `python -m slipbench._export FILE`,
where FILE holds the `Request`. The program starts it after checking the dataset."""
