"""plugin_python_test.py LIBRARY [PLUGIN_TRACE].

The plugin as Python and, where there is one of this MuJoCo, another C program load it. Runs in
every release of MuJoCo that the plugin knows.
"""

import copy
import gc
import os
import pickle
import subprocess
import sys
import tempfile
import unittest

import mujoco
import numpy as np

EXPECTED = os.environ.get("SLIPBENCH_TEST_MUJOCO")
if EXPECTED not in (None, mujoco.mj_versionString()):
    sys.exit(f"MuJoCo {EXPECTED} is not installed; install it: tools/setup/setup.sh mujoco-all")
LIBRARY = sys.argv[1]
TRACE = sys.argv[2] if len(sys.argv) > 2 else None
HAS_IMPLICIT = tuple(map(int, mujoco.__version__.split(".")[:2])) >= (3, 14)
SCENES = os.path.join(os.path.dirname(__file__), "..", "..", "..", "..", "scenes", "mujoco")
INTEGRATORS = {"Euler": 0, "RK4": 1, "implicitfast": 3}
if HAS_IMPLICIT:
    INTEGRATORS["discrete"] = 4
STEPS = 5000  # 5 s at 1 ms


def rows(n=3, pitch=0.007, k_n=1000, k_t=200):
    return str(
        [
            [pitch * (i - (n - 1) / 2), pitch * (j - (n - 1) / 2), 0, k_n, k_t]
            for i in range(n)
            for j in range(n)
        ]
    )


def grip(left=None, right=None, integrator="implicitfast"):
    """A box of 100 g between a fixed pad and one that ctrl[0] closes.

    It is moved and turned a little.
    """

    def instance(name, attributes):
        every = {
            "pad": name,
            "touch": "box",
            "friction": "{static: 0.5, kinetic: 0.45}",
            "truth": "true",
            **attributes,
        }
        configs = "".join(f'<config key="{key}" value="{value}"/>' for key, value in every.items())
        return f'<instance name="{name}">{configs}</instance>'

    return f"""<mujoco><option timestep="0.001" integrator="{integrator}"/>
      <extension><plugin plugin="slipbench.field">
        {instance("left", left or {"elements": rows()})}{instance("right", right or {"elements": rows()})}
      </plugin></extension>
      <default><geom contype="0" conaffinity="0"/></default>
      <worldbody>
        <body name="box" pos="0 0.00013 0.00013" axisangle="0.5 0.7 0.6 0.004"><freejoint/>
          <geom name="box" type="box" size="0.015 0.02 0.06" mass="0.1"/></body>
        <body pos="-0.0151 0 0"><site name="left" zaxis="-1 0 0"/><plugin instance="left"/></body>
        <body pos="0.0151 0 0"><joint name="right" type="slide" axis="-1 0 0" damping="50"/><geom size="0.01" mass="0.05"/>
          <site name="right" zaxis="1 0 0"/><plugin instance="right"/></body>
      </worldbody>
      <actuator><motor joint="right"/></actuator>
      <sensor><plugin name="left" instance="left"/><plugin name="right" instance="right"/></sensor></mujoco>"""


def control(tick):
    """The grip [N] of plugin_trace.cc.

    Across the threshold of 0.98 N and back every 0.4 s, so that the box moves down in steps.
    """
    phase = tick % 400
    return 0.4 + 0.01 * (phase if phase < 200 else 400 - phase)


def step(model, data, tick):
    data.ctrl[0] = control(tick)
    mujoco.mj_step(model, data)


