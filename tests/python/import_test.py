"""`import --map`: tables as instruments write them, arrays, bags; labels and objects; messages with file and line."""

import contextlib
import json
import os
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
import zipfile
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import slipbench
from backports import zstd
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from slipbench._import import arrays, bags, labels, limits, times
from slipbench._import.block import read_map
from slipbench._import.keys import BLOCKS
from slipbench._import.recordings import Importer, Map
from slipbench.bin import _core

ROWS = [["0.00", "0.500", "1.250"], ["0.01", "0.600", "1.350"], ["0.02", "0.700", "1.450"]]
CHANNELS = "channels: {force: {unit: N, columns: [f1, f2]}}"
MAP = "{sensor: pad, type: own, time: {column: t}, " + CHANNELS + "%s}"


def table(
    separator=",", decimal=".", quote="", end="\n", rows=ROWS, tail="", titles=("t", "f1", "f2")
):
    """Returns a table of three columns in an instrument's format."""
    lines = [separator.join(quote + title + quote for title in titles) + tail]
    lines += [
        separator.join(quote + cell.replace(".", decimal) + quote for cell in row) + tail
        for row in rows
    ]
    return end.join(lines) + end


@contextlib.contextmanager
def printed(path):
    """Captures the output of C++ and Python; yields a function that returns it afterwards."""
    sys.stdout.flush()
    kept = os.dup(1)
    with path.open("wb") as file:
        os.dup2(file.fileno(), 1)
    try:
        yield path.read_text
    finally:
        os.dup2(kept, 1)
        os.close(kept)


class ImportTest(unittest.TestCase):
    """A folder for each test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.count = 0

    def write(self, name, text):
        """Writes a file, whose text may be bytes."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def read(self, map, *sources):
        """Imports in this process; returns the recordings and the texts of the warnings."""
        self.count += 1
        output = self.folder / f"out_{self.count}.h5"
        described = Map(read_map(str(self.write("map.yaml", map))))
        options = _core.import_options(
            [str(source) for source in sources], "", "map.yaml", str(output), 1, None
        )
        writer = _core.MappedImport(options, "object" if described.object else "trial")
        importer = Importer(described, writer)
        files = described.files([str(source) for source in sources])
        for file in files:
            importer.add(file)
        writer.finish(len(files))
        with printed(self.folder / "printed") as text:
            writer.print(json=True)
        data = slipbench.open(output)
        self.addCleanup(data.close)
        return list(data.values()), [warning["text"] for warning in json.loads(text())["warnings"]]

    def force(self, map, *sources):
        """Returns the values and stamps of the sensor `pad` in the only recording."""
        pad = self.read(map, *sources)[0][0].sensors["pad"]
        return np.asarray(pad.force), np.asarray(pad.t)

    def refused(self, map, *sources):
        """Returns the message of the refusal; nothing may be left."""
        with self.assertRaises(slipbench.InputError) as caught:
            self.read(map, *sources)
        self.assertFalse((self.folder / f"out_{self.count}.h5").exists())
        return str(caught.exception)


