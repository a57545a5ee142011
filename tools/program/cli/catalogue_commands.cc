#include "tools/program/cli/catalogue_commands.h"

#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/describe.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {

void ListCommand::declare(Arguments& arguments) {
  arguments.about("list", "List what a scene may name", R"(
Examples:
  slipbench list
  slipbench list effects)");
  arguments.text(
      "CATALOGUE", catalogue,
      "effects, sensors, surfaces, bodies, materials, motions, electronics, grasp, contact, detectors, controllers or expectations (default: all)");
}

int ListCommand::run() {
  const std::vector<CatalogueItem> items = catalogue_items(program_catalogues());
  std::vector<CatalogueKind> kinds(catalogue_kinds().begin(), catalogue_kinds().end());
  if (!catalogue.empty()) kinds = {find_kind(catalogue)};
  if (json) {
    fmt::print("{}\n", list_json(items, kinds).dump());
  } else {
    fmt::print("{}", list_text(items, kinds, style_for(stdout), terminal_width(stdout)));
  }
  return exit_good;
}

void DescribeCommand::declare(Arguments& arguments) {
  arguments.about("describe", "Explain one name: parameters, units, defaults, law, source", R"(
Generated from the declarations that the scene parser reads.

Examples:
  slipbench describe papillarray
  slipbench describe stage
  slipbench describe acrylic --json)");
  arguments.text("NAME", name, "A name that `slipbench list` shows").required();
}

int DescribeCommand::run() {
  const Catalogues catalogues = program_catalogues();
  const std::vector<CatalogueItem> found = find_items(catalogue_items(catalogues), name);
  if (json) {
    nlohmann::ordered_json entries = nlohmann::ordered_json::array();
    for (const CatalogueItem& item : found) entries.push_back(describe_json(item, catalogues));
    fmt::print("{}\n", nlohmann::ordered_json{{"name", name}, {"entries", entries}}.dump());
    return exit_good;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    fmt::print("{}{}", i == 0 ? "" : "\n", describe_text(found[i], catalogues, style_for(stdout), terminal_width(stdout)));
  }
  return exit_good;
}

}  // namespace slipbench
