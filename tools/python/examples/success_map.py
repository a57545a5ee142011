"""A sweep of grasps into a table and maps of success: friction against weight, for two controllers. Writes success_map.png."""

import matplotlib.pyplot as plt
import pandas as pd

import slipbench

controllers = ["step_on_slip", "hold_preset"]
scene = slipbench.Scene.load("grasp/lift.yaml").set(
    {
        "friction.static": 0.3,
        "friction.kinetic": 0.24,
        "detector.type": "truth",  # the oracle: what drops is the controller's doing
        "sweep": {
            "controller.type": controllers,
            "friction.scale": [0.6, 1, 1.5, 2],
            "box.mass": ["100 g", "200 g", "400 g", "600 g"],
            "trials": 2,
        },
    }
)
rows = []
sweep = scene.sweep(record="outcome")  # no arrays: a grasp is a few hundred bytes
for trial in sweep:
    rows.append({**trial.params, **trial.outcome})
    if sweep.done % 16 == 0:
        print(f"{sweep.done} of {len(sweep)}")
table = pd.DataFrame(rows)
table["held"] = ~table["dropped"].astype(bool)
table["mu"] = 0.3 * table["friction.scale"]
table["excess"] = table["max_grip_force_N"] / table["ideal_grip_force_N"]

figure, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained", sharey=True)
for axis, controller in zip(axes, controllers, strict=True):
    chosen = table[table["controller.type"] == controller]
    held = chosen.pivot_table(index="box.mass", columns="mu", values="held", aggfunc="mean")
    image = axis.imshow(held, origin="lower", vmin=0, vmax=1, cmap="RdYlGn", alpha=0.6, aspect="auto")
    axis.set_xticks(range(len(held.columns)), [f"{mu:.2f}" for mu in held.columns])
    axis.set_yticks(range(len(held.index)), [f"{1e3 * mass:.0f}" for mass in held.index])
    axis.set(title=controller, xlabel="coefficient of friction")
    for (row, column), share in pd.DataFrame(held.to_numpy()).stack().items():
        axis.text(column, row, f"{100 * share:.0f} %", ha="center", va="center")
    print(chosen[chosen["held"]].groupby("mu")[["excess"]].mean().round(2).T.to_string())
axes[0].set_ylabel("mass of the box [g]")
figure.colorbar(image, ax=axes, label="share of boxes held")
figure.savefig("success_map.png")
