// `report` and `export`: a dataset in other forms.
#pragma once

#include <string>

#include "tools/program/cli/command.h"
#include "tools/program/export/export.h"
#include "tools/program/report/report.h"

namespace slipbench {

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

}  // namespace slipbench
