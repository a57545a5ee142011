// The commands that read and write datasets.
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/command.h"
#include "tools/program/export/export.h"
#include "tools/program/import/import.h"
#include "tools/program/report/report.h"

namespace slipbench {

// `report` and `export`: a dataset in other forms.
class ReportCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string dataset;
  std::string output;  // HTML file; empty: named after the dataset
  ReportOptions options;
};

class ExportCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string dataset;
  std::string output;  // folder
  ExportOptions options;
};

// `import`: recordings of real sensors as a dataset.
class ImportCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  ImportOptions options;
};

// `verify`: is a dataset what it says?
class VerifyCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> datasets;
};

// The commands that say what there is: to name in a scene, and on this machine.

// `list` and `describe`: what a scene may name.
class ListCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string catalogue;  // empty: all
};

class DescribeCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string name;
};

// `doctor` and `plugin-path`: what is installed, and where.
class DoctorCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;
};

class PluginPathCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

 private:
  std::string mujoco;  // version
};

}  // namespace slipbench
