"""Fuzzing of `import --map`: damaged tables, maps, arrays, Parquet files and bags are read, or are an InputError.

Without arguments: a bounded run that is always the same, as a test. To search for more, kind by kind:

    PYTHONPATH=build/release/python build/venv/bin/python tests/python/fuzz_import.py --runs 10000 --keep FOLDER

With the package atheris, libFuzzer searches by coverage, from the sources in FOLDER/KIND and into them:

    ... fuzz_import.py --atheris KIND --keep FOLDER -- -runs=10000 -timeout=20
"""

import argparse
import contextlib
import faulthandler
import io
import resource
import signal
import sqlite3
import sys
import tempfile
import time
import traceback
import unittest
import zipfile
import zlib
from pathlib import Path
from random import Random
from unittest import mock

options = argparse.ArgumentParser(
    description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
)
options.add_argument("--runs", type=int, default=0, help="inputs of each kind")
options.add_argument("--seed", type=int, default=1, help="of the changes [1]")
options.add_argument(
    "--kinds", nargs="+", default=[], metavar="KIND", help="kinds of sources [all]"
)
options.add_argument("--keep", type=Path, help="folder for inputs that show a fault")
options.add_argument("--atheris", metavar="KIND", help="search with atheris")
options.add_argument("rest", nargs="*", help="arguments of libFuzzer, after --")

instrumented = contextlib.nullcontext()
if "--atheris" in sys.argv:
    import atheris

    instrumented = atheris.instrument_imports(include=["slipbench._import", "rosbags"])
with instrumented:
    import numpy as np
    import pyarrow as pa
    import pyarrow.parquet
    import rosbags.highlevel  # noqa: F401  imported before bags.py does, so that it is instrumented
    import slipbench
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    from slipbench._import import arrays, bags, block, recordings, text
    from slipbench.bin import _core

LONGEST = 10.0  # s of CPU time, of one input
MEMORY = 2 << 30  # bytes of address space beyond what the imports take
RUNS = 40  # inputs of each kind, in the test
TABLE = "t,f1,f2,s\n0.00,0.500,1.250,0\n0.01,0.600,1.350,1\n0.02,0.700,1.450,2\n"
CHANNELS = "channels: {force: {unit: N, columns: [f1, f2]}}"
TABLE_MAPS = (
    f"{{sensor: pad, type: own, time: {{column: t}}, {CHANNELS}, state: {{column: s, rule: hand}}}}",
    f"{{sensor: pad, type: own, time: {{column: t}}, {CHANNELS}, missing: gap, comment: '#'}}",
    "{sensor: pad, type: own, time: {rate: 100 Hz}, missing: nan, channels: {force: {unit: N, columns: [f1 .. s]}}}",
)
ARRAY_MAP = (
    "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}, "
    "state: {column: s, rule: hand}}"
)
COLUMN_MAP = "{sensor: pad, type: own, time: {column: '1'}, channels: {force: {unit: N, columns: ['2 .. 4']}}}"
BAG_MAP = (
    "{sensor: pad, type: own, topic: /a, time: {column: header.stamp}, "
    "channels: {force: {unit: N, columns: ['pillars[*].x']}, raw: {unit: '1', columns: [gain, 'data[0] .. data[2]']}}}"
)
WHOLE_MAP = f"""# A map with every kind of key
sensors:
  pad: {{type: own, frame: z up, {CHANNELS}}}
  skin: {{type: taxels, channels: {{force: {{unit: N, scale: 1e-3, components: 2, columns: ['f*']}}}}}}
time: {{column: t, unit: ms}}
state: {{column: s, values: {{"0": no_contact, a: gross, "1": 2, "2": 1}}, rule: by hand}}
object: {{file: '(.*)[.]csv'}}
files: '*.csv'
separator: ","
decimal: .
header: true
skip: [7, 8]
comment: '#'
missing: gap
"""
PILLAR = "float64 x\nint8 state\nstring name\n"
MESSAGE = "std_msgs/Header header\nfuzz_msgs/Pillar[] pillars\nfloat32[3] f\nuint8[] data\nbool on\nfloat32 gain\n"
WORDS = [
    b"", b"0", b"-1", b"nan", b"inf", b"1e999", b"1e-400", b",", b";", b"\t", b"\"", b"\n", b"\r", b"\x00", b"#",
    b"\xff\xfe", b"\xef\xbb\xbf", b"{", b"}", b"[", b"]", b": ", b"- ", b"'", b"&a", b"*a", b"!!", b" .. ", b"*",
    b"[*]", b"(", b")", b"|", b"\\", b"12:00:00", b"2026-02-03T10:00", b"\xe2\x88\x92", b"=" * 80, b"[]",
    b"string", b"float64", b"wstring", b"<=5", b" -> ", b"12:00:01.123 -> ", b"a:1", b"[!",
]  # fmt: skip


