// Many simulations of one model at once: threads with an mjData each, and MuJoCo's batch API, are
// bit-identical to a loop.
#include <thread>

#include <gtest/gtest.h>
#include <mujoco/mjbatch.h>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

constexpr int sims = 6, steps = 300;

// The thread sanitizer does not see how MuJoCo's library, which is not instrumented, synchronises
// its threads.
#ifdef __SANITIZE_THREAD__
constexpr int most_threads = 1;
#else
constexpr int most_threads = 2;
#endif

// Grips from loose to tight, so that some boxes fall and others are held, with noise and effects.
Model grip_model(const std::string& integrator) {
  Model model = load(grip_xml(
      {.dt = 5e-4,
       .integrator = integrator,
       .left = config("sensor", "{type: papillarray, electronics: typical}") + config("effects", "[ageing, viscoelastic]")}));
  model->opt.gravity[2] = -g;
  return model;
}
double grip_of(int sim) { return 0.5 + 0.4 * sim; }

using Readings = std::vector<mjtNum>;

// sensordata of every step.
Readings looped(const mjModel* model, int sim) {
  const Data data(mj_makeData(model));
  data->ctrl[0] = grip_of(sim);
  Readings readings;
  for (int i = 0; i < steps; ++i) {
    mj_step(model, data.get());
    readings.insert(readings.end(), data->sensordata, data->sensordata + model->nsensordata);
  }
  return readings;
}

bool same(const Readings& a, const Readings& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(mjtNum)) == 0;
}

TEST(PluginBatch, ThreadsGiveTheBitsOfALoop) {
  const Model model = grip_model("implicitfast");
  std::vector<Readings> threaded(sims);
  std::vector<std::thread> threads;
  for (int sim = 0; sim < sims; ++sim) {
    threads.emplace_back([&, sim] { threaded[static_cast<std::size_t>(sim)] = looped(model.get(), sim); });
  }
  for (std::thread& thread : threads) thread.join();
  for (int sim = 0; sim < sims; ++sim)
    EXPECT_TRUE(same(threaded[static_cast<std::size_t>(sim)], looped(model.get(), sim))) << sim;
}

TEST(PluginBatch, BatchGivesTheBitsOfALoop) {
  for (const char* integrator : {"Euler", "implicitfast", "discrete", "RK4"}) {
    const Model model = grip_model(integrator);
    std::vector<Readings> loops;
    for (int sim = 0; sim < sims; ++sim) loops.push_back(looped(model.get(), sim));
    EXPECT_FALSE(same(loops.front(), loops.back()));
    for (int threads = 1; threads <= most_threads; ++threads) {
      for (const bool persistent : {false, true}) {
        mjBatchConfig settings;
        mjb_defaultConfig(&settings);
        settings.nthread = threads;
        settings.persistent = persistent;
        std::array<char, 1000> error{};
        const std::unique_ptr<mjBatch, decltype(&mjb_deleteBatch)> batch(
            mjb_makeBatch(model.get(), sims, &settings, error.data(), static_cast<int>(error.size())), &mjb_deleteBatch);
        ASSERT_NE(batch, nullptr) << error.data();
        int size = 0, bytes = 0;
        const auto* output = static_cast<const mjtNum*>(mjb_output(batch.get(), "sensordata", &size, &bytes));
        ASSERT_NE(output, nullptr);
        ASSERT_EQ(size, model->nsensordata);
        ASSERT_EQ(mjb_reset(batch.get(), nullptr, 0, nullptr, mjSTAGE_NONE), 0);
        int controls = 0;
        mjtNum* grip = mjb_stateComponent(batch.get(), mjSTATE_CTRL, &controls);
        ASSERT_EQ(controls, 1);
        for (int sim = 0; sim < sims; ++sim) grip[sim * mjb_nstate(batch.get())] = grip_of(sim);
        std::vector<Readings> readings(sims);
        for (int i = 0; i < steps; ++i) {
          ASSERT_EQ(mjb_step(batch.get(), nullptr, 0, 1, mjSTAGE_NONE), 0) << mjb_error(batch.get(), 0);
          for (std::size_t sim = 0; sim < sims; ++sim) {
            const mjtNum* row = output + sim * static_cast<std::size_t>(size);
            readings[sim].insert(readings[sim].end(), row, row + size);
          }
        }
        for (std::size_t sim = 0; sim < sims; ++sim) {
          EXPECT_TRUE(same(readings[sim], loops[sim]))
              << integrator << ", sim " << sim << ", " << threads << " threads, persistent " << persistent;
        }
      }
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_plugin