class Tables(ImportTest):
    """Separators, decimal marks, encodings, cells."""

    def test_every_way_to_write_a_table_gives_the_same_values(self):
        ways = {
            "commas": table(),
            "tabs": table("\t"),
            "semicolons": table(";"),
            "bars": table("|"),
            "blanks": table(" "),
            "blanks in columns": table("   "),
            "decimal commas": table(";", ","),
            "decimal commas, blanks": table(" ", ","),
            "quotes": table(quote='"'),
            "quotes, decimal commas": table(",", ",", '"'),
            "commas at the end": table(tail=",,"),
            "of rows alone": table().replace("50\n", "50,\n"),
            "Windows": table(end="\r\n"),
            "old Mac": table(end="\r"),
            "blank lines": "\n" + table().replace("\n0.01", "\n\n0.01") + "\n\n",
            "blanks after commas": table(", "),
            "comment": "# logger 3, 12 N cell\n" + table(),
            "sep": "sep=;\n" + table(";"),
            "signs": table().replace("0.6", "+0.6"),
            "mark": b"\xef\xbb\xbf" + table().encode(),
            "UTF-16": table().encode("utf-16"),
            "UTF-16 without a mark": table().encode("utf-16-le"),
            "exponents": table().replace("0.600", "6E-1"),
        }
        for name, text in ways.items():
            with self.subTest(name):
                values, times = self.force(MAP % "", self.write("a.csv", text))
                np.testing.assert_array_equal(
                    values, np.array([[0.5, 1.25], [0.6, 1.35], [0.7, 1.45]], np.float32)
                )
                np.testing.assert_array_equal(times, [0, 0.01, 0.02])

    def test_keys_say_what_is_not_found(self):
        units = table().replace("f2\n", "f2\ns,N,N\n")
        self.assertIn(
            "a.csv:2: column 1, t: expected a number, found 's'; skip a row of units by skip: [2]",
            self.refused(MAP % "", self.write("a.csv", units)),
        )
        first = "a logger\n2026\n" + table()
        for text, keys in (
            (units, "skip: [2]"),
            (first, "skip: 2"),
            ("% x\n" + table(), "comment: '%'"),
            (table(":"), "separator: ':'"),
            (table(";", ","), "separator: ;, decimal: ','"),
        ):
            with self.subTest(keys):
                values, _ = self.force(MAP % f", {keys}", self.write("a.csv", text))
                self.assertEqual(values.shape, (3, 2))
        bare = "{sensor: pad, type: own, header: false, time: {column: 1}, channels: {force: {unit: N, columns: [2 .. 3]}}}"
        values, _ = self.force(bare, self.write("a.csv", table().partition("\n")[2]))
        self.assertEqual(values.shape, (3, 2))

    def test_a_table_that_cannot_be_read_is_refused_with_its_line(self):
        def changed(old, new):
            return table().replace(old, new)

        cases = {
            "commas twice": (
                table(",", ","),
                "a.csv:2: has 6 cells; expected 3; commas seem to be both the separator and the decimal mark",
            ),
            "word": (
                changed("0.600", "True"),
                "a.csv:3: column 2, f1: expected a number, found 'True'",
            ),
            "unit": (
                changed("0.600", "0.6 N"),
                "a.csv:3: column 2, f1: expected a number, found '0.6 N'",
            ),
            "thousands": (
                changed("0.600", '"1,234.5"'),
                "found '1,234.5'; set the mark between thousands in the map: thousands: ','",
            ),
            "Fortran": (changed("0.600", "0.6D1"), "found '0.6D1'; write the exponent with E"),
            "infinite": (
                changed("0.600", "inf"),
                "a.csv:3: column 2, f1: expected a number, found 'inf'",
            ),
            "titles": (
                table(titles=("T", "F1", "f2")),
                "a.csv:1: has no column 'f1'; did you mean 'F1'? found: T, F1, f2",
            ),
            "none": (
                table().partition("\n")[2],
                "the first line contains numbers: a table without titles needs header: false",
            ),
            "empty": ("", "a.csv:1: the file has no row"),
            "titles alone": ("t,f1,f2\n", "a.csv:1: the table has titles but no rows"),
            "one row": (
                "t,f1,f2\n0,1,2\n",
                "a.csv: has 1 sample; at least two are needed to determine the rate",
            ),
            "back": (
                changed("0.02", "0.01"),
                "a.csv:4: column 1, time: 0.01 s is the time of line 3, too; expected ascending times",
            ),
            "twice": (
                table(titles=("t", "f1", "f1")).replace("f1,f1", "f1,f1,f2"),
                "a.csv:1: has 2 columns 'f1'",
            ),
            "bytes": (b"t,f1\0\xff" * 9, "a.csv: is not text"),
            "no value": (
                changed("0.600", ""),
                "a.csv:3: column f1 has no value; expected a number in each row, or missing: gap",
            ),
            "short": (table() + "0.03,1\n", "a.csv:5: column f2 has no value"),
            "all short": ("t,f1,f2\n0,1\n1,2\n", "a.csv:2: column f2 has no value"),
        }
        for name, (text, message) in cases.items():
            with self.subTest(name):
                self.assertIn(message, self.refused(MAP % "", self.write("a.csv", text)))

    def test_logs_of_an_arduino_are_named(self):
        rows = range(3)
        monitor = "; lines begin with '12:00:01.000 ->', like times of Arduino's serial monitor: replace ' -> '"
        plotter = "are a name and a number, like output for Arduino's serial plotter: write only the numbers"
        bare = "{sensor: pad, type: own, header: false, time: {column: 1}, channels: {force: {unit: N, columns: [2, 3]}}}"
        stamped = "".join(f"12:00:01.{k:03d} -> {k},2,3\n" for k in rows)
        cases = {
            "a time before the values": (stamped, bare, monitor),
            "a time before the titles": ("12:00:00.900 -> t,f1,f2\n" + stamped, MAP % "", monitor),
            "a time before blanks": (
                "".join(f"12:00:01.{k:03d} -> {k} 2 3\n" for k in rows),
                bare,
                monitor,
            ),
            "names with commas": ("".join(f"f1:{k},f2:2.5\n" for k in rows), MAP % "", plotter),
            "names with tabs": (
                "".join(f"f1:{k}\tf2:-1e3\n" for k in rows),
                bare.replace(", 3", ""),
                plotter,
            ),
            "names with blanks": ("".join(f"f1: {k} f2: 2.5\n" for k in rows), bare, plotter),
        }
        for name, (text, map, message) in cases.items():
            with self.subTest(name):
                self.assertIn(message, self.refused(map, self.write("a.csv", text)))
        # 40,000 letters without a number: the search takes time proportional to their number, and
        # the message has few of them.
        message = self.refused(MAP % "", self.write("a.csv", ("a" * 40_000 + "\n") * 50))
        self.assertRegex(message, r"has no column 'f1'; found: a{60}…; read as one column")

    def test_missing_cells_are_gaps_or_nan_and_reported_with_place_and_length(self):
        rows = [[f"{k / 100:.2f}", f"{k}", "1"] for k in range(10)]
        rows[3][1], rows[4][2], rows[8][1] = "", "NaN", "NA"
        path = self.write("a.csv", table(rows=rows))
        recordings, warnings = self.read(MAP % ", missing: gap", path)
        pad = recordings[0].sensors["pad"]
        np.testing.assert_array_equal(np.asarray(pad.force)[:, 0], [0, 1, 2, 5, 6, 7, 9])
        # Rows 3 and 4 (lines 5, 6) between 0.02 s and 0.05 s; row 8 (line 10) between 0.07 s and
        # 0.09 s.
        self.assertIn(
            f"{path}: 3 of 10 samples have missing values and are left out: 2 at {path}:5, 0.03 s from 0.02 s on; "
            f"1 at {path}:10, 0.02 s from 0.07 s on",
            warnings,
        )
        pad = self.read(MAP % ", missing: nan", path)[0][0].sensors["pad"]
        self.assertEqual(
            np.argwhere(np.isnan(np.asarray(pad.force))).tolist(), [[3, 0], [4, 1], [8, 0]]
        )
        self.assertTrue(slipbench.verify(self.folder / f"out_{self.count}.h5")["holds"])

    def test_resampling_keeps_the_samples_beside_missing_ones(self):
        rows = [[f"{k / 10:.1f}", f"{k}", "1"] for k in range(6)]
        rows[3][1] = ""
        output = self.folder / "resampled.h5"
        self.write("map.yaml", MAP % ", missing: nan")
        with self.assertWarnsRegex(UserWarning, "1 of 6 samples has missing values"):
            slipbench.import_recordings(
                self.write("a.csv", table(rows=rows)),
                output,
                map=self.folder / "map.yaml",
                rate="10 Hz",
            )
        with slipbench.open(output) as data:
            np.testing.assert_array_equal(
                np.asarray(data[0].sensors["pad"].force)[:, 0], [0, 1, 2, np.nan, 4, 5]
            )

    def test_times_have_a_unit_are_dates_or_follow_from_a_rate(self):
        def timed(cells, time):
            return self.force(
                MAP.replace("{column: t}", time) % "",
                self.write("a.csv", table(rows=[[cell, "1", "2"] for cell in cells])),
            )[1]

        np.testing.assert_allclose(
            timed(["10", "20", "30"], "{column: t, unit: ms}"), [0.01, 0.02, 0.03]
        )
        np.testing.assert_allclose(timed(["1", "2", "3"], "{column: t, scale: 0.5}"), [0.5, 1, 1.5])
        np.testing.assert_allclose(timed(["x", "y", "z"], "{rate: 50 Hz}"), [0, 0.02, 0.04])
        # 2026-02-03T10:00:00Z is 1,770,112,800 s after 1970.
        np.testing.assert_allclose(
            timed(
                [
                    "2026-02-03T10:00:00.000",
                    "2026-02-03T10:00:00.010",
                    "2026-02-03T11:00:00.020+01:00",
                ],
                "{column: t}",
            ),
            1770112800 + np.array([0, 0.01, 0.02]),
            rtol=0,
            atol=1e-6,
        )
        np.testing.assert_allclose(
            timed(["10:00:00.00", "10:00:00.01", "10:00:00.02"], "{column: t}"),
            [36000, 36000.01, 36000.02],
        )
        self.assertIn(
            "has no key 'time'",
            self.refused(MAP.replace("time: {column: t}, ", "") % "", self.write("a.csv", table())),
        )

    def test_times_as_programs_write_them(self):
        def stamps(time, *cells):
            path = self.write("a.csv", table(";", rows=[[cell, "1", "2"] for cell in cells]))
            return self.force((MAP % "").replace("{column: t}", time), path)[1]

        # 2023-05-11T14:22:33Z is 1,683,814,953 s after 1970.
        for pattern, first, second in (
            ("%d-%b-%Y %H:%M:%S.%f", "11-May-2023 14:22:33.500", "11-May-2023 14:22:33.750"),
            ("%m/%d/%Y %I:%M:%S.%f %p", "5/11/2023 2:22:33.500 PM", "5/11/2023 2:22:33.750 PM"),
            (
                "%d.%m.%Y %H:%M:%S,%f %z",
                "11.05.2023 16:22:33,5 +0200",
                "11.05.2023 16:22:33,75 +0200",
            ),
        ):
            time = f"{{column: t, format: '{pattern}'}}"
            self.assertEqual(stamps(time, first, second).tolist(), [1683814953.5, 1683814953.75])
        path = self.write("a.csv", table(rows=[["11.5.2023 14:22", "1", "2"]] * 2))
        self.assertIn(
            "a.csv:2: column t: expected a time in the format of time.format, '%d.%m.%y', found '11.5.2023 14:22'",
            self.refused(
                (MAP % "").replace("{column: t}", "{column: t, format: '%d.%m.%y'}"), path
            ),
        )
        self.assertIn("such as '%d.%m.%Y %H:%M:%S.%f'", self.refused(MAP % "", path))
        # ros2 topic echo --csv
        path = self.write("a.csv", "5,990000000,pad,1,2\n6,0,pad,1,2\n6,10000000,pad,1,2\n")
        map = "{sensor: pad, type: own, header: false, time: {column: '1', nanoseconds: '2'}, channels: {force: {unit: N, columns: ['4', '5']}}}"
        np.testing.assert_allclose(self.force(map, path)[1], [5.99, 6, 6.01], rtol=0, atol=1e-12)
        for keys in ("unit: s, nanoseconds: '2'", "format: '%s', scale: 2"):
            self.assertIn(
                "time: expected one of unit, scale, format and nanoseconds, found",
                self.refused((MAP % "").replace("{column: t}", "{column: t, " + keys + "}"), path),
            )

    def test_iso_8601_is_read_right_or_refused(self):
        # 2024-03-11 is day 71 of its year, the Monday of week 11, and 19,793 days after 1970-01-01:
        # 54 years of 365 days, 13 leap days (1972 to 2020), 31 + 29 days of 2024 and 10 days of March.
        day = 86400 * (54 * 365 + 13 + 31 + 29 + 10)
        for text, seconds, resolution in (
            ("2024-03-11T23:40:05", day + 23 * 3600 + 40 * 60 + 5, 1),
            ("2024-03-11T23:40:05.25", day + 23 * 3600 + 40 * 60 + 5.25, 0.01),
            ("2024-03-11 23:40:05,25Z", day + 23 * 3600 + 40 * 60 + 5.25, 0.01),
            # A fraction counts in the last part that is written: 0.05 min is 3 s, 0.25 h is 15 min.
            ("2024-03-11T23:40.05", day + 23 * 3600 + 40 * 60 + 3, 0.6),
            ("2024-03-11T23,25", day + 23 * 3600 + 15 * 60, 36),
            ("2024-03-11T23:40", day + 23 * 3600 + 40 * 60, 60),
            ("20240311T234005", day + 23 * 3600 + 40 * 60 + 5, 1),
            ("20240311T2340.5+0100", day + 22 * 3600 + 40 * 60 + 30, 6),
            ("2024-03-11T23:40:05-05:30", day + 86400 + 5 * 3600 + 10 * 60 + 5, 1),
            ("2024-03-11T23:40:05\N{MINUS SIGN}05", day + 86400 + 4 * 3600 + 40 * 60 + 5, 1),
            ("2024-W11-1T01:00", day + 3600, 60),
            ("2024W111T01", day + 3600, 3600),
            ("2024-071T01:00:00", day + 3600, 1),
            ("2024071T010000", day + 3600, 1),
            ("2024-03-10T24:00:00", day, 1),  # the end of a day is the beginning of the next
            ("2024-03-11", day, 86400),
            ("12:30:00,5", 45000.5, 0.1),
            ("24:00:00", 86400, 1),
        ):
            with self.subTest(text):
                self.assertTrue(times.is_moment(text))
                found, written = times.moment_of(text)
                self.assertEqual(found, seconds)
                self.assertAlmostEqual(written, resolution, places=12)
        for text in (
            "2024-03-11T24:00:01",
            "2024-03-11T25:00",
            "2024-03-11T23:60",
            "2024-03-11T23:40:60",  # seconds since 1970 know no leap second
            "2024-02-30T00:00",
            "2023-366T00:00",
            "2024-W53-1T00:00",
            "2024-0311T00:00",
            "2024-03-11T23:4005",
            "2024-03-11T23:40:05+24:00",
            "2024-03-11T23:40:05.5.5",
            "2024-03",
            "12:30",  # minutes and seconds, or hours and minutes
            "12:30.5",
        ):
            with self.subTest(text), self.assertRaises(ValueError):
                times.moment_of(text)
        for text in ("20240311", "12.5", "1e-3"):
            self.assertFalse(times.is_moment(text))
        rows = [[f"2024-03-11T23:40.0{k}", "1", "2"] for k in (5, 6, 7)]
        np.testing.assert_allclose(
            self.force(MAP % "", self.write("a.csv", table(rows=rows)))[1] - day,
            85200 + np.array([3, 3.6, 4.2]),
            atol=1e-6,
        )
        self.assertIn(
            "a.csv:2: column t: expected a time in ISO 8601 such as 2026-02-03T10:00:00.01, or a time of day such as 10:00:00.01, found '12:30'",
            self.refused(MAP % "", self.write("a.csv", table(rows=[["12:30", "1", "2"]] * 2))),
        )

    def test_times_that_do_not_ascend_are_explained(self):
        def message(*cells, time="{column: t}"):
            path = self.write("a.csv", table(rows=[[cell, "1", "2"] for cell in cells]))
            return self.refused((MAP % "").replace("{column: t}", time), path).split("a.csv", 1)[1]

        for clock in ("{column: t}", "{column: t, unit: us}"):
            self.assertEqual(
                message("0", "0", "0", time=clock),
                ":1: column 1, time: t is 0 s in all 3 samples; use time: {rate: 100 Hz}, with your rate",
            )
        self.assertEqual(
            message("1710201598.118", "1710201598.120", "1710201598.120"),
            ":4: column 1, time: 1710201598.12 s is the time of line 3, too; expected ascending times",
        )
        self.assertEqual(
            message("0.1", "0.104", "0.102"),
            ":4: column 1, time: 0.102 s comes after 0.104 s in line 3, 2 ms earlier; expected ascending times",
        )
        # Counters of 2^32 us and 2^16 ms, with 500 us and 1 ms between samples.
        self.assertIn(
            "the time jumps back by 2^32 us: a counter of 32 bits has wrapped; use wrap: 4294.967296 s",
            message("4294966.796", "4294967.296", "0.5", time="{column: t, unit: ms}"),
        )
        self.assertIn(
            "the time jumps back by 2^16 ms: a counter of 16 bits has wrapped; use wrap: 65.536 s",
            message("65534", "65535", "0", time="{column: t, unit: ms}"),
        )
        self.assertIn(
            "; the clock passed midnight; write the times with their date, or use wrap: 1 day",
            message("23:59:59.8", "23:59:59.9", "00:00:00.0"),
        )
        self.assertIn(
            "a clock of 12 hours passed noon or midnight; use wrap: 12 h",
            message("11:59:59.8", "11:59:59.9", "00:00:00.0"),
        )
        self.assertIn(
            "if the file has several recordings, write each into its own file",
            message("0", "0.1", "0.2", "0"),
        )

    def test_times_that_start_again_go_on_by_the_period(self):
        def stamps(time, *cells):
            path = self.write("a.csv", table(rows=[[cell, "1", "2"] for cell in cells]))
            return self.force((MAP % "").replace("{column: t}", time), path)[1]

        # Two midnights: 86,400 s and 172,800 s after the first.
        found = stamps("{column: t, wrap: 1 day}", "20:00:00", "04:00:00", "16:00:00", "03:00:00")
        self.assertEqual(found.tolist(), [72000, 86400 + 14400, 86400 + 57600, 172800 + 10800])
        # A counter of 2^16 in ms, 65.536 s: 65,535 is followed by 0.
        found = stamps("{column: t, unit: ms, wrap: 65.536 s}", "65534", "65535", "0", "1")
        np.testing.assert_allclose(found, [65.534, 65.535, 65.536, 65.537], rtol=0, atol=1e-12)
        self.assertEqual(
            stamps("{column: t, wrap: 2 days}", "25:00:00", "00:00:01").tolist(), [90000, 172801]
        )
        self.assertEqual(
            stamps("{column: t, wrap: 12 h}", "11:59:59", "00:00:00").tolist(), [43199, 43200]
        )
        path = self.write("a.csv", table(rows=[[cell, "1", "2"] for cell in ("0", "5", "11")]))
        for clock, message in (
            (
                "{column: t, wrap: 10 s}",
                "map.yaml:1: time.wrap: .*a.csv:1: the times span 11 s; expected times within 10 s",
            ),
            ("{column: t, wrap: 1 year}", "map.yaml:1: time.wrap: .*'year'.*; or in day or h$"),
            (
                "{column: t, wrap: 0 s}",
                "map.yaml:1: time.wrap: expected a time such as '1 day', found '0 s'",
            ),
            (
                "{rate: 1 Hz, wrap: 1 day}",
                "map.yaml:1: time: wrap is for a column of times, not for a rate",
            ),
        ):
            self.assertRegex(self.refused((MAP % "").replace("{column: t}", clock), path), message)

    def test_a_step_forward_by_more_than_half_of_the_period_is_refused(self):
        """Swapped samples at midnight would begin two days: 86399.9, 86400, 172799.95, 172800.1."""
        map = (MAP % ", missing: gap").replace("{column: t}", "{column: t, wrap: 10 s}")
        # The third row has no time: line 5 follows line 3, by 9.97 s - 0.01 s.
        path = self.write(
            "a.csv", table(rows=[[cell, "1", "2"] for cell in ("9.95", "0.01", "", "9.97", "0.02")])
        )
        self.assertEqual(
            self.refused(map, path),
            f"{path}:5: column 1, time: 9.97 s is 9.96 s after the time of line 3; expected at most half of time.wrap, 5 s: sort samples that "
            "are in another order, and split the file at a long pause",
        )
        path = self.write(
            "a.csv", table(rows=[[cell, "1", "2"] for cell in ("9", "2", "7", "1")])
        )  # half of the period, forward
        np.testing.assert_allclose(self.force(map, path)[1], [9, 12, 17, 21], rtol=0, atol=1e-12)

    def test_long_cells_and_titles_end_at_once_and_are_cut_in_messages(self):
        """A cell of n digits has n ways to be a number with an optional point; trying all for each digit took 30 s for 20,000."""
        digits = "1" * 500_000
        began = time.monotonic()
        message = self.refused(
            MAP % "", self.write("a.csv", table().replace("0.600", digits + "x"))
        )
        self.assertRegex(message, r"a.csv:3: column 2, f1: expected a number, found '1{60}…'$")
        message = self.refused(
            (MAP % "").replace("column: t", f"column: {digits}"),
            self.write("a.csv", table(titles=("2" * 500_000, "f1", "f2"))),
        )
        self.assertRegex(message, r"a.csv:1: has no column '1{60}…'; found: 2{60}…, f1, f2")
        self.assertLess(time.monotonic() - began, 20)

    def test_keys_of_another_kind_say_what_is_expected(self):
        path = self.write("a.csv", table())
        for keys, message in (
            (
                "files: [a]",
                "files: expected a text (pattern for the names of the files that are read in folders, such as '*_bio.csv'; files given by name are always read), found a list",
            ),
            ("header: [a]", "header: expected true or false, found a list"),
        ):
            self.assertEqual(
                self.refused(MAP % f", {keys}", path), f"{self.folder}/map.yaml:1: {message}"
            )
        for clock, message in (
            ("wrap: [1]", "time.wrap: expected a time such as '1 day', found a list"),
            ("rate: {a: b}", "time.rate: expected a rate such as '100 Hz', found a map"),
        ):
            self.assertIn(
                message,
                self.refused((MAP % "").replace("{column: t}", f"{{column: t, {clock}}}"), path),
            )

    def test_formats_of_times_are_checked_with_the_map(self):
        path = self.write("a.csv", table())
        for pattern, reason in (
            ("%Y" * 2000, "has 4000 characters; expected at most 100"),
            ("%Y %Y", "names a part twice"),
            ("%q", "'q' is a bad directive"),
        ):
            self.assertRegex(
                self.refused(
                    (MAP % "").replace("{column: t}", "{column: t, format: '" + pattern + "'}"),
                    path,
                ),
                rf"map.yaml:1: time.format: expected a format of strptime, found .*: {reason}",
            )

    def test_files_that_are_not_tables_are_named(self):
        for beginning, message in (
            (b"MATLAB 5.0 MAT-file, Platform", "is a MATLAB file; .*; read it by scipy.io.loadmat"),
            (b"\x89HDF\r\n\x1a\n", "is an HDF5 file"),
            (b"PK\x03\x04", "is a zip archive, such as Excel's .xlsx"),
            (b"\x80\x04\x95", "is a pickle file of Python"),
            (b"PAR1", "is a Parquet file; .*; rename it to .parquet"),
            (b"%PDF-1.7\n", "is a PDF document; .*; save the table as .csv"),
            (b'{"t": [0, 1]}', "is a JSON file; .*; read it by pandas.read_json"),
            (b' [\n {"t": 0}]', "is a JSON file"),
            (b"[[0, 1], [2, 3]]", "is a JSON file"),
        ):
            self.assertRegex(
                self.refused(MAP % "", self.write("a.csv", beginning + bytes(8))),
                f"a.csv: {message}",
            )
        head = (
            "LabVIEW Measurement\t\n***End_of_Header***\t\nX0\t0\t0\t\n***End_of_Header***\t\t\t\n"
            + table("\t")
        )
        self.assertIn(
            "a.lvm:1: has no column 'f1'; found: LabVIEW Measurement; the file begins with a header of LabVIEW, and the titles are in line 5: skip: 4",
            self.refused(MAP % "", self.write("a.lvm", head)),
        )
        self.assertEqual(len(self.force(MAP % ", skip: 4", self.write("a.lvm", head))[0]), 3)

    def test_characters_that_look_alike_are_named(self):
        self.assertIn(
            "has no column 'f1'; did you mean 'f1\\u200b'? 'f1\\u200b' has U+200B (zero width space);",
            self.refused(MAP % "", self.write("a.csv", table(titles=("t", "f1\u200b", "f2")))),
        )
        for cell, message in (
            ("1\u00a0000", "found '1\\xa0000', which has U+00A0 (no-break space)"),
            ("1\uff0e5", "found '1\uff0e5', which has U+FF0E (fullwidth full stop)"),
            ("\u20131", "found '\u20131', which has U+2013 (en dash)"),
        ):
            self.assertIn(
                message, self.refused(MAP % "", self.write("a.csv", table().replace("0.600", cell)))
            )

    def test_a_title_cannot_stop_the_import(self):
        path = self.write("a.csv", table(titles=("t", "f" + "1" * 5000, "f2")))
        star = (MAP % "").replace("[f1, f2]", "['%s']")
        # Titles with more digits than a number has are no match; a pattern that could divide digits in many ways is refused.
        self.assertEqual(self.force(star % "f*", path)[0].shape, (3, 1))
        self.assertIn("'f**': a * stands for a whole number", self.refused(star % "f**", path))
        self.assertIn("'f*1*1': a * stands for a whole number", self.refused(star % "f*1*1", path))

    def test_tables_of_programs(self):
        """LabVIEW, pandas, numpy, Instron and R, with the text around the numbers."""
        want = [[0.5, 1.25], [0.6, 1.35], [0.7, 1.45]]
        lines = table("\t")
        head = "LabVIEW Measurement\t\nDecimal_Separator\t.\n***End_of_Header***\t\n\t\nX0\t0\t0\t\n***End_of_Header***\t\t\t\n"
        titled = head + lines.replace("t\tf1\tf2", "t\tf1\tf2\tComment")
        named = '"t" "f1" "f2"\n"a" 0.00 0.500 1.250\n"b" 0.01 0.600 1.350\n"c" 0.02 0.700 1.450\n'
        numbers = MAP.replace("{column: t}", "{column: '%s'}").replace("[f1, f2]", "['%s', '%s']")
        for name, text, map in (
            ("a.lvm", titled, MAP % ", skip: 6"),
            ("a.csv", table(titles=("", "f1", "f2")), MAP.replace("column: t", "column: '1'") % ""),
            ("a.txt", "# a log\n# " + table(" "), MAP % ""),
            ("a.csv", table(quote='"').replace("0.600", "1,000.6"), MAP % ", thousands: ','"),
            ("a.csv", table(";", ",").replace("0,600", "1.000,6"), MAP % ", thousands: ."),
            ("a.txt", named, numbers[:-3] % (2, 3, 4) + ", skip: 1, header: false}"),
        ):
            with self.subTest(text=text):
                values = self.force(map, self.write(name, text))[0]
                np.testing.assert_allclose(
                    np.where(values > 1000, values - 1000, values), want, rtol=0, atol=1e-4
                )
        self.write("b/a.lvm", titled)
        self.assertEqual(len(self.read(MAP % ", skip: 6", self.folder / "b")[0]), 1)  # of a folder
        self.assertIn(
            "a.txt:2: has 4 cells; expected 3; where rows begin with a name that has no title, as R writes them, use header: false",
            self.refused(MAP % "", self.write("a.txt", named)),
        )
        self.assertIn(
            "found '1,00.6'",
            self.refused(
                MAP % ", thousands: ','", self.write("a.csv", table(";").replace("0.600", "1,00.6"))
            ),
        )
        self.assertIn(
            "decimal and thousands: expected two marks, found ',' for both",
            self.refused(MAP % ", decimal: ',', thousands: ','", self.write("a.csv", table(";"))),
        )

    def test_empty_rows_and_missing_cells_shift_nothing(self):
        rate = MAP.replace("{column: t}", "{rate: 100 Hz}") % ", missing: gap"
        # The second sample is empty: the third stays at 0.02 s.
        for name, map, text in (
            ("a.tsv", rate, "f1\tf2\n1\t2\n\t\n3\t4\n5\t6\n"),
            ("a.txt", rate.replace("f1, f2", "f1"), "f1\n1\n\n3\n5\n\n"),
        ):
            with self.subTest(name):
                path = self.write(name, text)
                values, times = self.force(map, path)
                self.assertEqual(values[:, 0].tolist(), [1, 3, 5])
                self.assertEqual(times.tolist(), [0, 0.02, 0.03])
                self.assertIn(
                    f"{name}:3: column f1 has no value",
                    self.refused(map.replace(", missing: gap", ""), path),
                )
        for missing in ("", ", missing: gap", ", missing: nan"):
            self.assertIn(
                "a.txt:3: has 2 cells; expected 3: with blanks as separators the missing cell is unknown",
                self.refused(MAP % missing, self.write("a.txt", "t f1 f2\n0 1 2\n1 2\n2 3 4\n")),
            )

    def test_commas_that_mean_two_things_are_refused(self):
        path = self.write("a.csv", table(rows=[["0", '"1,000"', "1"], ["1", '"1,001"', "2"]]))
        self.assertIn(
            "a.csv:2: '1,000' has a decimal comma or a mark between thousands, which cannot be distinguished",
            self.refused(MAP % "", path),
        )
        self.assertEqual(self.force(MAP % ", thousands: ','", path)[0][:, 0].tolist(), [1000, 1001])
        self.assertEqual(self.force(MAP % ", decimal: ','", path)[0][1, 0], np.float32(1.001))
        # Programs that write decimal commas separate cells by semicolons.
        path = self.write("a.csv", table(";", rows=[["0", "1,000", "1"], ["1", "1,001", "2"]]))
        self.assertEqual(self.force(MAP % "", path)[0][1, 0], np.float32(1.001))
        self.assertIn(
            "found '1e400'",
            self.refused(MAP % "", self.write("a.csv", "t,f1,f2\n0,1e400,1\n1,2,3\n")),
        )

    def test_the_rate_follows_from_the_digits_of_the_stamps(self):
        """Steps of 1/77 s in ms, written in two ways.

        The rate is 77 Hz, not one with fewer digits.
        """
        milliseconds = [round(1000 * k / 77) for k in range(201)]
        for clock, keys, cells in (
            (
                "{column: t, format: '%d.%m.%Y %H.%M.%S.%f'}",
                "",
                [f"03.02.2026 10.00.{k // 1000:02d}.{k % 1000:03d}" for k in milliseconds],
            ),
            ("{column: t, unit: ms}", ", thousands: ','", [f'"{k:,}"' for k in milliseconds]),
        ):
            path = self.write("a.csv", table(rows=[[cell, "1", "2"] for cell in cells]))
            pad = self.read((MAP % keys).replace("{column: t}", clock), path)[0][0].sensors["pad"]
            self.assertEqual(pad.rate, 77.0)
        self.assertIn(
            "found '10:75:00'",
            self.refused(
                MAP % "",
                self.write("a.csv", table(rows=[["10:75:00", "1", "2"], ["10:76:00", "1", "2"]])),
            ),
        )

    def test_a_unit_of_slow_times_is_proposed_where_it_can_be_another(self):
        rows = [[str(10_000 * k), "1", "2"] for k in range(5)]
        path = self.write("a.csv", table(rows=rows))
        for unit, message in {
            "": "one sample every 1e+04 s; times in us would give 100 Hz (time: {unit: us} in the map)",  # 1e4 us is 1/(100 Hz)
            ", unit: ms": "one sample every 10 s; times in us would give 100 Hz (time: {unit: us} in the map)",
        }.items():
            with self.subTest(unit):
                self.assertIn(
                    message,
                    self.read((MAP % "").replace("column: t", "column: t" + unit), path)[1][0],
                )
        minutes = [[f"2026-01-01T10:0{k}:00", "1", "2"] for k in range(5)]
        self.assertEqual(self.read(MAP % "", self.write("b.csv", table(rows=minutes)))[1], [])
        days = (MAP % "").replace("column: t", "column: t, format: '%d.%m.%Y'")
        rows = [[f"0{k}.01.2026", "1", "2"] for k in range(1, 6)]
        self.assertEqual(self.read(days, self.write("c.csv", table(rows=rows)))[1], [])

    def test_a_rate_that_is_given_is_the_rate(self):
        path = self.write("a.csv", table())
        self.assertEqual(
            self.read(MAP.replace("{column: t}", "{rate: 2 kHz}") % "", path)[0][0]
            .sensors["pad"]
            .rate,
            2000.0,
        )


