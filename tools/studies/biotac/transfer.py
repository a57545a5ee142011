"""What a classifier that has seen synthetic recordings alone says of real ones: slip or touch, and which of seven classes.

usage: transfer.py REAL SYNTHETIC [SYNTHETIC ...]

Folders in the layout of recordings.py. Several synthetic ones, of as many seeds, give the spread.
"""

import argparse
import sys

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import balanced_accuracy_score, roc_auc_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

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


def classifier(x, y):
    """Softmax of a linear function of standardised features, with a penalty on the squared weights; classes weigh the same."""
    # Of two classes scikit-learn has one vector of weights, the difference of the softmax's two, whose squares are half of its square.
    strength = (2 if len(np.unique(y)) == 2 else 1) / PENALTY
    regression = LogisticRegression(C=strength, class_weight="balanced", solver="newton-cholesky", tol=1e-8, max_iter=1000)
    return make_pipeline(StandardScaler(), regression).fit(x, y)


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
        found[name] = {"slip AUC": roc_auc_score(c_test != touch, classifier(x, c != touch).predict_proba(x_test)[:, 1])}
        if name == "sorted spreads":
            continue
        p = classifier(x, c).predict_proba(x_test)
        found[name]["seven classes"] = balanced_accuracy_score(c_test, p.argmax(1))
        for a, b in (("n", "s"), ("e", "w"), ("cw", "aw")):
            i, j = CLASSES.index(a), CLASSES.index(b)
            of = (c_test == i) | (c_test == j)
            found[name][f"{a} or {b}"] = balanced_accuracy_score(c_test[of], np.where(p[of, i] > p[of, j], i, j))
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
