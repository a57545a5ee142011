// A pad on a foreign model: attach LIBRARY. Exit status 0: the pad carries the load on it.
#include <cmath>

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/attach_pad.h"

int main(int /*count*/, char** words) {
  mj_loadPluginLibrary(words[1]);
  char error[500] = "";
  mjSpec* spec = mj_parseXMLString(
      "<mujoco><option timestep='0.0005'/><worldbody><geom name='plate' type='plane' size='1 1 1'/><body name='foot' pos='0 0 1e-4'>"
      "<joint type='slide' axis='0 0 1' damping='20'/><geom size='0.01' pos='0 0 0.02' mass='0.1'/><site name='sole'/></body></worldbody></mujoco>",
      nullptr, error, sizeof error);
  slipbench::attach_pad(spec, "sole", {"plate"}, {.pad = "[[0, 0, 0, 1000, 200]]", .truth = false});
  for (mjsElement* geom = mjs_firstElement(spec, mjOBJ_GEOM); geom != nullptr; geom = mjs_nextElement(spec, geom)) {
    mjs_asGeom(geom)->contype = mjs_asGeom(geom)->conaffinity = 0;
  }
  mjModel* model = mj_compile(spec, nullptr);
  if (model == nullptr) return 2;
  mjData* data = mj_makeData(model);
  for (int k = 0; k < 4000; ++k) mj_step(model, data);
  // Its force [N] is the weight of 0.1 kg.
  return std::abs(data->sensordata[2] - 0.1 * 9.81) < 1e-6 ? 0 : 1;
}
