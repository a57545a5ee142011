"""slipbench.mujoco with the imported package `mujoco`.

Tests attach_pad, named readings, the longest step.

Arguments: the project's root, and the program attached_trace if it was built for this MuJoCo.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import mujoco
import numpy as np
import slipbench.mujoco
from slipbench import InputError

EXPECTED = os.environ.get("SLIPBENCH_TEST_MUJOCO")
if EXPECTED not in (None, mujoco.mj_versionString()):
    sys.exit(f"MuJoCo {EXPECTED} is not installed; install it: tools/setup/setup.sh mujoco-all")
ROOT = Path(sys.argv.pop(1))
TRACE = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None
HOLD = ROOT / "scenes/mujoco/hold.xml"
HAS_IMPLICIT = tuple(map(int, mujoco.__version__.split(".")[:2])) >= (3, 14)


def stock(collide=True):
    """Returns the gripper and the box of hold.xml without pads.

    Its geoms collide, like a robot's.
    """
    text = re.sub(
        r"<extension>.*</extension>|<sensor>.*</sensor>|<plugin instance=[^>]*/>",
        "",
        HOLD.read_text(encoding="utf-8"),
        flags=re.DOTALL,
    )
    return mujoco.MjSpec.from_string(
        text.replace('<geom contype="0" conaffinity="0"/>', "") if collide else text
    )


def grasp(model, seconds=1.0, control=4.0):
    data = mujoco.MjData(model)
    data.ctrl[:] = control
    mujoco.mj_step(model, data, math.ceil(seconds / model.opt.timestep - 1e-6))
    return data


def held(spec, left="left_pad", right="right_pad", touch="box", **more):
    """Attaches the pads of hold.xml."""
    return [
        slipbench.mujoco.attach_pad(spec, site, touch, friction=0.5, **more)
        for site in (left, right)
    ]


def reference():
    return grasp(mujoco.MjModel.from_xml_path(str(HOLD))).sensordata


class Attach(unittest.TestCase):
    def test_four_lines_on_a_stock_gripper_are_hold_xml(self):
        spec = stock()
        left = slipbench.mujoco.attach_pad(spec, "left_pad", touch="box", friction=0.5)
        right = slipbench.mujoco.attach_pad(spec, "right_pad", touch="box", friction=0.5)
        data = grasp(spec.compile(), 3.0)
        self.assertAlmostEqual(left.read(data).force[:, 2].sum(), 4.0, places=3)  # the fingers' 4 N
        # Each pad carries half of 0.1 kg; the pads' axes are level, so that the load is all
        # tangential.
        for pad in (left, right):
            self.assertAlmostEqual(
                np.hypot(*pad.read(data).force[:, :2].sum(axis=0)), 0.05 * 9.81, places=5
            )
        self.assertEqual(set(left.read(data).unit_state), {0.0, 1.0})
        np.testing.assert_allclose(
            grasp(spec.compile()).sensordata, reference(), rtol=0, atol=1e-12
        )

    def test_touch_by_body_subtree_group_and_objects(self):
        for touch in (
            "body:box",
            "subtree:box",
            "group:0",
            lambda spec: spec.geom("box"),
            lambda spec: spec.body("box"),
            lambda spec: [spec.geom("box")],
        ):
            spec = stock()
            held(
                spec, touch=touch(spec) if callable(touch) else touch
            ) if touch != "group:0" else self.by_group(spec)
            np.testing.assert_allclose(
                grasp(spec.compile()).sensordata, reference(), rtol=0, atol=1e-12
            )

    def by_group(self, spec):
        spec.geom("box").group = 3
        held(spec, touch="group:3")

    def test_of_a_body_only_what_can_collide_is_touched(self):
        spec = stock()
        spec.body("box").add_geom(
            name="look",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.02, 0.02, 0.03],
            mass=0,
            contype=0,
            conaffinity=0,
        )
        held(spec, touch="body:box")
        np.testing.assert_allclose(
            grasp(spec.compile()).sensordata, reference(), rtol=0, atol=1e-12
        )

    def attached(self, child):
        parent = mujoco.MjSpec()
        parent.option.timestep = 0.0005
        parent.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        parent.attach(child, prefix="robot/", frame=parent.worldbody.add_frame())
        return parent

    def test_before_an_attach_with_a_prefix(self):
        child = stock()
        left, _ = held(child)
        parent = self.attached(child)
        data = grasp(parent.compile())
        np.testing.assert_allclose(data.sensordata, reference(), rtol=0, atol=1e-12)
        self.assertEqual(left.read(data).force.shape, (9, 3))

    def test_after_an_attach_with_a_prefix(self):
        parent = self.attached(stock())
        held(parent, "robot/left_pad", "robot/right_pad", "robot/box")
        np.testing.assert_allclose(
            grasp(parent.compile()).sensordata, reference(), rtol=0, atol=1e-12
        )

    def test_two_of_one_kind_each_with_its_own(self):
        parent = mujoco.MjSpec()
        parent.option.timestep = 0.0005
        for k, prefix in enumerate(("a/", "b/")):
            child = stock()
            pad = slipbench.mujoco.attach_pad(child, "left_pad", "box")
            parent.attach(child, prefix=prefix, frame=parent.worldbody.add_frame(pos=[0, k, 0]))
        data = grasp(parent.compile(), 0.01)
        self.assertEqual(list(slipbench.mujoco.pads(data.model)), ["a/left_pad", "b/left_pad"])
        with self.assertRaisesRegex(InputError, "'left_pad'.*a/left_pad.*b/left_pad"):
            pad.read(data)
        for other in slipbench.mujoco.pads(data.model).values():
            self.assertGreater(other.read(data).force[:, 2].sum(), 1.0)

    def test_pad_of_a_child_that_touches_what_the_parent_has(self):
        child, box = stock(), None
        child.delete(child.body("box"))
        held(child)
        parent = self.attached(child)
        box = parent.worldbody.add_body(name="box", pos=[0, 0, 0.1])
        box.add_freejoint()
        box.add_geom(name="box", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.02, 0.02, 0.03], mass=0.1)
        with self.assertRaisesRegex(
            (ValueError, mujoco.FatalError), "MuJoCo's own contact between"
        ):
            mujoco.MjData(parent.compile())
        slipbench.mujoco.complete(parent)
        data = grasp(parent.compile())
        for name in ("robot/left_pad", "robot/right_pad"):
            mine = slipbench.mujoco.Pad(name).read(data).force
            self.assertAlmostEqual(mine[:, 2].sum(), reference()[2:27:3].sum(), places=9)

    def test_implicit_pads_get_all_they_need(self):
        spec = stock()
        spec.option.timestep, spec.option.iterations, spec.option.noslip_iterations = 0.002, 5, 3
        if not HAS_IMPLICIT:
            with self.assertRaisesRegex(InputError, f"do not work in MuJoCo {mujoco.__version__}"):
                held(spec, solver="implicit")
            return
        pads = held(spec, solver="implicit")
        model = spec.compile()
        explicit = stock()
        held(explicit)
        self.assertGreater(model.opt.timestep, slipbench.mujoco.max_timestep(explicit.compile()))
        data = grasp(model, 3.0)
        self.assertAlmostEqual(pads[0].read(data).force[:, 2].sum(), 4.0, places=3)
        before = data.qpos[2]
        while data.time < 6.0:
            mujoco.mj_step(model, data)
        self.assertLess(abs(data.qpos[2] - before) / 3.0, 1e-8, "creep [m/s]")
        self.assertEqual(slipbench.mujoco.max_timestep(model), math.inf)

    def test_nothing_falls_through_the_floor_for_a_pad_on_the_world(self):
        text = """<mujoco><option timestep="0.0005" integrator="implicitfast"/><worldbody><geom type="plane" size="1 1 .1"/>
          <geom name="wall" type="box" pos="0.05 0 0.1" size="0.02 0.1 0.1"/>
          <body name="finger" pos="0 0 0.1"><freejoint/><geom type="box" size="0.01 0.012 0.012" mass="0.05"/>
            <site name="pad" pos="0.0105 0 0" zaxis="-1 0 0"/></body></worldbody></mujoco>"""
        spec = mujoco.MjSpec.from_string(text)
        slipbench.mujoco.attach_pad(spec, "pad", touch="wall", friction=0.5)
        self.assertEqual(len(spec.excludes), 0)
        with self.assertRaisesRegex(Exception, "(?s)contact.*'wall'.*contype.*conaffinity"):
            mujoco.MjData(spec.compile())
        spec = mujoco.MjSpec.from_string(
            text.replace('name="wall"', 'name="wall" contype="0" conaffinity="0"')
        )
        slipbench.mujoco.attach_pad(spec, "pad", touch="wall", friction=0.5)
        data = grasp(spec.compile(), control=())
        self.assertGreater(
            data.body("finger").xpos[2], 0.011
        )  # half of its height is 12 mm: it lies on the floor

    def test_pads_of_like_names_are_told_apart(self):
        spec = stock()
        for site, name in (("left_pad", "pad"), ("right_pad", "pad_2")):
            slipbench.mujoco.attach_pad(spec, site, "box", friction=0.5, name=name)
        robot = mujoco.MjSpec()
        robot.option.timestep, robot.option.integrator = (
            spec.option.timestep,
            spec.option.integrator,
        )
        robot.attach(spec, prefix="robot_", frame=robot.worldbody.add_frame())
        slipbench.mujoco.complete(robot)
        data = grasp(robot.compile())
        force = (
            slipbench.mujoco.Pad("pad").read(data).force,
            slipbench.mujoco.Pad("pad_2").read(data).force,
        )
        self.assertFalse(np.shares_memory(*force))
        with self.assertRaisesRegex(InputError, "no pad 'ad_'"):
            slipbench.mujoco.Pad("ad_").read(data)
        with self.assertRaisesRegex(InputError, "already has a sensor 'left'"):
            other = stock()
            other.add_sensor(name="left", type=mujoco.mjtSensor.mjSENS_CLOCK)
            slipbench.mujoco.attach_pad(other, "left_pad", "box", name="left")

    def test_mistakes_are_named(self):
        with self.assertRaisesRegex(InputError, "site 'left_pat'.*left_pad.*right_pad"):
            slipbench.mujoco.attach_pad(stock(), "left_pat", "box")
        spec = stock()
        slipbench.mujoco.attach_pad(spec, "left_pad", "box")
        with self.assertRaisesRegex(InputError, "already has a plugin 'left_pad'"):
            slipbench.mujoco.attach_pad(spec, "left_pad", "box")
        with self.assertRaisesRegex(ValueError, "two|on the same site 'left_pad'"):
            slipbench.mujoco.attach_pad(spec, "left_pad", "box", name="second")
            spec.compile()
        spec = stock()
        slipbench.mujoco.attach_pad(spec, "left_pad", "bax")
        with self.assertRaisesRegex(ValueError, "no geom 'bax' in the model"):
            spec.compile()
        spec = stock()
        slipbench.mujoco.attach_pad(spec, "left_pad", "box", material="acrylic", friction=0.3)
        with self.assertRaisesRegex(ValueError, "material and friction are both given"):
            spec.compile()


class Cpp(unittest.TestCase):
    @unittest.skipUnless(TRACE, "attached_trace is built for the bench's own MuJoCo")
    def test_the_same_pads_attached_in_cpp_and_in_python(self):
        for solver in ("explicit", "implicit"):
            text = stock().to_xml()  # rounded, so both methods start from it
            spec = mujoco.MjSpec.from_string(text)
            with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
                file.write(text)
                file.flush()
                said = subprocess.run(
                    [TRACE, slipbench.mujoco.plugin_path(), file.name, solver],
                    capture_output=True,
                    check=True,
                ).stdout
            held(spec, solver=solver, damping=0.5e-3)
            model = spec.compile()
            sizes = np.frombuffer(said, np.int32, 6)
            self.assertEqual(
                list(sizes),
                [
                    model.nexclude,
                    model.ntendon,
                    model.nsite,
                    model.nplugin,
                    model.npluginstate,
                    model.nsensordata,
                ],
            )
            np.testing.assert_allclose(
                np.frombuffer(said, np.float64, offset=sizes.nbytes),
                grasp(model).sensordata,
                rtol=0,
                atol=1e-12,
            )


class Read(unittest.TestCase):
    def test_names_shapes_and_units(self):
        spec = stock()
        pad = held(spec)[0]
        data = grasp(spec.compile(), 0.1)
        reading = pad.read(data)
        self.assertEqual(
            reading.shapes,
            {
                "force": (9, 3),
                "displacement": (9, 3),
                "unit_state": (9,),
                "slip_velocity": (9, 2),
                "slip_distance": (9,),
                "margin": (9,),
                "contact_force": (9, 3),
                "state": (),
                "state_micro": (),
                "stuck_fraction": (),
            },
        )
        self.assertEqual(
            (reading.units["force"], reading.units["displacement"], reading.units["slip_velocity"]),
            ("N", "m", "m/s"),
        )
        self.assertEqual(
            np.concatenate([getattr(reading, name).ravel() for name in reading.shapes]).tobytes(),
            data.sensor("left_pad").data.tobytes(),
        )
        mujoco.mj_step(data.model, data)
        self.assertTrue(np.shares_memory(reading.force, data.sensordata))
        with self.assertRaisesRegex(AttributeError, "'forces'.*force, displacement"):
            _ = reading.forces
        with self.assertRaisesRegex(InputError, "'lefd'.*left_pad.*right_pad"):
            slipbench.mujoco.Pad("lefd").read(data)

    def test_other_sensors_and_elements(self):
        rows = [[0.01 * i, 0, 0, 3000, 500] for i in (-1, 0, 1)]
        for pad, channel, shape in (
            ({"type": "papillarray", "bristles": 6}, "force", (9, 3)),
            (rows, "force", (3, 3)),
            ("myrmex", "taxels", (16, 16)),
        ):
            spec = stock()
            attached = slipbench.mujoco.attach_pad(spec, "left_pad", "box", pad=pad, truth=False)
            data = mujoco.MjData(spec.compile())
            mujoco.mj_forward(data.model, data)
            self.assertEqual(getattr(attached.read(data), channel).shape, shape)
            with self.assertRaises(AttributeError):
                _ = attached.read(data).margin


class Step(unittest.TestCase):
    def test_a_class_of_ones_own_reads_the_contact_of_each_point(self):
        class Twin:
            """Four pillars in pairs: a unit's force is the sum of k times depth and shear of its points."""

            def __init__(self, source):
                self.made_for = (source.sensor, source.seed, source.trial)

            def layout(self):
                return slipbench.Layout(
                    [(x, y, 0) for x in (-3e-3, 3e-3) for y in (-3e-3, 3e-3)],
                    k_normal=7000.0,
                    k_tangential=4000.0,
                    units=[0, 0, 1, 1],
                    channels={"load": ((2, 3), "N"), "force": ((2, 3), "N")},
                )

            def measure(self, frame):
                each = np.column_stack(
                    [
                        4000.0 * frame["shear"][0],
                        4000.0 * frame["shear"][1],
                        7000.0 * frame["depth"],
                    ]
                )
                return {"load": each.reshape(2, 2, 3).sum(axis=1), "force": frame["force"]}

        spec = stock()
        left, _ = held(spec, pad=Twin, seed=3, trial=2)
        read = left.read(grasp(spec.compile()))
        self.assertEqual(read.shapes["load"], (2, 3))
        self.assertEqual(read.units["load"], "N")
        self.assertGreater(np.abs(read.force).max(), 1.0)
        np.testing.assert_allclose(read.load, read.force, atol=2e-6)  # float32
        self.assertEqual(set(read.unit_state), {1.0})
        Twin.measure = lambda self, frame: {
            "load": np.full((2, 3), np.nan),
            "force": frame["force"],
        }
        with self.assertRaisesRegex(InputError, r"^measure\(\) .*load .*finite.* 0 s"):
            data = mujoco.MjData(spec.compile())
            mujoco.mj_forward(data.model, data)
            left.read(data)

    def test_longest_step_is_that_of_the_closed_form(self):
        # 2 kg on a vertical slider over a plate, 4 springs of 1 kN/m: omega = sqrt(4000/2) = 44.7
        # rad/s, and a step of 1/omega is stable.
        spec = mujoco.MjSpec.from_string("""<mujoco><worldbody><geom name="plate" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
            <body pos="0 0 0.2"><joint type="slide" axis="0 0 1"/><geom size="0.01" mass="2"/><site name="pad"/></body></worldbody></mujoco>""")
        slipbench.mujoco.attach_pad(
            spec,
            "pad",
            "plate",
            pad=[[x, y, 0, 1000, 200] for x in (-0.01, 0.01) for y in (-0.01, 0.01)],
            damping=1e-4,
        )
        model = spec.compile()
        self.assertAlmostEqual(
            slipbench.mujoco.max_timestep(model), 1 / math.sqrt(2000), delta=1e-9
        )

    def test_of_a_grip_it_is_what_the_steps_bear(self):
        longest = slipbench.mujoco.max_timestep(mujoco.MjModel.from_xml_path(str(HOLD)))
        for factor, borne in ((0.99, True), (2.0, False)):
            spec = stock()
            held(spec)
            spec.option.timestep = factor * longest
            model = spec.compile()
            if borne:
                grasp(model, 0.5, 20.0)
            else:
                with self.assertRaisesRegex(mujoco.FatalError, "with all elements in contact"):
                    grasp(model, 0.5, 20.0)