class SameBits(unittest.TestCase):
    def test_python_and_c_read_the_same_sensordata(self):
        if TRACE is None:
            self.skipTest("the C program is of the pinned MuJoCo")
        noisy = {"elements": rows(), "effects": "[viscoelastic, ageing]"}
        for integrator, number in INTEGRATORS.items():
            with self.subTest(integrator), tempfile.TemporaryDirectory() as folder:
                xml = grip(left=noisy, integrator=integrator)
                path, out = os.path.join(folder, "grip.xml"), os.path.join(folder, "trace")
                with open(path, "w") as file:
                    file.write(xml)
                subprocess.run([TRACE, LIBRARY, path, str(number), str(STEPS), out], check=True)
                model = mujoco.MjModel.from_xml_path(path)
                self.assertEqual(model.opt.integrator, number)
                data = mujoco.MjData(model)
                readings = np.empty((STEPS, model.nsensordata))
                for tick in range(STEPS):
                    step(model, data, tick)
                    readings[tick] = data.sensordata
                with open(out, "rb") as file:
                    self.assertEqual(file.read(), readings.tobytes())
                states = readings[
                    :, 54:63
                ]  # of the left pad's nine elements, after 27 forces and 27 displacements
                self.assertEqual(
                    set(np.unique(states)), {0.0, 1.0, 2.0}, "the run must detach, stick and slip"
                )

    def test_copies_of_data_go_on_alike(self):
        electronics = {
            "sensor": "{type: papillarray, electronics: typical}",
            "effects": "[ageing, viscoelastic]",
        }
        for integrator in INTEGRATORS:
            with self.subTest(integrator):
                model = mujoco.MjModel.from_xml_string(
                    grip(left=electronics, integrator=integrator)
                )
                model.opt.timestep = 0.0005
                data = mujoco.MjData(model)
                for tick in range(1001):
                    step(model, data, tick)
                twin = copy.copy(data)
                for tick in range(1001, 1701):
                    step(model, data, tick)
                    step(model, twin, tick)
                    self.assertEqual(
                        data.sensordata.tobytes(), twin.sensordata.tobytes(), f"step {tick}"
                    )
                self.assertEqual(data.plugin_state.tobytes(), twin.plugin_state.tobytes())


class Refusals(unittest.TestCase):
    def test_mistake_in_a_model_is_an_exception_with_its_text(self):
        with self.assertRaisesRegex(
            ValueError, "plugin 'left'.*effects='\\[agein\\]'.*'agein'.*'ageing'"
        ):
            mujoco.MjModel.from_xml_string(grip(left={"elements": rows(), "effects": "[agein]"}))

    def test_error_in_a_step_is_an_exception_and_a_reset_mends_it(self):
        model = mujoco.MjModel.from_xml_string(grip())
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data)
        for _ in range(
            1000
        ):  # each jumps out of mj_step: neither memory nor MuJoCo's stack may be exhausted
            model.opt.disableflags = (
                mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
            )
            with self.assertRaisesRegex(
                mujoco.FatalError, "the flags spring and damper are both disabled"
            ):
                mujoco.mj_step(model, data)
            model.opt.disableflags = 0
            mujoco.mj_resetData(model, data)
            mujoco.mj_step(model, data)
        fresh = mujoco.MjData(model)
        mujoco.mj_step(model, fresh)
        self.assertEqual(data.sensordata.tobytes(), fresh.sensordata.tobytes())


