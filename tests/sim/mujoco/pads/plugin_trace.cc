// plugin_trace LIBRARY MODEL INTEGRATOR STEPS OUT: a C host that loads the plugin's library, steps
// the model under the control of plugin_python_test.py and writes the sensordata of every step.
#include <cstdio>
#include <cstdlib>

#include <mujoco/mujoco.h>

int main(int /*argc*/, char** argv) {
  mj_loadPluginLibrary(argv[1]);
  char error[1000] = "";
  mjModel* model = mj_loadXML(argv[2], nullptr, error, sizeof error);
  if (model == nullptr) {
    std::fprintf(stderr, "%s\n", error);
    return 1;
  }
  model->opt.integrator = std::atoi(argv[3]);
  mjData* data = mj_makeData(model);
  std::FILE* out = std::fopen(argv[5], "wb");
  for (int tick = 0; tick < std::atoi(argv[4]); ++tick) {
    const int phase = tick % 400;
    data->ctrl[0] = 0.4 + 0.01 * (phase < 200 ? phase : 400 - phase);
    mj_step(model, data);
    std::fwrite(data->sensordata, sizeof(mjtNum), static_cast<std::size_t>(model->nsensordata), out);
  }
  std::fclose(out);
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
