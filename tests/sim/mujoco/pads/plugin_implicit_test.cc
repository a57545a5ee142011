// solver='implicit' in the plugin: a light box between pads too stiff for an explicit force at 1
// ms.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "tests/expect.h"
#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

// A box between a fixed pad, 0.13 mm off its middle, and one on a slider, both of nine elements of
// `stiffness` times 3 kN/m and 500 N/m, pressed by `force` [N] at the start: each element by
// force/(9 k_n).
struct Pinch {
  double mass, stiffness, force;
  std::string solver = "implicit";
  std::string tendon =
      "<tendon><spatial damping='1e-9'><site site='left'/><site site='box'/></spatial><spatial damping='1e-9'><site site='right'/><site site='box'/></spatial></tendon>";
  std::string effects = "[]";
  double dt = 1e-3;  // s
};

std::string pinch_xml(const Pinch& pinch) {
  const double depth = pinch.force / (9.0 * 3000.0 * pinch.stiffness);
  // A damping ratio of 0.2 in the fastest mode, that along the normals: sqrt(18 k_n/m).
  const double tau = 0.4 / std::sqrt(18.0 * 3000.0 * pinch.stiffness / pinch.mass);
  std::ostringstream xml;
  xml.precision(17);
  const auto instance = [&](const std::string& name) {
    std::ostringstream damping;
    damping.precision(17);
    damping << tau;
    return "<instance name='" + name + "'>" + config("pad", name) + config("touch", "box") +
           config("elements", square(3, 0.007, 3000.0 * pinch.stiffness, 500.0 * pinch.stiffness)) +
           config("friction", "{static: 0.5}") + config("damping", damping.str()) + config("solver", pinch.solver) +
           config("effects", pinch.effects) + config("truth", "true") + "</instance>";
  };
  xml << "<mujoco><option timestep='" << pinch.dt
      << "' integrator='discrete' gravity='0 0 0'/><extension><plugin plugin='slipbench.field'>" << instance("left")
      << instance("right") << "</plugin></extension><worldbody>"
      << "<body name='box'><freejoint/><geom name='box' type='box' size='0.02 0.02 0.06' mass='" << pinch.mass
      << "' contype='0' conaffinity='0'/><site name='box'/></body>"
      << "<body name='left' pos='" << -0.02 + depth
      << " 0.00013 0.0001'><site name='left' zaxis='-1 0 0'/><plugin instance='left'/></body>"
      << "<body name='right' pos='" << 0.02 - depth << " 0 0'><joint type='slide' name='slide' axis='-1 0 0'/>"
      << "<geom size='0.001' mass='0.05' contype='0' conaffinity='0'/><site name='right' zaxis='1 0 0'/><plugin instance='right'/></body>"
      << "</worldbody><actuator><motor joint='slide'/></actuator>" << pinch.tendon
      << "<sensor><plugin instance='left'/><plugin instance='right'/></sensor></mujoco>";
  return xml.str();
}

// The box under a weight that grows smoothly within 0.3 s, and then stays.
class PinchedBox {
 public:
  explicit PinchedBox(const Pinch& pinch) : model(load(pinch_xml(pinch))), data(data_of(model)), weight_(pinch.mass * g) {
    const int ramp = static_cast<int>(std::lround(0.3 / pinch.dt));
    for (int i = 0; i < ramp; ++i) step(pinch.force, 0.5 * g * (1.0 - std::cos(std::numbers::pi * i / ramp)));
  }
  void step(double force, double gravity) {
    data->ctrl[0] = force;
    model->opt.gravity[2] = -gravity;
    mj_step(model.get(), data.get());
  }
  void run(int steps, double force) {
    for (int i = 0; i < steps; ++i) step(force, g);
  }
  [[nodiscard]] double z() const { return data->qpos[2]; }
  [[nodiscard]] double speed() const { return data->qvel[2]; }
  // Number of units of both pads in that state.
  [[nodiscard]] std::ptrdiff_t units(UnitState state) const {
    std::ptrdiff_t count = 0;
    for (int pad : {0, 1})
      count += std::ranges::count(pad_of(model.get(), data.get(), pad)->truth(FramePart::all).unit_state, state);
    return count;
  }
  // Share of the weight that the pads carry.
  [[nodiscard]] double carried() const { return data->qfrc_passive[2] / weight_; }

