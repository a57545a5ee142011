// What can be reproduced: a function and a line each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/page/page.h"
#include "tools/program/cli/command.h"

namespace slipbench::reproduce {

// What a reproduction found: tables of text for people, numbers for programs.

struct ResultTable {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows = {};  // as many cells as the head has
  std::string note = {};                            // a sentence with it; may be empty
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

// A figure that others measured on a real device, and ours. `reproduce realism` (realism.py) gathers them from all studies.
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

class KeptNetworks;  // grid.h

struct ReproduceOptions {
  std::string data;                             // a dataset to use instead of a fresh one; empty: none
  std::string real;                             // a dataset of imported recordings that also judges; empty: none
  std::optional<std::uint64_t> seed;            // of datasets, item memories and draws
  std::size_t jobs = 0;                         // threads; 0: as many as the machine has
  bool full = false;                            // the paper's size
  bool synthesise = false;                      // run the synthesis again instead of reading its stored figures
  std::size_t trials = 0;                       // of each row; 0: as many as is usual
  std::vector<std::string> only;                // names of rows to keep; of an axis that none names, all
  std::string memories;                         // folder of the published classifier; empty: the source tree's
  KeptNetworks* kept = nullptr;                 // where networks that are done are kept; null: nowhere
  std::function<void(const std::string&)> say;  // told what is being done; may be empty
};

struct Reproduction {
  std::string name;                                // PAPER/TABLE: "hd-papillarray/table1"
  std::string summary;                             // a line
  std::vector<std::string> options;                // "--data", "--seed": those that it takes
  Result (*run)(const ReproduceOptions& options);  // null: the Python package slipbench_studies has it
};

// All, in the order of the list.
const std::vector<Reproduction>& reproductions();

// Throws InputError with the nearest name.
const Reproduction& find_reproduction(const std::string& name);

Result biotac_table1(const ReproduceOptions& options);
Result biotac_fig12(const ReproduceOptions& options);
Result biotac_table2(const ReproduceOptions& options);
Result biotac_table3(const ReproduceOptions& options);
Result hd_table1(const ReproduceOptions& options);
Result hd_table2(const ReproduceOptions& options);
Result hd_table3(const ReproduceOptions& options);
Result learned_grasp_loop(const ReproduceOptions& options);
Result learned_scaling(const ReproduceOptions& options);

// `reproduce`: a paper's table beside ours.
struct ReproduceCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string name;     // PAPER/TABLE; empty: list what there is
  std::string output;   // HTML file to write, and JSON beside it; empty: none
  bool resume = false;  // go on with the networks that lie beside `output`
  ReproduceOptions options;
};

}  // namespace slipbench::reproduce
