#include "tools/program/cost/cost_page.h"

#include <stdexcept>

#include "tools/base/page/page.h"
#include "tools/base/page/page_files.h"
#include "tools/program/cost/assets.h"

namespace slipbench::cost {

namespace {

constexpr std::string_view exploration_key = "slipbench_cost", stability_key = "slipbench_stability";

constexpr std::string_view generator = "slipbench cost";

constexpr page::PageKind page_kind{
    "an exploration", {"page of slipbench cost", &begins_as_cost_page}, {"result of slipbench cost", &begins_as_cost_json}};

// What the browser's tab says.
std::string title_of(const Json& result) {
  return result.contains("scene") ? result.at("scene").get<std::string>() : "stability";
}

}  // namespace

bool begins_as_cost_page(std::string_view text) { return page::begins_as_page(text, generator); }

bool begins_as_cost_json(std::string_view text) {
  const auto begins = [&](std::string_view key) { return text.starts_with("{\n  \"" + std::string(key) + "\": "); };
  return begins(exploration_key) || begins(stability_key);
}

std::string cost_page(const Json& result) {
  if (!result.is_object() || result.empty() ||
      (result.begin().key() != exploration_key && result.begin().key() != stability_key)) {
    throw std::logic_error("the result of a cost exploration begins with its kind");
  }
  return page::compose_drawn_page({generator, title_of(result) + " · slipbench cost"}, assets(), result);
}

void check_cost_target(const std::string& html_path) { page::check_page_files(html_path, page_kind); }

std::vector<std::string> write_cost(const std::string& html_path, const Json& result) {
  return page::write_page_files(html_path, page_kind, cost_page(result), result);
}

}  // namespace slipbench::cost
