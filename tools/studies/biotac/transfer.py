"""What a classifier that has seen synthetic recordings alone says of real ones: slip or touch, and which of seven classes.

usage: transfer.py REAL SYNTHETIC [SYNTHETIC ...]

Folders in the layout of recordings.py. Several synthetic ones, of as many seeds, give the spread.
"""

import argparse
import sys

import numpy as np

import recordings as rec
from recordings import CLASSES, BadInput

PENALTY = 1.0  # of the squared weights, of features with standard deviation 1


def sorted_spreads(window):
    """Where the motion is does not matter: logarithms of the 24 standard deviations, in order."""
    return np.sort(np.log(window.std(0) + 1.0))


def dynamics(window):
    """How each electrode moves: logarithm of its standard deviation, and its trend over the window, compressed."""
    t = np.arange(len(window)) - (len(window) - 1) / 2
    trend = (t @ window) / (t @ t) * len(window)
    return np.concatenate([np.log(window.std(0) + 1.0), np.arcsinh(trend / 10.0)])


def level_and_dynamics(window):
    """Also where each electrode stands."""
    return np.concatenate([dynamics(window), window.mean(0)])


FEATURES = {"sorted spreads": sorted_spreads, "dynamics": dynamics, "level and dynamics": level_and_dynamics}


class LogisticRegression:
    """Softmax of a linear function, with a penalty on the squared weights; classes weigh the same. Newton's method, from zero."""

    def __init__(self, x, y, classes):
        self.mean, self.sd = x.mean(0), x.std(0) + 1e-12
        x = self._with_one(x)
        (count, size), target = x.shape, np.eye(classes)[y]
        weight = (count / classes / target.sum(0))[y]
        ridge = np.repeat(np.r_[np.full(size - 1, PENALTY), 1e-6], classes)  # the last: of the constant
        self.weights = np.zeros((size, classes))

        def loss(weights):
            scores = x @ weights
            scores = scores - scores.max(1, keepdims=True)
            return (weight @ (np.log(np.exp(scores).sum(1)) - (scores * target).sum(1))) + 0.5 * ridge @ weights.ravel() ** 2

        for _ in range(100):
            p = self._softmax(x @ self.weights)
            gradient = (x.T @ (weight[:, None] * (p - target))).ravel() + ridge * self.weights.ravel()
            hessian = np.empty((size, classes, size, classes))
            for a in range(classes):
                for b in range(a, classes):
                    block = x.T @ ((weight * p[:, a] * ((a == b) - p[:, b]))[:, None] * x)
                    hessian[:, a, :, b] = hessian[:, b, :, a] = block
            flat = hessian.reshape(size * classes, -1)
            step = np.linalg.solve(flat + np.diag(ridge), gradient).reshape(size, classes)
            length, before = 1.0, loss(self.weights)
            while length > 1e-6 and loss(self.weights - length * step) > before:
                length /= 2
            self.weights = self.weights - length * step
            if length * np.abs(step).max() < 1e-8:
                break

    def _with_one(self, x):
        return np.hstack([(x - self.mean) / self.sd, np.ones((len(x), 1))])

    @staticmethod
    def _softmax(scores):
        e = np.exp(scores - scores.max(1, keepdims=True))
        return e / e.sum(1, keepdims=True)

    def probabilities(self, x):
        return self._softmax(self._with_one(x) @ self.weights)


def auc(scores, positive):
    """Chance that a positive scores higher than a negative; ties count half."""
    order = np.concatenate([scores[positive], scores[~positive]])
    values, where, counts = np.unique(order, return_inverse=True, return_counts=True)
    rank = (np.cumsum(counts) - (counts - 1) / 2)[where]
    n, m = positive.sum(), (~positive).sum()
    return (rank[:n].sum() - n * (n + 1) / 2) / (n * m)


def balanced_accuracy(found, truth):
    """Mean over the classes of the share that is found."""
    return np.mean([(found[truth == c] == c).mean() for c in np.unique(truth)])


def table_of(recordings, features):
    """Features of all windows and their classes' numbers."""
    pairs = [(features(w), CLASSES.index(r.kind)) for r in recordings for w in rec.windows(r.counts)]
    return np.array([x for x, _ in pairs]), np.array([c for _, c in pairs])


def scores(train, test):
    """By feature set: AUC of slip against touch; balanced accuracy over seven classes; of the windows of a pair of classes, the share that is
    put on the right side by the same classifier."""
    found = {}
    for name, features in FEATURES.items():
        (x, c), (x_test, c_test) = table_of(train, features), table_of(test, features)
        touch = CLASSES.index("t")
        slip = LogisticRegression(x, (c != touch).astype(int), 2)
        found[name] = {"slip AUC": auc(slip.probabilities(x_test)[:, 1], c_test != touch)}
        if name == "sorted spreads":
            continue
        p = LogisticRegression(x, c, len(CLASSES)).probabilities(x_test)
        found[name]["seven classes"] = balanced_accuracy(p.argmax(1), c_test)
        for a, b in (("n", "s"), ("e", "w"), ("cw", "aw")):
            i, j = CLASSES.index(a), CLASSES.index(b)
            of = (c_test == i) | (c_test == j)
            found[name][f"{a} or {b}"] = balanced_accuracy(np.where(p[of, i] > p[of, j], i, j), c_test[of])
    return found


def print_scores(title, runs):
    print(title)
    for name in FEATURES:
        for what in runs[0][name]:
            values = [run[name][what] for run in runs]
            spread = f" +- {np.std(values, ddof=1):.3f}, {min(values):.3f} to {max(values):.3f}" if len(values) > 1 else ""
            print(f"  {name:20}{what:15}{np.mean(values):.3f}{spread}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("real", help="folder of the real recordings")
    parser.add_argument("synthetic", nargs="+", help="folders of synthetic ones, one a seed")
    options = parser.parse_args()
    try:
        real = rec.read_folder(options.real)
        synthetic = [rec.read_folder(folder) for folder in options.synthetic]
    except (BadInput, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    print("Windows of 0.5 s; logistic regression. Chance: AUC 0.5, seven classes 0.143, pairs 0.5.")
    print_scores(f"Trained on synthetic recordings alone ({len(synthetic)} set(s) of {len(synthetic[0])}), tested on {len(real)} real ones:",
                 [scores(train, real) for train in synthetic])
    objects = sorted({r.object for r in real})
    if len(objects) > 1:
        runs = [scores([r for r in real if r.object != out], [r for r in real if r.object == out]) for out in objects]
        print_scores(f"For comparison, trained on the real recordings of all objects but one, tested on that one ({', '.join(objects)}):", runs)


if __name__ == "__main__":
    main()
