#include "tools/program/cost/cost_page.h"

#include <stdexcept>

#include "tools/program/cost/assets.h"
#include "tools/program/report/page.h"
#include "tools/program/report/page_files.h"

namespace slipbench::cost {

namespace {

constexpr std::string_view exploration_key = "slipbench_cost", stability_key = "slipbench_stability";

constexpr report::PageKind page_kind{
    "an exploration", {"page of slipbench cost", &begins_as_cost_page}, {"result of slipbench cost", &begins_as_cost_json}};

// Libraries and shared scripts come from the report's files; our own follow them.
std::string joined(const std::vector<std::string_view>& shared, std::string_view extension) {
  std::string text;
  for (const std::string_view name : shared) text.append(report::embedded(report::assets(), name)) += '\n';
  for (const report::Asset& file : assets()) {
    if (file.name.ends_with(extension)) text.append(file.text) += '\n';
  }
  return text;
}

// What the browser's tab says.
std::string title_of(const Json& result) {
  return result.contains("scene") ? result.at("scene").get<std::string>() : "stability";
}

}  // namespace

bool begins_as_cost_page(std::string_view text) {
  return text.starts_with("<!DOCTYPE html>") &&
         text.find(R"(<meta name="generator" content="slipbench cost">)") != std::string_view::npos;
}

bool begins_as_cost_json(std::string_view text) {
  const auto begins = [&](std::string_view key) { return text.starts_with("{\n  \"" + std::string(key) + "\": "); };
  return begins(exploration_key) || begins(stability_key);
}

std::string cost_page(const Json& result) {
  if (!result.is_object() || result.empty() ||
      (result.begin().key() != exploration_key && result.begin().key() != stability_key)) {
    throw std::logic_error("the result of a cost exploration begins with its kind");
  }
  return report::fill_page(report::embedded(assets(), "cost.html"), {{"title", report::escape_html(title_of(result))},
                                                                     {"styles", joined({"report.css"}, ".css")},
                                                                     {"scripts", joined({"d3.min.js", "common.js"}, ".js")},
                                                                     {"licences", joined({"d3_licence.txt"}, ".txt")},
                                                                     {"data", report::script_json(result)}});
}

void check_cost_target(const std::string& html_path) { report::check_page_files(html_path, page_kind); }

std::vector<std::string> write_cost(const std::string& html_path, const Json& result) {
  return report::write_page_files(html_path, page_kind, cost_page(result), result);
}

}  // namespace slipbench::cost
