"""What `slipbench export` writes in Python: `python -m slipbench._export REQUEST` (see `Request`). The program starts it once it has checked the dataset."""
