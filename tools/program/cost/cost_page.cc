#include "tools/program/cost/cost_page.h"

#include <algorithm>
#include <stdexcept>

namespace slipbench::cost {
namespace {

// What the browser's tab says.
std::string title_of(const Json& result) {
  return result.contains("scene") ? result.at("scene").get<std::string>() : "stability";
}

}  // namespace

std::string cost_page(const Json& result) {
  if (!result.is_object() || result.empty() || std::ranges::find(page_kind.keys, result.begin().key()) == page_kind.keys.end()) {
    throw std::logic_error("the result of a cost exploration begins with its kind");
  }
  return page::compose_drawn_page({page_kind.generator, title_of(result) + " · slipbench cost"}, assets(), result);
}

}  // namespace slipbench::cost
