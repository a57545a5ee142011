"""What `slipbench export` writes in Python: `python -m slipbench._export FILE`, where FILE has the `Request`. The program starts it once it has checked the dataset."""
