// The HTML page around what a command shows: one file, which loads nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/base/record/json.h"

namespace slipbench::page {

// Files as bytes inside the program, which so needs none beside it. slipbench_embed() of embed.cmake makes them.
struct Asset {
  std::string_view name;  // file name without its folder: "charts.js"
  std::string_view text;
};

// The files of tools/base/page/web and d3, in the order in which a page loads them.
const std::vector<Asset>& assets();

// The text of the file `name`, of a library without its pointer to a source map, which a browser would fetch. Throws std::logic_error where
// `files` has none of that name.
std::string_view embedded(const std::vector<Asset>& files, std::string_view name);

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

// A kind of page with the object that it shows: FILE.html, and FILE.json beside it.
struct PageKind {
  std::string_view what;                 // in "-o r.txt: WHAT is a page with its figures beside it": "a result"
  std::string_view generator;            // of the page
  std::string_view page, json;           // what messages call either file: "page of slipbench eval", "result of slipbench eval"
  std::array<std::string_view, 2> keys;  // the object's first key is one of these
};

// FILE.json of FILE.html.
std::string json_path(const std::string& html_path);

// Whether a file that begins so holds such an object.
bool begins_as_object(std::string_view text, const PageKind& kind);

// Throws InputError when `html_path` does not end in .html, or when either file cannot be put there or holds something of another kind.
void check_page_files(const std::string& html_path, const PageKind& kind);

// Writes both, each under a temporary name that is then renamed; returns their names. Throws InputError as check_page_files() does, before
// anything is written, and when writing fails. Bytes in `object` that are no UTF-8 become the replacement character.
std::vector<std::string> write_page_files(const std::string& html_path, const PageKind& kind, const std::string& page,
                                          const Json& object);

// A table of texts, names on the left.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows = {};  // as many cells as the head has
};
// It as <table>.
std::string table_html(const TextTable& table);

// <ul> of texts.
std::string list_html(const std::vector<std::string>& items);

// What a page without scripts begins with: the command's name, its title, notes and, where there is one, the command as code.
std::string head_html(std::string_view generator, const std::string& title, const std::vector<std::string>& notes,
                      const std::string& command = "");
// A section of HTML below its title and what there is to know of it, "" for nothing.
std::string section_html(const std::string& title, const std::string& note, const std::string& content);

// Arrays made small enough to sit inside a page.

// Standard base64 (RFC 4648) with padding.
std::string base64(std::span<const std::uint8_t> bytes);

// Packs `values` [rows, columns] (C order) for tools/program/report/web/data.js: column-major; each value as a 16 bit multiple of a step that is
// 1/32767 of the largest magnitude; differences along a column; low bytes, then high bytes; zlib; base64. A value that is not
// finite becomes NaN. Only every `stride`-th row is kept, from row 0.
// Returns {"codec": "delta16", "rows", "columns", "step", "data"}.
Json pack_curves(std::span<const float> values, std::size_t columns, std::size_t stride);

// Packs bytes [rows, columns] without loss, column-major. Returns {"codec": "bytes", "rows", "columns", "data"}.
Json pack_bytes(std::span<const std::uint8_t> values, std::size_t columns);

// Packs finite times [s] as signed 32 bit multiples of a step: 1 us up to 2147 s, for longer times the finest that reaches them.
// Returns {"codec": "delta32", "rows", "columns": 1, "step", "data"}.
Json pack_times(std::span<const double> times);

}  // namespace slipbench::page
