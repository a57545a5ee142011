// The plugin's state is in mjData only: a run that is saved, copied, reset or inspected continues
// bit-identically.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

// The model includes everything with memory: electronics with noise at half the rate of the steps,
// every effect with a memory, pillars in part, and a box pulled to and fro in a grip that loosens
// and closes, so that elements stick, slip, detach and touch.
Model busy_model(const std::string& integrator) {
  return load(grip_xml(
      {.dt = 5e-4,
       .integrator = integrator,
       .left = config("sensor", "{type: papillarray, bristles: 6, electronics: typical}") +
               config("effects",
                      "[ageing, load_dependent_friction, patchy_friction, stribeck, texture, viscoelastic, viscous_friction]"),
       .right = nine_pillars() + config("effects", "[anisotropic_friction, viscoelastic]"),
       .option = "noslip_iterations='0'",
       .more = "<keyframe><key/></keyframe>"}));
}

// For a step of 0.5 ms: the grip goes from 0.3 to 2.8 N and back at 5 Hz, and the box is pulled
// sideways by up to 1.2 N at 20 Hz.
void drive(mjData* data, int tick) {
  const auto triangle = [tick](int period) {  // 0 to 1 and back
    const int phase = tick % period;
    return 2.0 * std::min(phase, period - phase) / period;
  };
  data->ctrl[0] = 0.3 + 2.5 * triangle(400);
  data->qfrc_applied[1] = 1.2 - 2.4 * triangle(100);
}
void step(const mjModel* model, mjData* data, int tick) {
  drive(data, tick);
  mj_step(model, data);
}
void run(const mjModel* model, mjData* data, int from, int to) {
  for (int tick = from; tick < to; ++tick) step(model, data, tick);
}

// NaN (the margin without contact) equals NaN of the same bits.
bool same_bits(const mjtNum* a, const mjtNum* b, mjtSize count) {
  return std::memcmp(a, b, static_cast<std::size_t>(count) * sizeof(mjtNum)) == 0;
}
testing::AssertionResult same(const mjModel* model, const mjData* a, const mjData* b) {
  const auto differs = [&](const char* what) { return testing::AssertionFailure() << what << " differs at " << a->time << " s"; };
  if (!same_bits(a->qpos, b->qpos, model->nq)) return differs("qpos");
  if (!same_bits(a->qvel, b->qvel, model->nv)) return differs("qvel");
  if (!same_bits(a->sensordata, b->sensordata, model->nsensordata)) return differs("sensordata");
  if (!same_bits(a->plugin_state, b->plugin_state, model->npluginstate)) return differs("plugin_state");
  return testing::AssertionSuccess();
}

void expect_to_go_on_alike(const mjModel* model, mjData* a, mjData* b, int from, int steps) {
  for (int tick = from; tick < from + steps; ++tick) {
    step(model, a, tick);
    step(model, b, tick);
    ASSERT_TRUE(same(model, a, b)) << "step " << tick;
  }
}

constexpr int middle = 1500, rest = 700;

// Skins store forces, shifts and their increments of the last step; a copy and a restored state
// continue with them.
TEST(PluginState, SkinsGoOnFromACopy) {
  const std::string skin =
      config("elements", square(8, 2.5e-3, 1.0, 1.0)) + config("effects", "[{elastic_skin: {shear_modulus: 20 kPa}}]");
  const Model model = load(grip_xml({.dt = 5e-4, .left = skin, .right = skin}));
  const mjModel* m = model.get();
  const Data data = data_of(model), set = data_of(model);
  run(m, data.get(), 0, middle);
  const Data copy(mj_copyData(nullptr, m, data.get()));
  std::vector<mjtNum> state(static_cast<std::size_t>(mj_stateSize(m, mjSTATE_INTEGRATION)));
  mj_getState(m, data.get(), state.data(), mjSTATE_INTEGRATION);
  mj_setState(m, set.get(), state.data(), mjSTATE_INTEGRATION);
  int slid = 0;
  for (int tick = middle; tick < middle + rest; ++tick) {
    for (const Data* each : {&data, &copy, &set}) step(m, each->get(), tick);
    ASSERT_TRUE(same(m, data.get(), copy.get())) << tick;
    ASSERT_TRUE(same(m, data.get(), set.get())) << tick;
    slid += static_cast<int>(pad_of(m, data.get(), 0)->fields().front().slipping());
  }
  EXPECT_GT(slid, 100);
}

