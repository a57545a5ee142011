// The HTML page around the data.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::report {

// One HTML page that needs no other file. The scripts that draw a grasp are in it where `data` has "grasps". `recordings`: by the ids of their
// elements, "recording-17".
std::string report_page(const std::string& title, const Json& data,
                        const std::vector<std::pair<std::string, Json>>& recordings = {});

// Whether a file that begins so is such a page.
bool begins_as_report(std::string_view text);

}  // namespace slipbench::report
