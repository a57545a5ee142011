// What the plugin refuses, as a C++ host reads it: a model's mistakes in the text of the loader, a run's in mju_error.
#include <algorithm>

#include "tests/expect.h"
#include "tests/sim/mujoco/pads/plugin_rig.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace slipbench::testing_plugin {
namespace {

const std::string site = config("pad", "fingertip"), plate = config("touch", "plate"),
                  one = config("elements", "[[0, 0, 0, 3000, 500]]");

std::string model_of(const std::string& attributes, const std::string& option = "") {
  return "<mujoco>" + option + "<extension><plugin plugin='slipbench.field'><instance name='left'>" + attributes +
         "</instance></plugin></extension><worldbody><geom name='plate' type='box' size='.1 .1 .1' pos='0 0 -.1'/><geom name='ball' type='sphere' size='.1' pos='0 0 -9'/><body><joint type='slide' axis='0 0 1'/><geom size='.01' mass='1' contype='0' conaffinity='0'/><site name='fingertip'/><plugin instance='left'/></body></worldbody><sensor><plugin instance='left'/></sensor></mujoco>";
}

std::string refusal_of_model(const std::string& model) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler
      disabler;  // MuJoCo's compiler jumps over its own vectors when a plugin refuses: 52 bytes each time
#endif
  return slipbench::refusal_of<std::runtime_error>([&] { load(model); });
}

std::string refusal_of(const std::string& attributes) { return refusal_of_model(model_of(attributes)); }

constexpr const char* a_row = "[x, y, z, k_n, k_t], or [x, y, z, k_n, k_t, ax, ay, az] with the element's axis";

TEST(PluginRefusal, TellsWhatIsWrongWithAModel) {
  std::vector<std::string> sensor_names;
  for (const Entry& sensor : pad_catalogues().sensors) sensor_names.push_back(sensor.name);
  std::ranges::sort(sensor_names);
  const auto refuses = [](const std::string& attributes, const std::string& what) {
    EXPECT_THAT(refusal_of(attributes), EndsWith("slipbench: plugin 'left'" + what)) << attributes;
  };
  EXPECT_EQ(refusal_of(site + plate + one), "accepted");
  refuses(plate + one, ": no attribute pad; allowed: the name of a site");
  refuses(site + one, ": no attribute touch; allowed: names of geoms, body:NAME, subtree:NAME or group:N, with blanks between");
  refuses(config("pad", "fingertop") + plate + one,
          ": no site 'fingertop' in the model; did you mean 'fingertip'? allowed: fingertip");
  refuses(site + config("touch", "plat") + one, ": no geom 'plat' in the model; did you mean 'plate'? allowed: plate, ball");
  refuses(site + config("touch", "ball plate ball") + one, ": touch names the geom 'ball' twice");
  refuses(site + plate, ": the pad is given by one of the attributes sensor and elements; found: neither");
  refuses(site + plate + one + config("sensor", "{type: papillarray}"),
          ": the pad is given by one of the attributes sensor and elements; found: both");
  refuses(site + plate + config("sensor", "{type: papilarray}"),
          " sensor='{type: papilarray}': unknown sensor 'papilarray'" + allowed_names("papilarray", sensor_names));
  refuses(site + plate + config("sensor", "{type: papillarray, rate: 333}"),
          ": sensors.left.rate: 333 Hz is not a rate of the PapillArray; allowed: 100 Hz, 250 Hz, 500 Hz, 1000 Hz");
  refuses(site + plate + config("sensor", "{type: papillarray}") + config("units", "[9]"),
          ": units belongs to elements; allowed: both or neither");
  refuses(site + plate + config("sensor", "{type: papillarray}") + config("element_truth", "true"),
          ": element_truth belongs to elements; allowed: both or neither");
  const auto refuses_table = [&](const std::string& rows, const std::string& what) {
    refuses(site + plate + config("elements", rows), " elements='" + rows + "': " + what);
  };
  refuses_table("5", "elements is '5'; allowed: a sequence of " + std::string(a_row));
  refuses_table("[]", "0 elements; allowed: 1 to 4096");
  refuses_table("[[0, 0, 0, 3000]]", "element 0 is no row; allowed: " + std::string(a_row));
  refuses_table("[[0, 0, 0, 1, 1], [0, 0, 0, 0, 1]]", "element 1: a stiffness is not positive; allowed: > 0 N/m");
  refuses_table("[[0, 0, 0, .inf, 1]]", "element 0, entry 3: '.inf' is infinite; allowed: a finite number");
  refuses_table("[[0, 0, nan, 1, 1]]",
                "element 0, entry 2: 'nan' is not a length; allowed: a number in m, or one with a unit: m, mm, um, cm, nm");
  refuses_table("[[0, 0, 0, 1, 1, 0, 0, 0]]", "element 0: the axis has no length");
  refuses(site + plate + one + config("units", "[2]"),
          " units='[2]': the units have 2 elements; allowed: as many as there are, 1");
  refuses(site + plate + one + config("units", "[0.5]"),
          " units='[0.5]': unit 0 is '0.5'; allowed: a whole number from 1 to 4096");
  refuses(
      site + plate + one + config("effects", "[stribek]"),
      " effects='[stribek]': unknown effect 'stribek'; did you mean 'stribeck'? allowed: ageing, anisotropic_friction, asperities, elastic_skin, inertia, lean, load_dependent_friction, patchy_friction, roughness, stribeck, texture, viscoelastic, viscous_friction");
  refuses(
      site + plate + one + config("material", "acrylc"),
      " material='acrylc': unknown material 'acrylc'; did you mean 'acrylic'? allowed: acrylic, cardboard, felt, glass, masonite, paper, ptfe, rubber, soaped_wavy_acrylic, wavy_acrylic, wet_felt, wet_paper, wet_ptfe, wet_rubber");
  refuses(
      site + plate + one + config("friction", "{static: 0.2, kinetic: 0.5}"),
      " friction='{static: 0.2, kinetic: 0.5}': friction.kinetic 0.5 exceeds the static coefficient 0.2; allowed: at most that");
  refuses(site + plate + one + config("damping", "-1 ms"), ": damping: '-1 ms' is out of range; allowed: >= 0 s");
  refuses(site + plate + one + config("trial", "-1"), ": trial: '-1' is out of range; allowed: >= 0");
  refuses(site + plate + one + config("seed", "-1"), " seed='-1': seed: '-1' is no seed; allowed: 0 to 18446744073709551615");
  refuses(site + plate + one + config("truth", "maybe"), ": truth: 'maybe' is not a flag; allowed: true, false");
  refuses(site + plate + one + config("solver", "implict"),
          ": solver: unknown value 'implict'; did you mean 'implicit'? allowed: explicit, implicit");
}

