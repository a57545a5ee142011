// Output of a fit: the parameters as a table, an HTML page, and the files.
#pragma once

#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::calibrate {

// Returns the parameters as the page and a terminal show them, and the size of the residuals in
// words.
page::TextTable parameter_table(const Json& result);
std::string residual_text(const Json& result);

// Returns a result as an HTML page without scripts: parameters, profiles, residuals, real and
// synthetic curves.
std::string calibration_page(const Json& result);

// Throws InputError if `path` does not end in .yaml, or if it, or FILE.html or FILE.json next to
// it, cannot be written, holds something else, or is one of the `inputs`.
void check_calibration_target(const std::string& path, const std::vector<std::string>& inputs);
// Writes the fitted scene, and FILE.html and FILE.json next to it. Returns their names. Throws as
// check_calibration_target().
std::vector<std::string> write_calibration(const std::string& path, const std::string& fitted, const Json& result);

}  // namespace slipbench::calibrate
