#include "tools/catalogue/catalogues.h"

#include "tools/catalogue/detectors.h"
#include "tools/catalogue/sensors.h"

namespace slipbench {

Catalogues program_catalogues() {
  Catalogues catalogues = pad_catalogues();
  catalogues.detectors = detector_entries();
  return catalogues;
}

}  // namespace slipbench
