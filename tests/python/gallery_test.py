"""The gallery has a picture of each folder of scenes, in the displayed size, drawn by its script.

Argument: the project's root.
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from PIL import Image

SCENES = Path(sys.argv.pop(1)) / "scenes"
FOLDERS = sorted(
    path.name for path in SCENES.iterdir() if path.is_dir() and path.name != "__pycache__"
)


class GalleryTest(unittest.TestCase):
    def check(self, folder):
        for name in FOLDERS:
            with self.subTest(name=name):
                place = folder / name / "gallery.png"
                self.assertLess(place.stat().st_size, 60_000)
                with Image.open(place) as picture:
                    self.assertEqual(picture.size, (700, 300))
                    colours = picture.convert("RGB").getcolors(700 * 300)
                self.assertGreater(len(colours), 20)
                self.assertLess(max(count for count, _ in colours), 0.95 * 700 * 300)

    def test_kept(self):
        self.check(SCENES)
        text = (SCENES / "GALLERY.md").read_text(encoding="utf-8")
        for name in FOLDERS:
            self.assertIn(f"]({name}/gallery.png)", text)

    def test_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(
                [sys.executable, SCENES / "gallery.py", folder],
                check=True,
                capture_output=True,
                text=True,
            )
            self.check(Path(folder))


if __name__ == "__main__":
    unittest.main()
