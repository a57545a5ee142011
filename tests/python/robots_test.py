"""Tests scenes/mujoco/robots: robots_test.py FOLDER WithoutModels|Models.

Models needs a clone of MuJoCo Menagerie, named by the variable SLIPBENCH_MENAGERIE; exits with 77
if none of its models is there.
"""

import contextlib
import importlib.util
import io
import math
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import mujoco
import slipbench.mujoco

FOLDER = Path(sys.argv.pop(1))
MENAGERIE = Path(os.environ.get("SLIPBENCH_MENAGERIE", "/nowhere"))
HAS_IMPLICIT = tuple(map(int, mujoco.__version__.split(".")[:2])) >= (3, 14)
described = importlib.util.spec_from_file_location("robots", FOLDER / "robots.py")
robots = importlib.util.module_from_spec(described)
described.loader.exec_module(robots)

# The parts of a Panda that the example needs: two coupled slides, the drive, the names.
HAND = """<mujoco model="stand-in"><option integrator="implicitfast"/><worldbody><body name="hand" pos="0 0 0.5" quat="0 1 0 0">
  <body name="left_finger" pos="0 0 0.06"><joint name="finger_joint1" type="slide" axis="0 1 0" damping="1"/>
    <geom type="box" pos="0 0.005 0.04" size="0.01 0.005 0.02" mass="0.03"/></body>
  <body name="right_finger" pos="0 0 0.06" quat="0 0 0 1"><joint name="finger_joint2" type="slide" axis="0 1 0" damping="1"/>
    <geom type="box" pos="0 0.005 0.04" size="0.01 0.005 0.02" mass="0.03"/></body></body></worldbody>
  <tendon><fixed name="split"><joint joint="finger_joint1" coef="0.5"/><joint joint="finger_joint2" coef="0.5"/></fixed></tendon>
  <equality><joint joint1="finger_joint1" joint2="finger_joint2"/></equality>
  <actuator><general name="actuator8" tendon="split" ctrlrange="0 255" gainprm="0.01568627451" biastype="affine" biasprm="0 -100 -10"/></actuator>
  <keyframe><key name="home" qpos="0.04 0.04" ctrl="255"/></keyframe></mujoco>"""


def run(*words):
    """Returns exit status, output and errors."""
    out, complaint = io.StringIO(), io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["robots.py", *map(str, words)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(complaint),
    ):
        try:
            status = robots.main()
        except SystemExit as end:
            status = end.code
    return status, out.getvalue(), complaint.getvalue()


class Checks(unittest.TestCase):
    def slips_by_the_law(self, figures, mass, rate):
        """Each of two pads carries half of the weight; by Coulomb's law it slips when mu N is less.

        The grip falls by `rate` [N/s]. The two centre pillars, 650 N/m each, stick last: the box
        swings on them and is late by at most half a swing. A reading is up to two steps old. A face
        that leans by 1 degree carries 2e-4 less than the weight.
        """
        law = mass * 9.81 / (2 * 0.5)
        late = rate * (math.pi * math.sqrt(mass / (2 * 650)) + 2 * 0.002)
        self.assertAlmostEqual(figures["m g / (2 mu) [N]"], law, places=12)
        self.assertAlmostEqual(figures["the box slips at [N]"], law, delta=late + 2e-4 * law)
        self.assertLess(late / law, 2e-3)  # as documented on the page
        self.assertEqual(figures["other contacts of the box"], 0)

    def drive_is_what_pads_feel(self, figures):
        # Two slides, each pulled by a tendon with half its force, at rest: only residual motion
        # disturbs the balance.
        self.assertAlmostEqual(
            figures["normal force of the pads at rest [N]"],
            figures["force of the drive on a finger [N]"],
            delta=1e-4,
        )
        self.assertGreater(
            figures["force of the drive on a finger [N]"], 1.2
        )  # 100 N/m over 29.7 mm, halved, is 1.49 N; the pads open it further

    def refuses(self, function, folder, text, **changes):
        """Returns attach_pad with changed arguments; `excludes=False` removes what it excluded."""
        attach, excludes = slipbench.mujoco.attach_pad, changes.pop("excludes", True)

        def changed(spec, *words, **named):
            pad = attach(spec, *words, **{**named, **changes})
            for exclude in (
                []
                if excludes
                else [e for e in spec.excludes if "object" in (e.bodyname1, e.bodyname2)]
            ):
                spec.delete(exclude)
            return pad

        with (
            mock.patch.object(slipbench.mujoco, "attach_pad", changed),
            self.assertRaisesRegex((ValueError, mujoco.FatalError), text),
        ):
            function(folder)


