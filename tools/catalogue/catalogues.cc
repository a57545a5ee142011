#include "tools/catalogue/catalogues.h"

#include "tools/catalogue/controllers.h"
#include "tools/catalogue/detectors.h"
#include "tools/catalogue/expectations.h"
#include "tools/catalogue/sensors.h"

namespace slipbench {

Catalogues program_catalogues() {
  Catalogues catalogues = pad_catalogues();
  catalogues.detectors = detector_entries();
  catalogues.controllers = controller_entries();
  catalogues.expectations = expectation_entries();
  return catalogues;
}

}  // namespace slipbench
