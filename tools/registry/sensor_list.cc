#include "tools/registry/sensor_list.h"

namespace slipbench {

// Each is defined in the folder of its sensor; plugin_sensor() in sensors/plugins.
SensorKind papillarray_sensor();
SensorKind nib_pad_sensor();
SensorKind piezo_skin_sensor();
SensorKind biotac_sp_sensor();
SensorKind biotac_19_sensor();
SensorKind myrmex_sensor();
SensorKind taxels_sensor();
SensorKind gel_markers_sensor();
SensorKind magnetic_skin_sensor();
SensorKind plugin_sensor();

const std::vector<SensorKind>& sensor_catalogue() {
  static const std::vector<SensorKind> kinds{
      papillarray_sensor(), nib_pad_sensor(), piezo_skin_sensor(),  biotac_sp_sensor(),     biotac_19_sensor(),
      myrmex_sensor(),      taxels_sensor(),  gel_markers_sensor(), magnetic_skin_sensor(), plugin_sensor(),
  };
  return kinds;
}

}  // namespace slipbench
