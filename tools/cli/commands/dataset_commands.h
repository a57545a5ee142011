// The commands that read and write datasets.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.h"
#include "tools/formats/export/export.h"
#include "tools/formats/import/import.h"
#include "tools/report/report.h"

namespace slipbench {

// `report` and `export`: a dataset in other forms.
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
};

// `import`: recordings of real sensors as a dataset.
struct ImportCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  ImportOptions options;

 private:
  [[noreturn]] void import_by_map();
};

// The result of an import on stdout, its warnings on stderr. `json`: one JSON object.
void print_import(const ImportSummary& summary, const ImportOptions& options, bool json);

// `verify`: is a dataset what it says?
struct VerifyCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> datasets;
};

// `list` and `describe`: what a scene may name.
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

// `schema`: what scenes and import maps may hold, for editors.
struct SchemaCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string schema_kind = "scene";
};

// `doctor` and `plugin-path`: what is installed, and where.
struct DoctorCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;
};

struct PluginPathCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

 private:
  std::string mujoco;  // version
};

}  // namespace slipbench