def bag_types(version, pillar=PILLAR, message=MESSAGE):
    """Returns a type store with the messages of the bags, for ROS 1 or 2."""
    store = get_typestore({1: Stores.ROS1_NOETIC, 2: Stores.LATEST}[version])
    store.register(
        get_types_from_msg(pillar, "fuzz_msgs/msg/Pillar")
        | get_types_from_msg(message, "fuzz_msgs/msg/Pad")
    )
    return store


def bag_messages(version):
    """Returns a store, and three messages in its encoding."""
    store = bag_types(version)
    types = store.types
    made = []
    for row in range(3):
        header = {"seq": row} if version == 1 else {}
        stamp = types["builtin_interfaces/msg/Time"](sec=5, nanosec=row * 10_000_000)
        made.append(
            types["fuzz_msgs/msg/Pad"](
                header=types["std_msgs/msg/Header"](stamp=stamp, frame_id="pad", **header),
                pillars=[types["fuzz_msgs/msg/Pillar"](x=0.5, state=1, name="a") for _ in range(2)],
                f=np.zeros(3, np.float32),
                data=np.arange(3, dtype=np.uint8),
                on=True,
                gain=1.5,
            )
        )
    encode = store.serialize_ros1 if version == 1 else store.serialize_cdr
    return store, [bytes(encode(message, "fuzz_msgs/msg/Pad")) for message in made]


def write_bag1(path, compression=None):
    """Writes a bag of ROS 1."""
    store, messages = bag_messages(1)
    path.unlink(missing_ok=True)
    writer = Writer1(path)
    if compression:
        writer.set_compression(compression)
    with writer:
        connection = writer.add_connection("/a", "fuzz_msgs/msg/Pad", typestore=store)
        for row, message in enumerate(messages):
            writer.write(connection, row * 10_000_000, message)
    return path.read_bytes()


def write_bag2(folder, plugin, mode=CompressionMode.NONE):
    """Writes a bag of ROS 2."""
    store, messages = bag_messages(2)
    writer = Writer2(folder, version=9, storage_plugin=plugin)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/a", "fuzz_msgs/msg/Pad", typestore=store)
        for row, message in enumerate(messages):
            writer.write(connection, row * 10_000_000, message)
    return next(path for path in folder.iterdir() if path.suffix != ".yaml").read_bytes()


