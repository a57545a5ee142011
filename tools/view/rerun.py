"""Sends trials to Rerun.

`python3 -c "<this file>" NAME [OUT.rrd]`, started by `slipbench view --rerun` with the user's own
Python.

It needs rerun-sdk and no module of slipbench. Each line of stdin is the path of a trial's numpy
archive (`slipbench export --format npz`). With OUT.rrd it writes to that file and opens no viewer.
Without rerun-sdk it prints a message and exits with status 2.
"""

import importlib
import json
import os
import sys


def time_of(arrays, key):
    """Returns the times of an array's rows: its own, or those of its group.

    None if its rows are not samples in time.
    """
    for name in (f"{key}_t", f"{key.rsplit('/', 1)[0]}/t"):
        if name in arrays:
            return arrays[name]
    return None


def send(rerun, numpy, stream, arrays, units):
    """Sends every array with rows in time, in one call per array."""
    for key in arrays.files:
        name = key.rsplit("/", 1)[-1]
        time = time_of(arrays, key)
        if (
            name in ("about", "t")
            or name.endswith("_t")
            or "/events/" in key
            or time is None
            or len(arrays[key]) != len(time)
        ):
            continue
        values = arrays[key]
        path = [*key.split("/")]
        if name == "pose":
            # Stored as x, y, z, then the quaternion with its real part first.
            columns = rerun.Transform3D.columns(
                translation=values[:, :3], quaternion=values[:, [4, 5, 6, 3]]
            )
        else:
            columns = rerun.Scalars.columns(
                scalars=values.reshape(len(values), -1).astype(numpy.float64)
            )
            if units.get(key, "1") != "1":
                path[-1] += f" [{units[key]}]"
        entity = "/".join(rerun.escape_entity_path_part(part) for part in path)
        stream.send_columns(
            entity, indexes=[rerun.TimeColumn("trial_time", duration=time)], columns=columns
        )


def main():
    try:
        rerun, numpy = importlib.import_module("rerun"), importlib.import_module("numpy")
    except ImportError:
        print(
            f"slipbench: view: --rerun needs rerun-sdk, which {sys.executable} does not have; install it: {sys.executable} -m pip install rerun-sdk",
            file=sys.stderr,
        )
        sys.exit(2)
    name, target = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None
    for number, line in enumerate(sys.stdin):
        with numpy.load(line.rstrip("\n")) as arrays:
            about = json.loads(arrays["about"].item())
            stream = rerun.RecordingStream(
                "slipbench", recording_id=f"{name} trial {about['trial']} {os.getpid()}"
            )
            if target is not None:
                stream.save(target)
            elif number == 0:
                stream.spawn()
            else:
                stream.connect_grpc()
            stream.send_recording_name(f"{name}, trial {about['trial']}")
            send(rerun, numpy, stream, arrays, about["units"])
            stream.flush()


try:
    main()
except KeyboardInterrupt:
    sys.exit(130)
except Exception as error:  # another release of rerun-sdk, or a viewer that cannot start
    reason = next(iter(str(error).splitlines()), "")
    print(
        f"slipbench: view: --rerun: rerun-sdk of {sys.executable} failed: {type(error).__name__}: {reason}",
        file=sys.stderr,
    )
    sys.exit(2)
