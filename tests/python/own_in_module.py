"""A detector in a separate module, which a worker process can import."""

import slipbench


@slipbench.detector("mine_in_a_module")
class Mine:
    """Alarms at each fiftieth frame."""

    def __init__(self, source):
        self.frames = 0

    def update(self, frame):
        self.frames += 1
        return slipbench.State.GROSS if self.frames % 50 == 0 else slipbench.State.NON_SLIP