  Model model;
  Data data;

 private:
  double weight_;
};

// Mass [kg] and stiffness. At 1 ms h omega is 3.3, 10 and 33 for 5 g, and 3 and 10 for 100 g.
class ImplicitPlugin : public testing::TestWithParam<std::pair<double, double>> {
 protected:
  double mass = GetParam().first, stiffness = GetParam().second;
  double least = mass * g;  // N, m g/(2 mu) with mu = 0.5
};

TEST_P(ImplicitPlugin, HoldsJustAboveTheLeastForceAndCarriesTheWeight) {
  PinchedBox held({mass, stiffness, 1.003 * least});
  held.run(200, 1.003 * least);
  const double z = held.z();
  held.run(200, 1.003 * least);
  EXPECT_NEAR(held.z(), z, 1e-7) << "creep of 0.5 um/s would be this much";
  EXPECT_NEAR(held.carried(), 1.0, 1e-5);
  EXPECT_EQ(pad_group_of(held.model.get(), held.data.get())->unconverged_steps(), 0U);
}

TEST_P(ImplicitPlugin, HeldFirmlyCreepsNotAtAllAndNoLabelFlickers) {
  PinchedBox held({mass, stiffness, 1.5 * least});
  held.run(200, 1.5 * least);
  const double z = held.z();
  for (int i = 0; i < 200; ++i) {
    held.run(1, 1.5 * least);
    ASSERT_EQ(held.units(UnitState::stick), 18) << i;
  }
  EXPECT_NEAR(held.z(), z, 0.01e-6 * 0.2);  // 0.01 um/s
}

TEST_P(ImplicitPlugin, DropsJustBelowIt) {
  // a = g (1 - F/F_0) = 0.003 g: 1.2 mm within 0.28 s; a fifth of that must appear within 0.2 s
  // after the full weight.
  PinchedBox held({mass, stiffness, 0.997 * least});
  const double z = held.z();
  held.run(200, 0.997 * least);
  EXPECT_LT(held.z() - z, -0.2 * 0.003 * g * 0.5 * 0.2 * 0.2);
}

TEST_P(ImplicitPlugin, SlidesWithTheRightAcceleration) {
  // Half of the least force: m a = m g - 2 mu F = m g/2. The pads need some steps to follow the new
  // force: 10 ms pass before.
  PinchedBox held({mass, stiffness, 1.2 * least});
  held.run(10, 0.5 * least);
  const double before = held.speed();
  for (int i = 0; i < 20; ++i) {
    held.run(1, 0.5 * least);
    EXPECT_EQ(held.units(UnitState::stick), 0) << i;
  }
  EXPECT_NEAR((held.speed() - before) / 0.02, -0.5 * g, 2e-3 * 0.5 * g);
}

TEST_P(ImplicitPlugin, SinksAtTheTerminalSpeedOfARateLaw) {
  // Least force over 1.1: m g = 2 mu F g(v) with g = 1.1 = 1 + 0.1 log10(1 + v/(1 mm/s)), v = 9
  // mm/s.
  Pinch pinch{mass, stiffness, 1.2 * least};
  pinch.effects = "[{viscous_friction: {gain: 0.1, speed: 1 mm/s}}]";
  PinchedBox held(pinch);
  held.run(300, least / 1.1);
  const double before = held.speed();
  held.run(20, least / 1.1);
  EXPECT_NEAR(1.0 + 0.1 * std::log10(1.0 - held.speed() / 1e-3), 1.1, 1e-4) << "the pads' offset turns their forces a little";
  EXPECT_NEAR(held.speed(), before, 1e-5);
  EXPECT_EQ(pad_group_of(held.model.get(), held.data.get())->unconverged_steps(), 0U);
}

