"""lerobot itself loads an export and gives the dataset's values bit-exactly.

Arguments: the project's root, the program. Skipped if lerobot cannot be imported: it needs torch
with CUDA, larger than everything the suite installs. README.md says how it was run.
"""

import sys
import unittest

import h5py
import numpy as np
from _made import ExportTest, for_each_scene, held

try:
    from lerobot.datasets.lerobot_dataset import LeRobotDataset
except ImportError as error:
    print(f"lerobot cannot be imported ({error}): skipped")
    sys.exit(77)


class RealLeRobot(ExportTest):
    @for_each_scene("lerobot")
    def test_every_sensor_comes_back_with_its_past(self, dataset, out):
        with h5py.File(dataset) as file:
            order = [
                name for part in ("train", "valid", "test") for name in file[f"mask/{part}"].asstr()
            ]
            for folder in out.iterdir():
                rate = int(folder.name.removesuffix("hz"))
                channels = {
                    f"observation.{sensor}.{channel}": (sensor, channel)
                    for sensor, group in file["data/demo_0/sensors"].items()
                    if group.attrs["rate_hz"] == rate
                    for channel in group.attrs["channels"]
                }
                self.check(file, order, folder, rate, channels)

    def check(self, file, order, folder, rate, channels):
        past = [-2 / rate, -1 / rate, 0.0]
        data = LeRobotDataset(
            "slipbench/test", root=folder, delta_timestamps=dict.fromkeys(channels, past)
        )
        self.assertEqual((data.fps, data.num_episodes), (rate, len(order)))
        ends = list(data.meta.episodes["dataset_to_index"])
        self.assertEqual(ends[-1], len(data))
        steps = {
            *range(0, len(data), max(1, len(data) // 200)),
            *(end - 1 for end in ends),
            *ends[:-1],
        }  # of long ones 200, and the ends of each episode
        for index in sorted(steps):
            item = data[index]
            episode = int(item["episode_index"])
            demo, begin = file["data"][order[episode]], [0, *ends][episode]
            rows = (
                np.maximum(np.arange(index - 2, index + 1), begin) - begin
            )  # before an episode lerobot repeats its first row
            # Rows are the sensors' samples up to the last; torch has the dataset's `time` only as
            # float32.
            instants = demo["sensors"][next(iter(channels.values()))[0]]["t"][:][
                begin - ends[episode] :
            ][rows]
            for name, (sensor, channel) in channels.items():
                group = demo["sensors"][sensor]
                expected = held(
                    group[f"{channel}_t" if f"{channel}_t" in group else "t"][:],
                    group[channel][:],
                    instants,
                )
                found = item[name].numpy().reshape(3, -1)
                self.assertEqual(
                    (found.dtype, found.tobytes()),
                    (expected.dtype, expected.tobytes()),
                    f"{name} {index}",
                )


if __name__ == "__main__":
    unittest.main()
