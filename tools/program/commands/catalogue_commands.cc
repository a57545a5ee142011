#include "tools/program/commands/dataset_commands.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "tools/base/record/json.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/doctor/doctor.h"
#include "tools/program/plugin/plugin_builds.h"
#include "tools/program/text/describe.h"

namespace slipbench {

void ListCommand::declare(Arguments& arguments) {
  arguments.about("list", "List what a scene may name, and recipes", R"(
Examples:
  slipbench list
  slipbench list effects
  slipbench list recipes)");
  arguments.text(
      "CATALOGUE", catalogue,
      "effects, sensors, surfaces, bodies, materials, motions, electronics, grasp, contact, detectors, controllers, expectations or recipes (default: all)");
}

int ListCommand::run() {
  const std::vector<CatalogueItem> items = catalogue_items(program_catalogues());
  std::vector<CatalogueKind> kinds;
  if (catalogue.empty()) kinds.assign(catalogue_kinds().begin(), catalogue_kinds().end());
  const bool recipes = catalogue.empty() || catalogue == "recipes";
  if (!recipes) kinds = {find_kind(catalogue)};
  if (json) {
    Json lists = list_json(items, kinds);
    if (recipes) lists["recipes"] = recipe_list_json();
    return print_json(lists);
  }
  const Style style = style_for(stdout);
  const std::size_t width = terminal_width(stdout);
  fmt::print("{}{}{}", list_text(items, kinds, style, width), kinds.empty() || !recipes ? "" : "\n",
             recipes ? recipe_list_text(style, width) : "");
  return exit_good;
}

void DescribeCommand::declare(Arguments& arguments) {
  arguments.about("describe", "Explain one name: parameters, units, defaults, law, source", R"(
Generated from the declarations that the scene parser reads.

Examples:
  slipbench describe papillarray
  slipbench describe stage
  slipbench describe acrylic --json
  slipbench describe piezo_fft_gru)");
  arguments.text("NAME", name, "A name that `slipbench list` shows").required();
}

int DescribeCommand::run() {
  const Catalogues catalogues = program_catalogues();
  const auto recipe = std::ranges::find(train::recipes(), name, &train::Recipe::name);
  const bool is_recipe = recipe != train::recipes().end();
  std::vector<CatalogueItem> found;
  if (!is_recipe) found = find_items(catalogue_items(catalogues), name, recipe_names());
  if (json) {
    Json entries = Json::array();
    for (const CatalogueItem& item : found) entries.push_back(describe_json(item, catalogues));
    if (is_recipe) entries.push_back(recipe_json(*recipe));
    return print_json({{"name", name}, {"entries", entries}});
  }
  const Style style = style_for(stdout);
  for (std::size_t i = 0; i < found.size(); ++i)
    fmt::print("{}{}", i == 0 ? "" : "\n", describe_text(found[i], catalogues, style, terminal_width(stdout)));
  if (is_recipe) fmt::print("{}", recipe_text(*recipe, style, terminal_width(stdout)));
  return exit_good;
}

void DoctorCommand::declare(Arguments& arguments) {
  arguments.about("doctor", "Check the installation", R"(
Exit status 0 when everything required is there, 1 otherwise, with the command that installs it.)");
}

int DoctorCommand::run() {
  take_stdout_back();
  return doctor_main(json);
}

void PluginPathCommand::declare(Arguments& arguments) {
  arguments.about("plugin-path", "Print where the MuJoCo plugin is", R"(
For `mj_loadPluginLibrary`: the library looks which MuJoCo loads it, and takes the build for that version. With --mujoco: the build for one version.
scenes/mujoco/README.md shows what the plugin is for.)");
  arguments.text("--mujoco VERSION", mujoco, "The build for this version of MuJoCo, such as 3.3.7");
}

int PluginPathCommand::run() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path front = own_path(SLIPBENCH_PLUGIN);
  if (!fs::exists(front, error)) {
    throw InputError(fmt::format(
        "there is no MuJoCo plugin {}: `./slipbench plugin-path` builds it where there is MuJoCo; `slipbench doctor` says how to get that",
        front.string()));
  }
  const std::string build = mujoco.empty() ? front.filename().string() : plugin_build(mujoco);
  if (build.empty()) {
    throw InputError(fmt::format("--mujoco {}: there is no build of the plugin for MuJoCo {}; allowed: {}", mujoco, mujoco,
                                 plugin_versions_text(mujoco)));
  }
  const fs::path path = fs::canonical(front.parent_path() / build);
  if (json) return print_json({{"plugin", path.string()}});
  fmt::print("{}\n", path.string());
  return exit_good;
}

}  // namespace slipbench
