#include "sim/mujoco/pads/implicit.h"

#include <functional>

#include "tests/expect.h"
#include "tests/sim/mujoco/pads/models.h"

namespace slipbench {
namespace {

// A pad on a slider over a free box, next to a damped arm with a stiff servo: other terms of a
// model's metric.
constexpr const char* bodies = R"(<mujoco><option timestep='0.002'/><worldbody>
  <body name='box' pos='0.01 0.02 0.03' axisangle='1 2 3 0.4'><freejoint/>
    <geom name='box' type='box' size='0.015 0.02 0.03' mass='0.005'/><site name='middle'/></body>
  <body name='finger' pos='0 0 0.1'><joint name='x' type='slide' axis='1 0 0' damping='3'/>
    <joint name='bend' type='hinge' axis='0 1 0' stiffness='2' damping='0.1' armature='1e-4'/>
    <geom size='0.01' mass='0.05' pos='0 0 -0.02'/><site name='pad' pos='0 0.001 -0.04'/></body>
  <body name='other'><joint type='slide' axis='0 1 0'/><geom size='0.01' mass='0.05'/></body>
  </worldbody><actuator><position joint='x' kp='500' kv='5'/></actuator></mujoco>)";

std::vector<ImplicitPad> pads_of(const mjModel* m, const PadLayout& layout) {
  return {{mj_name2id(m, mjOBJ_BODY, "finger"),
           mj_name2id(m, mjOBJ_BODY, "box"),
           {Eigen::Matrix3d::Identity(), {0.0, 0.001, -0.04}},
           &layout}};
}

const std::vector<SitePair> finger_on_box{{"pad", "middle"}};

TEST(Implicit, PreparedModelPasses) {
  const Spec spec = parse(bodies);
  prepare_implicit(spec.get(), finger_on_box);
  const Model model = compile(spec.get());
  for (const double stiffer : {1.0, 100.0}) {
    const PadLayout layout = nine_flat_pillars(stiffer);
    EXPECT_THAT(implicit_refusal(model.get(), pads_of(model.get(), layout)), IsEmpty());
    EXPECT_THAT(implicit_self_test(model.get(), pads_of(model.get(), layout)), IsEmpty());
  }
}

TEST(Implicit, RefusesWhatWouldLeaveTheFieldsOut) {
  const PadLayout layout = nine_flat_pillars(1.0);
  const auto refusal = [&](const std::function<void(mjModel*)>& spoil) {
    const Spec spec = parse(bodies);
    prepare_implicit(spec.get(), finger_on_box);
    const Model model = compile(spec.get());
    spoil(model.get());
    return implicit_refusal(model.get(), pads_of(model.get(), layout));
  };
  EXPECT_THAT(refusal([](mjModel* m) { m->opt.integrator = mjINT_IMPLICITFAST; }), HasSubstr("integrator=\"discrete\""));
  EXPECT_THAT(refusal([](mjModel* m) { m->opt.noslip_iterations = 3; }), HasSubstr("noslip_iterations=\"0\""));
  EXPECT_THAT(refusal([](mjModel* m) { m->opt.solver = mjSOL_PGS; }), HasSubstr("Newton"));
  EXPECT_THAT(refusal([](mjModel* m) { m->opt.disableflags |= mjDSBL_DAMPER; }), HasSubstr("damper"));
  EXPECT_THAT(refusal([](mjModel* m) { m->opt.enableflags |= mjENBL_SLEEP; }), HasSubstr("sleep"));
  EXPECT_THAT(refusal([](mjModel* m) { m->tendon_damping[0] = 0.0; }),
              AllOf(HasSubstr("tendon between a site on body finger and a site on body box"), HasSubstr("damping=\"1e-9\"")));
}

// The self-test must detect what implicit_refusal() knows: without a tendon MuJoCo ignores the
// rows.
TEST(Implicit, SelfTestFailsWhereTheRowsAreIgnored) {
  const Spec spec = parse(bodies);
  prepare_implicit(spec.get(), {});
  const Model model = compile(spec.get());
  const PadLayout layout = nine_flat_pillars(1.0);
  EXPECT_THAT(implicit_self_test(model.get(), pads_of(model.get(), layout)), HasSubstr("self-test failed"));

  model->opt.integrator = mjINT_IMPLICITFAST;
  EXPECT_THAT(implicit_self_test(model.get(), pads_of(model.get(), layout)), HasSubstr("no effective metric"));
}

TEST(Implicit, PreparingNamesAMissingSite) {
  const Spec spec = parse(bodies);
  const std::vector<SitePair> pairs{{"pad", "midle"}};
  EXPECT_THAT(refusal_of<std::invalid_argument>([&] { prepare_implicit(spec.get(), pairs); }), HasSubstr("'midle'"));
}

}  // namespace
}  // namespace slipbench