class WithoutModels(Checks):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def write(self, file, text):
        path = self.folder / file
        path.parent.mkdir()
        path.write_text(text, encoding="utf-8")

    def test_wrong_words(self):
        files = {
            "panda": "franka_emika_panda/panda.xml",
            "robotiq_2f85": "robotiq_2f85/2f85.xml",
            "leap_hand": "leap_hand/right_hand.xml",
        }
        for robot, file in files.items():
            status, out, complaint = run(self.folder, robot)
            self.assertEqual((status, out), (2, ""))
            self.assertRegex(
                complaint,
                f"^error: {self.folder / file}: no such file.*github.com/google-deepmind/mujoco_menagerie\n$",
            )
        status, _, complaint = run(self.folder, "shadow_hand")
        self.assertEqual(status, 2)
        self.assertRegex(complaint, "invalid choice: 'shadow_hand'.*panda.*robotiq_2f85.*leap_hand")

    def test_a_model_of_another_make(self):
        self.write(
            "robotiq_2f85/2f85.xml",
            '<mujoco model="half"><worldbody><body name="base_mount"/></worldbody></mujoco>',
        )
        status, out, complaint = run(self.folder, "robotiq_2f85")
        self.assertEqual((status, out), (2, ""))
        self.assertRegex(complaint, "^error: .*'half'.*'left_pad'.*\n$")
        self.write(
            "leap_hand/right_hand.xml",
            '<mujoco><worldbody><body><geom size="1"/></body></worldbody></mujoco>',
        )
        status, _, complaint = run(self.folder, "leap_hand")
        self.assertEqual(status, 2)
        self.assertRegex(complaint, "^error: .*LEAP hand.* 1 tips.* 0 joints.* 4 .*16\n$")
        self.write(
            "franka_emika_panda/panda.xml",
            HAND.replace("<worldbody>", '<asset><mesh file="no.stl"/></asset><worldbody>'),
        )
        status, _, complaint = run(self.folder, "panda")
        self.assertEqual(status, 2)
        self.assertIn("no.stl", complaint)

    def test_box_between_two_slides(self):
        self.write("franka_emika_panda/panda.xml", HAND)
        status, out, complaint = run(self.folder, "panda")
        self.assertEqual((status, complaint), (0, ""))
        figures = {line[:50].rstrip(): float(line[50:]) for line in out.splitlines()}
        exact, _ = robots.panda(self.folder)
        self.assertEqual(figures.keys(), exact.keys())
        self.drive_is_what_pads_feel(exact)
        self.slips_by_the_law(exact, 0.1, 0.05)

    def test_mistakes(self):
        self.write("franka_emika_panda/panda.xml", HAND)
        self.refuses(
            robots.panda,
            self.folder,
            'own contact between .*<exclude body1="left_finger" body2="object"/>',
            excludes=False,
        )
        with mock.patch.object(robots, "JAW_SIDE", [1, 1, 0, 0]):
            self.refuses(robots.panda, self.folder, "the site points the wrong way")


