#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/program/cli/commands.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/export/export.h"
#include "tools/program/report/report.h"

namespace slipbench {

int report_command(const Options& options) {
  const std::string page =
      options.output.empty() ? std::filesystem::path(options.dataset).replace_extension(".html").string() : options.output;
  ReportOptions report;
  report.trial = options.trial;
  write_report(options.dataset, page, report);
  if (options.json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"report", page}}.dump());
  } else {
    fmt::print("{} {}\n{} open it in a browser\n", style_for(stdout).good("written:"), page, style_for(stdout).dim("next:"));
  }
  return exit_good;
}

int export_command(const Options& options) {
  ExportOptions exporting;
  exporting.format = options.format;
  exporting.slip_rule = options.slip_rule;
  exporting.label_speed = options.label_speed;
  exporting.sensor = options.sensor;
  exporting.trial = options.trial;
  exporting.rate = options.rate;
  const std::vector<std::string> files = export_dataset(options.dataset, options.output, exporting);
  if (options.json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"files", files}}.dump());
  } else {
    for (const std::string& file : files) fmt::print("{} {}\n", style_for(stdout).good("written:"), file);
  }
  return exit_good;
}

}  // namespace slipbench
