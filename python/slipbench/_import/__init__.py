"""Readers of `slipbench import --map`: `python -m slipbench._import REQUEST`, started by the program."""