class PluginState : public testing::TestWithParam<const char*> {
 protected:
  PluginState() : model_(busy_model(GetParam())), data_(data_of(model_)) { model_->opt.gravity[2] = -1.0; }
  // Runs the model to a state with elements that stick and elements that slip.
  void go_to_the_middle() {
    run(m(), d(), 0, middle);
    std::array<int, 3> count{};
    for (int pad : {0, 1}) {
      for (const Field& field : pad_of(m(), d(), pad)->fields()) {
        for (std::size_t i = 0; i < field.size(); ++i) ++count[static_cast<std::size_t>(field.state(i))];
      }
    }
    EXPECT_GT(count[1] + count[2], 0);
    EXPECT_GT(d()->qpos[2], -0.03) << "the box has left the pads";
  }
  mjModel* m() { return model_.get(); }
  mjData* d() { return data_.get(); }

  Model model_;
  Data data_;
};
INSTANTIATE_TEST_SUITE_P(Integrators, PluginState, testing::Values("Euler", "implicit", "implicitfast", "discrete", "RK4"));

TEST_P(PluginState, RunStaysBusy) {
  // The other tests of this file are meaningless unless elements change their states all the time.
  int stick = 0, slip = 0, detached = 0, steps_with_slip = 0;
  for (int tick = 0; tick < middle + rest; ++tick) {
    step(m(), d(), tick);
    bool slips = false;
    for (int pad : {0, 1}) {
      for (const UnitState state : pad_of(m(), d(), pad)->truth(FramePart::all).unit_state) {
        stick += state == UnitState::stick ? 1 : 0;
        detached += state == UnitState::detached ? 1 : 0;
        slip += state == UnitState::slip || state == UnitState::partial ? 1 : 0;
        slips = slips || state == UnitState::slip || state == UnitState::partial;
      }
    }
    steps_with_slip += slips ? 1 : 0;
  }
  EXPECT_GT(stick, 1000);
  EXPECT_GT(slip, 1000);
  EXPECT_GT(detached, 1000);
  EXPECT_LT(steps_with_slip, middle + rest);
}

TEST_P(PluginState, SetStateGoesOnToTheSameBits) {
  go_to_the_middle();
  for (const int parts :
       {static_cast<int>(mjSTATE_INTEGRATION), static_cast<int>(mjSTATE_FULLPHYSICS) | static_cast<int>(mjSTATE_CTRL)}) {
    std::vector<mjtNum> state(static_cast<std::size_t>(mj_stateSize(m(), parts)));
    mj_getState(m(), d(), state.data(), parts);
    const Data fresh = data_of(model_), other = data_of(model_), again = Data(mj_copyData(nullptr, m(), d()));
    run(m(), other.get(), 0, 100);  // data with a past of its own
    mj_setState(m(), fresh.get(), state.data(), parts);
    mj_setState(m(), other.get(), state.data(), parts);
    run(m(), again.get(), middle, middle + rest);
    run(m(), fresh.get(), middle, middle + rest);
    run(m(), other.get(), middle, middle + rest);
    EXPECT_TRUE(same(m(), again.get(), fresh.get()));
    EXPECT_TRUE(same(m(), again.get(), other.get()));
  }
}

TEST_P(PluginState, CopyGoesOnToTheSameBits) {
  go_to_the_middle();
  const Data made(mj_copyData(nullptr, m(), d())), overwritten = data_of(model_);
  run(m(), overwritten.get(), 0, 50);
  mj_copyData(overwritten.get(), m(), d());
  expect_to_go_on_alike(m(), d(), made.get(), middle, rest);
  run(m(), overwritten.get(), middle, middle + rest);
  EXPECT_TRUE(same(m(), d(), overwritten.get()));
}

TEST_P(PluginState, PointersInPluginDataDoNotMatter) {
  // As Python's pickle makes an mjData: a new one, then all arrays, plugin_data included, of an
  // mjData that may be gone or of another process.
  go_to_the_middle();
  Data made = data_of(model_);
  std::vector<mjtNum> state(static_cast<std::size_t>(mj_stateSize(m(), mjSTATE_INTEGRATION)));
  mj_getState(m(), d(), state.data(), mjSTATE_INTEGRATION);
  mj_setState(m(), made.get(), state.data(), mjSTATE_INTEGRATION);
  std::copy_n(d()->plugin_data, m()->nplugin, made->plugin_data);
  run(m(), made.get(), middle, middle + 50);
  std::fill_n(made->plugin_data, m()->nplugin, std::uintptr_t{0xdead});
  run(m(), made.get(), middle + 50, middle + rest);
  run(m(), d(), middle, middle + rest);
  EXPECT_TRUE(same(m(), made.get(), d()));
  std::copy_n(d()->plugin_data, m()->nplugin, made->plugin_data);
  made.reset();
  run(m(), d(), middle + rest, middle + rest + 50);
}

