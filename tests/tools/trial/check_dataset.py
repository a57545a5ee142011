"""Writes a dataset with the program and reads it with h5py, independently of this project.

usage: check_dataset.py SLIPBENCH SCENE
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

LABELS = {  # name: (dtype, extents after the first; N: number of units)
    "unit_state": ("u1", ("N",)),
    "slip_velocity": ("f4", ("N", 2)),
    "slip_distance": ("f4", ("N",)),
    "margin": ("f4", ("N",)),
    "force": ("f4", ("N", 3)),
    "state": ("u1", ()),
    "state_micro": ("u1", ()),
    "state_paper": ("u1", ()),
    "stuck_fraction": ("f4", ()),
    "slip_direction": ("f4", ()),
    "slip_centre": ("f4", (2,)),
    "slip_angle": ("f4", ()),
}


def arrays_of(group):
    found = {}
    group.visititems(
        lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None
    )
    return found


def check_filters(demo):
    for name, array in arrays_of(demo).items():
        if array.size:
            assert array.compression == "gzip", name
            assert array.shuffle == (array.dtype.itemsize > 1), name
            assert not (array.fletcher32 or array.scaleoffset), name


def check_sensor(demo, name):
    sensor, labels = demo["sensors"][name], demo["labels"][name]
    samples = sensor["t"].shape[0]
    assert sensor.attrs["type"] == "papillarray"
    assert len(sensor.attrs["channel_names"]) == 54
    assert "compression is positive" in sensor.attrs["frame"]
    assert np.allclose(np.diff(sensor["t"]), 1 / sensor.attrs["rate_hz"], atol=1e-12)
    for channel in ("force", "displacement"):
        assert sensor[channel].shape == (samples, 9, 3) and sensor[channel].dtype == "f4"
    units = len(labels.attrs["k_normal"])
    for label, (dtype, tail) in LABELS.items():
        expected = (samples, *(units if extent == "N" else extent for extent in tail))
        assert labels[label].shape == expected and labels[label].dtype == dtype, label
    for array, state in (("unit_state", "slip"), ("state", "gross"), ("events/kind", "detach")):
        codes = json.loads(labels[array].attrs["codes"])
        assert (
            labels[array].dtype == "u1"
            and set(labels[array][()].ravel()) <= set(codes.values())
            and state in codes
        ), array
    events = labels["events"]
    assert events["t"].shape == events["unit"].shape == events["kind"].shape
    assert (np.diff(events["t"]) >= 0).all()
    for attribute in (
        "onset_time_s",
        "micro_onset_time_s",
        "mu_static",
        "mu_kinetic",
        "k_tangential",
    ):
        assert labels.attrs[attribute].shape == (units,), attribute
    first_slip = [
        min(events["t"][(events["unit"][()] == u) & (events["kind"][()] == 1)], default=np.nan)
        for u in range(units)
    ]
    assert np.array_equal(labels.attrs["onset_time_s"], first_slip, equal_nan=True)


def check_coulomb(labels):
    """Checks sticking: f_t <= mu_s f_n; slipping: f_t = mu_k f_n, to 1e-6 of the load or of 1 N.

    Valid for a pad without tilt, whose axes are those of the contact plane, and one bristle per
    unit, because the pulls of several may differ in direction.
    """
    force, state = labels["force"][()].astype(float), labels["unit_state"][()]
    f_t, f_n = np.hypot(force[..., 0], force[..., 1]), force[..., 2]
    mu_s, mu_k = labels.attrs["mu_static"], labels.attrs["mu_kinetic"]
    tolerance = 1e-6 * np.maximum(1, f_n)
    assert (f_t <= mu_s * f_n + tolerance)[state == 1].all()
    assert (np.abs(f_t - mu_k * f_n) <= tolerance)[state == 2].all()
    assert (force[state == 0] == 0).all()


def check_control(demo):
    """Returns the classes of a force_ratio of 0.4 from 0.05 N on for the recorded forces."""
    control, force = demo["control"], demo["sensors/pad/force"][()].astype("f8")
    assert set(control) == {"t", "detector_class"} and control["detector_class"].dtype == "u1"
    assert (
        control.attrs["detector"] == "force_ratio"
        and control.attrs["sensor"] == "pad"
        and control.attrs["rate_hz"] == 1000
    )
    assert np.array_equal(control["t"], demo["sensors/pad/t"])
    touching = force[..., 2] >= 0.05
    slipping = touching & (np.hypot(force[..., 0], force[..., 1]) > 0.4 * force[..., 2])
    count, slips = touching.sum(axis=1), slipping.sum(axis=1)
    expected = np.where(count == 0, 0, np.where(slips == 0, 1, np.where(slips < count, 2, 3)))
    assert len(set(expected)) == 4 and np.array_equal(control["detector_class"], expected)


def check_run(program, scene, settings):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "out.h5"
        subprocess.run(
            [program, "run", scene, *settings, "-o", str(path)],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        with h5py.File(path) as file:
            assert file.attrs["schema"] == 2 and file.attrs["complete"] == 1
            assert file.attrs["scene"] == pathlib.Path(scene).read_text()
            json.loads(file.attrs["overrides"])
            assert "--jobs" not in file.attrs["command"] and str(path) not in file.attrs["command"]
            demos = sorted(file["data"], key=lambda name: int(name.removeprefix("demo_")))
            masked = [
                name.decode() for part in ("train", "valid", "test") for name in file["mask"][part]
            ]
            assert sorted(masked) == sorted(demos)
            for name in demos:
                demo = file["data"][name]
                json.loads(demo.attrs["params"])
                assert json.loads(demo.attrs["outcome"])["dropped"] is None
                check_filters(demo)
                assert ("control" in demo) == bool(settings)
                if settings:
                    check_control(demo)
                for sensor in demo["sensors"]:
                    check_sensor(demo, sensor)
                    check_coulomb(demo["labels"][sensor])
                for body in ("pad", "surface"):
                    truth = demo["truth"][body]
                    assert truth["pose"].shape == (demo.attrs["num_samples"], 7)
                    assert truth["velocity"].shape == (demo.attrs["num_samples"], 6)
                    assert np.allclose(np.linalg.norm(truth["pose"][:, 3:], axis=1), 1, atol=1e-6)


def main():
    program, scene = sys.argv[1:]
    check_run(program, scene, [])
    check_run(program, scene, ["--set", "detector.type=force_ratio"])


if __name__ == "__main__":
    main()