TEST_P(ImplicitPlugin, ExplicitPadsAreRefusedWithTheLimit) {
  Model model = load(pinch_xml({mass, stiffness, 1.1 * least, "explicit"}));
  Data data = data_of(model);
  const mjModel* m = model.get();
  mjData* d = data.get();
  EXPECT_EQ(mju_error_of([=] { mj_step(m, d); }), "") << "MuJoCo's compiler takes one step, too";
  const std::string what = mju_error_of([=] { mj_step(m, d); });
  EXPECT_THAT(what, mentions({"1 ms", "0 s", "vibration"}));
  EXPECT_THAT(what, mentions({"rad/s"}));
}

INSTANTIATE_TEST_SUITE_P(StiffPads, ImplicitPlugin,
                         testing::Values(std::pair(0.005, 10.0), std::pair(0.005, 100.0), std::pair(0.1, 10.0),
                                         std::pair(0.1, 100.0)));

// Both solvers step the same physics: a released box falls in the same way. Each may release it a
// step late, 0.1 ms of the 100 ms of a fall that grows with the square of time: 2e-3 each.
TEST(PluginImplicit, AgreesWithTheExplicitForceAtAShortStep) {
  const double mass = 0.1, least = mass * g;
  const auto fall = [&](const std::string& solver) {
    Pinch pinch{mass, 1.0, 1.5 * least, solver};
    pinch.dt = 1e-4;
    PinchedBox held(pinch);
    const double z = held.z();
    held.run(1000, 0.5 * least);
    return z - held.z();
  };
  const double explicitly = fall("explicit");
  EXPECT_GT(explicitly, 1e-3);
  EXPECT_NEAR(fall("implicit") / explicitly, 1.0, 4e-3);
}

// Mean force on a box of 5 g [N] from a pad that presses with 1 N and slides over it at 20 mm/s.
// The box lies on a table with MuJoCo's own contact.
Eigen::Vector3d drag(double stiffness, double dt, const std::string& solver) {
  const bool implicit = solver == "implicit";
  const double tau = 0.4 / std::sqrt(9.0 * 3000.0 * stiffness / 0.005);
  std::ostringstream xml;
  xml.precision(17);
  xml << "<mujoco><option timestep='" << dt << "' integrator='" << (implicit ? "discrete" : "implicitfast")
      << "' cone='elliptic' impratio='10'/><extension><plugin plugin='slipbench.field'><instance name='pad'>"
      << config("pad", "pad") << config("touch", "box")
      << config("elements", square(3, 0.007, 3000.0 * stiffness, 500.0 * stiffness)) << config("friction", "{static: 0.3}")
      << config("damping", std::to_string(1e6 * tau) + " us") << config("solver", solver) << config("truth", "true")
      << "</instance></plugin></extension><worldbody><geom type='plane' size='1 1 1' friction='0.6 0.005 0.0001'/><body name='box' pos='0.00013 0.00013 0.0151' axisangle='0.5 0.7 0.6 0.004'><freejoint/><geom name='box' type='box' size='0.015 0.02 0.015' mass='0.005' friction='0.6 0.005 0.0001'/><site name='middle'/></body><body name='arm' pos='0 0 0.0305'><joint name='x' type='slide' axis='1 0 0'/><joint name='z' type='slide' axis='0 0 1' damping='50'/><geom size='0.005' mass='0.05' contype='0' conaffinity='0' pos='0 0 0.01'/><site name='pad'/><plugin instance='pad'/></body></worldbody><actuator><velocity joint='x' kv='1000'/></actuator>"
      << (implicit ? "<tendon><spatial damping='1e-9'><site site='pad'/><site site='middle'/></spatial></tendon>" : "")
      << "<sensor><plugin instance='pad'/></sensor></mujoco>";
  const Model model = load(xml.str());
  const Data data = data_of(model);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const int steps = static_cast<int>(std::lround(1.0 / dt)), settled = static_cast<int>(std::lround(0.6 / dt));
  for (int i = 0; i < steps; ++i) {
    data->qfrc_applied[7] = -1.0 + 0.05 * g;
    data->ctrl[0] = i * dt > 0.4 ? 0.02 : 0.0;
    mj_step(model.get(), data.get());
    if (i >= settled) mean += force_of_pad(model.get(), data.get(), 0) / (steps - settled);
  }
  return mean;
}

