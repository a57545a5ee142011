// The page of `slipbench calibrate`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::calibrate {

// One HTML page without scripts of a result (calibrate.h): parameters, profiles, residuals, real beside synthetic.
std::string calibration_page(const Json& result);

// Whether a file that begins so is such a page, such a result, or a scene that was fitted.
bool begins_as_calibration_page(std::string_view text);
bool begins_as_calibration_json(std::string_view text);
bool begins_as_fitted_scene(std::string_view text);

// Throws InputError when `path` does not end in .yaml, or it, FILE.html or FILE.json beside it cannot be written or holds something else, or is
// one of the `inputs`.
void check_calibration_target(const std::string& path, const std::vector<std::string>& inputs);
// Writes the fitted scene, and FILE.html and FILE.json beside it; returns their names. Throws as check_calibration_target().
std::vector<std::string> write_calibration(const std::string& path, const std::string& fitted, const Json& result);

}  // namespace slipbench::calibrate
