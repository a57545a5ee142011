// The HTML page around the data.
#pragma once

#include <string>
#include <string_view>

#include "tools/report/json.h"

namespace slipbench::report {

// Text made safe for HTML content and quoted attributes.
std::string escape_html(const std::string& text);

// The page web/report.html with styles, libraries, scripts and `data` put in. Nothing in `data` can end its element: '<' and
// everything beyond ASCII is written as an escape. The scripts that draw a grasp are in it where `data` has "grasps".
std::string compose_page(const std::string& title, const Json& data);

// Whether a file that begins so is such a page.
bool begins_as_page(std::string_view text);

}  // namespace slipbench::report
