// A dataset turned into one HTML file that a person opens in a browser, without a network and without the program.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/base/page/page.h"

namespace slipbench {

struct ReportOptions {
  std::optional<std::size_t> trial;  // trial (k of demo_<k>) to open the page on; empty: the overview, or the only trial
  // Trials whose curves are embedded at most, spread over the file; at least 1. Empty: all, or as many as 19 MB have room for with 24 rows a
  // curve. Where there is no room for every sample, curves are thinned, but those of `trial`.
  std::optional<std::size_t> max_trials = {};
  // Trials in the overview, at most, spread likewise; the page says how many there are. Those with curves come on top. A trial takes 400 bytes or more.
  std::size_t max_rows = 20'000;
};

// Throws InputError when `html_path` cannot be written or holds anything but a report.
void check_report_target(const std::string& html_path, const std::string& dataset_path);

// Reads the dataset at `dataset_path` (HDF5, tools/base/dataset), after slipbench-reader (checked_dataset.h), and writes the page to
// `html_path`, under a temporary name first. Trials of any length are shown.
// Throws InputError when the dataset cannot be read, is damaged (its content_sha256 is checked), misses something, has no trial
// `options.trial`, or when the page cannot be written or would replace anything but a report.
void write_report(const std::string& dataset_path, const std::string& html_path, const ReportOptions& options = {});

namespace report {

// The files of web/, in the order in which the page loads them. Written by slipbench_embed().
const std::vector<page::Asset>& assets();

// One HTML page that needs no other file. The scripts that draw a grasp are in it where `data` has "grasps". `recordings`: by
// the ids of their elements, "recording-17".
std::string report_page(const std::string& title, const Json& data,
                        const std::vector<std::pair<std::string, Json>>& recordings = {});

// Whether a file that begins so is such a page.
bool begins_as_report(std::string_view text);

}  // namespace report
}  // namespace slipbench
