// Composes HTML pages: one file each, which loads nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/dataset/record/json.h"

namespace slipbench::page {

// A file embedded in the program, which needs no data files then. slipbench_embed() of embed.cmake
// generates it.
struct Asset {
  std::string_view name;  // file name without its folder: "charts.js"
  std::string_view text;
};

// The files of tools/page/web and d3, in the order in which a page loads them.
const std::vector<Asset>& assets();

// Text of the file `name`; for a library without its pointer to a source map, which a browser would
// fetch. Throws std::logic_error if `files` lacks the name.
std::string_view embedded(const std::vector<Asset>& files, std::string_view name);

// Escapes text for the content and the quoted attributes of HTML and SVG. It may come from an
// untrusted file: control, invisible and direction characters are escaped as by printable().
std::string escape_html(std::string_view text);

// Parts of a page that depend on the command.
struct Page {
  std::string_view generator;  // identifies the page: "slipbench cost"
  std::string title;           // shown in the browser's tab
};

// Composes a page without scripts. `body`: HTML, which may contain drawings (svg.h).
std::string compose_page(const Page& page, std::string_view body);

// Composes a page that scripts draw into its element "page". `files`: its styles (.css), scripts
// (.js) and licences (.txt) in the order of loading, after the shared files such as d3 and
// common.js. Scripts find `data` as JSON in the element "slipbench-data" and the licences in
// "licences". Nothing in `data` is parsed as HTML, and bytes that are not UTF-8 become the
// replacement character. `later`: further data by id (letters, digits and "-"), each an element
// after the scripts, so that the scripts can draw before the browser has parsed it.
std::string compose_drawn_page(const Page& page, const std::vector<Asset>& files, const Json& data,
                               const std::vector<std::pair<std::string, Json>>& later = {});

// True if a file that begins with `text` is a page of that generator.
bool begins_as_page(std::string_view text, std::string_view generator);

// A kind of page with the object that it shows: FILE.html, with FILE.json.
struct PageKind {
  std::string_view what;                 // in "-o r.txt: WHAT is a page with its figures beside it": "a result"
  std::string_view generator;            // generator of the page
  std::string_view page, json;           // names in messages: "page of slipbench eval", "result of slipbench eval"
  std::array<std::string_view, 2> keys;  // possible first keys of the object
};

// Path of the JSON file: FILE.json for FILE.html.
std::string json_path(const std::string& html_path);

// True if a file that begins with `text` holds an object of that kind.
bool begins_as_object(std::string_view text, const PageKind& kind);

// Throws InputError if `html_path` does not end in .html, or if either file cannot be written or
// exists with content of another kind.
void check_page_files(const std::string& html_path, const PageKind& kind);

// Writes both files, each under a temporary name that is then renamed; returns their names. Throws
// InputError as check_page_files() does, before anything is written, and if writing fails. Bytes in
// `object` that are not UTF-8 become the replacement character.
std::vector<std::string> write_page_files(const std::string& html_path, const PageKind& kind, const std::string& page,
                                          const Json& object);

// A table of texts; the first column holds names.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows = {};  // each as long as the head
};
// The table as <table>.
std::string table_html(const TextTable& table);

// The texts as <ul>.
std::string list_html(const std::vector<std::string>& items);

// Head of a page without scripts: the command's name, the title, notes and, if not empty, the
// command as code.
std::string head_html(std::string_view generator, const std::string& title, const std::vector<std::string>& notes,
                      const std::string& command = "");
// A section of HTML with its title and a note, which may be empty.
std::string section_html(const std::string& title, const std::string& note, const std::string& content);

// Compact encodings of arrays for pages.

// Standard base64 (RFC 4648) with padding.
std::string base64(std::span<const std::uint8_t> bytes);

// Packs `values` [rows, columns] (C order) for tools/report/web/data.js: column-major; each
// value as a 16 bit multiple of a step that is 1/32767 of the largest magnitude; differences along
// a column; low bytes, then high bytes; zlib; base64. Non-finite values become NaN. Keeps every
// `stride`-th row, from row 0.
// Returns {"codec": "delta16", "rows", "columns", "step", "data"}.
Json pack_curves(std::span<const float> values, std::size_t columns, std::size_t stride);

// Packs bytes [rows, columns] without loss, column-major. Returns {"codec": "bytes", "rows",
// "columns", "data"}.
Json pack_bytes(std::span<const std::uint8_t> values, std::size_t columns);

// Packs finite times [s] as signed 32 bit multiples of a step: 1 us up to 2147 s, for longer times
// the finest step that covers them.
// Returns {"codec": "delta32", "rows", "columns": 1, "step", "data"}.
Json pack_times(std::span<const double> times);

}  // namespace slipbench::page
