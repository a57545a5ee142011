// The page of `slipbench calibrate`.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"
#include "tools/program/calibrate/calibrate.h"

namespace slipbench::calibrate {

// One HTML page without scripts of a result (calibrate.h): parameters, profiles, residuals, real beside synthetic.
std::string calibration_page(const Json& result);

// Throws InputError when `path` does not end in .yaml, or it, FILE.html or FILE.json beside it cannot be written or holds something else, or is
// one of the `inputs`.
void check_calibration_target(const std::string& path, const std::vector<std::string>& inputs);
// Writes the fitted scene, and FILE.html and FILE.json beside it; returns their names. Throws as check_calibration_target().
std::vector<std::string> write_calibration(const std::string& path, const std::string& fitted, const Json& result);

}  // namespace slipbench::calibrate
