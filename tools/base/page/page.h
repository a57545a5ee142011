// The HTML page around what a command shows: one file, which loads nothing.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/base/page/asset.h"
#include "tools/base/page/json.h"

namespace slipbench::page {

// Text made safe for the content and the quoted attributes of HTML and SVG.
std::string escape_html(std::string_view text);

// What the page of one command has of its own.
struct Page {
  std::string_view generator;  // by which the page is known again: "slipbench cost"
  std::string title;           // in the browser's tab
};

// A page that needs no script. `body`: HTML. It may hold drawings (svg.h).
std::string compose_page(const Page& page, std::string_view body);

// A page that scripts draw into its element "page". `files`: its styles (.css), scripts (.js) and licences (.txt) in the order in which they are
// loaded; they follow the kit's, d3 and common.js among them. Scripts find `data` as JSON in the element "slipbench-data" and the
// licences in "licences". Nothing in `data` is read as HTML, and bytes that are no UTF-8 become the replacement character.
// `later`: further data by names of letters, digits and "-", each an element of that id, after the scripts: these run and draw what they can before it has
// been read.
std::string compose_drawn_page(const Page& page, const std::vector<Asset>& files, const Json& data,
                               const std::vector<std::pair<std::string, Json>>& later = {});

// Whether a file that begins so is a page of that generator.
bool begins_as_page(std::string_view text, std::string_view generator);

// <table> with one row of heads, names on the left. All cells are text.
std::string table_html(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

// <ul> of texts.
std::string list_html(const std::vector<std::string>& items);

// What a page without scripts begins with: the command's name, its title, notes and, where there is one, the command as code.
std::string head_html(std::string_view generator, const std::string& title, const std::vector<std::string>& notes,
                      const std::string& command = "");
// A section of HTML below its title and what there is to know of it, "" for nothing.
std::string section_html(const std::string& title, const std::string& note, const std::string& content);

}  // namespace slipbench::page
