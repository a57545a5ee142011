"""A detector in a module of its own, as a worker process can import it."""

import slipbench


@slipbench.detector("mine_in_a_module")
class Mine:
    """Alarms at each fiftieth frame."""

    def __init__(self, source):
        self.frames = 0

    def update(self, frame):
        self.frames += 1
        return slipbench.State.GROSS if self.frames % 50 == 0 else slipbench.State.NON_SLIP
