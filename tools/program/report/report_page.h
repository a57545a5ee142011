// The HTML page around the data.
#pragma once

#include <string>
#include <string_view>

#include "tools/base/page/json.h"

namespace slipbench::report {

// One HTML page that needs no other file. The scripts that draw a grasp are in it where `data` has "grasps".
std::string report_page(const std::string& title, const Json& data);

// Whether a file that begins so is such a page.
bool begins_as_report(std::string_view text);

}  // namespace slipbench::report
