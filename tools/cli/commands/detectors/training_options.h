// Options of `train` and `train-hd` that choose the operating point, and their labels.
#pragma once

#include <optional>
#include <string>

#include "tools/cli/arguments.h"
#include "tools/learning_data/label_rules.h"

namespace slipbench {

// How training chooses when a detector raises an alarm.
struct PointOptions {
  std::optional<double> alarms;       // maximum rate of false alarms, 1/min
  bool score = false;                 // by the score of open recordings, instead
  std::optional<double> specificity;  // with `score`: share of trials without slip that raise no alarm

  // Declares --alarms, --score and --specificity. `without`: the default of --alarms, for its help.
  void declare(Arguments& arguments, const std::string& without);
  // Reads what was given. Throws InputError that begins with `command` for a text that is no rate, and
  // for options that exclude or need one another.
  void read(const std::string& command);

 private:
  std::string rate_;
  std::optional<std::size_t> percent_;
};

// Returns the rule with this name. Throws InputError that begins with `command` unless `use` takes it.
LabelRule labels_of(const std::string& command, const std::string& name, LabelUse use);

}  // namespace slipbench
