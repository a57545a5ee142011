#include "tools/program/report/report_page.h"

#include "tools/base/page/page.h"
#include "tools/program/report/assets.h"

namespace slipbench::report {

namespace {

constexpr std::string_view generator = "slipbench";

}  // namespace

std::string report_page(const std::string& title, const Json& data, const std::vector<std::pair<std::string, Json>>& recordings) {
  std::vector<page::Asset> files = assets();
  if (!data.contains("grasps")) std::erase_if(files, [](const page::Asset& file) { return file.name.starts_with("grasp_"); });
  return page::compose_drawn_page({generator, title + " · slipbench report"}, files, data, recordings);
}

bool begins_as_report(std::string_view text) { return page::begins_as_page(text, generator); }

}  // namespace slipbench::report
