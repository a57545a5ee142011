#include "tools/program/catalogue/program_catalogues.h"

#include "tools/program/catalogue/controller_catalogue.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/catalogue/expectation_catalogue.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench {

Catalogues program_catalogues() {
  Catalogues catalogues = pad_catalogues();
  catalogues.detectors = detector_entries();
  catalogues.controllers = controller_entries();
  catalogues.expectations = expectation_entries();
  return catalogues;
}

}  // namespace slipbench