class Layouts(ImportTest):
    """Columns, sensors, labels, objects, files."""

    def test_columns_are_ranges_and_patterns(self):
        titles = ["t", *(f"p{k} f{axis}" for axis in "xyz" for k in (0, 1, 10))]
        rows = [[f"{row}", *(str(k) for k in range(9))] for row in range(2)]
        path = self.write("a.csv", "\n".join(",".join(row) for row in [titles, *rows]))
        values, _ = self.force(
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [p* fx, p* fy, p* fz]}}}",
            path,
        )
        # Columns x of the pillars 0, 1, 10 are 0 to 2, y 3 to 5, z 6 to 8.
        np.testing.assert_array_equal(values[0], [[0, 3, 6], [1, 4, 7], [2, 5, 8]])
        values, _ = self.force(
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, scale: 2, columns: [p1 fx .. p0 fy]}}}",
            path,
        )
        np.testing.assert_array_equal(values[0], [2, 4, 6])

    def test_columns_are_not_confused(self):
        path = self.write("a.csv", "t,a,b,b,c\n0,1,2,3,4\n1,1,2,3,4\n")
        map = MAP.replace("f1, f2", "%s") % ("a .. c", "")
        self.assertIn("a.csv:1: has 2 columns 'b'", self.refused(map, path))
        path = self.write("a.csv", "t,p0x,p2x,p0y,p1y\n0,1,2,3,4\n1,1,2,3,4\n")
        self.assertIn(
            "a.csv:1: the column 'p1y' would be paired with 'p2x'",
            self.refused(map.replace("a .. c", "'p*x', 'p*y'"), path),
        )

    def test_channels_are_stored_in_si_units(self):
        # Factors to SI; gravity has its standard value, 9.80665 m/s2. g is a mass, a force or an
        # acceleration, and remains, as do unknown units.
        for unit, si, factor in (
            ("N", "N", 1.0),
            ("mN", "N", 1e-3),
            ("kN", "N", 1e3),
            ("uN", "N", 1e-6),
            ("\u00b5N", "N", 1e-6),
            ("\u03bcN", "N", 1e-6),
            ("mV", "V", 1e-3),
            ("gf", "N", 9.80665e-3),
            ("kgf", "N", 9.80665),
            ("mm", "m", 1e-3),
            ("um", "m", 1e-6),
            ("\u00b5m", "m", 1e-6),
            ("mm/s", "m/s", 1e-3),
            ("kPa", "Pa", 1e3),
            ("deg", "rad", np.pi / 180),
            ("g", "g", 1.0),
            ("counts", "counts", 1.0),
            ("1", "1", 1.0),
            ("%", "%", 1.0),
            ("count", "counts", 1.0),
            ("uT", "uT", 1.0),
            ("\u00b5T", "uT", 1.0),
            ("mT", "uT", 1e3),
            ("T", "uT", 1e6),
            ("nT", "uT", 1e-3),
        ):
            with self.subTest(unit=unit):
                source = self.write("a.csv", table())
                pad = self.read(
                    f"{{sensor: pad, type: own, time: {{column: t}}, channels: {{force: {{unit: {json.dumps(unit)}, scale: 2, columns: [f1]}}}}}}",
                    source,
                )[0][0].sensors["pad"]
                self.assertEqual(pad.units, {"force": si})
                np.testing.assert_allclose(
                    pad.force[:, 0], 2 * factor * np.array([0.5, 0.6, 0.7]), rtol=1e-7
                )

    def test_a_recording_in_another_unit_is_the_same_recording(self):
        rows = [
            [f"{0.01 * k:.2f}", *(f"{0.1 * (k + i) % 3:.3f}" for i in range(6))] for k in range(40)
        ]
        titles = ["t", *(f"f{i}" for i in range(3)), *(f"d{i}" for i in range(3))]
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: %s, components: 3, columns: [f0 .. f2]}, displacement: {unit: %s, components: 3, columns: [d0 .. d2]}}}"
        milli = [[row[0], *(f"{1e3 * float(cell):.0f}" for cell in row[1:])] for row in rows]
        si = self.read(map % ("N", "m"), self.write("si.csv", table(rows=rows, titles=titles)))[0][
            0
        ].sensors["pad"]
        small = self.read(
            map % ("mN", "mm"), self.write("milli.csv", table(rows=milli, titles=titles))
        )[0][0].sensors["pad"]
        np.testing.assert_array_equal(si.force, small.force)
        np.testing.assert_array_equal(si.displacement, small.displacement)

    def test_labels_are_of_their_own_files(self):
        """A folder's name does not match a file, and a table's row does not match two files."""
        for name in ("slip_set/none_1.csv", "other/none_1.csv"):
            self.write(f"set/{name}", table())
        map = MAP % ", state: {file: '(slip|none)', values: {slip: 3, none: 1}, rule: the file}"
        trials, _ = self.read(map, self.folder / "set")
        self.assertEqual([int(trial.labels["pad"].state_paper[0]) for trial in trials], [1, 1])
        labels = self.write("set/labels/all.csv", "file,label\nnone_1.csv,3\n")
        map = MAP % ", state: {table: {path: ../labels/all.csv, column: label}, rule: a table}"
        self.assertIn(
            "the row 'none_1.csv' means other/none_1.csv and slip_set/none_1.csv",
            self.refused(map, self.folder / "set"),
        )
        labels.write_text("file,label\nother/none_1.csv,3\nslip_set/none_1.csv,1\n")
        trials, _ = self.read(map, self.folder / "set")
        self.assertEqual([int(trial.labels["pad"].state_paper[0]) for trial in trials], [3, 1])

    def test_warnings_of_missing_samples_name_the_sensor(self):
        map = (
            "{time: {column: t}, missing: gap, sensors: {a: {type: own, channels: {force: {unit: N, columns: [f1]}}}, "
            "b: {type: own, channels: {force: {unit: N, columns: [f2]}}}}}"
        )
        _, warnings = self.read(
            map, self.write("a.csv", table(rows=[*ROWS, ["0.03", "", "1"], ["0.04", "1", "1"]]))
        )
        self.assertIn("a.csv: sensor a: 1 of 5 samples has missing values", warnings[0])

    def test_several_sensors_of_a_table_are_in_one_recording(self):
        map = "{time: {rate: 100 Hz}, sensors: {a: {type: own, channels: {force: {unit: N, columns: [f1]}}}, b: {type: own, channels: {force: {unit: N, columns: [f2]}}}}}"
        trial = self.read(map, self.write("a.csv", table()))[0][0]
        self.assertEqual(
            np.asarray(trial.sensors["a"].force).ravel().tolist(),
            np.float32([0.5, 0.6, 0.7]).tolist(),
        )
        self.assertEqual(
            np.asarray(trial.sensors["b"].force).ravel().tolist(),
            np.float32([1.25, 1.35, 1.45]).tolist(),
        )

    def test_channels_have_the_shape_of_a_simulated_sensor(self):
        map = (
            "{sensor: tip, type: biotac_sp, time: {column: t}, channels: "
            "{electrodes: {unit: counts, columns: [f1]}, pdc: {unit: counts, columns: [f2]}}}"
        )
        tip = self.read(map, self.write("a.csv", table()))[0][0].sensors["tip"]
        self.assertEqual(np.shape(tip.electrodes), (3, 1))
        self.assertEqual(np.shape(tip.pdc), (3,))

    def test_labels_and_objects_by_folder_file_table_and_column(self):
        for folder in ("slip", "none"):
            self.write(f"set/{folder}/cup_1.csv", table())
        folders = [self.folder / "set/slip", self.folder / "set/none"]
        for keys, states, objects in (
            (
                ", state: {folder: 1, values: {slip: gross, none: 1}, rule: the folder}, object: {file: '([a-z]+)_[0-9]+'}",
                {3, 1},
                {"cup"},
            ),
            (
                ", state: {table: {path: labels.csv, column: label}, values: {slip: 3, open: unknown}, rule: a table}, object: {folder: 1}",
                {3, 4},
                {"slip", "none"},
            ),
            (
                ", state: {value: 1, rule: all are held}, object: {table: {path: labels.csv, column: object}}",
                {1},
                {"cup"},
            ),
        ):
            with self.subTest(keys):
                if "labels.csv" in keys:  # next to the recordings
                    self.write("set/slip/labels.csv", "file,label,object\ncup_1.csv,slip,cup\n")
                    self.write("set/none/labels.csv", "file,label,object\ncup_1,open,cup\n")
                trials, _ = self.read(MAP % keys, *folders)
                found = {trial.params["file"]: trial for trial in trials}
                self.assertEqual(set(found), {"slip/cup_1.csv", "none/cup_1.csv"})
                labels = [trial.labels.get("pad") for trial in trials]
                self.assertEqual(
                    {None if label is None else int(label.state_paper[0]) for label in labels},
                    states,
                )
                self.assertEqual({trial.params["object"] for trial in trials}, objects)
        path = self.write(
            "a.csv",
            table(
                rows=[
                    [*row[:2], label]
                    for row, label in zip(ROWS, ("hold", "hold", "slip"), strict=True)
                ]
            ),
        )
        map = (
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f1]}}, "
            "state: {column: f2, values: {hold: non_slip, slip: gross}, rule: a button}}"
        )
        self.assertEqual(self.read(map, path)[0][0].labels["pad"].state_paper.tolist(), [1, 1, 3])
        self.assertIn(
            "a.csv:4: column f2: the label 'slip' is not in state.values",
            self.refused(map.replace(", slip: gross", ""), path),
        )

    def test_unknown_labels(self):
        # Six samples at 10 Hz: hold, unknown, unknown, slip, slip, unknown.
        labels = ("hold", "?", "?", "slip", "slip", "?")
        path = self.write(
            "a.csv",
            "t,f,l\n" + "".join(f"{k / 10},{k},{label}\n" for k, label in enumerate(labels)),
        )
        map = (
            "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}, "
            "state: {column: l, values: {hold: non_slip, slip: gross, '?': unknown}, rule: a button}}"
        )
        output = self.folder / "unknown.h5"
        slipbench.import_recordings(path, output, map=self.write("map.yaml", map))
        with slipbench.open(output) as data:
            self.assertEqual(data[0].labels["pad"].state_paper[:].tolist(), [1, 4, 4, 3, 3, 4])
            codes = json.loads(data[0].labels["pad"]["state_paper"].attrs["codes"])
            self.assertEqual(
                codes, {"no_contact": 0, "non_slip": 1, "incipient": 2, "gross": 3, "unknown": 4}
            )
            # Windows of two samples end with the samples 1 to 5: those with 3 and 4 have a label.
            X, y, groups = (windows := data.windows(length=2, labels="recorded")).arrays()
            self.assertEqual(
                (X[:, :, 0].tolist(), y.tolist(), groups.tolist()),
                ([[2, 3], [3, 4]], [1, 1], [0, 0]),
            )
            self.assertEqual(
                [(one.ravel().tolist(), label) for one, label in windows],
                [([2, 3], 1), ([3, 4], 1)],
            )
            self.assertEqual([windows.time(k) for k in range(2)], [0.3, 0.4])
            # With a stride of 2, windows end with the samples 1, 3 and 5, of which 3 has a label.
            self.assertEqual(
                data.windows(length=2, stride=2, labels="recorded").arrays()[0][:, :, 0].tolist(),
                [[2, 3]],
            )
            # The only window of six samples ends with sample 5.
            with self.assertRaisesRegex(
                slipbench.InputError, "label of each window of 1 trial is unknown"
            ):
                data.windows(length=6, labels="recorded")
        self.assertTrue(slipbench.verify(output)["holds"])
        found = slipbench.detect("deviation", output, self.folder / "found.html")
        self.assertEqual(
            found["trials"][0]["samples"]["label"], ["non_slip", None, None, "gross", "gross", None]
        )
        # A window of 0.5 s has five samples, so that only the fifth has an estimate. The standard
        # deviation of 0 to 4 is sqrt(2), below the threshold of 6: both slips of three labels are missed.
        self.assertAlmostEqual(found["trials"][0]["wrong_share"], 2 / 3)
        judged = slipbench.evaluate("deviation", output)["all"]
        self.assertEqual((judged["frames"], judged["called"]["non_slip"]["no_contact"]), (3, 1))
        slipbench.export(output, self.folder / "csv", format="csv")
        text = next((self.folder / "csv").glob("*.csv")).read_text(encoding="utf-8").splitlines()
        self.assertEqual(
            [line.rpartition(",")[2] for line in text[1:]], ["1", "4", "4", "3", "3", "4"]
        )

    def test_a_factor_for_each_component(self):
        star = (MAP % "").replace("columns: [f1, f2]", "%s columns: [f1, f2]")
        path = self.write("a.csv", table())
        values = self.force(star % "components: 2, scale: [2, -4],", path)[0]
        self.assertEqual(values.tolist()[0], [[1.0, -5.0]])  # 0.5 * 2, 1.25 * -4
        self.assertEqual(self.force(star % "scale: [2],", path)[0].tolist()[0], [1.0, 2.5])
        self.assertIn(
            "map.yaml:1: channels.force.scale: expected one factor, or one for each of the 1 component, found 3",
            self.refused(star % "scale: [1, 2, 3],", path),
        )
        self.assertTrue(
            self.refused(star % "scale: [1, 2, 3],", path).endswith("found 3")
        )  # two columns are no triples
        # Two factors for two columns, as the message proposes.
        self.assertTrue(
            self.refused(star % "scale: [2, -4],", path).endswith(
                "one for each of the 1 component, found 2; for values of 2 components each, set components: 2"
            )
        )
        self.assertIn(
            "channels.force.scale: expected a number other than 0, or with a unit as '0.01 N', found '0'",
            self.refused(star % "scale: [1, 0],", path),
        )
        force = np.ones((2, 3, 3))
        np.savez(self.folder / "a.npz", t=np.array([0.0, 0.01]), force=force)
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, scale: [1, 2, -3], columns: [force]}}}"
        self.assertEqual(
            self.force(map, self.folder / "a.npz")[0].tolist(), [[[1.0, 2.0, -3.0]] * 3] * 2
        )

    def test_counts_become_the_unit_of_their_sensitivity(self):
        # The row 0.5, 1.25 with 0.01 N a count is 0.005, 0.0125 N; with 2 mV and 4 uV a count it is
        # 0.5 * 2e-3 and 1.25 * 4e-6 V. A volt of 500 N is 250, 625 N.
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: %s, %s, columns: [f1, f2]}}}"
        path = self.write("a.csv", table())
        for unit, scale, si, first in (
            ("count", "scale: 0.01 N", "N", [[0.005], [0.0125]]),
            ("counts", "components: 2, scale: [2 mV, -4 uV]", "V", [[1e-3, -5e-6]]),
            ("V", "scale: 500 N", "N", [[250.0], [625.0]]),
            ("counts", "scale: 2", "counts", [[1.0], [2.5]]),
        ):
            with self.subTest(scale):
                pad = self.read(map % (unit, scale), path)[0][0].sensors["pad"]
                self.assertEqual(pad.units, {"force": si})
                np.testing.assert_allclose(
                    np.asarray(pad.force)[0].ravel(), np.ravel(first), rtol=1e-7
                )
        for unit, scale, message in (
            (
                "counts",
                "components: 2, scale: [1 N, 1 uT]",
                "map.yaml:1: channels.force.scale: expected the same unit for each component, found '1 N' and '1 uT'",
            ),
            (
                "counts",
                "components: 2, scale: [1 N, 2]",
                "expected the same unit for each component, found '1 N' and '2'",
            ),
            (
                "mN",
                "scale: 0.01 N",
                "channels.force.scale: expected a number, because unit is 'mN', found '0.01 N'; if the cells are counts, write unit: counts",
            ),
            (
                "counts",
                "scale: N",
                "channels.force.scale: expected a number other than 0, or with a unit as '0.01 N', found 'N'",
            ),
            ("counts", "scale: 0 N", "or with a unit as '0.01 N', found '0 N'"),
        ):
            with self.subTest(scale):
                self.assertIn(message, self.refused(map % (unit, scale), path))

    def test_counts_without_a_sensitivity_are_refused_with_both_units(self):
        output = self.folder / "counts.h5"
        rows = [[f"{0.01 * k:.2f}", "0", "0", "5"] for k in range(9)]
        for channel, detector in (("force", "force_ratio"), ("force", "shear_rate")):
            self.write(
                "map.yaml",
                "{sensor: pad, type: own, time: {column: t}, channels: {"
                + channel
                + ": {unit: count, components: 3, columns: [x, y, z]}}}",
            )
            slipbench.import_recordings(
                self.write("a.csv", table(rows=rows, titles=("t", "x", "y", "z"))),
                output,
                map=self.folder / "map.yaml",
            )
            with self.assertRaisesRegex(
                slipbench.InputError,
                "in N, .* has it in 'counts'; the key scale of the map of `import` states what one count is, for example scale: 0.01 N",
            ):
                slipbench.detect(detector, output)

    def test_a_baseline_is_the_mean_of_the_first_seconds(self):
        # 10 samples/s. In the first 0.3 s a is 1, 2, 6 and b is 4, 4, 7: levels 3 and 5, which are
        # subtracted from the whole recording. With 2 mN a count the forces are 2e-3 (a - 3) N. The
        # channel without the key is kept.
        a, b = [1, 2, 6, 8, 3, 3], [4, 4, 7, 5, 0, 9]
        rows = [[f"{100 + 0.1 * k:.1f}", f"{a[k]}", f"{b[k]}"] for k in range(6)]
        map = (
            "{sensor: pad, type: own, time: {column: t}%s, channels: {force: {unit: counts, scale: 2 mN, baseline: %s, "
            "columns: [f1, f2]}, raw: {unit: counts, columns: [f1]}}}"
        )
        path = self.write("a.csv", table(rows=rows))
        pad = self.read(map % ("", "0.3 s"), path)[0][0].sensors["pad"]
        np.testing.assert_allclose(
            np.asarray(pad.force),
            2e-3 * np.column_stack([np.array(a) - 3, np.array(b) - 5]),
            rtol=1e-6,
            atol=1e-12,
        )
        self.assertEqual(np.asarray(pad.raw)[:, 0].tolist(), a)
        # Each recording has its own level, and values that are missing do not count.
        other = self.write(
            "b.csv", table(rows=[[row[0], f"{int(row[1]) + 10}", row[2]] for row in rows])
        )
        recordings = self.read(map % ("", "0.3 s"), path, other)[0]
        np.testing.assert_allclose(
            *(np.asarray(one.sensors["pad"].force) for one in recordings), rtol=1e-6, atol=1e-12
        )
        rows[1][1] = ""
        holes = self.write("c.csv", table(rows=rows))
        pad = self.read((map % (", missing: nan", "0.3 s")), holes)[0][0].sensors["pad"]
        np.testing.assert_allclose(
            np.asarray(pad.force)[:, 0], 2e-3 * (np.array([1, np.nan, 6, 8, 3, 3]) - 3.5), rtol=1e-6
        )

    def test_a_baseline_that_is_not_at_rest_is_refused(self):
        def labelled(states):
            rows = [[f"{0.1 * k:.1f}", "1", state] for k, state in enumerate(states)]
            return self.write("a.csv", table(rows=rows, titles=("t", "f", "s")))

        map = "{sensor: pad, type: own, time: {column: t}, state: {column: s, rule: r}, channels: {force: {unit: N, baseline: 0.3 s, columns: [f]}}}"
        self.assertEqual(
            self.read(map, labelled("000111"))[0][0].sensors["pad"].force[:, 0].tolist(), [0.0] * 6
        )
        place = "map.yaml:1: channels.force.baseline: the baseline is 300 ms, but "
        self.assertIn(
            f"{place}{self.folder}/a.csv:4 is labelled as gross 200 ms after the beginning; expected no contact in that time: shorten or remove it",
            self.refused(map, labelled("003333")),
        )
        self.assertIn(
            "a.csv:2 is labelled as non-slip 0 ns after the beginning",
            self.refused(map, labelled("111111")),
        )
        self.assertIn(
            f"{place}{self.folder}/a.csv lasts only 300 ms; shorten it",
            self.refused(map, labelled("0000")),
        )
        empty = map.replace("type: own", "type: own, missing: nan")
        rows = [[f"{0.1 * k:.1f}", "" if k < 3 else "1", "0"] for k in range(6)]
        self.assertIn(
            f"{place}value 1 of {self.folder}/a.csv is missing throughout it",
            self.refused(empty, self.write("a.csv", table(rows=rows, titles=("t", "f", "s")))),
        )
        self.assertIn(
            "channels.force.baseline: ",
            self.refused(map.replace("0.3 s", "0.3 N"), labelled("000111")),
        )

    def test_labels_may_be_booleans(self):
        map = MAP % ", state: {column: slip, values: {%s}, rule: by hand}"

        def states(text, values):
            return (
                self.read(map % values, self.write("a.csv", text))[0][0]
                .labels["pad"]["state_paper"][:]
                .tolist()
            )

        for off, on in (("False", "True"), ("false", "true"), ("FALSE", "TRUE")):
            text = f"t,f1,f2,slip\n0,1,2,{off}\n1,1,2,{on}\n"
            self.assertEqual(states(text, "false: non_slip, true: gross"), [1, 3])
            self.assertEqual(states(text, "'False': non_slip, 'True': gross"), [1, 3])
        # Booleans are not 0 and 1.
        message = self.refused(
            map % "0: non_slip, 1: gross",
            self.write("a.csv", "t,f1,f2,slip\n0,1,2,False\n1,1,2,True\n"),
        )
        self.assertRegex(
            message,
            "a.csv:2: column slip: the label 'False' is not in state.values; .*; write false: and true: for labels that are booleans$",
        )
        self.assertIn(
            "a.csv:2: column slip: the label 'no' is not in state.values; found there: false, true",
            self.refused(
                map % "false: non_slip, true: gross",
                self.write("a.csv", "t,f1,f2,slip\n0,1,2,no\n1,1,2,no\n"),
            ),
        )

    def test_a_map_names_files_of_the_folders_that_the_user_named(self):
        outside = tempfile.TemporaryDirectory()
        self.addCleanup(outside.cleanup)
        secret = Path(outside.name) / "secret.csv"
        secret.write_text("root:x:0:0\n")
        path = self.write("in/a.csv", table())
        self.write("in/link.csv", "")
        (self.folder / "in/link.csv").unlink()
        (self.folder / "in/link.csv").symlink_to(secret)
        for name in (secret, os.path.relpath(secret, self.folder), "in/link.csv"):
            message = self.refused(
                MAP % f", state: {{table: {{path: {name}, column: x}}, rule: r}}", path
            )
            self.assertRegex(
                message,
                "map.yaml:1: state.table.path: .*secret.csv: is outside of the folders of the map, of the recordings and of the command",
            )
            self.assertNotIn("root", message)
        secret.write_text("file,label\na.csv,3\n")  # its folder is a source, too
        states = self.read(
            MAP % f", state: {{table: {{path: {secret}, column: label}}, rule: r}}", path, secret
        )[0][0]
        self.assertEqual(states.labels["pad"]["state_paper"][:].tolist(), [3, 3, 3])
        with self.assertRaisesRegex(
            slipbench.InputError, "map.yaml:1: definitions: .* is outside of the folders"
        ):
            bags.read_definitions(
                read_map(str(self.write("map.yaml", MAP % f", definitions: [{secret}]"))), []
            )
        link = self.folder / "defs/x/msg/State.msg"
        link.parent.mkdir(parents=True)
        link.symlink_to(secret)
        with self.assertRaises(slipbench.InputError) as caught:
            bags.read_definitions(
                read_map(str(self.write("map.yaml", MAP % ", definitions: [defs]"))), []
            )
        self.assertIn(
            f"map.yaml:1: definitions: {link}: is outside of the folders of the map",
            str(caught.exception),
        )

    def test_links_in_a_folder_to_other_folders_are_refused(self):
        outside = tempfile.TemporaryDirectory()
        self.addCleanup(outside.cleanup)
        secret = Path(outside.name, "secret")
        secret.write_text("root:x:0:0:SECRET\n")
        self.write("rec/a.csv", table())
        link = self.folder / "rec/b.csv"
        link.symlink_to(secret)
        message = self.refused(MAP % "", self.folder / "rec")
        self.assertEqual(
            message,
            f"{link}: is a link to a file outside of the folders of the command; to read it, name the file or folder itself on the command line",
        )
        secret.write_text(table())
        self.assertEqual(
            len(self.read(MAP % "", self.folder / "rec/a.csv", link)[0]), 2
        )  # as the remedy says
        link.unlink()
        self.write("raw/b.csv", table())
        link.symlink_to("../raw/b.csv")
        with contextlib.chdir(self.folder):  # its target is in the current folder
            self.assertEqual(len(self.read(MAP % "", self.folder / "rec")[0]), 2)

    def test_a_pattern_for_names_of_files_ends(self):
        path = self.write("a" * 40 + ".csv", table())
        state = MAP % ", state: {file: '%s', rule: r}"
        self.addCleanup(signal.signal, signal.SIGALRM, signal.getsignal(signal.SIGALRM))
        labels.limit_searches()  # as the program does
        with mock.patch.object(labels, "LONGEST_SEARCH", 0.1):
            self.assertIn(
                "map.yaml:1: state.file: the search in 'aaaa",
                self.refused(state % "((?:a+)+)$", path),
            )  # 2^40 ways to divide the name
        self.assertIn(
            "its parts are nested too deeply", self.refused(state % ("(" * 3000 + ")" * 3000), path)
        )

    def test_timers_and_threads_of_the_caller_do_not_matter(self):
        path = self.write("press_1.csv", table())
        map = self.write("map.yaml", MAP % ", object: {file: '([a-z]+)_[0-9]+'}")
        found = []

        def read():
            found.append(slipbench.import_recordings(path, map=map)["trials"])

        self.addCleanup(signal.setitimer, signal.ITIMER_REAL, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 100.0)
        thread = threading.Thread(target=read)
        thread.start()
        thread.join()
        read()
        self.assertEqual(found, [1, 1])
        self.assertGreater(signal.getitimer(signal.ITIMER_REAL)[0], 0.0)

    def test_a_folder_of_texts_is_read(self):
        self.write("set/a.txt", table("\t"))
        self.write("set/b.txt", table("\t"))
        self.assertEqual(len(self.read(MAP % "", self.folder / "set")[0]), 2)

    def test_the_map_chooses_files_of_a_folder(self):
        for name in ("m1_bio", "m2_bio"):
            self.write(f"set/{name}.csv", table())
            self.write(f"set/{name.replace('bio', 'cp')}.csv", "timestamp,x\n0,1\n")
        self.assertRegex(
            self.refused(MAP % "", self.folder / "set"),
            r"m1_cp.csv:1: has no column 'f1'.* files: '\*_a\.csv' in the map",
        )
        chosen = MAP % ", files: '*_bio.csv'"
        self.assertEqual(
            [trial.params["file"] for trial in self.read(chosen, self.folder / "set")[0]],
            ["m1_bio.csv", "m2_bio.csv"],
        )
        self.write("set/notes.txt", "a text of another kind")
        self.write("other.csv", table())
        both = self.read(chosen, self.folder / "set", self.folder / "other.csv")[
            0
        ]  # named directly
        self.assertEqual(len(both), 3)
        self.assertIn(
            "set: no file matches files: '*.dat' of the map; found: m1_bio.csv, m1_cp.csv, m2_bio.csv, m2_cp.csv",
            self.refused(MAP % ", files: '*.dat'", self.folder / "set"),
        )

    def test_a_source_counts_once(self):
        path = self.write("set/a.csv", table())
        (self.folder / "link.csv").symlink_to(path)
        for again in (
            path,
            self.folder / "set",
            self.folder / "set" / ".." / "set" / "a.csv",
            self.folder / "link.csv",
        ):
            self.assertIn("is given twice", self.refused(MAP % "", path, again))

    def test_a_map_is_checked_with_its_line(self):
        path = self.write("a.csv", table())
        lines = "sensor: pad\ntype: own\ntime: {column: t}\nchannels:\n  force: {unit: N, columns: [f1]}\n"
        for map, message in (
            (lines.replace("type: own\n", ""), "map.yaml:1: the map has no key 'type'"),
            (
                lines.replace("columns", "column"),
                "map.yaml:5: unknown key 'column' in channels.force; did you mean 'columns'? allowed: unit",
            ),
            (
                lines.replace("[f1]", "f1"),
                "map.yaml:5: channels.force.columns: expected a list of texts, found 'f1'",
            ),
            (lines.replace("column: t", "rate: 5 mm"), "map.yaml:3: time.rate: "),
            (
                lines + "missing: skip\n",
                "map.yaml:6: missing: expected refuse or gap or nan, found 'skip'",
            ),
            (
                lines + "state: {rule: x}\n",
                "map.yaml:6: state: expected one of column, value, folder, file, table, found none of them",
            ),
            (lines + "state: {value: 7, rule: x}\n", "a.csv: expected a label of 0, 1, 2, 3"),
            (
                lines + "sensors: {a: {type: own}}\n",
                "map.yaml:1: the map: expected one of sensor, sensors, found sensor and sensors",
            ),
            (lines + "skip: -1\n", "map.yaml:6: skip: expected a whole number from 1"),
            ("a: [", "map.yaml:"),
        ):
            with self.subTest(message):
                self.assertIn(message, self.refused(map, path))
        with self.assertRaisesRegex(
            slipbench.InputError,
            "no such file, and not an included map; found: biotac_ros, biotac_slide, fabric_slide, papillarray_ros, papillarray_ros2, uskin_boxes, uskin_flat, weiss_ros, xela_ros",
        ):
            slipbench.import_recordings(path, map="nothing")

    def test_the_table_of_keys_is_whole(self):
        kinds = {
            "text",
            "name",
            "number",
            "factors",
            "duration",
            "integer",
            "boolean",
            "texts",
            "lines",
            "rate",
            "words",
            "block",
            "blocks",
        }
        for block, keys in BLOCKS.items():
            self.assertEqual(len({key.name for key in keys}), len(keys), block)
            for key in keys:
                self.assertIn(key.kind, kinds)
                self.assertEqual(key.kind in ("block", "blocks"), key.block in BLOCKS)
                self.assertTrue(key.description)

    def test_a_missing_package_is_named(self):
        request = json.dumps(
            {
                "sources": [str(self.write("a.csv", table()))],
                "map": str(self.write("map.yaml", MAP % "")),
                "output": "",
                "seed": 1,
                "rate": None,
                "json": False,
                "install": "pip install x",
            }
        )
        told = subprocess.run(
            [
                sys.executable,
                "-c",
                "import json, sys; sys.modules['pandas'] = None; "
                "from slipbench._import.__main__ import main; "
                "sys.exit(main(json.loads(sys.argv[1])))",
                request,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(told.returncode, 2)
        self.assertRegex(
            told.stderr,
            "import --map needs the Python package pandas, .* install it: pip install x",
        )

    def test_a_summary_that_cannot_be_printed_is_an_error(self):
        command = [
            PROGRAM,
            "import",
            str(self.write("a.csv", table())),
            "--map",
            str(self.write("map.yaml", MAP % "")),
            "-o",
            str(self.folder / "a.h5"),
        ]
        for words in (command, [PROGRAM, "schema", "map"]):
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run(
                    words, stdout=full, stderr=subprocess.PIPE, text=True, check=False
                )
            self.assertEqual(
                (done.returncode, done.stderr),
                (2, "slipbench: cannot write to standard output: No space left on device\n"),
            )
            done = subprocess.run(
                ["sh", "-c", '"$@" >&-', "sh", *words],
                stderr=subprocess.PIPE,
                text=True,
                check=False,
            )
            self.assertEqual(
                (done.returncode, done.stderr),
                (2, "slipbench: cannot write to standard output: Bad file descriptor\n"),
            )


class Drafts(ImportTest):
    """`import --draft`: a map from the titles of a table."""

    def draft(self, titles, type, times=("0", "0.01", "0.02"), step=1):
        """Returns the map for a table with these titles, and its recording.

        Column k of row r is (10 k + r) step.
        """
        rows = [
            [time, *(f"{(10 * k + row) * step}" for k in range(1, len(titles)))]
            for row, time in enumerate(times)
        ]
        path = self.write("a.csv", table(titles=titles, rows=rows))
        map = self.folder / "drafted.yaml"
        map.unlink(missing_ok=True)
        done = subprocess.run(
            [PROGRAM, "import", path, "--draft", type, "-o", map],
            check=False,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"import {path} --map {map} -o {self.folder}/drafted.h5", done.stdout)
        text = map.read_text(encoding="utf-8")
        self.assertTrue(done.stdout.startswith(text))
        return text, self.read(text.replace(", baseline: 0.2 s", ""), path)[0][0].sensors["pad"]

    def test_columns_are_found_by_their_titles(self):
        text, skin = self.draft(
            ["time_s", *(f"txl{k}_{axis}" for k in (1, 2) for axis in "xyz"), "temp"],
            "magnetic_skin",
        )
        self.assertIn("time: {column: time_s, unit: s}  # 100 Hz", text)
        self.assertIn("# Check: what 1 count is", text)
        self.assertTrue(text.endswith("# Not read: temp\n"))
        # The first row is 10, 20, ... 60 counts of 0.601, 0.601 and 0.968 uT.
        np.testing.assert_allclose(
            np.asarray(skin.field)[0], [[6.01, 12.02, 29.04], [24.04, 30.05, 58.08]], rtol=1e-6
        )
        # Numbers that are not whole are not counts.
        text, skin = self.draft(
            ["t", "x0", "y0", "z0", "x1", "y1", "z1"], "magnetic_skin", step=0.5
        )
        self.assertEqual(
            np.asarray(skin.field)[0].tolist(), [[5.0, 10.0, 15.0], [20.0, 25.0, 30.0]]
        )
        self.assertIn("unit: uT, baseline: 0.2 s", text)
        # Forces [N] and displacements [mm], in the order of the device's log.
        text, pad = self.draft(
            [
                "t (ms)",
                *(f"P{p}_{kind}{axis}" for p in range(9) for kind in "DF" for axis in "XYZ"),
            ],
            "papillarray",
            ("0", "2", "4"),
        )
        self.assertIn('time: {column: "t (ms)", unit: ms}  # 500 Hz', text)
        self.assertEqual(pad.units, {"force": "N", "displacement": "m"})
        self.assertEqual(np.asarray(pad.force)[0, 1].tolist(), [100.0, 110.0, 120.0])
        np.testing.assert_allclose(
            np.asarray(pad.displacement)[0, 1], [0.07, 0.08, 0.09], rtol=1e-6
        )
        # 19 electrodes, of which the tenth is not the second, and 3 values of pac; the unit of the
        # stamps follows from their steps: 10,000 us are 100 Hz.
        text, finger = self.draft(
            ["stamp", "pdc", *(f"pac{k}" for k in range(1, 4)), *(f"ele{k}" for k in range(1, 20))],
            "biotac_sp",
            ("5", "10005", "20005"),
        )
        self.assertIn("time: {column: stamp, unit: us}  # 100 Hz", text)
        self.assertEqual(
            np.asarray(finger.electrodes)[0].tolist(), [50.0 + 10 * k for k in range(19)]
        )
        self.assertEqual(np.asarray(finger.pac).shape, (3, 3))
        # An array of one axis.
        text, array = self.draft(
            ["timestamp", *(f"channel{k}" for k in range(16))],
            "taxels",
            ("134559", "134587", "134615"),
        )
        self.assertIn("unit: ms}  # 35.71 Hz", text)
        self.assertEqual(np.asarray(array.signal).shape, (3, 16))
        # A title such as t_1 is not a time.
        text, array = self.draft(["elapsed [ms]", "t_1", "t_2"], "taxels", ("0", "10", "20"))
        self.assertIn('time: {column: "elapsed [ms]", unit: ms}  # 100 Hz', text)
        self.assertIn(
            "time: {rate: 100 Hz}  # Check: the rate",
            self.draft(["t_0", "t_1", "t_2"], "taxels")[0],
        )
        # One unit without a number.
        self.assertEqual(
            np.asarray(self.draft(["t", "fx", "fy", "fz"], "taxels")[1].force).shape, (3, 1, 3)
        )

    def test_import_names_a_detector_that_reads_the_channels(self):
        for type, channel, detector in (
            (
                "magnetic_skin",
                "field: {unit: uT, components: 3",
                "scenes/learn/magnetic_skin_slip.onnx",
            ),
            ("magnetic_skin", "raw: {unit: counts", "deviation"),
            ("papillarray", "force: {unit: N, components: 3", "force_ratio"),
            ("biotac_sp", "electrodes: {unit: counts", "deviation"),
        ):
            with self.subTest(type):
                map = self.write(
                    "map.yaml",
                    f"{{sensor: pad, type: {type}, time: {{column: t}}, channels: {{{channel}, columns: [x, y, z]}}}}}}",
                )
                rows = [[f"{0.01 * k:.2f}", "1", "2", "3"] for k in range(3)]
                path = self.write("a.csv", table(rows=rows, titles=("t", "x", "y", "z")))
                done = subprocess.run(
                    [PROGRAM, "import", path, "--map", map, "-o", self.folder / "out.h5"],
                    check=True,
                    capture_output=True,
                    text=True,
                )
                self.assertRegex(
                    done.stdout.splitlines()[-1],
                    rf"^next: \S+ detect (\S+/)?{detector} {self.folder}/out.h5$",
                )

    def test_what_cannot_be_drafted_is_explained(self):
        path = self.write("a.csv", table())
        for words, message in (
            (
                (path, "--draft", "papillaray"),
                "did you mean 'papillarray'? found: biotac_sp, magnetic_skin, myrmex, papillarray, piezo_skin, taxels",
            ),
            (
                (path, "--draft", "magnetic_skin"),
                "a.csv:1: no columns were found for x, y and z of field of a magnetic_skin, such as x0, y0, z0, x1, ...; found: t, f1, f2",
            ),
            (
                (self.write("v.csv", "T_us,S0_P0_DX\n1,2\n"), "--draft", "papillarray"),
                "needs no map; import it with --format papillarray-csv",
            ),
            (
                (self.write("n.csv", "0,1,2,3\n1,2,3,4\n"), "--draft", "papillarray"),
                "a table without titles needs header: false",
            ),
            (
                (path, "--draft", "taxels", "--map", "xela_ros"),
                "--draft writes a map; expected only -o FILE.yaml next to it",
            ),
            (
                (self.write("b.bag", "x"), "--draft", "taxels"),
                "b.bag: --draft reads tables of text",
            ),
            (
                (path, "--draft", "taxels", "-o", self.write("kept.yaml", "x")),
                "kept.yaml: exists already, and may have been edited",
            ),
            ((path,), "--draft TYPE writes a map of a table"),
        ):
            with self.subTest(message):
                done = subprocess.run(
                    [PROGRAM, "import", *words], check=False, capture_output=True, text=True
                )
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertIn(message, " ".join(done.stderr.split()))


class PublicSets(ImportTest):
    """The maps of public recordings, on invented files of their layouts."""

    def imported(self, map, **files):
        """Writes the files into a folder and imports it; returns the trials in order."""
        folder = self.folder / map
        folder.mkdir()
        for name, text in files.items():
            (folder / f"{name}.csv").write_text(text, encoding="utf-8")
        output = self.folder / f"{map}.h5"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # notes of the maps
            slipbench.import_recordings(folder, output, map=map)
        with slipbench.open(output) as data:
            return [self.copied(data[trial]) for trial in data.trials]

    @staticmethod
    def copied(trial):
        [(name, sensor)] = trial.sensors.items()
        channels = {
            str(one): (sensor[str(one)][:], str(sensor[str(one)].attrs["unit"]))
            for one in sensor.attrs["channels"]
        }
        labels = trial.labels[name].state_paper[:].tolist() if name in trial.labels else None
        return (
            dict(trial.params),
            str(sensor.attrs["type"]),
            sensor["t"][:].tolist(),
            channels,
            labels,
        )

    def test_uskin_boxes(self):
        titles = ",".join(["t", *(f"{axis}{k}" for k in range(16) for axis in "xyz"), "state"])
        rows = [
            ",".join([f"{row / 40}", *(f"{row + k / 100:.2f}" for k in range(48)), state])
            for row, state in enumerate(("unknown", "hold", "slip"))
        ]
        text = "\n".join([titles, *rows]) + "\n"
        trials = self.imported(
            "uskin_boxes", r00_finger1=text, r00_finger2=text, recordings="recording,object\n0,11\n"
        )
        self.assertEqual(
            [params for params, *_ in trials],
            [{"file": f"r00_finger{k}.csv", "object": "r00"} for k in (1, 2)],
        )
        _, type, times, channels, labels = trials[1]
        self.assertEqual((type, times, labels), ("magnetic_skin", [0.0, 0.025, 0.05], [4, 1, 3]))
        field, unit = channels["field"]
        self.assertEqual((field.shape, unit), ((3, 16, 3), "uT"))
        np.testing.assert_allclose(field[2, 15], [2.45, 2.46, 2.47], rtol=1e-6)

    def test_uskin_flat(self):
        titles = ",".join(["t", *(f"t{k}_{axis}" for k in range(16) for axis in "xyz")])
        text = (
            titles
            + "\n"
            + "".join(
                ",".join([f"{row / 40}", *(f"{row + k / 10:.1f}" for k in range(48))]) + "\n"
                for row in range(3)
            )
        )
        trials = self.imported(
            "uskin_flat",
            r00=text,
            r02=text,
            r08=text,
            labels="file,rate_hz,rows,label\nr00.csv,40,3,none\nr02.csv,40,3,slip\nr08.csv,40,3,open\n",
        )
        self.assertEqual([labels for *_, labels in trials], [[1, 1, 1], [4, 4, 4], [4, 4, 4]])
        counts, unit = trials[0][3]["counts"]
        self.assertEqual((counts.shape, unit), ((3, 16, 3), "counts"))
        np.testing.assert_allclose(counts[1, 1], [1.3, 1.4, 1.5], rtol=1e-6)
        field, unit = trials[0][3]["field"]
        self.assertEqual((field.shape, unit), ((3, 16, 3), "uT"))
        np.testing.assert_allclose(field[1, 1], [1.3 * 0.601, 1.4 * 0.601, 1.5 * 0.968], rtol=1e-5)

    def test_fabric_slide(self):
        titles = ", ".join(
            ["timestamp", "proximity1", "proximity2", *(f"channel{k}" for k in range(1, 17))]
        )
        text = (
            titles
            + "\n"
            + "".join(
                ",".join(map(str, [29725 + 28 * row, 284, 48215, *range(16)])) + "\n"
                for row in range(3)
            )
        )
        [(params, type, times, channels, labels)] = self.imported(
            "fabric_slide", **{"Board10mm_F120_V-5mmps_0": text}
        )
        self.assertEqual((params["object"], type, labels), ("Board10mm", "taxels", None))
        np.testing.assert_allclose(times, [29.725, 29.753, 29.781], rtol=0, atol=1e-9)
        self.assertEqual(channels["counts"][0].tolist(), [list(range(16))] * 3)

    def test_biotac_slide(self):
        titles = ",".join(
            [
                "timestamp",
                "tdc",
                "tac",
                "pdc",
                *(f"pac{k}" for k in range(1, 23)),
                *(f"ele{k}" for k in range(1, 20)),
            ]
        )
        text = (
            titles
            + "\n"
            + "".join(
                ",".join(
                    map(
                        str,
                        [f"1581072654.{21 + row}0000000", 1, 87, 62, *range(22), *range(100, 119)],
                    )
                )
                + ",\n"
                for row in range(3)
            )
        )
        pose = "timestamp,posx\n1581072654.2,0.7\n"
        [(params, type, _, channels, labels)] = self.imported(
            "biotac_slide", mat1_6_bio=text, mat1_6_cp=pose
        )
        self.assertEqual(
            (params["file"], params["object"], type, labels),
            ("mat1_6_bio.csv", "mat1", "biotac_sp", [3, 3, 3]),
        )
        self.assertEqual(channels["electrodes"][0][0].tolist(), list(range(100, 119)))
        self.assertEqual(channels["pdc"][0].ravel().tolist(), [62.0] * 3)
        self.assertEqual(channels["pac"][0][0].tolist(), list(range(22)))


class Arrays(ImportTest):
    """.npz, .npy and Parquet."""

    def test_arrays_keep_their_shape(self):
        force = np.arange(18, dtype=float).reshape(2, 3, 3)
        np.savez(self.folder / "a.npz", t=np.array([0.0, 0.01]), force=force, serial=np.array([7]))
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [force]}}}"
        np.testing.assert_array_equal(self.force(map, self.folder / "a.npz")[0], force)
        pa.parquet.write_table(
            pa.table({"t": [0.0, 0.01], "force": force.reshape(2, 9).tolist()}),
            self.folder / "a.parquet",
        )
        np.testing.assert_array_equal(
            self.force(map.replace("[force]", "[force], components: 3"), self.folder / "a.parquet")[
                0
            ],
            force,
        )
        np.save(self.folder / "a.npy", force.reshape(2, 9))
        bare = "{sensor: pad, type: own, time: {rate: 10 Hz}, channels: {force: {unit: N, columns: [1 .. 9]}}}"
        np.testing.assert_array_equal(
            self.force(bare, self.folder / "a.npy")[0], force.reshape(2, 9)
        )
        for name in ("a.npz", "a.npy", "a.parquet"):
            self.write(name, b"not it")
            self.assertIn(f"{name}: cannot be read", self.refused(map, self.folder / name))

    def test_times_and_labels_of_arrays(self):
        times = np.arange(300) / 100
        labels = (times > 1).astype(float)
        map = (
            MAP.replace("f1, f2", "f1")
            % ", state: {column: l, values: {0: non_slip, 1: gross}, rule: a button}"
        )
        # 1,000 s in float32 are exact to 6e-5 s, which is consistent with 100 Hz.
        np.savez(self.folder / "a.npz", t=np.float32(times + 1000), f1=times, l=labels)
        trial = self.read(map, self.folder / "a.npz")[0][0]
        self.assertEqual(trial.sensors["pad"].rate, 100.0)
        self.assertEqual(trial.labels["pad"].state_paper.tolist(), (1 + 2 * labels).tolist())
        stamps = np.datetime64("2026-02-03T10:00:00", "ns") + (times * 1e9).round().astype(
            "timedelta64[ns]"
        )
        np.savez(self.folder / "a.npz", t=stamps, f1=times, l=labels)
        np.testing.assert_allclose(
            self.force(map, self.folder / "a.npz")[1], 1770112800 + times, rtol=0, atol=1e-6
        )

    def test_arrays_of_another_length_are_named(self):
        times = np.arange(10) / 100
        np.savez(self.folder / "a.npz", t=times, f1=times, f2=times[:7], f3=np.float64(1.5))
        for columns, message in {
            "f1, f2": "a.npz: 'f2' has 7 rows; expected 10, as most arrays have",
            "f3": "a.npz: 'f3' has one value without rows; expected 10, as most arrays have",
            "f*": "a.npz: 'f2', which 'f*' means, has 7 rows; expected 10",
        }.items():
            self.assertIn(
                message, self.refused((MAP % "").replace("f1, f2", columns), self.folder / "a.npz")
            )

    def test_columns_of_one_name_are_refused(self):
        times = pa.array(np.arange(10) / 100)
        pa.parquet.write_table(
            pa.table([times] * 3, names=["t", "f1", "f1"]), self.folder / "a.parquet"
        )
        self.assertIn(
            "a.parquet: has 2 columns 'f1'; titles must differ",
            self.refused(MAP % "", self.folder / "a.parquet"),
        )

    def test_damaged_arrays_are_refused(self):
        """Found by fuzz_import.py."""
        bare = "{sensor: pad, type: own, time: {column: '1'}, channels: {force: {unit: N, columns: ['2']}}}"
        np.save(self.folder / "a.npy", np.array([[0.0, 1.0], [1e-300, 1.0], [2e-300, 1.0]]))
        self.assertIn(
            "1e-300 s after the sample before; expected at least 1e-10 s",
            self.refused(bare, self.folder / "a.npy"),
        )
        whole = (self.folder / "a.npy").read_bytes()
        self.write("a.npy", whole.replace(b"}  ", b"} ("))
        self.assertIn(
            "a.npy: cannot be read as an array: ", self.refused(bare, self.folder / "a.npy")
        )
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [force]}}}"
        np.savez_compressed(
            self.folder / "a.npz", t=np.array([0.0, 0.01]), force=np.arange(2000.0).reshape(2, 1000)
        )
        data = bytearray((self.folder / "a.npz").read_bytes())
        data[-1000:-600] = bytes(400)  # inside the compressed force
        self.write("b.npz", bytes(data))
        self.assertIn("b.npz: cannot be read as arrays: ", self.refused(map, self.folder / "b.npz"))
        with mock.patch.object(arrays, "LARGEST", 1000):
            self.assertIn(
                "expected at most 0 GB; split the file", self.refused(map, self.folder / "a.npz")
            )
        with zipfile.ZipFile(self.folder / "a.npz", "a") as archive:
            archive.writestr("README.txt", "not an array")
        self.assertEqual(self.force(map, self.folder / "a.npz")[0].shape, (2, 1000))
        record = np.array(
            [(0.0, 1.0, "0"), (0.01, 2.0, "1")], [("t", "f8"), ("force", "f4"), ("s", "<U1")]
        )
        np.save(self.folder / "c.npy", record)
        labelled = map[:-1] + ", state: {column: s, rule: by hand}}"
        self.assertEqual(self.force(labelled, self.folder / "c.npy")[0].ravel().tolist(), [1, 2])
        # The last text is the code point 0xff000031.
        self.write("c.npy", (self.folder / "c.npy").read_bytes()[:-1] + b"\xff")
        self.assertIn(
            "c.npy: s contains a text that cannot be read",
            self.refused(labelled, self.folder / "c.npy"),
        )

    def test_damaged_parquet_is_refused(self):
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}, missing: gap}"
        path = self.folder / "a.parquet"

        def write(rows, **columns):
            times = pa.array([*range(rows - 1), None], pa.timestamp("s"))
            pa.parquet.write_table(
                pa.table({"t": times, "f": [1.0] * rows} | columns),
                path,
                use_dictionary=False,
                compression="none",
            )

        write(4)
        self.assertEqual(self.force(map, path)[1].tolist(), [0, 1, 2])
        write(4, s=["text"] * 4)
        self.write("a.parquet", path.read_bytes().replace(b"text", b"te\xffx"))
        self.assertEqual(
            self.force(map, path)[1].tolist(), [0, 1, 2]
        )  # the map does not name the damaged column
        labelled = map[:-1] + ", state: {column: s, rule: r, values: {text: 1}}}"
        self.assertIn("a.parquet: cannot be read as Parquet: ", self.refused(labelled, path))
        write(4, s=[[1.0], [1.0, 2.0], [], []])
        self.assertIn(
            "a.parquet: column 's': its lists differ in length",
            self.refused(map.replace("[f]", "[s]"), path),
        )
        write(4, s=[["a"]] * 4)
        self.assertIn(
            "a.parquet: column 's' contains lists of texts; expected numbers",
            self.refused(map.replace("[f]", "[s]"), path),
        )
        write(2000)
        with mock.patch.object(
            arrays, "LARGEST", 16_000
        ):  # 2,000 values of 8 bytes; the file has 4,000
            self.assertIn(
                "columns f, t have 4000 values in 2000 rows; expected at most 2000 values",
                self.refused(map, path),
            )
        write(4)
        table = pa.parquet.read_table(path)
        with mock.patch.object(
            pa.parquet.ParquetFile, "read", return_value=table.slice(0, 0)
        ):  # its list of row groups is lost
            self.assertIn(
                "a.parquet: is damaged: has 0 rows; expected 4, as its footer states",
                self.refused(map, path),
            )

    def test_parquet_reads_only_the_named_columns_and_each_text_once(self):
        """Ten row groups of 8 rows with one text of 5 MB: 400 MB as texts of the rows, 50 MB as dictionaries."""
        map = "{sensor: pad, type: own, time: {column: t}, channels: {force: {unit: N, columns: [f]}}%s}"
        path, long = self.folder / "a.parquet", "x" * 5_000_000
        rows = [k / 100 for k in range(80)]
        table = pa.table(
            {
                "t": rows,
                "f": rows,
                "s": [long] * 80,
                "name": ["a", None] * 40,
                "fixed": pa.array([b"x" * 1000] * 80, pa.binary(1000)),
            }
        )
        pa.parquet.write_table(table, path, row_group_size=8, compression="zstd")
        self.assertLess(path.stat().st_size, 200_000)
        np.testing.assert_array_equal(
            self.force(map % "", path)[0].ravel(), np.array(rows, np.float32)
        )
        source = arrays.read_parquet(str(path))
        self.assertEqual((len(source), source.titles), (80, ["t", "f", "s", "name", "fixed"]))
        before = limits.data_bytes()
        with limits.memory_limit(str(path), 250_000_000):
            source.load(["t", "s", "name"], ["s", "name"])
            self.assertEqual(set(source.texts("s")), {long})
        self.assertLess(limits.data_bytes() - before, 250_000_000)
        self.assertEqual(source.texts("name")[:3], ["a", "None", "a"])
        # By the footer, the texts take 50 MB, and 80 values of 1,000 bytes take 80 kB.
        with mock.patch.object(arrays, "LARGEST", 40_000_000):
            self.assertIn(
                "a.parquet: columns s take 0.05 GB when they are unpacked; expected at most 0.04 GB",
                self.refuse_load(source, "s"),
            )
        with mock.patch.object(arrays, "LARGEST", 70_000):
            self.assertIn(
                "a.parquet: columns fixed take 8e-05 GB", self.refuse_load(source, "fixed")
            )
            source.load(["t", "f"], [])

    def refuse_load(self, source, *titles):
        """Returns the message with which the columns are refused."""
        with self.assertRaises(slipbench.InputError) as caught:
            source.load(titles, [])
        return str(caught.exception)

    def test_a_limit_is_that_of_one_thread_at_a_time(self):
        before = resource.getrlimit(resource.RLIMIT_DATA)
        begun, end, seen = threading.Event(), threading.Event(), []

        def first():
            with limits.memory_limit("a", 10**9), limits.memory_limit("a", 10**9):
                begun.set()
                end.wait()

        def second():
            begun.wait()
            with limits.memory_limit("b", 2 * 10**9):
                seen.append(resource.getrlimit(resource.RLIMIT_DATA)[0] - limits.data_bytes())

        threads = [threading.Thread(target=target) for target in (first, second)]
        for thread in threads:
            thread.start()
        begun.wait()
        threads[1].join(0.1)
        self.assertEqual(seen, [])
        end.set()
        for thread in threads:
            thread.join()
        self.assertGreater(seen[0], 1.5e9)  # its own 2 GB, less what was allocated since
        self.assertEqual(resource.getrlimit(resource.RLIMIT_DATA), before)

    def test_a_source_takes_at_most_half_of_the_memory(self):
        for machine, most in (
            (16_000_000_000, 8_000_000_000),
            (64_000_000_000, 32_000_000_000),
            (256_000_000_000, 32_000_000_000),
        ):
            with mock.patch.object(limits, "machine_bytes", return_value=machine):
                self.assertEqual(limits.source_limit(), most)
        installed = next(
            line
            for line in Path("/proc/meminfo").read_text().splitlines()
            if line.startswith("MemTotal")
        )
        self.assertAlmostEqual(limits.machine_bytes(), 1024 * int(installed.split()[1]), delta=1024)