def npy(array):
    """Returns the bytes of an .npy file."""
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def npz(*members, compression=zipfile.ZIP_STORED):
    """Returns an .npz file of named members."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", compression) as archive:
        for name, data in members:
            archive.writestr(name, data)
    return file.getvalue()


def parquet(**options):
    """Returns a Parquet file with numbers, lists, texts and times."""
    columns = {
        "t": pa.array([0.0, 0.01, 0.02]),
        "f": pa.array([[1.0, 2.0]] * 3, pa.list_(pa.float32())),
        "s": pa.array(["0", "1", "2"]),
        "at": pa.array([1, 2, 3], pa.timestamp("ns")),
        "n": pa.array([1, None, 3]),
    }
    file = io.BytesIO()
    pyarrow.parquet.write_table(pa.table(columns), file, **options)
    return file.getvalue()


class Fuzzer:
    """Sources of every kind, changed in many ways, in one folder.

    Args:
        folder: empty
    """

    def __init__(self, folder):
        self.folder = folder
        times = np.array([0.0, 0.01, 0.02])
        force = np.arange(12.0).reshape(3, 4)
        record = np.array(
            [(0.0, 1.0, "0"), (0.01, 2.0, "1")], [("t", "f8"), ("f", "f4"), ("s", "U1")]
        )
        members = [
            ("t.npy", npy(times)),
            ("f.npy", npy(force)),
            ("s.npy", npy(np.array([0, 1, 2]))),
        ]
        self.members = dict(members)
        # Bags in folders: their database, their metadata.
        self.bags = {}
        for name, mode in (
            ("plain", CompressionMode.NONE),
            ("compressed", CompressionMode.MESSAGE),
        ):
            database = write_bag2(folder / name, StoragePlugin.SQLITE3, mode)
            self.bags[name] = (database, (folder / name / "metadata.yaml").read_bytes())
        self.seeds = {
            "table": [
                TABLE.encode(),
                TABLE.replace(",", ";").replace(".", ",").encode(),
                TABLE.replace(",", "\t").replace("\n0.", "\n2026-02-03T10:00:00.").encode(),
                TABLE.encode("utf-16"),
                ("# log\n" + TABLE.replace("0.600", '"0.6"').replace("\n", "\r\n")).encode(),
                TABLE.replace(",", "  ").encode("latin-1"),
            ],
            "map": [WHOLE_MAP.encode(), *(map.encode() for map in TABLE_MAPS)],
            "npy": [
                npy(force),
                npy(record),
                npy(force.astype(">f4")),
                npy(np.asfortranarray(force)),
            ],
            "npz": [npz(*members), npz(*members, compression=zipfile.ZIP_DEFLATED)],
            "member": [npy(force), npy(np.asfortranarray(force)), npy(times.astype(">f2"))],
            "parquet": [
                parquet(),
                parquet(compression="none", use_dictionary=False),
                parquet(compression="zstd", data_page_version="2.0", write_statistics=False),
            ],
            "bag1": [
                write_bag1(folder / "seed.bag", compression)
                for compression in (
                    None,
                    Writer1.CompressionFormat.BZ2,
                    Writer1.CompressionFormat.LZ4,
                )
            ],
            "mcap": [
                write_bag2(folder / "mcap", StoragePlugin.MCAP),
                write_bag2(folder / "storage", StoragePlugin.MCAP, CompressionMode.STORAGE),
            ],
            "plain": [self.bags["plain"][0]],
            "compressed": [self.bags["compressed"][0]],
            "metadata": [self.bags["plain"][1]],
            "message": bag_messages(2)[1][1:2],
            "definition": [
                bag_types(2).generate_msgdef("fuzz_msgs/msg/Pad", ros_version=2)[0].encode()
            ],
        }

    def write(self, kind, data):
        """Writes an input as a source of its kind; returns the source and the text of the map."""
        suffix, content, map = kind, data, ARRAY_MAP
        if kind == "table":
            suffix, map = "csv", TABLE_MAPS[zlib.crc32(data) % len(TABLE_MAPS)]
        elif kind == "map":
            suffix, content, map = "csv", TABLE.encode(), data
        elif kind == "npy" and b"'t'" not in data:
            map = COLUMN_MAP
        elif kind == "member":
            suffix, content = "npz", npz(*(self.members | {"f.npy": data}).items())
        elif kind in ("bag1", "mcap"):
            suffix, map = {"bag1": "bag"}.get(kind, kind), BAG_MAP
        elif kind in ("plain", "compressed", "metadata", "message", "definition"):
            return self.write_folder(kind, data), BAG_MAP
        path = self.folder / f"input.{suffix}"
        path.write_bytes(content)
        return path, map

    def write_folder(self, kind, data):
        """Writes an input into a bag in a folder; returns the folder."""
        name = kind if kind in self.bags else "plain"
        folder = self.folder / name
        database, metadata = self.bags[name]
        (folder / "metadata.yaml").write_bytes(data if kind == "metadata" else metadata)
        (folder / f"{name}.db3").write_bytes(data if kind == name else database)
        if kind in ("message", "definition"):
            with contextlib.closing(sqlite3.connect(folder / f"{name}.db3")) as file, file:
                if kind == "message":
                    file.execute("UPDATE messages SET data = ? WHERE id = 2", (data,))
                else:
                    definition = data.decode("utf-8", "replace")
                    file.execute(
                        "UPDATE message_definitions SET encoded_message_definition = ?",
                        (definition,),
                    )
        return folder

    def read(self, kind, data):
        """Imports a source without an output.

        Raises InputError if it is refused; anything else is a fault.
        """
        source, map = self.write(kind, data)
        (self.folder / "map.yaml").write_bytes(map if isinstance(map, bytes) else map.encode())
        described = recordings.Map(block.read_map(str(self.folder / "map.yaml")))
        options = _core.import_options([str(source)], "", "map.yaml", "", 1, None)
        writer = _core.MappedImport(options, "object" if described.object else "trial")
        importer = recordings.Importer(described, writer)
        for file in described.files([str(source)]):
            importer.add(file)

    def changed(self, kind, random):
        """Returns a seed of this kind with a few changes."""
        seeds = self.seeds[kind]
        data = bytearray(random.choice(seeds))
        for _ in range(random.choice((1, 1, 2, 3, 6))):
            place, length = (
                random.randrange(len(data) + 1),
                min(random.choice((0, 1, 1, 2, 4, 8, 40)), len(data)),
            )
            way = random.randrange(6)
            if way == 0 and place < len(data):
                data[place] ^= 1 << random.randrange(8)
            elif way == 1:
                data[place : place + length] = random.choice(WORDS)
            elif way == 2:  # a number of four or eight bytes, as lengths and counts are written
                value = random.choice(
                    (0, 1, 255, 65535, 2**31 - 1, 2**32 - 1, random.getrandbits(32))
                )
                size = random.choice((1, 2, 4, 8))
                data[place : place + size] = (value % 256**size).to_bytes(
                    size, random.choice(("little", "big"))
                )
            elif way == 3:
                data[place:place] = data[place : place + length]
            elif way == 4:
                other = random.choice(seeds)
                data[place : place + length] = other[place : place + length]
            elif random.random() < 0.2:
                del data[place:]
            else:
                del data[place : place + length]
        return bytes(data)

    def search(self, kinds, runs, seed, keep=None):
        """Reads `runs` changed sources of each kind.

        Args:
            kinds: names of `seeds`
            runs: number for each kind
            seed: of the changes
            keep: folder for the inputs that show a fault; None: they are not kept

        Returns:
            The traceback of the first input for each place of a fault, and the number of inputs of
            each kind that were read.
        """
        faults, taken = {}, dict.fromkeys(kinds, 0)
        for kind in kinds:
            random = Random(f"{kind} {seed}")
            for _ in range(runs):
                data = self.changed(kind, random)
                signal.setitimer(signal.ITIMER_PROF, LONGEST)
                try:
                    self.read(kind, data)
                    taken[kind] += 1
                except slipbench.InputError:
                    pass
                except Exception as error:  # noqa: BLE001
                    frame = traceback.extract_tb(error.__traceback__)[-1]
                    name = (
                        f"{kind}_{type(error).__name__}_{Path(frame.filename).stem}_{frame.lineno}"
                    )
                    if name not in faults:
                        faults[name] = traceback.format_exc()
                        if keep:
                            (keep / name).write_bytes(data)
                finally:
                    signal.setitimer(signal.ITIMER_PROF, 0)
        return faults, taken


def limit():
    """Turns a runaway allocation into a MemoryError.

    Ends the process with a traceback if an input takes too long.
    """
    faulthandler.register(signal.SIGPROF, chain=True)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MEMORY,) * 2)


class Fuzzing(unittest.TestCase):
    """A bounded search, and faults that it must find."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.fuzzer = Fuzzer(Path(folder.name))

    def test_sources_are_read_as_they_are(self):
        for kind, seeds in self.fuzzer.seeds.items():
            for k, seed in enumerate(seeds):
                with self.subTest(kind=kind, seed=k):
                    self.fuzzer.read(kind, seed)

    def test_changed_sources_are_read_or_refused(self):
        faults, taken = self.fuzzer.search(list(self.fuzzer.seeds), RUNS, 1)
        self.assertFalse(faults, "\n".join(faults.values()))
        self.assertEqual([kind for kind, count in taken.items() if not 0 < count < RUNS], [])

    def test_faults_of_every_reader_are_found(self):
        planted = [
            (text, "decoded", "table"),
            (arrays, "read_npy", "npy"),
            (arrays, "read_parquet", "parquet"),
            (bags, "flatten", "mcap"),
        ]
        for module, name, kind in planted:
            owner = module if hasattr(recordings, name) is False else recordings
            with (
                self.subTest(name),
                mock.patch.object(owner, name, side_effect=KeyError("planted")),
            ):
                faults, _ = self.fuzzer.search([kind], 20, 1)
                self.assertTrue(any("planted" in fault for fault in faults.values()))


