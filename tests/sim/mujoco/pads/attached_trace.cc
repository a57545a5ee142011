// attached_trace LIBRARY MODEL SOLVER: attaches the pads of hold.xml to the model by C++, steps it
// for a second under 4 N and writes nexclude, ntendon, nsite, nplugin, npluginstate, nsensordata as
// int32 and then the sensordata to stdout.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include <mujoco/mujoco.h>

#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/attach_pad.h"

int main(int /*count*/, char** words) {
  mj_loadPluginLibrary(words[1]);
  std::array<char, 500> error{};
  const slipbench::SpecPointer spec(mj_parseXML(words[2], nullptr, error.data(), static_cast<int>(error.size())));
  for (const char* site : {"left_pad", "right_pad"}) {
    slipbench::attach_pad(spec.get(), site, {"box"}, {.friction = "0.5", .solver = words[3], .damping = 0.5e-3});
  }
  const slipbench::ModelPointer model(mj_compile(spec.get(), nullptr));
  const slipbench::DataPointer data(mj_makeData(model.get()));
  mju_fill(data->ctrl, 4.0, static_cast<int>(model->nu));
  const auto steps = static_cast<int>(std::ceil(1.0 / model->opt.timestep - 1e-6));
  for (int k = 0; k < steps; ++k) mj_step(model.get(), data.get());
  for (const auto size :
       {model->nexclude, model->ntendon, model->nsite, model->nplugin, model->npluginstate, model->nsensordata}) {
    const auto written = static_cast<std::int32_t>(size);
    std::fwrite(&written, sizeof written, 1, stdout);
  }
  std::fwrite(data->sensordata, sizeof(mjtNum), static_cast<std::size_t>(model->nsensordata), stdout);
}
