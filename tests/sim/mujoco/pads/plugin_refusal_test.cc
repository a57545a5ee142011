// Errors of the plugin as a C++ host sees them: a model's in the loader's text, a run's in
// mju_error.
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
      disabler;  // MuJoCo's compiler jumps over its own vectors when a plugin refuses: a leak of 52 bytes each time
#endif
  return slipbench::refusal_of<std::runtime_error>([&] { load(model); });
}

std::string refusal_of(const std::string& attributes) { return refusal_of_model(model_of(attributes)); }

TEST(PluginRefusal, TellsWhatIsWrongWithAModel) {
  // Every name that a message may list, together with the wrong one.
  const auto with_names = [](const auto& declared, const std::string& wrong) {
    std::vector<std::string> names{wrong};
    for (const auto& one : declared) names.push_back(one.name);
    return names;
  };
  const Catalogues& catalogues = pad_catalogues();
  const auto refuses = [](const std::string& attributes, std::vector<std::string> words) {
    words.emplace_back("plugin 'left'");
    EXPECT_THAT(refusal_of(attributes), mentions(words)) << attributes;
  };
  EXPECT_EQ(refusal_of(site + plate + one), "accepted");
  refuses(plate + one, {"pad", "site"});
  refuses(site + one, {"touch", "group:N"});
  refuses(config("pad", "fingertop") + plate + one, {"site", "fingertop", "fingertip"});
  refuses(site + config("touch", "plat") + one, {"geom", "plat", "plate", "ball"});
  refuses(site + config("touch", "ball plate ball") + one, {"touch", "ball", "twice"});
  refuses(site + plate, {"sensor", "elements", "neither"});
  refuses(site + plate + one + config("sensor", "{type: papillarray}"), {"sensor", "elements", "both"});
  refuses(site + plate + config("sensor", "{type: papilarray}"), with_names(catalogues.sensors, "papilarray"));
  refuses(site + plate + config("sensor", "{type: papillarray, rate: 333}"),
          {"sensors.left.rate", "333 Hz", "100 Hz", "1000 Hz"});
  refuses(site + plate + config("sensor", "{type: papillarray}") + config("units", "[9]"), {"units", "elements"});
  refuses(site + plate + config("sensor", "{type: papillarray}") + config("element_truth", "true"),
          {"element_truth", "elements"});
  const auto refuses_table = [&](const std::string& rows, std::vector<std::string> words) {
    words.push_back("elements='" + rows + "'");
    refuses(site + plate + config("elements", rows), words);
  };
  refuses_table("5", {"elements", "'5'"});
  refuses_table("[]", {"0 elements", "4096"});
  refuses_table("[[0, 0, 0, 3000]]", {"element 0", "[x, y, z, k_n, k_t]"});
  refuses_table("[[0, 0, 0, 1, 1], [0, 0, 0, 0, 1]]", {"element 1", "stiffness", "0 N/m"});
  refuses_table("[[0, 0, 0, .inf, 1]]", {"element 0", "entry 3", ".inf"});
  refuses_table("[[0, 0, nan, 1, 1]]", {"element 0", "entry 2", "nan", "length"});
  refuses_table("[[0, 0, 0, 1, 1, 0, 0, 0]]", {"element 0", "axis"});
  refuses(site + plate + one + config("units", "[2]"), {"units", "2 elements", "1"});
  refuses(site + plate + one + config("units", "[0.5]"), {"unit 0", "0.5", "4096"});
  refuses(site + plate + one + config("effects", "[stribek]"), with_names(catalogues.effects, "stribek"));
  refuses(site + plate + one + config("material", "acrylc"), with_names(catalogues.materials, "acrylc"));
  refuses(site + plate + one + config("friction", "{static: 0.2, kinetic: 0.5}"), {"friction.kinetic", "0.5", "0.2"});
  refuses(site + plate + one + config("damping", "-1 ms"), {"damping", "-1 ms", "0 ms"});
  refuses(site + plate + one + config("trial", "-1"), {"trial", "-1", "0"});
  refuses(site + plate + one + config("seed", "-1"), {"seed", "-1", "18446744073709551615"});
  refuses(site + plate + one + config("truth", "maybe"), {"truth", "maybe", "true", "false"});
  refuses(site + plate + one + config("solver", "implict"), {"solver", "implict", "implicit"});
}

TEST(PluginRefusal, APadExactlyOnAnEndOfACylinderPointsAtIt) {
  std::string on_can = model_of(site + plate + one);
  const std::string box = "type='box' size='.1 .1 .1'";
  on_can.replace(on_can.find(box), box.size(), "type='cylinder' size='.1 .1'");
  EXPECT_EQ(refusal_of_model(on_can), "accepted");
  const std::string tip = "<site name='fingertip'";
  on_can.replace(on_can.find(tip), tip.size(), tip + " zaxis='0 0 -1' pos='0 0 -.001'");
  EXPECT_THAT(refusal_of_model(on_can), mentions({"plugin 'left'", "plate", "wrong way"}));
}

