"""What `slipbench import --map` reads in Python: `python -m slipbench._import REQUEST`, started by the program."""
