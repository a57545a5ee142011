// libslipbench_mujoco.so: what mj_loadPluginLibrary loads.
#include "sim/mujoco/register_plugin.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench {
namespace {

[[gnu::constructor]] void register_on_load() { register_field_plugin({pad_catalogues(), &make_sensor}); }

}  // namespace
}  // namespace slipbench
