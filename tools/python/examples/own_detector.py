"""A detector of one's own in the grasp loop, beside a shipped one and the oracle. Writes own_detector.png."""

from collections import Counter

import matplotlib.pyplot as plt
import numpy as np

import slipbench


@slipbench.detector("leaving_pillars")
class LeavingPillars:
    """A pillar slips once its share of tangential to normal force falls below a part of the greatest that it has shown."""

    parameters = {"part": 0.95, "touch": 0.1}  # touch [N]: a pillar that is pressed with less says nothing

    def __init__(self, source, part, touch):
        self.part, self.touch = part, touch
        self.greatest = np.zeros(source.shapes["force"][0])

    def update(self, frame):
        x, y, normal = frame["force"].T
        touching = normal > self.touch
        share = np.where(touching, np.hypot(x, y) / np.maximum(normal, self.touch), 0.0)
        slips = touching & (share < self.part * self.greatest)
        self.greatest = np.where(touching & ~slips, np.maximum(self.greatest, share), share)
        if not touching.any():
            return slipbench.State.NO_CONTACT
        if slips.sum() < 3:  # of nine: less is noise
            return slipbench.State.NON_SLIP
        return slipbench.State.GROSS if slips.sum() == touching.sum() else slipbench.State.INCIPIENT


scene = slipbench.Scene.load("grasp/lift.yaml").set({"surface.material": "acrylic", "sweep.trials": 8})
figure, (course, ends) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
for name in ("leaving_pillars", "gst_hd", "truth"):
    trials = list(scene.set({"detector.type": name}).sweep())
    loop = trials[0].control
    assert loop  # there are a detector and a controller
    course.plot(loop.time, loop.grip_force, label=name)
    held = [trial.outcome for trial in trials if not trial.outcome["dropped"]]
    least = np.array([one["ideal_grip_force_N"] for one in held])
    slips, forces = np.array([[1e3 * one["slip_translation_m"], one["final_grip_force_N"]] for one in held]).T
    ends.plot(slips, forces / least, "o", label=name)
    print(f"{name}: {len(held)} of {len(trials)} held with {np.mean(forces / least):.1f} times the least force,", Counter(one["detection"] for one in held))
course.axhline(least[0], color="grey", linestyle=":", label="least that holds")
course.set(title="trial 0", xlabel="time [s]", ylabel="true grip force [N]")
ends.set(title="all trials", xlabel="slip of the box until the end [mm]", ylabel="last grip force / least that holds", ylim=(0, None))
course.legend()
ends.legend()
figure.savefig("own_detector.png")