TEST_P(PluginState, ResetBeginsTheSameRunAnew) {
  run(m(), d(), 0, 300);
  const Data first(mj_copyData(nullptr, m(), d()));
  run(m(), d(), 300, middle);
  mj_resetData(m(), d());
  run(m(), d(), 0, 300);
  EXPECT_TRUE(same(m(), first.get(), d()));
}

TEST_P(PluginState, ForwardAtOtherPosesMovesNoAnchor) {
  const Data plain = data_of(model_);
  std::vector<mjtNum> state(static_cast<std::size_t>(mj_stateSize(m(), mjSTATE_PHYSICS)));
  for (int tick = 0; tick < middle; ++tick) {
    mj_getState(m(), d(), state.data(), mjSTATE_PHYSICS);
    d()->qpos[2] += 3e-3;  // a probe, as by inverse kinematics or a planner: 3 mm up, 5 mm in, fast
    d()->qpos[7] += 5e-3;
    d()->qvel[0] += 0.4;
    mj_forward(m(), d());
    mj_inverse(m(), d());
    mj_setState(m(), d(), state.data(), mjSTATE_PHYSICS);
    step(m(), d(), tick);
    step(m(), plain.get(), tick);
    ASSERT_TRUE(same(m(), plain.get(), d())) << "step " << tick;
  }
}

TEST_P(PluginState, FiniteDifferencesMoveNoAnchor) {
  if (m()->opt.integrator == mjINT_RK4) GTEST_SKIP() << "mjd_transitionFD refuses RK4";
  const Data plain = data_of(model_);
  const auto n = static_cast<std::size_t>(2 * m()->nv);
  std::vector<mjtNum> a(n * n), b(n * static_cast<std::size_t>(m()->nu));
  for (int tick = 0; tick < middle; ++tick) {
    drive(d(), tick);
    if (tick % 20 == 0) mjd_transitionFD(m(), d(), 1e-6, 1, a.data(), b.data(), nullptr, nullptr);
    step(m(), d(), tick);
    step(m(), plain.get(), tick);
    ASSERT_TRUE(same(m(), plain.get(), d())) << "step " << tick;
  }
}

TEST_P(PluginState, StepInTwoHalvesIsOneStep) {
  if (m()->opt.integrator == mjINT_RK4) GTEST_SKIP() << "mj_step2 does not integrate by RK4";
  const Data plain = data_of(model_), hops = data_of(model_);
  for (int tick = 0; tick < middle; ++tick) {
    mj_step1(m(), d());
    drive(d(), tick);
    mj_copyData(hops.get(), m(), d());  // a copy between the halves continues with the second half
    mj_step2(m(), d());
    mj_step2(m(), hops.get());
    step(m(), plain.get(), tick);
    ASSERT_TRUE(same(m(), plain.get(), d())) << "step " << tick;
    ASSERT_TRUE(same(m(), plain.get(), hops.get())) << "step " << tick << " in the copy";
  }
}

TEST_P(PluginState, DrawingChangesNothing) {
  const Data plain = data_of(model_);
  mjvScene scene;
  mjv_defaultScene(&scene);
  mjv_makeScene(m(), &scene, 1000);
  mjvOption option;
  mjv_defaultOption(&option);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  for (int tick = 0; tick < middle; ++tick) {
    if (tick % 10 == 0) mjv_updateScene(m(), d(), &option, nullptr, &camera, mjCAT_ALL, &scene);
    step(m(), d(), tick);
    step(m(), plain.get(), tick);
    ASSERT_TRUE(same(m(), plain.get(), d())) << "step " << tick;
  }
  // A ball for each element, and an arrow for each touching one.
  int touching = 0, elements = 0, balls = 0, arrows = 0;
  for (int pad : {0, 1}) {
    for (const Field& field : pad_of(m(), d(), pad)->fields()) {
      for (std::size_t i = 0; i < field.size(); ++i) touching += field.state(i) != ElementState::detached ? 1 : 0;
      elements += static_cast<int>(field.size());
    }
  }
  mj_forward(m(), d());
  mjv_updateScene(m(), d(), &option, nullptr, &camera, mjCAT_ALL, &scene);
  for (int i = 0; i < scene.ngeom; ++i) {
    if (scene.geoms[i].category != mjCAT_DECOR) continue;
    balls += scene.geoms[i].type == mjGEOM_SPHERE ? 1 : 0;
    arrows += scene.geoms[i].type == mjGEOM_ARROW ? 1 : 0;
  }
  EXPECT_EQ(balls, elements);
  EXPECT_GT(arrows, 0);
  EXPECT_LE(std::abs(arrows - touching), 10) << "one step lies between the two counts";
  mjvScene small;  // a scene that is full
  mjv_defaultScene(&small);
  mjv_makeScene(m(), &small, 20);
  mjv_updateScene(m(), d(), &option, nullptr, &camera, mjCAT_ALL, &small);
  EXPECT_LE(small.ngeom, 20);
  mjv_freeScene(&small);
  mjv_freeScene(&scene);
}

