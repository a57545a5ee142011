"""Recordings to a slip classifier of scikit-learn, judged as a detector in a gripper is. Writes slip_classifier.png."""

import matplotlib.pyplot as plt
import numpy as np
from sklearn.tree import DecisionTreeClassifier

import slipbench

LENGTH = 8  # samples of 10 ms that a window holds


def features(window):
    """Of forces [LENGTH, 27] in N: tangential to normal force of each pillar, normal force, and what became of both in the window: [36]."""
    x, y, normal = np.array([window[0], window[-1]]).reshape(2, 9, 3).transpose(2, 0, 1)
    told = np.concatenate([np.hypot(x, y) / np.maximum(normal, 0.05), normal], axis=1)
    return np.concatenate([told[1], told[1] - told[0]])


@slipbench.detector("classifier")
class Classifier:
    def __init__(self, source):
        self.window = []

    def update(self, frame):
        self.window = [*self.window[1 - LENGTH :], frame["force"].flatten()]  # a copy: the frame's arrays are filled anew
        slips = len(self.window) == LENGTH and model.predict([features(self.window)])[0]
        return slipbench.State.GROSS if slips else slipbench.State.NON_SLIP


parts = {"by": "trial", "shares": [0.6, 0, 0.4]}  # neighbouring samples are alike: a trial is learnt from or judged on, never both
sweep = {
    "motion.speed": ["1 mm/s", "4 mm/s", "16 mm/s"],
    "motion.start": {"draw": "uniform", "min": "0.6 s", "max": "2 s"},  # so that the clock says nothing of slip
    "motion.direction": {"draw": "uniform", "min": "0 deg", "max": "360 deg"},
    "friction.scale": {"draw": "lognormal", "median": 1, "sd": 0.3},
    "trials": 14,
}
scene = slipbench.Scene.load("papillarray/hexapod.yaml").set({"sensors.pad.rate": "100 Hz"}, duration="3 s", split=parts, sweep=sweep)
scene.write("slips.h5")
with slipbench.open("slips.h5") as data:
    windows = data.windows(length=LENGTH, channels=["force"], labels="micro", part="train")
    x, y = np.array([features(window) for window, _ in windows]), np.array([slips for _, slips in windows])
    unseen = data.mask("test")
model = DecisionTreeClassifier(max_depth=6, min_samples_leaf=20, random_state=1).fit(x, y)
figure, (course, bars) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
trial = scene.set({"detector.type": "classifier"}).run(unseen[0])
assert trial.control  # there is a detector
course.fill_between(trial.control.time, trial.sensors["pad"].labels.state_micro >= 2, step="post", alpha=0.3, label="truth")
course.step(trial.control.time, trial.control.detector_class >= 2, where="post", label="classifier")
course.set(title=f"trial {unseen[0]}", xlabel="time [s]", yticks=[0, 1], yticklabels=["hold", "slip"])
course.legend()
for place, name in enumerate(["classifier", "gst_hd", "force_ratio"]):
    judged = slipbench.evaluate(name, "slips.h5", labels="micro", split="test")["all"]["figures"]
    told = [judged[key]["value"] for key in ("balanced_slip_accuracy", "early", "missed", "delay_median_s")]
    print(name, np.round(told, 3))
    bars.bar(np.arange(3) + 0.27 * place - 0.27, told[:3], 0.25, label=f"{name}, {1e3 * told[3]:.0f} ms late")
words = ["balanced accuracy", "alarms before slip", "slips missed"]
bars.set(title=f"{len(unseen)} trials that the classifier has not seen", ylabel="share", xticks=range(3), xticklabels=words)
bars.legend()
figure.savefig("slip_classifier.png")
