#include "tools/cli/commands/detectors/training_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "tools/files/reject.h"

namespace slipbench {
namespace {

// Returns false alarms per minute from a text such as "1/min".
double alarms_a_minute(const std::string& command, const std::string& text) {
  double rate = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  const std::string_view unit(end, text.data() + text.size());
  if (error == std::errc() && rate >= 0.0 && std::isfinite(rate)) {
    if (unit == "/min") return rate;
    if (unit == "/h") return rate / 60.0;
  }
  reject("{}: --alarms is {}; expected a rate of 0 or more with its unit, such as 1/min or 10/h", command, quote(text));
}

}  // namespace

void PointOptions::declare(Arguments& arguments, const std::string& without) {
  arguments.text("--alarms RATE", rate_, "Maximum rate of false alarms on the validation trials (default: " + without + ")");
  arguments.flag("--score", score, "Instead of --alarms: operating point with the highest score of open recordings");
  arguments.number("--specificity N", percent_,
                   "With --score: least percentage of trials without slip that raise no alarm, 0 to 100 (default: 95)", 0, 100);
}

void PointOptions::read(const std::string& command) {
  if (score && !rate_.empty()) reject("{}: give either --score or --alarms", command);
  if (percent_ && !score) reject("{}: --specificity needs --score", command);
  if (!rate_.empty()) alarms = alarms_a_minute(command, rate_);
  if (percent_) specificity = static_cast<double>(*percent_) / 100.0;
}

LabelRule labels_of(const std::string& command, const std::string& name, LabelUse use) {
  const std::vector<std::string> names = label_rule_names(use);
  if (std::ranges::find(names, name) == names.end())
    reject("{}: --labels is {}{}", command, quote(name), allowed_names(name, names));
  return parse_label_rule(name, use);
}

}  // namespace slipbench
