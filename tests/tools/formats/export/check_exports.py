"""Exports a dataset and reads the files with numpy, h5py and csv, independently of this project.

usage: check_exports.py SLIPBENCH SCENE
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

RATE = 100.0  # Hz, of the demonstrations


def check_npz(path, demo):
    with np.load(path) as archive:  # allow_pickle stays off
        about = json.loads(archive["about"].item())
        assert about["trial"] == 0 and about["sensors"]["pad"]["type"] == "papillarray"
        assert about["units"]["sensors/pad/force"] == "N" and about["split"] in (
            "train",
            "valid",
            "test",
        )
        arrays = {}
        demo.visititems(
            lambda name, item: (
                arrays.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None
            )
        )
        assert len(arrays) > 15
        for name, values in arrays.items():
            assert archive[name].dtype == values.dtype and np.array_equal(
                archive[name], values, equal_nan=values.dtype.kind == "f"
            ), name
        for name in ("onset_time_s", "mu_static", "unit_positions"):
            assert np.array_equal(
                archive[f"labels/pad/{name}"], demo["labels/pad"].attrs[name], equal_nan=True
            ), name


def check_csv(path, demo):
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    names = demo["sensors/pad"].attrs["channel_names"]
    assert header == [
        "t [s]",
        *(f"{name} [{'N' if '_F' in name else 'm'}]" for name in names),
        "state",
        "state_micro",
        "state_paper",
    ]
    table = np.array(rows, dtype=float)
    assert np.array_equal(table[:, 0], demo["sensors/pad/t"])
    channels = [demo["sensors/pad"][name] for name in demo["sensors/pad"].attrs["channels"]]
    values = np.concatenate([channel[()].reshape(len(table), -1) for channel in channels], axis=1)
    assert np.array_equal(table[:, 1:-3].astype("f4"), values)
    for column, name in ((-3, "state"), (-2, "state_micro"), (-1, "state_paper")):
        assert np.array_equal(table[:, column], demo[f"labels/pad/{name}"]), name


# Requirements of robomimic's SequenceDataset and its file utilities: how they open the file, the
# members they read, and that each array has num_samples rows.
def check_robomimic(path, source):
    with h5py.File(path, "r", swmr=True, libver="latest") as file:
        data = file["data"]
        environment = json.loads(data.attrs["env_args"])
        assert (
            environment["env_name"] == "slipbench"
            and isinstance(environment["type"], int)
            and "scene" in environment["env_kwargs"]
        )
        demos = sorted(data, key=lambda name: int(name[5:]))
        assert demos == sorted(source["data"], key=lambda name: int(name[5:]))
        total = 0
        for name in demos:
            demo, recorded = data[name], source["data"][name]
            steps = demo.attrs["num_samples"]
            total += steps
            assert set(demo["obs"]) == set(demo["next_obs"]) == {"pad_force", "pad_displacement"}
            for key in demo["obs"]:
                assert demo["obs"][key].shape == demo["next_obs"][key].shape == (steps, 27), key
                assert np.array_equal(demo["obs"][key][1:], demo["next_obs"][key][:-1]), key
            assert demo["actions"].shape == (steps, 6) and np.abs(demo["actions"]).max() <= 1
            assert demo["states"].shape == (steps, 26)
            for key in ("rewards", "dones", "pad_state", "pad_state_micro", "pad_state_paper"):
                assert demo[key].shape == (steps,), key
            assert demo["dones"][-1] == 1 and demo["dones"][()].sum() == 1
            # The scene samples at a multiple of the rate, so each row is a sample.
            stride = round(recorded["sensors/pad"].attrs["rate_hz"] / RATE)
            whole = recorded["sensors/pad/force"][::stride].reshape(-1, 27)
            assert steps == len(whole) - 1
            assert np.array_equal(demo["obs/pad_force"], whole[:-1]) and np.array_equal(
                demo["next_obs/pad_force"], whole[1:]
            )
            scale, offset = data.attrs["action_scale"], data.attrs["action_offset"]
            velocity = recorded["truth/pad/velocity"][::stride][:-1]
            assert np.allclose(demo["actions"] * scale + offset, velocity, rtol=1e-6, atol=1e-9)
        assert data.attrs["total"] == total
        split = {
            part: [name.decode("utf-8") for name in np.array(file[f"mask/{part}"][:])]
            for part in ("train", "valid", "test")
        }
        assert sorted(sum(split.values(), [])) == demos
        assert split == {
            part: [name.decode("utf-8") for name in source[f"mask/{part}"][:]] for part in split
        }


def main(program, scene):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        dataset = folder / "a.h5"
        sweep = "sweep={motion.speed: [2 mm/s, 4 mm/s, 8 mm/s]}"
        subprocess.run(
            [
                program,
                "sweep",
                scene,
                "--set",
                sweep,
                "--set",
                "duration=1 s",
                "-o",
                dataset,
                "--quiet",
            ],
            check=True,
        )
        for format, *more in (["npz"], ["csv"], ["robomimic", "--rate", "100 Hz"]):
            subprocess.run(
                [program, "export", dataset, "--format", format, *more, "-o", folder / format],
                check=True,
            )
        with h5py.File(dataset) as source:
            check_npz(folder / "npz/demo_0.npz", source["data/demo_0"])
            check_csv(folder / "csv/demo_0-pad.csv", source["data/demo_0"])
            check_robomimic(folder / "robomimic/robomimic.hdf5", source)


main(*sys.argv[1:])
