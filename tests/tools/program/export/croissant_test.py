"""croissant.json beside every export by Python: structure by the rules of Croissant 1.0. Arguments: the project's root, the program.

https://docs.mlcommons.org/croissant/docs/croissant-spec.html; mlcroissant itself has no wheel of all that it needs.
"""

import hashlib
import json
import unittest

import pyarrow.parquet
import yaml

from _made import ExportTest, contents, export, make

FORMATS = {"parquet": "", "mcap": "", "rosbag2": "", "lerobot": "1000hz"}
TYPES = {"sc:Text", "sc:Integer", "sc:Float", "sc:Boolean"}


class Croissant(ExportTest):
    def test_every_file_is_described(self):
        for format, below in FORMATS.items():
            with self.subTest(format=format):
                out = self.folder / format
                export(make("papillarray/stage.yaml"), out, "--format", format, "--licence", "cc-by-4.0")
                folder = out / below
                about = json.loads((folder / "croissant.json").read_text())
                self.assertEqual(about["@type"], "sc:Dataset")
                self.assertEqual(about["conformsTo"], "http://mlcommons.org/croissant/1.0")
                self.assertEqual(about["license"], "cc-by-4.0")
                self.assertRegex(about["version"], r"^\d+\.\d+\.\d+$")
                for name in ("name", "description", "citeAs"):
                    self.assertTrue(about[name])
                files = contents(folder)
                described = {one["contentUrl"]: one for one in about["distribution"]}
                self.assertEqual(set(described), set(files) - {"croissant.json"})
                for name, one in described.items():
                    self.assertEqual(one["@type"], "cr:FileObject")
                    self.assertEqual(one["sha256"], hashlib.sha256(files[name]).hexdigest())
                    self.assertIn("/", one["encodingFormat"])
                self.assertEqual("recordSet" in about, format == "parquet")
                _, front, text = (folder / "README.md").read_text().split("---\n", 2)
                self.assertEqual(yaml.safe_load(front)["license"], "cc-by-4.0")
                self.assertNotIn(str(self.folder), text)

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
                self.assertEqual(field["source"], {"fileObject": {"@id": f"{name}.parquet"}, "extract": {"column": field["name"]}})
                self.assertIn(field["dataType"], TYPES)
        self.assertEqual(len(set(identifiers)), len(identifiers))

    def test_a_licence_is_one_word_and_needs_a_card(self):
        dataset = make("papillarray/stage.yaml")
        _, said = export(dataset, self.folder / "out", "--format", "parquet", "--licence", "a: b", status=2)
        self.assertIn("--licence: expected a name such as cc-by-4.0", said)
        _, said = export(dataset, self.folder / "out", "--format", "npz", "--licence", "mit", status=2)
        self.assertIn("npz has no dataset card", said)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
