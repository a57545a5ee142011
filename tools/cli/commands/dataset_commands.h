// The commands that read and write datasets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command.h"
#include "tools/cli/terminal.h"
#include "tools/formats/export/export.h"
#include "tools/formats/import/import.h"
#include "tools/report/report.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {

// Lists the trials of the run that the dataset lacks; empty if it has all.
std::string failed_text(const std::string& dataset);

// `report` and `export` convert a dataset.
struct ReportCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string dataset;
  std::string output;  // HTML file; empty: named after the dataset
  ReportOptions options;
};

struct ExportCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string dataset;
  std::string output;  // folder
  ExportOptions options;
  bool verbose = false;

 private:
  [[nodiscard]] std::optional<PythonModule> python_writer() const;
};

// Output of an export.
struct ExportOutput {
  bool json = false;     // one JSON object on stdout
  bool quiet = false;    // neither progress nor a summary
  bool verbose = false;  // the name of every file
};

// Prints the result of an export to `folder` on stdout.
void print_export(const std::vector<std::string>& files, const std::string& folder, const ExportOutput& how);

// Prints the expected size of an export on stderr after its first trial, then the progress; nothing
// if `quiet`. The destructor removes an unfinished bar.
class ExportBar {
 public:
  explicit ExportBar(bool quiet) : quiet_(quiet), progress_(Progress::for_stream(stderr, quiet)) {}

  // Reports that `done` of `total` trials are `bytes` long.
  void update(std::size_t done, std::size_t total, std::uintmax_t bytes);
  // Removes an unfinished bar, so that a message starts on an empty line.
  void clear() { progress_.clear(); }

 private:
  bool quiet_;
  Progress progress_;
};

// "318 MB".
std::string size_text(std::uintmax_t bytes);

// `import` writes recordings of real sensors to a dataset.
struct ImportCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  ImportOptions options;
  std::string draft;  // type of the sensor of which a map is drafted; empty: import

 private:
  [[noreturn]] void import_by_map();
  [[noreturn]] void draft_map();
};

// Prints the result of an import on stdout, as one JSON object with `json`, and its warnings on
// stderr.
void print_import(const ImportSummary& summary, const ImportOptions& options, bool json);

// `verify` checks the digests and values of datasets.
struct VerifyCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> datasets;
};

// `list` and `describe` print the names that a scene may use, and their pages.
struct ListCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string catalogue;  // empty: all
};

struct DescribeCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string name;
};

// `schema` prints the JSON Schema of scenes and import maps, for editors.
struct SchemaCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string schema_kind = "scene";
};

// `doctor` lists installed dependencies; `plugin-path` prints the path of the MuJoCo plugin.
struct DoctorCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;
};

struct PluginPathCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

 private:
  std::string mujoco;  // version of MuJoCo
};

}  // namespace slipbench
