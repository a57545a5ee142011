// A pad far from its surface is idle. Results must not show it: with check="off" it is never idle,
// and gives bit-identical results.
#include <cstring>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

struct RestCase {
  std::string pad, geom, integrator = "implicitfast", solver = "explicit";
};

// A finger on a slider and a hinge that is pressed onto an object on a spring, 0.1 mm off.
std::string rest_xml(const RestCase& one, bool rests) {
  const std::string implicit = one.solver == "implicit"
                                   ? "<tendon><spatial damping='1e-9'><site site='pad'/><site site='object'/></spatial></tendon>"
                                   : "";
  return "<mujoco><option timestep='0.0002' gravity='0 0 0' iterations='20' integrator='" + one.integrator +
         "'/><extension><plugin plugin='slipbench.field'><instance name='pad'>" + config("pad", "pad") +
         config("touch", "object") + one.pad + config("truth", "true") + config("solver", one.solver) +
         config("check", rests ? "error" : "off") +
         "</instance></plugin></extension><default><geom contype='0' conaffinity='0'/></default><worldbody>"
         "<body>" +
         (one.geom.find("plane") == std::string::npos ? "<joint type='slide' axis='1 0 0' stiffness='2000' damping='2'/>" : "") +
         "<geom name='object' mass='0.2' " + one.geom +
         "/><site name='object'/></body>"
         "<body pos='0.0201 0 0'><joint type='slide' axis='1 0 0' damping='2'/><joint axis='0.2 1 0.3' stiffness='0.5' damping='0.002'/>"
         "<geom type='box' pos='0.01 0 0.002' size='0.005 0.012 0.012' mass='0.05'/><site name='pad' zaxis='1 0 0'/></body></worldbody>" +
         implicit + "<sensor><plugin instance='pad'/></sensor></mujoco>";
}

// Presses for 0.1 s, separates for 0.1 s, repeatedly; once the finger is put back from afar in one
// step.
void press_and_leave(const mjModel* model, mjData* data, int tick) {
  const auto slider = static_cast<std::size_t>(model->nv - 2);
  data->qfrc_applied[slider] = tick % 1000 < 500 ? -1.5 : 1.5;
  if (tick == 1900) {
    data->qpos[slider] = -0.3e-3;
    data->qvel[slider] = 0.0;
  }
  mj_step(model, data);
}

TEST(PluginRest, NobodySeesIt) {
  const std::string box = "type='box' size='0.02 0.02 0.03'", ball = "type='sphere' size='0.02'",
                    plane = "type='plane' size='1 1 1' pos='0.02 0 0' zaxis='1 0 0'";
  for (const RestCase& one : {RestCase{nine_pillars(), box}, RestCase{real_pillars(), box}, RestCase{real_pillars(), ball},
                              RestCase{real_pillars(), plane}, RestCase{real_pillars(), box, "RK4"},
                              RestCase{real_pillars(), box, "discrete", "implicit"},
                              RestCase{config("elements", square(20, 0.0005, 30.0, 5.0)), ball}}) {
    SCOPED_TRACE(one.pad + one.geom + one.integrator);
    const Model model = load(rest_xml(one, true)), never = load(rest_xml(one, false));
    const Data data = data_of(model), reference = data_of(never);
    // After it come the solver's memory and the content of sensordata.
    const auto rest = static_cast<std::size_t>(model->npluginstate - model->nsensordata - (one.solver == "implicit" ? 6 : 0) - 1);
    int apart = 0, resting = 0;
    for (int tick = 0; tick < 3000; ++tick) {
      press_and_leave(model.get(), data.get(), tick);
      press_and_leave(never.get(), reference.get(), tick);
      ASSERT_EQ(std::memcmp(data->qpos, reference->qpos, sizeof(mjtNum) * static_cast<std::size_t>(model->nq)), 0) << tick;
      ASSERT_EQ(
          std::memcmp(data->sensordata, reference->sensordata, sizeof(mjtNum) * static_cast<std::size_t>(model->nsensordata)), 0)
          << tick;
      apart += data->qpos[model->nq - 2] > 0.02 ? 1 : 0;
      resting += data->plugin_state[rest] == 3.0 ? 1 : 0;
    }
    EXPECT_GT(apart, 500);
    EXPECT_GE(resting, apart - 10);
  }
}

}  // namespace
}  // namespace slipbench::testing_plugin