// In the first step of its data there is no earlier result, and no residual of the step is a number.
TEST(PluginImplicit, VelocityThatIsNotANumberGivesForcesThatAreNone) {
  const Model model = load(pinch_xml({.mass = 0.1, .stiffness = 1.0, .force = 2.0}));
  const Data data = data_of(model);
  data->qvel[0] = std::nan("");
  const std::string error = mju_error_of([&] { mj_forward(model.get(), data.get()); });
  EXPECT_TRUE(!error.empty() || std::isnan(data->qfrc_passive[0])) << error;
}

// The metric couples the field to MuJoCo's contacts within the step, so that a pad 100 times as
// stiff gives at 1 ms the force of an ordinary explicit one at 0.1 ms (h omega = 0.23): none of
// these forces depends on the pad's stiffness.
TEST(PluginImplicit, SlidesOverABoxOnATable) {
  const Eigen::Vector3d reference = drag(1.0, 1e-4, "explicit");
  for (const double stiffness : {10.0, 100.0}) {
    const Eigen::Vector3d found = drag(stiffness, 1e-3, "implicit");
    EXPECT_NEAR(found.z() / reference.z(), 1.0, 5e-3) << stiffness;
    EXPECT_NEAR(found.x() / reference.x(), 1.0, 1e-2) << stiffness;
  }
}

std::vector<double> state_of(const mjModel* m, const mjData* d) {
  std::vector<double> state(static_cast<std::size_t>(mj_stateSize(m, mjSTATE_INTEGRATION)));
  mj_getState(m, d, state.data(), mjSTATE_INTEGRATION);
  return state;
}

TEST(ImplicitPluginState, GoesOnTheSameInAnotherData) {
  const double least = 0.005 * g;
  PinchedBox held({0.005, 100.0, 1.1 * least});
  held.run(5, 0.6 * least);  // the box slides
  const Data restored = data_of(held.model), copied = data_of(held.model);
  const std::vector<double> state = state_of(held.model.get(), held.data.get());
  mj_setState(held.model.get(), restored.get(), state.data(), mjSTATE_INTEGRATION);
  mj_copyData(copied.get(), held.model.get(), held.data.get());
  for (int i = 0; i < 300; ++i) {
    for (mjData* d : {held.data.get(), restored.get(), copied.get()}) mj_step(held.model.get(), d);
    const std::vector<double> now = state_of(held.model.get(), held.data.get());
    ASSERT_EQ(std::memcmp(now.data(), state_of(held.model.get(), restored.get()).data(), now.size() * sizeof(double)), 0) << i;
    ASSERT_EQ(std::memcmp(now.data(), state_of(held.model.get(), copied.get()).data(), now.size() * sizeof(double)), 0) << i;
  }
}

TEST(ImplicitPluginRefusal, SaysWhatTheModelLacks) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler disabler;  // MuJoCo leaks the mjData of a model that a plugin refuses
#endif
  const auto refusal = [](const std::string& xml) -> std::string { return refusal_of<std::runtime_error>([&] { load(xml); }); };
  const Pinch pinch{0.005, 10.0, 0.06};
  EXPECT_EQ(refusal(pinch_xml(pinch)), "accepted");
  Pinch no_tendon = pinch;
  no_tendon.tendon.clear();
  EXPECT_THAT(refusal(pinch_xml(no_tendon)), HasSubstr("tendon"));
  std::string euler = pinch_xml(pinch);
  euler.replace(euler.find("discrete"), 8, "Euler");
  EXPECT_THAT(refusal(euler), HasSubstr("discrete"));
  std::string uneven = pinch_xml(pinch);
  const std::size_t damping = uneven.find("key='damping' value=\"") + 21;
  uneven.replace(damping, uneven.find('"', damping) - damping, "0.5");
  EXPECT_THAT(refusal(uneven), mentions({"implicit", "damping"}));
}

