"""The formats of `slipbench export` that are written in Python: `python -m slipbench._export FILE`, where FILE has the `Request`. The program starts it once it has checked the dataset."""