PILLAR = "int64 id\nfloat32 dX\nfloat32 dY\nfloat32 dZ\nfloat32 fX\nfloat32 fY\nfloat32 fZ\nbool in_contact\nint64 slip_state\n"
SENSOR = (
    "std_msgs/Header header\nint64 tus\npapillarray_interfaces/PillarState[] pillars\nfloat32 gfX\n"
)


class Bags(ImportTest):
    """Bags that rosbags has written."""

    def messages(self, ros):
        """Returns types and 4 messages of a PapillArray.

        Pillar p carries (p, 0, 2) N and is displaced by (0, 0, row) mm, 1 ms apart.
        """
        store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_JAZZY)
        package = "papillarray_interfaces/msg"
        store.register(
            get_types_from_msg(PILLAR, f"{package}/PillarState")
            | get_types_from_msg(SENSOR, f"{package}/SensorState")
        )
        types = store.types
        header = {"seq": 0} if ros == 1 else {}
        made = []
        for row in range(4):
            pillars = [
                types[f"{package}/PillarState"](
                    id=p, dX=0, dY=0, dZ=row, fX=p, fY=0, fZ=2, in_contact=True, slip_state=1
                )
                for p in range(9)
            ]
            stamp = types["builtin_interfaces/msg/Time"](sec=5, nanosec=1_000_000 * row)
            made.append(
                types[f"{package}/SensorState"](
                    header=types["std_msgs/msg/Header"](stamp=stamp, frame_id="", **header),
                    tus=1000 * row,
                    pillars=pillars,
                    gfX=0.0,
                )
            )
        return store, f"{package}/SensorState", made

    def check(self, path):
        """Imports both sensors of a bag with the program's own map."""
        output = self.folder / f"{path.name}.h5"
        slipbench.import_recordings(path, output, map="papillarray_ros")
        with slipbench.open(output) as data:
            trial = data[0]
            self.assertEqual(set(trial.sensors), {"pad_hub_0_sensor_0", "pad_hub_0_sensor_1"})
            pad = trial.sensors["pad_hub_0_sensor_1"]
            np.testing.assert_allclose(pad.t, [0, 0.001, 0.002, 0.003])
            self.assertEqual(np.asarray(pad.force).tolist(), [[[p, 0, 2] for p in range(9)]] * 4)
            np.testing.assert_array_equal(
                np.asarray(pad.displacement)[:, 4, 2], np.float32([0, 0.001, 0.002, 0.003])
            )

    def test_bags_of_both_ros_are_read(self):
        store, kind, made = self.messages(1)
        with Writer1(self.folder / "one.bag") as writer:
            for topic in ("/hub_0/sensor_0", "/hub_0/sensor_1"):
                connection = writer.add_connection(topic, kind, typestore=store)
                for row, message in enumerate(made):
                    writer.write(connection, row * 1_000_000, store.serialize_ros1(message, kind))
        self.check(self.folder / "one.bag")
        for plugin in (StoragePlugin.SQLITE3, StoragePlugin.MCAP):
            store, kind, made = self.messages(2)
            path = self.folder / f"bag_{plugin.name}"
            with Writer2(path, version=9, storage_plugin=plugin) as writer:
                for topic in ("/hub_0/sensor_0", "/hub_0/sensor_1"):
                    connection = writer.add_connection(topic, kind, typestore=store)
                    for row, message in enumerate(made):
                        writer.write(
                            connection, row * 1_000_000, store.serialize_cdr(message, kind)
                        )
            self.check(path)
        self.check(next(path.glob("*.mcap")))

    def test_long_and_empty_topics(self):
        self.test_bags_of_both_ros_are_read()
        map = "{sensor: pad, type: own, topic: %s, channels: {force: {unit: N, columns: ['pillars[*].fX']}}}"
        with mock.patch.object(
            bags, "BLOCK", 200
        ):  # two messages of 87 values fit in, the third fills it
            values, _ = self.force(map % "/hub_0/sensor_0", self.folder / "one.bag")
        self.assertEqual(values.tolist(), [list(range(9))] * 4)
        with mock.patch.object(bags, "MOST_IN_TOPIC", 300):
            self.assertIn(
                "has more than 300 values",
                self.refused(map % "/hub_0/sensor_0", self.folder / "one.bag"),
            )
        with Writer1(self.folder / "empty.bag") as writer:
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg("float64[] data\n", "pad_msgs/msg/List"))
            writer.write(
                writer.add_connection("/e", "pad_msgs/msg/List", typestore=store), 0, bytes(4)
            )
        self.assertIn(
            "the messages have no values, or only lists of more than 100000",
            self.refused(map % "/e", self.folder / "empty.bag"),
        )

    def test_our_own_bags_are_read(self):
        dataset, output = self.folder / "ours.h5", self.folder / "again.h5"
        scene = slipbench.Scene.load("papillarray/stage.yaml").set({"motion.speed": "8 mm/s"})
        scene.write(dataset)
        slipbench.export(dataset, self.folder / "bags", format="rosbag2")
        slipbench.import_recordings(
            self.folder / "bags", output, map="papillarray_ros2"
        )  # there is a CMakeLists.txt, too
        with slipbench.open(dataset) as ours, slipbench.open(output) as again:
            pad, read = ours[0].sensors["pad"], again[0].sensors["pad"]
            np.testing.assert_array_equal(read.force, pad.force)
            np.testing.assert_allclose(
                read.displacement, pad.displacement, rtol=1e-6, atol=1e-12
            )  # mm as float32 in the bag

    def test_topics_are_named_or_found(self):
        self.test_bags_of_both_ros_are_read()
        bag = self.folder / "one.bag"
        map = (
            "{sensor: pad, type: own, %s channels: {force: {unit: N, columns: ['pillars[*].fX']}}}"
        )
        values, times = self.force(map % "topic: /hub_0/sensor_0,", bag)
        self.assertEqual(values[0].tolist(), list(range(9)))
        np.testing.assert_allclose(
            times, [0, 0.001, 0.002, 0.003]
        )  # when the messages were received
        _, times = self.force(map % "topic: /hub_0/sensor_0, time: {column: header.stamp},", bag)
        np.testing.assert_allclose(times, [5, 5.001, 5.002, 5.003])
        self.assertIn("has 2 topics, so the map needs the key 'topic'", self.refused(map % "", bag))
        self.assertIn(
            "has no topic '/hub_0/sensor_2'", self.refused(map % "topic: /hub_0/sensor_2,", bag)
        )
        self.assertIn(
            "has no topic of the type 'Other'", self.refused(map % "message: Other,", bag)
        )
        self.assertIn(
            "no column is called 'pillars[*].fx' with a number for each *",
            self.refused(map.replace("fX", "fx") % "topic: /hub_0/sensor_0,", bag),
        )
        self.write("bad.bag", b"#ROSBAG V2.0\nno")
        self.assertIn(
            "bad.bag: cannot be read as a bag", self.refused(map % "", self.folder / "bad.bag")
        )

    def test_definitions_that_a_bag_does_not_have(self):
        store, kind, made = self.messages(2)
        bag = self.folder / "humble"
        with Writer2(bag, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
            connection = writer.add_connection("/a", kind, typestore=store)
            for row, message in enumerate(made):
                writer.write(connection, row * 1_000_000, store.serialize_cdr(message, kind))
        with (
            contextlib.closing(sqlite3.connect(bag / "humble.db3")) as file,
            file,
        ):  # as ROS 2 Humble writes it
            file.execute("DROP TABLE message_definitions")
            file.execute("UPDATE schema SET schema_version = 3")
        map = (
            "{sensor: pad, type: own, %s channels: {force: {unit: N, columns: ['pillars[*].fX']}}}"
        )
        self.assertIn(
            f"topic /a: the bag has no definition of {kind}; name the .msg file, or a folder of such files, in the map: "
            "definitions: [PATH]",
            self.refused(map % "", bag),
        )
        package = kind.split("/")[0]
        sensor = self.write(f"{package}/SensorState.msg", SENSOR)
        self.assertIn(
            f"has no definition of {package}/msg/PillarState;",
            self.refused(map % f"definitions: [{sensor}],", bag),
        )
        self.write(f"more/{package}/msg/PillarState.msg", PILLAR)
        values, _ = self.force(map % f"definitions: [{package}, more],", bag)
        self.assertEqual(values.tolist(), [list(range(9))] * 4)
        self.assertIn(
            "map.yaml:1: definitions: expected a .msg file",
            self.refused(map % "definitions: [no.msg],", bag),
        )
        (self.folder / "none").mkdir()
        self.assertIn(
            "found 'none', which has none", self.refused(map % "definitions: [none],", bag)
        )
        self.write(f"{package}/SensorState.msg", "float32 1x\n")
        self.assertIn(
            "SensorState.msg: cannot be read as the definition",
            self.refused(map % f"definitions: [{package}],", bag),
        )

    def test_booleans_of_a_bag_are_labels(self):
        store, kind, made = self.messages(2)
        with Writer2(self.folder / "flags", version=9) as writer:
            connection = writer.add_connection("/a", kind, typestore=store)
            for row, message in enumerate(made):
                message.pillars[0].in_contact = row > 1
                writer.write(connection, row * 1_000_000, store.serialize_cdr(message, kind))
        state = "state: {column: 'pillars[0].in_contact', values: {false: no_contact, true: non_slip}, rule: r},"
        map = (
            "{sensor: pad, type: own, %s channels: {force: {unit: N, columns: ['pillars[*].fX']}}}"
        )
        trial = self.read(map % state, self.folder / "flags")[0][0]
        self.assertEqual(trial.labels["pad"]["state_paper"][:].tolist(), [0, 0, 1, 1])
        channel = map.replace("pillars[*].fX", "pillars[0].in_contact") % ""
        self.assertEqual(
            self.force(channel, self.folder / "flags")[0].ravel().tolist(), [0, 0, 1, 1]
        )

    def test_stamps_of_zero_are_explained(self):
        store, kind, made = self.messages(2)
        with Writer2(self.folder / "zero", version=9) as writer:
            connection = writer.add_connection("/a", kind, typestore=store)
            for row, message in enumerate(made):
                message.header.stamp.sec = message.header.stamp.nanosec = 0
                writer.write(connection, row * 1_000_000, store.serialize_cdr(message, kind))
        map = "{sensor: pad, type: own, time: {column: header.stamp}, channels: {force: {unit: N, columns: ['pillars[*].fX']}}}"
        self.assertRegex(
            self.refused(map, self.folder / "zero"),
            r"topic /a: column \d+, time: header.stamp is 0 s in all 4 samples; leave out 'time' in the map, to use the times of receipt",
        )

    def test_a_bag_of_other_messages_is_named(self):
        dataset = self.folder / "ours.h5"
        slipbench.Scene.load("papillarray/stage.yaml").set({"motion.speed": "8 mm/s"}).write(
            dataset
        )
        slipbench.export(dataset, self.folder / "mcap", format="mcap")
        self.assertRegex(
            self.refused(
                "{sensor: pad, type: own, channels: {force: {unit: N, columns: [f]}}}",
                self.folder / "mcap/demo_0.mcap",
            ),
            "demo_0.mcap: is an MCAP file with messages in 'protobuf'; expected those of ROS 2 in 'cdr'",
        )

    def test_files_that_unpack_to_much_more_are_refused(self):
        def zeros(count):
            packer, block = zstd.ZstdCompressor(), bytes(1_000_000)
            return b"".join(
                [*(packer.compress(block) for _ in range(count // len(block))), packer.flush()]
            )

        def record(code, content):
            return bytes([code]) + len(content).to_bytes(8, "little") + content

        map = "{sensor: pad, type: own, channels: {force: {unit: N, columns: [f]}}}"
        size = 600_000_000
        packed = zeros(size)
        magic, text = b"\x89MCAP0\r\n", lambda word: len(word).to_bytes(4, "little") + word
        chunk = (
            bytes(16)
            + size.to_bytes(8, "little")
            + bytes(4)
            + text(b"zstd")
            + len(packed).to_bytes(8, "little")
            + packed
        )
        file = self.write(
            "a.mcap",
            magic
            + record(1, text(b"ros2") + text(b""))
            + record(6, chunk)
            + record(15, bytes(4))
            + record(2, bytes(20))
            + magic,
        )
        with mock.patch.object(bags, "MEMORY_OF_BAG", 300_000_000):
            self.assertIn(
                "a.mcap: needs more than 0.3 GB of memory when it is unpacked",
                self.refused(map, file),
            )
        self.write("bag/a.db3.zstd", packed)
        self.write(
            "bag/metadata.yaml",
            "rosbag2_bagfile_information: {version: 5, storage_identifier: sqlite3, duration: {nanoseconds: 1}, starting_time: {nanoseconds_since_epoch: 0}, "
            "message_count: 1, topics_with_message_count: [], compression_format: zstd, compression_mode: FILE, relative_file_paths: [a.db3.zstd], files: []}",
        )
        with mock.patch.object(limits, "UNPACKED", 100_000_000):  # the packed file has some 20 kB
            self.assertIn(
                "bag: a file of the bag unpacks to more than 0.1 GB",
                self.refused(map, self.folder / "bag"),
            )

    def test_arrays_of_weiss(self):
        store = get_typestore(Stores.ROS1_NOETIC)
        store.register(
            get_types_from_msg(
                "uint32 matrix_id\nint16 cells_x\nint16 cells_y\nint16[] tactile_array\n",
                "schunk_sdh/msg/TactileMatrix",
            )
            | get_types_from_msg(
                "Header header\nschunk_sdh/TactileMatrix[] tactile_matrix\n",
                "schunk_sdh/msg/TactileSensor",
            )
        )
        matrix, sensor = (
            store.types[f"schunk_sdh/msg/{name}"] for name in ("TactileMatrix", "TactileSensor")
        )
        header, stamp = (
            store.types["std_msgs/msg/Header"],
            store.types["builtin_interfaces/msg/Time"],
        )
        with Writer1(self.folder / "weiss.bag") as writer:
            connection = writer.add_connection("/tactile", sensor.__msgtype__, typestore=store)
            for row in range(3):
                cells = [
                    matrix(
                        matrix_id=k,
                        cells_x=2,
                        cells_y=3,
                        tactile_array=np.arange(6, dtype=np.int16) + row + 10 * k,
                    )
                    for k in range(2)
                ]
                message = sensor(
                    header=header(
                        seq=row, stamp=stamp(sec=5, nanosec=30_000_000 * row), frame_id=""
                    ),
                    tactile_matrix=cells,
                )
                writer.write(
                    connection, 10**9 + row, store.serialize_ros1(message, sensor.__msgtype__)
                )
        output = self.folder / "weiss.h5"
        slipbench.import_recordings(self.folder / "weiss.bag", output, map="weiss_ros")
        with slipbench.open(output) as data:
            sensors = data[0].sensors
            self.assertEqual(
                set(sensors), {"array_tactile_tactile_matrix_0", "array_tactile_tactile_matrix_1"}
            )
            second = sensors["array_tactile_tactile_matrix_1"]
            self.assertEqual(second.counts[2].tolist(), [12, 13, 14, 15, 16, 17])
            np.testing.assert_allclose(second.t, [5.0, 5.03, 5.06], rtol=0, atol=1e-9)

    def test_items_of_a_list_are_sensors(self):
        store = get_typestore(Stores.ROS2_JAZZY)
        store.register(
            get_types_from_msg("uint16 x\nuint16 y\nuint16 z\n", "xela_server_ros2/msg/Taxel")
            | get_types_from_msg(
                "uint8 sensor_pos\nxela_server_ros2/Taxel[] taxels\n",
                "xela_server_ros2/msg/SensorFull",
            )
            | get_types_from_msg(
                "uint8 sensor_pos\nxela_server_ros2/SensorFull[] sensors\n",
                "xela_server_ros2/msg/SensStream",
            )
        )
        taxel, full, stream = (
            store.types[f"xela_server_ros2/msg/{name}"]
            for name in ("Taxel", "SensorFull", "SensStream")
        )
        with Writer2(self.folder / "xela", version=9) as writer:
            connection = writer.add_connection("/xServTopic", stream.__msgtype__, typestore=store)
            for row in range(30):
                touch = max(row - 20, 0)  # from 0.2 s on
                message = stream(
                    sensor_pos=9,
                    sensors=[
                        full(
                            sensor_pos=s,
                            taxels=[taxel(x=s + touch, y=k, z=900 + touch) for k in range(16)],
                        )
                        for s in (1, 2)
                    ],
                )
                writer.write(
                    connection, 10_000_000 * row, store.serialize_cdr(message, stream.__msgtype__)
                )
        output = self.folder / "xela.h5"
        scale = "1 count is taken as 0.601 uT along x and y and 0.968 uT along z"
        with self.assertWarnsRegex(UserWarning, scale):
            summary = slipbench.import_recordings(self.folder / "xela", output, map="xela_ros")
        self.assertIn(scale, str(summary))
        with slipbench.open(output) as data:
            sensors = data[0].sensors
            self.assertEqual(
                set(sensors), {"skin_xServTopic_sensors_0", "skin_xServTopic_sensors_1"}
            )
            counts = np.asarray(sensors["skin_xServTopic_sensors_1"].counts)
            self.assertEqual(counts.shape, (30, 16, 3))
            self.assertEqual(counts[22, 5].tolist(), [4, 5, 902])
            # As networks for the magnetic skin read it: 0 at rest, 2 counts of 0.601 and 0.968 uT.
            skin = sensors["skin_xServTopic_sensors_1"]
            self.assertEqual(list(skin.units.items()), [("field", "uT"), ("counts", "counts")])
            field = np.asarray(skin.field)
            np.testing.assert_allclose(field[:20], 0.0, atol=1e-9)
            np.testing.assert_allclose(field[22, 5], [1.202, 0.0, 1.936], rtol=1e-6, atol=1e-9)
        # The message has a field of the same name as the item's.
        map = "{sensor: skin, type: own, each: sensors, channels: {place: {unit: '1', columns: [sensor_pos]}}}"
        sensors = self.read(map, self.folder / "xela")[0][0].sensors
        self.assertEqual([sensors[name].place[0, 0] for name in sorted(sensors)], [1, 2])


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