class Models(Checks):
    def setUp(self):
        folder = {"panda": "franka_emika_panda", "leap": "leap_hand", "2f85": "robotiq_2f85"}[
            self._testMethodName.split("_")[1]
        ]
        if not (MENAGERIE / folder).is_dir():
            self.skipTest(f"SLIPBENCH_MENAGERIE names no folder with {folder}")

    def test_panda(self):
        figures, _ = robots.panda(MENAGERIE)
        self.drive_is_what_pads_feel(figures)
        self.slips_by_the_law(figures, 0.1, 0.05)

    def test_panda_mistakes(self):
        self.refuses(
            robots.panda,
            MENAGERIE,
            'own contact between .*<exclude body1="left_finger" body2="object"/>',
            excludes=False,
        )
        if HAS_IMPLICIT:  # otherwise the example takes shorter steps
            self.refuses(
                robots.panda,
                MENAGERIE,
                "the time step 2 ms is too long .* or any step with solver='implicit'",
                solver="explicit",
            )
        with mock.patch.object(robots, "JAW_SIDE", [1, 1, 0, 0]):
            self.refuses(robots.panda, MENAGERIE, "the site points the wrong way")

    def test_2f85(self):
        figures, _ = robots.robotiq_2f85(MENAGERIE)
        drive, pads = (
            figures["work of drive, springs and weight [N m/rad]"],
            figures["work of the pads [N m/rad]"],
        )
        self.assertGreater(drive, 0.3)
        # At rest they are opposite. The example takes a pillar's force as acting straight behind
        # its tip, the field along the face's normal: a jaw that leans by 0.02 rad gives 22 um of
        # 1.1 mm, at 6.3 N on each of two jaws that turn by 0.04 rad per rad of the drive.
        self.assertAlmostEqual(-pads, drive, delta=2 * 6.3 * 0.02 * 1.1e-3 * 0.04)
        self.slips_by_the_law(figures, 0.5, 0.1)

    def test_2f85_mistakes(self):
        # The jaw is welded to the follower and carries a silicone pad: three bodies per side.
        self.refuses(
            robots.robotiq_2f85,
            MENAGERIE,
            'own contact between .*<exclude body1="left_follower" body2="object"/>',
            excludes=False,
        )

    def test_leap_hand(self):
        figures, _ = robots.leap_hand(MENAGERIE)
        # Newton's second law of a bar at rest. A residual acceleration of 1 mm/s2 from a swing
        # would give 0.1 mN at 100 g.
        self.assertAlmostEqual(figures["weight of the bar [N]"], 0.981, places=12)
        self.assertAlmostEqual(
            figures["sum of the pads' forces on it, upwards [N]"], 0.981, delta=1e-4
        )
        self.assertLess(figures["sum, sideways [N]"], 1e-4)
        self.assertEqual(figures["other contacts of the bar"], 0)
        fingers = [figures[f"normal force of {name} [N]"] for name in ("index", "middle", "ring")]
        # 1 N is requested. The servos yield to the bar: less in the older model, more in the newer.
        self.assertTrue(all(0.7 < force < 1.3 for force in fingers), fingers)
        self.assertAlmostEqual(
            figures["normal force of thumb [N]"], sum(fingers), delta=0.02
        )  # faces lean by up to 1 degree: the weight's share

    def test_leap_hand_mistakes(self):
        self.refuses(
            robots.leap_hand,
            MENAGERIE,
            "own contact between .*, which moves with the pad",
            excludes=False,
        )
        if HAS_IMPLICIT:
            self.refuses(
                robots.leap_hand,
                MENAGERIE,
                "the time step 2 ms is too long .* or any step with solver='implicit'",
                solver="explicit",
            )
        with mock.patch.object(robots, "PALM_SIDE", [1, 0, -1, 0]):
            self.refuses(robots.leap_hand, MENAGERIE, "the site points the wrong way")


if __name__ == "__main__":
    result = unittest.main(exit=False).result
    sys.exit(77 if len(result.skipped) == result.testsRun else not result.wasSuccessful())
