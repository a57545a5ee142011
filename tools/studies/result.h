// What a reproduction found: tables of text for people, numbers for programs.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"

namespace slipbench::reproduce {

struct ResultTable {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows = {};  // as many cells as the head has
  std::string note = {};                            // a sentence below it; may be empty
};

// A value against what was varied, with its interval; `low` and `high` may be equal to it.
struct ResultPoint {
  double value = 0.0, low = 0.0, high = 0.0;
};
struct ResultCurve {
  std::string name;
  std::vector<ResultPoint> points;  // one at each of the chart's places
};
// Curves over places that stand at equal distances, whatever numbers they are.
struct ResultChart {
  std::string title, across, up;    // and what the axes are
  std::vector<std::string> places;  // "0", "0.5", ..., at least two
  std::vector<ResultCurve> curves;  // at least one
  double bar = 0.0;                 // a line across
  std::string bar_name;             // what it says beside it
};

// A figure that others measured on a real device, and ours. `reproduce realism` gathers them from all studies.
struct RealFigure {
  std::string what;               // with its unit
  double real = 0.0, ours = 0.0;  // NaN: not published
  std::string note = {};          // what was fitted or assumed; may be empty
};

struct Result {
  std::string title;               // "Ablation of the hyperdimensional slip detector"
  std::string source;              // what is reproduced: paper and place in it
  std::vector<std::string> setup;  // how it was measured, a line each
  std::vector<ResultTable> tables;
  std::vector<ResultChart> charts = {};  // drawn before the tables
  std::vector<std::string> remarks;      // what differs from the paper, and why
  std::vector<RealFigure> real = {};
  Json figures;  // every number of the tables, unrounded
};

// The one JSON object of `--json` and of the written file: name, title, source, setup, figures, remarks.
Json result_json(const std::string& name, const Result& result);

// One HTML page that needs no other file.
std::string result_page(const std::string& name, const Result& result);

// The page and the object as they are written.
inline constexpr page::PageKind page_kind{
    "a result", "slipbench reproduce", "result page", "result of a reproduction", {"reproduction"}};

}  // namespace slipbench::reproduce
