// The published memories and vectors of tests/detectors/hd/data.
#pragma once

#include <map>
#include <ranges>
#include <string>
#include <vector>

#include "detectors/hd/engine.h"
#include "tests/files.h"

namespace slipbench::hd {

inline const std::string published_folder = std::string(SLIPBENCH_SOURCE_DIR) + "/tests/detectors/hd/data/published";

// One step: column name to value.
using PublishedRow = std::map<std::string, int>;

inline std::vector<PublishedRow> published_rows() {
  const std::vector<std::string> lines = lines_of(bytes_of(published_folder + "/vectors.csv"));
  const std::vector<std::string> names = parts_of(lines.at(0), ',');
  std::vector<PublishedRow> rows;
  for (const std::string& line : lines | std::views::drop(1)) {
    const std::vector<std::string> values = parts_of(line, ',');
    PublishedRow row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = std::stoi(values.at(i));
    rows.push_back(row);
  }
  return rows;
}

inline Frame published_frame(const PublishedRow& row) {
  Frame frame;
  for (std::size_t p = 0; p < pillar_count; ++p) frame.level[p] = static_cast<std::uint8_t>(row.at("L" + std::to_string(p)));
  frame.context = static_cast<std::uint8_t>(row.at("ctx"));
  return frame;
}

// The models of the columns "A", "P1" and "P0".
inline Model published_model(const std::string& column) {
  return {.ties = column == "P0" ? Ties::zero : Ties::one, .compat = column == "A" ? Compat::published_core : Compat::paper};
}

}  // namespace slipbench::hd
