#include "tools/base/page/page_files.h"

#include <filesystem>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench::page {

std::string json_path(const std::string& html_path) {
  return std::filesystem::path(html_path).replace_extension(".json").string();
}

void check_page_files(const std::string& html_path, const PageKind& kind) {
  if (!html_path.ends_with(".html")) {
    throw InputError(
        fmt::format("-o {}: {} is a page with its figures beside it; allowed: a name that ends in .html", html_path, kind.what));
  }
  check_text_target(html_path, {}, kind.page);
  check_text_target(json_path(html_path), {}, kind.json);
}

std::vector<std::string> write_page_files(const std::string& html_path, const PageKind& kind, const std::string& page,
                                          const Json& object) {
  check_page_files(html_path, kind);
  write_text_file(html_path, page);
  write_text_file(json_path(html_path), object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  return {html_path, json_path(html_path)};
}

}  // namespace slipbench::page