// Keyframes store positions, velocities, time and controls, but no plugin state.
TEST_P(PluginState, KeyframeStartsThePadsAfresh) {
  go_to_the_middle();
  mj_setKeyframe(m(), d(), 0);
  const std::vector<mjtNum> held(d()->plugin_state, d()->plugin_state + m()->npluginstate);
  run(m(), d(), middle, middle + 50);
  mj_resetDataKeyframe(m(), d(), 0);

  const Data fresh = data_of(model_);
  std::copy_n(m()->key_qpos, m()->nq, fresh->qpos);
  std::copy_n(m()->key_qvel, m()->nv, fresh->qvel);
  std::copy_n(m()->key_ctrl, m()->nu, fresh->ctrl);
  fresh->time = m()->key_time[0];
  const auto state = [this](const mjData* data) {
    std::vector<mjtNum> values(static_cast<std::size_t>(mj_stateSize(m(), mjSTATE_INTEGRATION)));
    mj_getState(m(), data, values.data(), mjSTATE_INTEGRATION);
    return values;
  };
  EXPECT_EQ(state(d()), state(fresh.get()));
  EXPECT_FALSE(same_bits(d()->plugin_state, held.data(), m()->npluginstate));
  expect_to_go_on_alike(m(), d(), fresh.get(), middle, rest);
}

// The pads' state saved with the keyframe and restored after it: the run continues unchanged.
TEST_P(PluginState, KeyframeWithThePadsStateGoesOnToTheSameBits) {
  go_to_the_middle();
  mj_setKeyframe(m(), d(), 0);
  std::vector<mjtNum> pads(static_cast<std::size_t>(mj_stateSize(m(), mjSTATE_PLUGIN)));
  mj_getState(m(), d(), pads.data(), mjSTATE_PLUGIN);
  const Data other = data_of(model_);
  run(m(), other.get(), 0, 100);
  mj_resetDataKeyframe(m(), other.get(), 0);
  mj_setState(m(), other.get(), pads.data(), mjSTATE_PLUGIN);
  expect_to_go_on_alike(m(), d(), other.get(), middle, rest);
}

TEST(PluginSensor, TakesTheSamplesThatTheSensorAloneWouldTake) {
  // In the air, a PapillArray of 1 kHz with noise, read at steps of 0.5 ms: every second step has a
  // new sample, the others hold it.
  const std::string sensor = "{type: papillarray, electronics: typical}";
  const Model model = load(grip_xml({.dt = 5e-4, .left = config("sensor", sensor) + config("seed", "5"), .truth = false}));
  const Data data = data_of(model);
  const PadConfig& config = pad_of(model.get(), data.get(), 0)->config();
  ContactFrame air = pad_of(model.get(), data.get(), 0)->truth(FramePart::all);
  std::vector<float> held;
  for (int round : {0, 1}) {  // the second after a reset
    const std::unique_ptr<Sensor> sensor_alone = make_sensor(config.sensor, 5, 0);
    for (int tick = 0; tick < 50; ++tick) {
      if (tick % 2 == 0) {
        air.time = 5e-4 * tick;
        const SensorFrame& frame = sensor_alone->measure(air);
        held.assign(frame.values.begin(), frame.values.end());
      }
      mj_step(model.get(), data.get());
      for (std::size_t v = 0; v < held.size(); ++v) {
        ASSERT_NEAR(data->sensordata[v], held[v], 1e-12) << "value " << v << ", step " << tick << ", round " << round;
      }
    }
    mj_resetData(model.get(), data.get());
  }
}

}  // namespace
}  // namespace slipbench::testing_plugin
