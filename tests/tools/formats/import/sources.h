// Source files of a few rows in the format of the sets and the vendor's software.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/tools/dataset/record/test_records.h"
#include "tools/formats/import/import.h"

namespace slipbench::testing {

inline std::string grasp_header() {
  std::vector<std::string> names{"object", "slipped"};
  for (const char* finger : {"ff", "mf", "th"}) {
    for (int e = 1; e <= 24; ++e) names.push_back(std::string(finger) + "_biotac_" + std::to_string(e));
  }
  return fmt::format("{}\n", fmt::join(names, ","));
}

// Electrode i of the 72, from 1, reads `first` + i.
inline std::string grasp_row(const std::string& object, const std::string& slipped, int first) {
  std::vector<std::string> cells{object, slipped};
  for (int i = 1; i <= 72; ++i) cells.push_back(std::to_string(first + i));
  return fmt::format("{}\n", fmt::join(cells, ","));
}

inline std::string slide_header() {
  std::vector<std::string> names;
  for (int e = 1; e <= 24; ++e) names.push_back("ff_e" + std::to_string(e));
  return fmt::format("{}\n", fmt::join(names, ","));
}

// Electrode e reads 100 e + `row`.
inline std::string slide_row(int row) {
  std::vector<std::string> cells;
  for (int e = 1; e <= 24; ++e) cells.push_back(std::to_string(100 * e + row));
  return fmt::format("{}\n", fmt::join(cells, ","));
}

// The vendor's names. `printed`: as in its manual, which has S0 for the second sensor's slip
// detection.
inline std::string log_header(int sensors, bool printed = false) {
  std::vector<std::string> names{"T_us"};
  for (int s = 0; s < sensors; ++s) {
    const std::string sensor = "S" + std::to_string(s), detection = printed ? "S0" : sensor;
    for (int p = 0; p < 9; ++p) {
      for (const char* part : {"DX", "DY", "DZ", "FX", "FY", "FZ"})
        names.push_back(sensor + "_P" + std::to_string(p) + "_" + part);
    }
    for (const char* part : {"FX", "FY", "FZ", "TX", "TY", "TZ"}) names.push_back(sensor + "_GG_" + part);
    names.push_back(detection + "_isSDActive");
    names.push_back(detection + "_isRefLoad");
    for (int p = 0; p < 9; ++p) {
      names.push_back(detection + "_P" + std::to_string(p) + "_isInContact");
      names.push_back(detection + "_P" + std::to_string(p) + "_slipState");
    }
    names.push_back(detection + "_FrictionEst");
  }
  return fmt::format("{}\n", fmt::join(names, ","));
}

// One sensor's 81 cells: pillar p is displaced by (p, 0.25, 0.5) mm and carries (p, 0, 2) N.
// `states` are the pillars' states.
inline std::vector<std::string> log_cells(const std::vector<int>& states, bool active = true) {
  std::vector<std::string> cells;
  for (int p = 0; p < 9; ++p) {
    const std::string number = std::to_string(p);
    cells.insert(cells.end(), {number, "0.25", "0.5", number, "0", "2"});
  }
  cells.insert(cells.end(), {"36", "0", "18", "0", "0", "0", active ? "1" : "0", "0"});
  for (const int state : states) cells.insert(cells.end(), {state > 0 ? "1" : "0", std::to_string(state)});
  cells.emplace_back("-1");
  return cells;
}

inline std::string log_row(long microseconds, const std::vector<std::vector<std::string>>& sensors) {
  std::vector<std::string> cells{std::to_string(microseconds)};
  for (const auto& sensor : sensors) cells.insert(cells.end(), sensor.begin(), sensor.end());
  return fmt::format("{}\n", fmt::join(cells, ","));
}

// Pillar p has the flags (contact, slip) of `flags`, is displaced by (p, 0.25, 0.5) mm and carries
// (p, 0, 2) N.
inline std::string training_row(const std::string& time, const std::vector<std::string>& flags) {
  std::vector<std::string> cells{time};
  for (std::size_t p = 0; p < 9; ++p) {
    const std::string number = std::to_string(p);
    cells.insert(cells.end(), {flags[p], number, "0.25", "0.5", number, "0", "2"});
  }
  return fmt::format("{}\n", fmt::join(cells, ","));
}

struct ImportTest : FolderTest {
  // Writes a source below the test's folder and returns its path.
  std::string source(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  ImportSummary run(const std::vector<std::string>& sources, const std::string& format, const std::string& out = "out.h5") {
    return import_recordings({sources, &import_format(format), path(out), 7});
  }
};

}  // namespace slipbench::testing