TEST(PluginRefusal, EffectMustSuitEveryTouchedGeom) {
  const std::string textured = site + one + config("effects", "[texture]");
  EXPECT_EQ(refusal_of(textured + plate), "accepted");
  const std::string what = refusal_of(textured + config("touch", "plate ball"));
  EXPECT_THAT(what, mentions({"plugin 'left'"}));
  EXPECT_THAT(what, mentions({"ball"}));
}

TEST(PluginRefusal, TipsWithMassNeedAPrescribedMotion) {
  std::string on_plane = model_of(site + plate + one + config("effects", "[inertia]"));
  const std::string box = "type='box' size='.1 .1 .1'";
  EXPECT_THAT(refusal_of_model(on_plane), mentions({"inertia", "plane", "plate"}));
  on_plane.replace(on_plane.find(box), box.size(), "type='plane' size='1 1 1'");
  EXPECT_THAT(refusal_of_model(on_plane), mentions({"plugin 'left'", "tips with mass", "prescribed"}));
}

TEST(PluginRefusal, SkinsGoWithTheExplicitSolver) {
  const std::string skin = config("effects", "[elastic_skin]") + config("solver", "implicit");
  EXPECT_THAT(refusal_of(site + plate + nine_pillars() + skin), mentions({"elastic skin", "implicit", "explicit"}));
}

TEST(PluginRefusal, MessageOfALongTableKeepsItsEnd) {
  std::string rows = square(30, 1e-3, 1.0, 1.0);  // 900 rows, some 30,000 characters
  rows.replace(rows.size() - 1, 1, ", [0, 0]]");
  EXPECT_THAT(refusal_of(site + plate + config("elements", rows)), mentions({"element 900", "[x, y, z, k_n, k_t]"}));
}

class PluginRun : public testing::Test {
 protected:
  PluginRun() : model_(load(model_of(site + plate + one))), data_(data_of(model_)) { data_->qpos[0] = -1e-3; }
  // Returns the error of the next step.
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
  EXPECT_THAT(error(), mentions({"plugin 'left'", "spring", "damper"}));
  model_->opt.disableflags = 0;
  expect_to_work_again();
  const std::string flags = "<option><flag spring='disable' damper='disable'/></option>";
  EXPECT_THAT(refusal_of_model(model_of(site + plate + one, flags)), mentions({"spring", "damper"}));
}

TEST_F(PluginRun, ChangedTimeStepIsRefused) {
  EXPECT_EQ(error(), "");
  model_->opt.timestep = 0.001;
  EXPECT_THAT(error(), mentions({"plugin 'left'", "0.002 s", "0.001 s", "mj_makeData"}));
  data_ = data_of(model_);
  EXPECT_EQ(error(), "");
}

TEST_F(PluginRun, TimeThatGoesBackIsRefused) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(error(), "");
  data_->time = 0.002;
  EXPECT_THAT(error(), mentions({"plugin 'left'", "0.004 s", "0.002 s", "mj_resetData", "mj_setState"}));
  expect_to_work_again();
}

TEST(PluginStep, IsRefusedAgainAfterAReset) {
  // 100 g between pads of 9 x 3 kN/m: omega is at least 735 rad/s, and 2 ms is too long.
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
    EXPECT_THAT(what, mentions({"time step", "2 ms"})) << "round " << round;
    // Continuing does not remove the error.
    EXPECT_THAT(mju_error_of([=] { mj_step(m, d); }), mentions({"time step", "2 ms"})) << "round " << round;
    mj_resetData(m, d);
  }
}

TEST(PluginStep, PadThatFliesOffInTheFirstStepIsRefusedAllTheSame) {
  // Pressed by 1 mm at the start with 1 MN/m per element: after one step of 1 ms the pad is
  // separated.
  const Model model = load(model_of(site + plate + config("elements", "[[0, 0, 0, 1e6, 1e5]]")));
  const Data data = data_of(model);
  const mjModel* m = model.get();
  mjData* d = data.get();
  d->qpos[0] = -1e-3;
  EXPECT_EQ(mju_error_of([=] { mj_step(m, d); }), "") << "the first one is MuJoCo's compiler's as well";
  EXPECT_THAT(mju_error_of([=] { mj_step(m, d); }), mentions({"time step", "1 ms", "0 s"}));
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
  EXPECT_THAT(what, mentions({"sleep"}));
}

TEST(PluginRefusal, PadOnTheBodyThatItTouches) {
  std::string self = model_of(site + config("touch", "tip") + one);
  self.replace(self.find("<geom size='.01' mass"), 5, "<geom name='tip'");
  EXPECT_THAT(refusal_of_model(self), mentions({"tip", "body"}));
}

}  // namespace
}  // namespace slipbench::testing_plugin
