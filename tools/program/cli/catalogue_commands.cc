#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/describe.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/doctor/build_info.h"

namespace slipbench {

int list_command(const Options& options) {
  const std::vector<CatalogueItem> items = catalogue_items(program_catalogues());
  std::vector<CatalogueKind> kinds(catalogue_kinds().begin(), catalogue_kinds().end());
  if (!options.name.empty()) kinds = {find_kind(options.name)};
  if (options.json) {
    fmt::print("{}\n", list_json(items, kinds).dump());
  } else {
    fmt::print("{}", list_text(items, kinds, style_for(stdout), terminal_width(stdout)));
  }
  return exit_good;
}

int describe_command(const Options& options) {
  const Catalogues catalogues = program_catalogues();
  const std::vector<CatalogueItem> found = find_items(catalogue_items(catalogues), options.name);
  if (options.json) {
    nlohmann::ordered_json entries = nlohmann::ordered_json::array();
    for (const CatalogueItem& item : found) entries.push_back(describe_json(item, catalogues));
    fmt::print("{}\n", nlohmann::ordered_json{{"name", options.name}, {"entries", entries}}.dump());
    return exit_good;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    fmt::print("{}{}", i == 0 ? "" : "\n", describe_text(found[i], catalogues, style_for(stdout), terminal_width(stdout)));
  }
  return exit_good;
}

int version_command(const Options& options) {
  const BuildInfo& info = build_info();
  if (options.json) {
    fmt::print(
        "{}\n",
        nlohmann::ordered_json{
            {"version", info.version}, {"commit", info.commit}, {"compiler", info.compiler}, {"build_type", info.build_type}}
            .dump());
  } else {
    fmt::print("slipbench {} (commit {}, {}, {})\n", info.version, info.commit, info.compiler, info.build_type);
  }
  return exit_good;
}

}  // namespace slipbench
