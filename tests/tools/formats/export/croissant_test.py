"""README.md and croissant.json of every export follow the rules of Croissant 1.0.

Arguments: the project's root, the program. Rules:
https://docs.mlcommons.org/croissant/docs/croissant-spec.html; mlcroissant itself lacks wheels for
some of its dependencies.
"""

import gzip
import hashlib
import json
import subprocess
import unittest

import h5py
import numpy as np
import pyarrow.parquet
import yaml
from _made import PROGRAM, ExportTest, contents, export, import_table, make

STAGE = "papillarray/stage.yaml"
# Scene, and the folder of the card below the output.
FORMATS = {
    "csv": (STAGE, ""),
    "npz": (STAGE, ""),
    "robomimic": (STAGE, ""),
    "vendor-csv": (STAGE, ""),
    "training-csv": (STAGE, ""),
    "grasp-csv": ("biotac_sp/grasp.yaml", ""),
    "slip-csv": ("biotac_sp/slip.yaml", ""),
    "myrmex-csv": ("myrmex/slip.yaml", ""),
    "myrmex-rotated": ("myrmex/slip.yaml", ""),
    "parquet": (STAGE, ""),
    "mcap": (STAGE, ""),
    "rosbag2": (STAGE, ""),
    "lerobot": (STAGE, "1000hz"),
}
TABLES = {
    "csv",
    "vendor-csv",
    "grasp-csv",
    "slip-csv",
    "parquet",
    "lerobot",
}  # the formats whose columns croissant.json describes
TYPES = {"sc:Text", "sc:Integer", "sc:Float", "sc:Boolean"}
PAD_CODES = "0 no_contact, 1 non_slip, 2 incipient, 3 gross"


def distribution(about, kind="cr:FileObject"):
    return [one for one in about["distribution"] if one["@type"] == kind]


