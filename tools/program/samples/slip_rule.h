// When a pillar of a PapillArray counts as slipping.
#pragma once

#include <string>
#include <vector>

namespace slipbench {

enum class SlipRule {
  strict,       // all of it slips
  micro,        // a part of it slips
  paper,        // its tip slides faster than `label_speed`, as a camera would see it
  has_slipped,  // from the first such sample on until it loses contact: "no pillar has slipped", as the paper words its classes
};

inline constexpr double default_label_speed = 1e-4;  // m/s

// The rules' names on the command line: "strict". The parser throws InputError with the nearest name.
SlipRule parse_slip_rule(const std::string& name);
std::vector<std::string> slip_rule_names();
std::string slip_rule_name(SlipRule rule);

}  // namespace slipbench