def main(arguments):
    """Searches as the arguments say."""
    with tempfile.TemporaryDirectory() as folder:
        fuzzer = Fuzzer(Path(folder))
        if arguments.keep:
            arguments.keep.mkdir(parents=True, exist_ok=True)
        if arguments.atheris:
            search_with_atheris(fuzzer, arguments)
            return 0
        limit()
        start = time.process_time()
        kinds = arguments.kinds or list(fuzzer.seeds)
        faults, taken = fuzzer.search(kinds, arguments.runs, arguments.seed, arguments.keep)
    print("\n".join(faults.values()))
    print(
        f"{arguments.runs * len(kinds)} inputs, {len(faults)} places of faults, "
        f"{time.process_time() - start:.0f} s of CPU time; read: {taken}"
    )
    return 1 if faults else 0


def search_with_atheris(fuzzer, arguments):
    """Passes one kind of source to libFuzzer, which ends the process."""
    kind = arguments.atheris
    corpus = arguments.keep / kind
    corpus.mkdir(exist_ok=True)
    for k, seed in enumerate(fuzzer.seeds[kind]):
        (corpus / f"seed_{k}").write_bytes(seed)

    def one(data):
        with contextlib.suppress(slipbench.InputError):
            fuzzer.read(kind, data)

    atheris.Setup(
        [sys.argv[0], *arguments.rest, f"-artifact_prefix={arguments.keep}/{kind}-", str(corpus)],
        one,
    )
    atheris.Fuzz()


if __name__ == "__main__":
    given = options.parse_args()
    if given.runs or given.atheris:
        sys.exit(main(given))
    limit()
    unittest.main(argv=sys.argv[:1])
