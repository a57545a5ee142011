// Trials in the viewer Rerun, by the user's own Python.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/page.h"

namespace slipbench {

namespace view {
// The Python of rerun.cc, inside the program. Written by slipbench_embed().
const std::vector<page::Asset>& assets();
}  // namespace view

struct RerunOptions {
  std::optional<std::size_t>
      trial;         // empty: the first; of a run that goes on the last, and each that is newest half a second later
  std::string save;  // an .rrd file in place of the viewer; empty: the viewer
};

struct RerunResult {
  int status = 0;                   // of Python: 2 where it has no rerun-sdk, which it has said on stderr
  std::vector<std::size_t> trials;  // that were sent
};

// Sends trials of the dataset at `path` to Rerun, column by column. Where a run is writing it, its trials are followed until it ends or SIGINT
// comes. Throws InputError when there is no dataset, no such trial, no Python, or a trial without a recording.
RerunResult show_in_rerun(const std::string& path, const RerunOptions& options);

// Exit status of a Python that loads rerun-sdk and shows nothing: 0, or 2 where it has none, which it has said on stderr. Throws InputError
// when there is no Python.
int status_of_rerun();

// Whether a file that begins so is a recording of Rerun.
bool begins_as_rrd(std::string_view text);

// Opens the file at `path` in the user's browser (README.md says in which) and does not wait for its end. Returns which program has opened it,
// or nothing where there is no screen or no such program.
std::optional<std::string> open_in_browser(const std::string& path);

}  // namespace slipbench