TEST(ImplicitPluginRefusal, OptionsThatChangeLaterAreSeen) {
  const double least = 0.005 * g;
  for (int change = 0; change < 3; ++change) {
    PinchedBox held({0.005, 10.0, 1.1 * least});
    mjModel* m = held.model.get();
    mjData* d = held.data.get();
    if (change == 0) m->opt.solver = mjSOL_PGS;
    if (change == 1) m->opt.disableflags |= mjDSBL_DAMPER;
    if (change == 2) m->opt.noslip_iterations = 3;
    EXPECT_THAT(mju_error_of([=] { mj_step(m, d); }), HasSubstr("solver='implicit' needs ")) << change;
  }
}

TEST(PluginImplicit, OneTendonIsEnoughForATree) {
  // A finger of two links, each with a pad on the box, against a fixed pad. The tendons' damping is
  // negligible: 1e-9 N s/m.
  const auto model_with = [](const std::string& tendons) {
    const auto instance = [](const std::string& name) {
      return "<instance name='" + name + "'>" + config("pad", name) + config("touch", "box") +
             config("elements", square(3, 0.004, 3e5, 5e4)) + config("friction", "{static: 0.5}") + config("solver", "implicit") +
             config("damping", "1e-5") + "</instance>";
    };
    return load(
        "<mujoco><option timestep='0.001' integrator='discrete' iterations='20'/><extension><plugin plugin='slipbench.field'>" +
        instance("wall") + instance("near") + instance("far") +
        "</plugin></extension><default><geom contype='0' conaffinity='0'/></default><worldbody>"
        "<body name='box'><freejoint/><geom name='box' type='box' size='0.02 0.02 0.02' mass='0.005'/><site name='box'/></body>"
        "<body pos='-0.02 0 0.0001'><site name='wall' zaxis='-1 0 0'/></body>"
        "<body pos='0.02 0 0.01'><joint type='slide' name='slide' axis='-1 0 0'/><geom size='0.001' mass='0.05'/><site name='near' zaxis='1 0 0'/>"
        "<body pos='0 0 -0.02'><joint type='slide' name='link' axis='-1 0 0' stiffness='100'/><geom size='0.001' mass='0.02'/>"
        "<site name='far' zaxis='1 0 0'/></body></body></worldbody><actuator><motor joint='slide'/><motor joint='link'/></actuator><tendon>" +
        tendons +
        "</tendon><sensor><plugin instance='wall'/><plugin instance='near'/><plugin instance='far'/></sensor></mujoco>");
  };
  const std::string wall = "<spatial damping='1e-9'><site site='wall'/><site site='box'/></spatial>",
                    near = "<spatial damping='1e-9'><site site='near'/><site site='box'/></spatial>",
                    far = "<spatial damping='1e-9'><site site='far'/><site site='box'/></spatial>";
  const Model each = model_with(wall + near + far), one = model_with(wall + near);
  const Data expected = data_of(each), found = data_of(one);
  for (int tick = 0; tick < 1000; ++tick) {
    for (const Data* data : {&expected, &found}) {
      (*data)->ctrl[0] = 0.6;  // N; with the far link's force it exceeds the 0.05 N of weight/(2 mu)
      (*data)->ctrl[1] = 0.3;
    }
    mj_step(each.get(), expected.get());
    mj_step(one.get(), found.get());
    for (int k = 0; k < static_cast<int>(each->nq); ++k) ASSERT_NEAR(found->qpos[k], expected->qpos[k], 1e-9) << tick;
  }
  EXPECT_NEAR(found->qpos[2], 0.0, 1e-4);  // the box is held
}

}  // namespace
}  // namespace slipbench::testing_plugin
