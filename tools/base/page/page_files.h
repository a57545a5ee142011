// A page and the object that it shows: FILE.html, and FILE.json beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/files/output_file.h"
#include "tools/base/page/json.h"

namespace slipbench::page {

// A kind of page that stands beside its object, and how files of both are told from the files of others.
struct PageKind {
  std::string_view what;  // in "-o r.txt: WHAT is a page with its figures beside it": "a result"
  TextKind page, json;
};

// FILE.json of FILE.html.
std::string json_path(const std::string& html_path);

// Throws InputError when `html_path` does not end in .html, or when either file cannot be put there or holds something of another kind.
void check_page_files(const std::string& html_path, const PageKind& kind);

// Writes both, each under a temporary name that is then renamed; returns their names. Throws InputError as check_page_files() does, before
// anything is written, and when writing fails. Bytes in `object` that are no UTF-8 become the replacement character.
std::vector<std::string> write_page_files(const std::string& html_path, const PageKind& kind, const std::string& page,
                                          const Json& object);

}  // namespace slipbench::page