class Versions(unittest.TestCase):
    def test_no_extra_excludes_a_release_that_the_pads_support(self):
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        wanted = project["dependencies"] + sum(project["optional-dependencies"].values(), [])
        of_mujoco = [one for one in wanted if one.startswith("mujoco")]
        self.assertEqual(of_mujoco, [f"mujoco>={slipbench.mujoco.builds()[0]}"])

    def test_another_version_is_refused_with_the_supported_ones(self):
        builds = slipbench.mujoco.builds()
        self.assertIn(mujoco.__version__, builds)
        with self.assertRaisesRegex(InputError, f"2.9.9 .known: {', '.join(builds)}"):
            slipbench.mujoco.plugin_path("2.9.9")
        code = "import mujoco; mujoco.__version__ = '2.9.9'\ntry: import slipbench.mujoco\nexcept ValueError as error: print(error)"
        said = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        self.assertIn("the plugin does not know MuJoCo 2.9.9", said)
        headers = Path(mujoco.__file__).parent / "include"
        self.assertIn(f"cc -shared -fPIC -I'{headers}' -o '", said)

    def test_simulations_and_the_plugin_share_a_process(self):
        simulate = (
            "import slipbench; print(slipbench.Scene.load('bodies/held_box.yaml').run().sha256)"
        )
        hold = (
            f"import slipbench.mujoco, mujoco; m = mujoco.MjModel.from_xml_path({str(HOLD)!r}); "
            "d = mujoco.MjData(m); mujoco.mj_step(m, d, 100); print(d.sensordata.tobytes().hex())"
        )
        said = [
            subprocess.run(
                [sys.executable, "-c", f"{a}\n{b}"], capture_output=True, text=True, check=True
            ).stdout.split()
            for a, b in ((simulate, hold), (hold, simulate))
        ]
        self.assertEqual(said[0], said[1][::-1])


if __name__ == "__main__":
    unittest.main()