TEST(PluginRefusal, EffectMustSuitEveryTouchedGeom) {
  const std::string textured = site + one + config("effects", "[texture]");
  EXPECT_EQ(refusal_of(textured + plate), "accepted");
  const std::string what = refusal_of(textured + config("touch", "plate ball"));
  EXPECT_THAT(what, HasSubstr("slipbench: plugin 'left': "));
  EXPECT_THAT(what, EndsWith("; geom 'ball' is none"));
}

TEST(PluginRefusal, TipsWithMassNeedAPrescribedMotion) {
  std::string on_plane = model_of(site + plate + one + config("effects", "[inertia]"));
  const std::string box = "type='box' size='.1 .1 .1'";
  EXPECT_THAT(refusal_of_model(on_plane), EndsWith("inertia needs a plane; allowed shapes: plane; geom 'plate' is none"));
  on_plane.replace(on_plane.find(box), box.size(), "type='plane' size='1 1 1'");
  EXPECT_THAT(
      refusal_of_model(on_plane),
      EndsWith("slipbench: plugin 'left': effects: inertia needs pads that move as prescribed; allowed here: effects without"));
}

TEST(PluginRefusal, SkinsGoWithTheExplicitSolver) {
  const std::string skin = config("effects", "[elastic_skin]") + config("solver", "implicit");
  EXPECT_THAT(refusal_of(site + plate + nine_pillars() + skin),
              EndsWith("effects: elastic_skin has no springs for the implicit solver; allowed here: solver explicit"));
}

TEST(PluginRefusal, MessageOfALongTableKeepsItsEnd) {
  std::string rows = square(30, 1e-3, 1.0, 1.0);  // 900 rows, some 30,000 characters
  rows.replace(rows.size() - 1, 1, ", [0, 0]]");
  EXPECT_THAT(refusal_of(site + plate + config("elements", rows)),
              EndsWith("...': element 900 is no row; allowed: " + std::string(a_row)));
}

class PluginRun : public testing::Test {
 protected:
  PluginRun() : model_(load(model_of(site + plate + one))), data_(data_of(model_)) { data_->qpos[0] = -1e-3; }
  // Of the next step.
  std::string error() {
    const mjModel* model = model_.get();
    mjData* data = data_.get();
    return mju_error_of([=] { mj_step(model, data); });
  }
  void expect_to_work_again() {
    mj_resetData(model_.get(), data_.get());
    EXPECT_EQ(error(), "");
  }
  Model model_;
  Data data_;
};