def run_scene(name, keyframe, seconds):
    model = mujoco.MjModel.from_xml_path(os.path.join(SCENES, name + ".xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(keyframe).id)
    while data.time < seconds:
        mujoco.mj_step(model, data)
    return data


class Scenes(unittest.TestCase):
    """The scenes of scenes/mujoco, unchanged.

    A PapillArray's sensordata: 27 forces, 27 displacements, then nine unit states (pad_readout.h).
    """

    def test_two_pads_hold_a_box(self):
        data = run_scene("hold", "grasped", 2.0)
        self.assertGreater(data.body("box").xpos[2], 0.0999)  # hung on springs, from 0.1
        self.assertAlmostEqual(data.sensordata[2:27:3].sum(), 4.0, places=3)  # the keyframe's 4 N
        self.assertEqual(
            set(data.sensordata[54:63]), {0.0, 1.0}
        )  # the corners do not touch, the rest stick

    def test_pad_on_a_slider_sticks_when_pressed_and_slips_when_pulled(self):
        self.assertEqual(set(run_scene("slide", "press", 1.0).sensordata[54:63]), {1.0})
        slid = run_scene("slide", "slide", 1.5)
        self.assertEqual(set(slid.sensordata[54:63]), {2.0})
        # 4 mm/s; the actuator's gain of 1e6 N s/m gives way to 20 N of friction by 0.5 %
        self.assertAlmostEqual(slid.body("carriage").cvel[3], 0.004, delta=0.01 * 0.004)

    def test_arm_lifts_a_box(self):
        self.assertLess(
            run_scene("arm", "grasp", 2.0).body("box").xpos[2], 0.0301
        )  # it stands on its table, half of 60 mm high
        lifted = run_scene("arm", "lift", 2.0)
        self.assertGreater(lifted.body("box").xpos[2], 0.07)
        self.assertEqual(set(lifted.sensordata[54:63]), {0.0, 1.0})


def touching(
    attributes="",
    geom="",
    option="",
    site="",
    more="",
    start=0.001,
    collide="contype='0' conaffinity='0'",
):
    """A block of 1 kg on a vertical slider, with a pad below it, over a plate.

    The pad has 3 x 3 elements of 1 kN/m; the plate's top is at z = 0.
    """
    return f"""<mujoco><option timestep="0.001" gravity="0 0 -9.81" {option}/>
      <extension><plugin plugin="slipbench.field"><instance name="left"><config key="pad" value="pad"/><config key="touch" value="plate"/>
        <config key="elements" value="{rows()}"/>{attributes}</instance>{more}</plugin></extension>
      <worldbody><body name="plate"><geom name="plate" type="box" size="0.05 0.05 0.1" pos="0 0 -0.1" {geom or collide}/></body>
        <body name="block" pos="0 0 {start}"><joint name="slide" type="slide" axis="0 0 1"/><geom name="block" type="box" size="0.01 0.01 0.01"
          pos="0 0 0.011" mass="1" {collide}/><site name="pad" {site}/></body></worldbody>
      <sensor><plugin name="left" instance="left"/></sensor></mujoco>"""


def key(name, value):
    return f'<config key="{name}" value="{value}"/>'


class Misuse(unittest.TestCase):
    """Models that would run with wrong results are refused when compiled or first stepped."""

    def refused(self, xml, text):
        with self.assertRaisesRegex((ValueError, mujoco.FatalError), text):
            model = mujoco.MjModel.from_xml_string(xml)
            data = mujoco.MjData(model)
            for _ in range(200):
                mujoco.mj_step(model, data)

    def accepted(self, xml, steps=200):
        model = mujoco.MjModel.from_xml_string(xml)
        data = mujoco.MjData(model)
        for _ in range(steps):
            mujoco.mj_step(model, data)
        return data

    def test_a_pad_alone_is_accepted_and_carries_the_block(self):
        data = self.accepted(touching(key("truth", "true")), 5000)
        self.assertAlmostEqual(data.sensordata[2:27:3].sum(), 9.81, places=3)

    def test_contact_of_mujoco_beside_a_pad(self):
        both = touching(collide="")
        self.refused(
            both,
            "plugin 'left': MuJoCo's own contact between geom 'block', which moves with the pad, and the touched geom "
            '\'plate\' .*<exclude body1="block" body2="plate"/>',
        )
        self.accepted(
            both.replace(
                "<sensor>", '<contact><exclude body1="block" body2="plate"/></contact><sensor>'
            )
        )
        self.accepted(touching(collide="", geom="contype='2' conaffinity='2'"))
        self.refused(
            touching().replace(
                "<sensor>", '<contact><pair geom1="block" geom2="plate"/></contact><sensor>'
            ),
            "own contact between",
        )

    def test_contact_of_what_is_welded_to_the_pads_body(self):
        nail = '<body name="nail"><geom name="nail" size="0.001" pos="0 0 0.02" mass="0.001"/></body><site name="pad"'
        self.refused(
            touching(geom="contype='1'").replace('<site name="pad"', nail),
            'between geom \'nail\', .*<exclude body1="nail" body2="plate"/>',
        )

    def test_a_site_that_looks_the_wrong_way(self):
        self.refused(
            touching(site='zaxis="0 0 -1"'),
            "plugin 'left': tips of the pad at site 'pad' are inside the touched geom 'plate' and point "
            "out of it: the site points the wrong way",
        )

    def test_a_site_that_begins_inside(self):
        # The pad's radius is 9.9 mm: its corner is 7 mm away along both axes.
        self.refused(touching(start=-0.015), "site 'pad'.*15 mm.*geom 'plate'.*9.9 mm")
        self.accepted(touching(start=-0.0001))

    def test_two_pads_on_one_site(self):
        second = f'<instance name="right">{key("pad", "pad")}{key("touch", "plate")}{key("elements", rows())}</instance>'
        self.refused(
            touching(more=second), "plugin 'right': it is on the same site 'pad' as plugin 'left'"
        )

    def test_material_and_friction(self):
        self.refused(
            touching(key("material", "acrylic") + key("friction", "{static: 0.5}")),
            "plugin 'left': material and friction are both given",
        )

    def test_all_that_implicit_lacks_in_one_message(self):
        self.refused(
            touching(key("solver", "implicit"), option='noslip_iterations="3" iterations="5"'),
            f"solver='implicit' needs the integrator discrete, with which pads do not work in MuJoCo {mujoco.__version__}"
            if not HAS_IMPLICIT
            else 'solver=\'implicit\' needs integrator="discrete"; noslip_iterations="0".*; iterations="20" or more, found 5; a tendon between a site '
            "on body block and a site on body plate",
        )

    def test_a_step_too_long_names_the_limit_with_all_elements(self):
        # 1 kg on 9 kN/m: omega 94.9 rad/s; a step of 1/omega, 10.5 ms, is stable.
        self.refused(
            touching().replace('timestep="0.001"', 'timestep="0.0123456"'),
            "time step 12.3 ms.* [0-9.]{1,5} m?s.*94.9 rad/s.*10.5 ms.*10.5 ms.*solver='implicit'",
        )

    def test_sleep(self):
        if not hasattr(mujoco.mjtEnableBit, "mjENBL_SLEEP"):
            self.skipTest("releases before 3.4 do not have this flag")
        self.refused(
            touching().replace("/>", '><flag sleep="enable"/></option>', 1),
            "plugin 'left': the flag sleep is enabled",
        )

    def test_check_warn_makes_warnings(self):
        with tempfile.TemporaryDirectory() as folder:  # MuJoCo writes its warnings to a file there
            before = os.getcwd()
            os.chdir(folder)
            self.accepted(touching(key("check", "warn"), collide=""))
            os.chdir(before)
            with open(os.path.join(folder, "MUJOCO_LOG.TXT")) as file:
                self.assertIn("slipbench: plugin 'left': MuJoCo's own contact between", file.read())


class Pickle(unittest.TestCase):
    """An MjData from pickle has MuJoCo's arrays, and goes on as after mj_setState."""

    def steps(self, model, data, first, last):
        for tick in range(first, last):
            step(model, data, tick)
        return data.qpos.copy(), data.sensordata.copy(), data.plugin_state.copy()

    def same(self, a, b):
        for x, y in zip(a, b, strict=True):
            np.testing.assert_array_equal(x, y)

    def test_goes_on_like_the_original(self):
        model = mujoco.MjModel.from_xml_string(grip())
        data = mujoco.MjData(model)
        self.steps(model, data, 0, 500)
        written = pickle.dumps(data)
        read = pickle.loads(written)
        self.assertGreater(np.count_nonzero(read.plugin_state), 0)
        there = self.steps(model, data, 500, 800)
        self.same(self.steps(read.model, read, 500, 800), there)
        del data, read
        gc.collect()
        again = pickle.loads(written)  # perhaps at the address of one that is gone
        self.same(self.steps(again.model, again, 500, 800), there)

    def test_in_another_process(self):
        model = mujoco.MjModel.from_xml_string(grip())
        data = mujoco.MjData(model)
        self.steps(model, data, 0, 500)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "data")
            with open(path, "wb") as file:
                pickle.dump(data, file)
            script = (
                f"import mujoco, pickle; mujoco.mj_loadPluginLibrary({LIBRARY!r}); data = pickle.load(open({path!r}, 'rb'))\n"
                "for _ in range(100): mujoco.mj_step(data.model, data)\n"
                "print(float(data.qpos[0]).hex())"
            )
            said = subprocess.run(
                [sys.executable, "-c", script],
                cwd=folder,
                capture_output=True,
                text=True,
                check=True,
            ).stdout
        for _ in range(100):
            mujoco.mj_step(model, data)
        self.assertEqual(said.strip(), float(data.qpos[0]).hex())


class Unloaded(unittest.TestCase):
    """Learners' inputs are finite: margin and stuck_fraction without contact are 1.

    After 9 x 6 readings and 9 x 4 of the truth come nine margins; stuck_fraction is the last value.
    """

    def test_all_is_finite_before_and_without_contact(self):
        model = mujoco.MjModel.from_xml_string(touching(key("truth", "true"), start=0.005))
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data)
        for _ in range(2):
            self.assertTrue(
                np.isfinite(data.sensordata).all() and np.isfinite(data.plugin_state).all()
            )
            self.assertEqual(set(data.sensordata[90:99]), {1.0})
            self.assertEqual(data.sensordata[-1], 1.0)
            mujoco.mj_resetData(model, data)
            mujoco.mj_forward(model, data)
        a, c = np.zeros((2, 2)), np.zeros((model.nsensordata, 2))
        mujoco.mjd_transitionFD(model, data, 1e-6, True, a, None, c, None)
        self.assertTrue(np.isfinite(a).all() and np.isfinite(c).all())

    def test_nan_where_it_is_asked_for(self):
        model = mujoco.MjModel.from_xml_string(
            touching(key("truth", "true") + key("unloaded", "nan"), start=0.005)
        )
        data = mujoco.MjData(model)
        mujoco.mj_step(model, data)
        self.assertTrue(np.isnan(data.sensordata[90:99]).all() and np.isnan(data.sensordata[-1]))
        self.assertEqual(np.isnan(data.sensordata).sum(), 10)


if __name__ == "__main__":
    mujoco.mj_loadPluginLibrary(LIBRARY)
    unittest.main(argv=sys.argv[:1])
