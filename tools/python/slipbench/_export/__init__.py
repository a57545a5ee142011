"""What `slipbench export` writes through Arrow: `python -m slipbench._export REQUEST` (see `Request`). The program starts it once it has checked the dataset."""