TEST_F(PluginRun, DisabledPassiveForcesAreRefused) {
  for (const int flag : {static_cast<int>(mjDSBL_SPRING), static_cast<int>(mjDSBL_DAMPER)}) {
    model_->opt.disableflags = flag;
    EXPECT_EQ(error(), "") << "one flag leaves the pad alone";
    EXPECT_NEAR(data_->qfrc_passive[0], 3.0, 0.1);
    mj_resetData(model_.get(), data_.get());
    data_->qpos[0] = -1e-3;
  }
  model_->opt.disableflags = mjDSBL_SPRING | mjDSBL_DAMPER;
  EXPECT_THAT(
      error(),
      EndsWith(
          "slipbench: plugin 'left': the flags spring and damper are both disabled, so that MuJoCo leaves out every passive force, the pad's too; allowed: at most one of them"));
  model_->opt.disableflags = 0;
  expect_to_work_again();
  const std::string flags = "<option><flag spring='disable' damper='disable'/></option>";
  EXPECT_THAT(refusal_of_model(model_of(site + plate + one, flags)), HasSubstr("the flags spring and damper are both disabled"));
}

TEST_F(PluginRun, ChangedTimeStepIsRefused) {
  EXPECT_EQ(error(), "");
  model_->opt.timestep = 0.001;
  EXPECT_THAT(
      error(),
      EndsWith(
          "slipbench: plugin 'left': the time step has changed from 0.002 s to 0.001 s; allowed: mj_makeData after the change"));
  data_ = data_of(model_);
  EXPECT_EQ(error(), "");
}

TEST_F(PluginRun, TimeThatGoesBackIsRefused) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(error(), "");
  data_->time = 0.002;
  EXPECT_THAT(
      error(),
      EndsWith(
          "slipbench: plugin 'left': the time went back from 0.004 s to 0.002 s without a reset; allowed: mj_resetData, or a whole state by mj_setState"));
  expect_to_work_again();
}

TEST(PluginStep, IsRefusedAgainAfterAReset) {
  // 100 g between pads of 9 x 3 kN/m: omega is 735 rad/s or more, and 2 ms is too long.
  const Model model = load(grip_xml({.dt = 2e-3}));
  const Data data = data_of(model);
  const mjModel* m = model.get();
  mjData* d = data.get();
  for (int round = 0; round < 3; ++round) {
    std::string what;
    for (int i = 0; i < 500 && what.empty(); ++i) {
      d->ctrl[0] = 2.0;
      what = mju_error_of([=] { mj_step(m, d); });
    }
    EXPECT_THAT(what, HasSubstr("the time step 2 ms is too long for what touches at ")) << "round " << round;
    // Nor is it obeyed by going on.
    EXPECT_THAT(mju_error_of([=] { mj_step(m, d); }), HasSubstr("is too long for what touches")) << "round " << round;
    mj_resetData(m, d);
  }
}

TEST(PluginStep, PadThatFliesOffInTheFirstStepIsRefusedAllTheSame) {
  // Pressed by 1 mm at the start with 1 MN/m an element: after one step of 1 ms nothing touches any more.
  const Model model = load(model_of(site + plate + config("elements", "[[0, 0, 0, 1e6, 1e5]]")));
  const Data data = data_of(model);
  const mjModel* m = model.get();
  mjData* d = data.get();
  d->qpos[0] = -1e-3;
  EXPECT_EQ(mju_error_of([=] { mj_step(m, d); }), "") << "the first one is MuJoCo's compiler's as well";
  EXPECT_THAT(mju_error_of([=] { mj_step(m, d); }), HasSubstr("is too long for what touches at 0 s"));
}

TEST(PluginRefusal, SleepingTrees) {
  std::string what;
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler disabler;  // as in refusal_of
#endif
  try {
    const Model model = load(model_of(site + plate + one, "<option><flag sleep='enable'/></option>"));
    const Data data = data_of(model);
    const mjModel* m = model.get();
    mjData* d = data.get();
    what = mju_error_of([=] { mj_step(m, d); });
  } catch (const std::runtime_error& error) {
    what = error.what();
  }
  EXPECT_THAT(what, HasSubstr("the flag sleep is enabled"));
}

TEST(PluginRefusal, PadOnTheBodyThatItTouches) {
  std::string self = model_of(site + config("touch", "tip") + one);
  self.replace(self.find("<geom size='.01' mass"), 5, "<geom name='tip'");
  EXPECT_THAT(refusal_of_model(self), HasSubstr("the touched geom 'tip' moves with the pad; allowed: a geom of another body"));
}

}  // namespace
}  // namespace slipbench::testing_plugin
