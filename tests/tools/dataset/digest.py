"""The digests of tools/dataset/storage.md, computed with h5py, independently of this project."""

import hashlib

import h5py
import numpy as np


def entry(key, value):
    """Returns the SHA-256 of one array or attribute."""
    value = np.asarray(value)
    if value.dtype.kind in "OSU":
        kind = "text"
        data = b"".join(
            (text if isinstance(text, bytes) else text.encode()) + b"\0" for text in value.ravel()
        )
    else:
        kind, data = value.dtype.str, np.ascontiguousarray(value).tobytes()
    extents = ",".join(str(extent) for extent in value.shape)
    return hashlib.sha256(f"{key}\0{kind}\0{extents}\0".encode() + data).digest()


def entries(item, path, leave_out=()):
    """Returns {key: SHA-256} of a group or array and everything below.

    `path` is its own path in the keys.
    """
    found = {
        f"{path}@{name}": entry(f"{path}@{name}", value)
        for name, value in item.attrs.items()
        if f"{path}@{name}" not in leave_out
    }
    if isinstance(item, h5py.Dataset):
        found[path] = entry(path, item[()])
    else:
        for name in item:
            below = f"{path}/{name}" if path else name
            if below not in leave_out:
                found.update(entries(item[name], below, leave_out))
    return found


def joined(found):
    return hashlib.sha256(b"".join(found[key] for key in sorted(found, key=str.encode))).digest()


def trial_digest(demo):
    return joined(entries(demo, "", {"@sha256"}))


def file_digest(file):
    demos = {f"data/{name}": trial_digest(demo) for name, demo in file["data"].items()}
    found = entries(file, "", {"@content_sha256", *demos})
    for key, digest in demos.items():
        found[key] = hashlib.sha256(f"{key}\0trial\0\0".encode() + digest).digest()
    return joined(found)