class Croissant(ExportTest):
    def exported(self, format, scene, *words):
        """Returns the folder with the card, and croissant.json."""
        out = self.folder / f"{format}{len(words)}"
        export(make(scene), out, "--format", format, *words)
        folder = out / FORMATS[format][1]
        return folder, json.loads((folder / "croissant.json").read_text())

    def test_every_file_is_described(self):
        for format, (scene, _) in FORMATS.items():
            with self.subTest(format=format):
                folder, about = self.exported(format, scene, "--licence", "cc-by-4.0")
                self.assertEqual(about["@type"], "sc:Dataset")
                self.assertEqual(about["conformsTo"], "http://mlcommons.org/croissant/1.0")
                self.assertEqual(about["license"], "cc-by-4.0")
                self.assertRegex(about["version"], r"^\d+\.\d+\.\d+$")
                for name in ("name", "description", "citeAs"):
                    self.assertTrue(about[name])
                files = contents(folder)
                described = {one["contentUrl"]: one for one in distribution(about)}
                self.assertEqual(set(described), set(files) - {"croissant.json"})
                for name, one in described.items():
                    self.assertEqual(one["sha256"], hashlib.sha256(files[name]).hexdigest())
                    self.assertIn("/", one["encodingFormat"])
                self.assertEqual("recordSet" in about, format in TABLES)

    def test_the_card_says_what_the_files_are(self):
        for format, (scene, _) in FORMATS.items():
            with self.subTest(format=format):
                folder, _ = self.exported(format, scene, "--licence", "cc-by-4.0")
                _, front, text = (folder / "README.md").read_text().split("---\n", 2)
                self.assertEqual(yaml.safe_load(front)["license"], "cc-by-4.0")
                self.assertNotIn(str(self.folder), text)
                for heading in ("## Sensors", "## Files", "## Origin", "The scene:", "## Citation"):
                    self.assertIn(f"\n{heading}\n", text)
                self.assertIn("| version | slipbench ", text)
                self.assertIn("| command | `slipbench ", text)
                self.assertRegex(text, r"\| SHA-256 of trial 0 \| `[0-9a-f]{64}` \|")
                self.assertRegex(text, r"\| `\w+` \| \w+ \| \d+ Hz \|")
                # Formats with labels document their codes: states of the pad, of a pillar, or of a
                # grasp.
                key = {
                    "vendor-csv": "-2 not yet touched",
                    "training-csv": "0 no, 1 slips; rule strict: a pillar slips when all of it slips",
                    "grasp-csv": "0 held, 1 lost",
                    "slip-csv": "cw and aw turn",
                    "myrmex-csv": "0 to 4095",
                }.get(format, PAD_CODES)
                self.assertIn(key, text)

    def test_tables_are_described_by_their_columns(self):
        for format, scene, table, named in (
            ("csv", STAGE, "pad", ["trial"]),
            ("csv", "nib_pad/linear.yaml", None, ["trial"]),
            ("vendor-csv", STAGE, "LOG", ["trial"]),
            ("grasp-csv", "biotac_sp/grasp.yaml", "grasps", []),
            ("slip-csv", "biotac_sp/slip.yaml", "recordings", ["class"]),
        ):
            for compress in ([], ["--compress"]):
                with self.subTest(format=format, scene=scene, compress=compress):
                    out = self.folder / f"{format}-{scene.replace('/', '-')}{len(compress)}"
                    export(make(scene), out, "--format", format, *compress)
                    about = json.loads((out / "croissant.json").read_text())
                    sets = {one["@id"]: one for one in distribution(about, "cr:FileSet")}
                    described = []
                    for one in about["recordSet"]:
                        files = sets[f"{one['name']}-files"]["includes"]
                        described += files
                        for name in files:
                            opened = gzip.open if compress else open
                            with opened(out / name, "rt") as file:
                                header = file.readline().rstrip("\n").split(",")
                            self.assertEqual(
                                [field["name"] for field in one["field"]], [*named, *header]
                            )
                        for field in one["field"]:
                            self.assertIn(field["dataType"], TYPES)
                            self.assertEqual(
                                field["source"]["fileSet"], {"@id": f"{one['name']}-files"}
                            )
                    self.assertEqual(
                        sorted(described),
                        sorted(name for name in contents(out) if name.endswith((".csv", ".gz"))),
                    )
                    if table:
                        self.assertEqual([one["name"] for one in about["recordSet"]], [table])
                    states = [
                        field["description"]
                        for one in about["recordSet"]
                        for field in one["field"]
                        if field["name"] == "state"
                    ]
                    self.assertEqual(
                        [PAD_CODES in text for text in states],
                        [True] * (len(about["recordSet"]) if format == "csv" else 0),
                    )

    def test_the_rule_of_a_log_is_in_its_card(self):
        for words, text in (
            (["--slip", "micro"], "rule micro: a pillar slips when a part of it slips"),
            (
                ["--slip", "paper", "--label-speed", "0.2 mm/s"],
                "rule paper: a pillar slips when its tip slides faster than 0.2 mm/s",
            ),
        ):
            folder, _ = self.exported("training-csv", STAGE, *words)
            self.assertIn(text, (folder / "README.md").read_text())

    def test_the_key_of_codes_is_in_the_files(self):
        key = {"no_contact": 0, "non_slip": 1, "incipient": 2, "gross": 3}
        folders = {
            format: self.exported(format, STAGE)[0]
            for format in ("npz", "robomimic", "parquet", "lerobot")
        }
        with np.load(folders["npz"] / "demo_0.npz") as archive:
            found = [json.loads(archive["about"].item())["codes"]["labels/pad/state"]]
        with h5py.File(folders["robomimic"] / "robomimic.hdf5") as file:
            found.append(json.loads(file["data/demo_0/pad_state"].attrs["codes"]))
        for path, column in (
            (folders["parquet"] / "pad.parquet", "label_state"),
            (folders["lerobot"] / "data/chunk-000/file-000.parquet", "labels.pad.state"),
        ):
            found.append(
                json.loads(pyarrow.parquet.read_schema(path).field(column).metadata[b"codes"])
            )
        self.assertEqual(found, [key] * 4)

    def test_recordings_without_labels_have_none_in_their_card(self):
        dataset = import_table(
            self.folder,
            "t,f\n0,1\n0.01,2\n0.02,3\n",
            "sensor: pad\ntype: own\ntime: {column: t}\nchannels: {force: {unit: N, columns: [f]}}\n",
        )
        for format, below in (("csv", ""), ("parquet", ""), ("lerobot", "100hz")):
            export(dataset, self.folder / format, "--format", format)
            card = (self.folder / format / below / "README.md").read_text()
            self.assertIn("\n# Recordings of own\n", card)
            self.assertNotIn(
                "labels",
                json.loads((self.folder / format / below / "croissant.json").read_text())[
                    "description"
                ],
            )
            # Folders of the machine are not revealed, and no argument is lost.
            self.assertIn(
                "| command | `slipbench import 'my logs' --map 'my map.yaml' --seed 1` |", card
            )
        folder, about = self.exported("myrmex-csv", "myrmex/slip.yaml")  # counts alone
        self.assertIn("\n# Recordings of myrmex\n", (folder / "README.md").read_text())
        self.assertNotIn("labels", about["description"])

    def test_a_card_has_the_codes_of_all_trials(self):
        # Only the second recording has a sample with an unknown label.
        logs = self.folder / "logs"
        logs.mkdir()
        for name, label in (("a", "hold"), ("b", "unknown")):
            (logs / f"{name}.csv").write_text(
                "t,f,s\n0,1,hold\n0.01,2,slip\n" + f"0.02,3,{label}\n"
            )
        (self.folder / "map.yaml").write_text(
            "sensor: pad\ntype: own\nfiles: '*.csv'\ntime: {column: t}\nchannels: {force: {unit: N, columns: [f]}}\n"
            "state: {column: s, values: {hold: non_slip, slip: gross, unknown: unknown}, rule: invented}\n"
        )
        dataset = str(self.folder / "both.h5")
        subprocess.run(
            [PROGRAM, "import", str(logs), "--map", str(self.folder / "map.yaml"), "-o", dataset],
            check=True,
            capture_output=True,
        )
        export(dataset, self.folder / "coded", "--format", "csv")
        self.assertRegex((self.folder / "coded/README.md").read_text(), "3 gross, 4 unknown")

    def test_texts_of_a_dataset_are_not_links_in_its_card(self):
        """CommonMark: a backslash escapes the next punctuation. GitHub's Markdown makes links of bare addresses, but not in code."""
        frame = r"x \[click\](http://evil.example/) www.evil.example, a@evil.example [a](javascript:b) <b>"
        shown = r"x `\[click\](http://evil.example/)` `www.evil.example,` `a@evil.example` \[a\](javascript:b) &lt;b&gt;"
        rule, escaped = (
            r"\[y\](javascript:alert`1`) | $z$",
            r"\\\[y\\\](javascript:alert\`1\`) \| \$z\$",
        )
        about = {
            "sensor": "pad",
            "type": "own",
            "time": {"column": "t"},
            "channels": {"force": {"unit": "N", "columns": ["f"]}},
            "frame": frame,
            "state": {"value": "1", "rule": rule},
        }
        export(
            import_table(self.folder, "t,f\n0,1\n0.01,2\n0.02,3\n", json.dumps(about)),
            self.folder / "out",
            "--format",
            "csv",
        )
        card = (self.folder / "out/README.md").read_text()
        self.assertIn(f"| `pad` | own | 100 Hz | {shown} |\n", card)
        self.assertIn(f"; rule: {escaped} |\n", card)

    def test_rates_and_shapes_are_those_of_the_files(self):
        """The scene has sensors of 1000, 1000 and 500 Hz and arrays of 16 x 16 and 4 x 3 taxels."""

        def rows(format):
            text = (self.exported(format, "myrmex/slip.yaml")[0] / "README.md").read_text()
            return [line.split(" | ") for line in text.splitlines()], text

        lines, _ = rows("robomimic")  # all at the rate of the slowest
        self.assertEqual(
            [line[2] for line in lines if line[-1].startswith("pad frame")], ["500 Hz"] * 3
        )
        _, text = rows("myrmex-csv")
        self.assertIn("one image per line at the rate of the sensor", text)
        lines, _ = rows("myrmex-rotated")
        self.assertEqual(
            sorted(line[2] for line in lines if line[1:2] == ["`taxels`"]),
            ["[12, 12, 12]", "[12, 12, 12]", "[4, 3]"],
        )

    def test_options_that_change_values_are_stated(self):
        for format, words, stated in (
            (
                "rosbag2",
                ["--labels", "micro", "--rate", "100 Hz"],
                "rosbag2 --labels micro --rate '100 Hz'",
            ),
            (
                "vendor-csv",
                ["--slip", "paper"],
                "vendor-csv --labels paper --label-speed '0.1 mm/s'",
            ),
            ("npz", [], "npz"),
        ):
            folder, _ = self.exported(format, STAGE, *words)
            self.assertIn(
                f"\n3 trials, written by `slipbench export --format {stated}`.\n",
                (folder / "README.md").read_text(),
            )

    def test_a_licence_is_text(self):
        for licence in ("no", "1.0", "-"):
            folder, _ = self.exported("npz", STAGE, f"--licence={licence}", "--trial", "0")
            self.assertEqual(
                yaml.safe_load((folder / "README.md").read_text().split("---\n", 2)[1])["license"],
                licence,
            )

    def test_a_card_of_somebody_else_is_kept(self):
        for name, format in (
            ("README.md", "csv"),
            ("croissant.json", "csv"),
            ("README.md", "parquet"),
            ("croissant.json", "mcap"),
            ("README.md", "rosbag2"),
        ):
            out = self.folder / f"{name}-{format}"
            out.mkdir()
            (out / name).write_text("mine")
            _, said = export(make(STAGE), out, "--format", format, status=2)
            self.assertRegex(
                said,
                f"{out / name}( exists and is not a|: would be replaced, but is not a) (dataset card|description)",
            )
            self.assertNotIn("trials", said)  # the conflict is found before the data is written
            self.assertEqual(contents(out), {name: b"mine"})

    def test_a_second_export_describes_the_second(self):
        out = self.folder / "out"
        for trial in ("0", "1"):
            export(make(STAGE), out, "--format", "npz", "--trial", trial)
        about = json.loads((out / "croissant.json").read_text())
        self.assertEqual([one["name"] for one in distribution(about)], ["README.md", "demo_1.npz"])
        self.assertIn("\n1 trial, written by", (out / "README.md").read_text())

    def test_an_export_that_ends_early_leaves_no_card_of_the_one_before(self):
        """Its digests would belong to replaced files."""
        out = self.folder / "out"
        export(make(STAGE), out, "--format", "csv")
        (out / "demo_1-pad.csv").write_text("mine")
        export(
            make(STAGE), out, "--format", "csv", "--rate", "100 Hz", status=2
        )  # demo_0 is replaced, demo_1 is refused
        self.assertEqual(
            sorted(contents(out)), ["demo_0-pad.csv", "demo_1-pad.csv", "demo_2-pad.csv"]
        )

    def test_all_files_are_told(self):
        out = self.folder / "out"
        said, _ = export(make(STAGE), out, "--format", "npz", "--json")
        self.assertEqual(
            json.loads(said)["files"],
            [
                str(out / name)
                for name in (
                    "demo_0.npz",
                    "demo_1.npz",
                    "demo_2.npz",
                    "README.md",
                    "croissant.json",
                )
            ],
        )

    def test_every_column_of_parquet_is_a_field(self):
        out = self.folder / "out"
        export(make("grasp/two_skins.yaml"), out, "--format", "parquet")
        about = json.loads((out / "croissant.json").read_text())
        self.assertNotIn("license", about)
        tables = {one["name"]: one for one in about["recordSet"]}
        self.assertEqual(set(tables), {path.stem for path in out.glob("*.parquet")})
        identifiers = [one["@id"] for one in about["distribution"]]
        for name, table in tables.items():
            schema = pyarrow.parquet.read_schema(out / f"{name}.parquet")
            self.assertEqual([field["name"] for field in table["field"]], schema.names)
            identifiers += [table["@id"], *(field["@id"] for field in table["field"])]
            for field in table["field"]:
                self.assertEqual(
                    field["source"],
                    {
                        "fileObject": {"@id": f"{name}.parquet"},
                        "extract": {"column": field["name"]},
                    },
                )
                self.assertIn(field["dataType"], TYPES)
        self.assertEqual(len(set(identifiers)), len(identifiers))

    def test_a_licence_is_one_word(self):
        for format in ("parquet", "npz"):
            _, said = export(
                make(STAGE), self.folder / "out", "--format", format, "--licence", "a: b", status=2
            )
            self.assertIn("--licence: expected a name such as cc-by-4.0", said)
            self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
