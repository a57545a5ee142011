// The HTML page around the data.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/program/report/assets.h"
#include "tools/program/report/json.h"

namespace slipbench::report {

// Text made safe for HTML content and quoted attributes.
std::string escape_html(const std::string& text);

// JSON as the content of a <script> element, which nothing in it can end: '<' and everything beyond ASCII is written as an escape.
std::string script_json(const Json& data);

// The text of the file `name`, of a library without its pointer to a source map, which a browser would fetch. Throws std::logic_error where
// `files` has none of that name.
std::string_view embedded(const std::vector<Asset>& files, std::string_view name);

// What a page has in place of {{marker}}.
struct PagePart {
  std::string_view marker;
  std::string text;
};

// `html` with its markers replaced, in one pass: no inserted text is searched again. Throws std::logic_error at a marker without its part.
std::string fill_page(std::string_view html, const std::vector<PagePart>& parts);

// The page web/report.html with styles, libraries, scripts and `data` put in. The scripts that draw a grasp are in it where `data` has
// "grasps".
std::string compose_page(const std::string& title, const Json& data);

// Whether a file that begins so is such a page.
bool begins_as_page(std::string_view text);

}  // namespace slipbench::report
