#include "tools/program/samples/slip_rule.h"

#include <array>

#include <fmt/format.h>

#include "detectors/hd/words.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

constexpr std::array rules{hd::Word<SlipRule>{"strict", SlipRule::strict}, hd::Word<SlipRule>{"micro", SlipRule::micro},
                           hd::Word<SlipRule>{"paper", SlipRule::paper},
                           hd::Word<SlipRule>{"has_slipped", SlipRule::has_slipped}};

}  // namespace

SlipRule parse_slip_rule(const std::string& name) {
  if (const std::optional<SlipRule> rule = hd::value_of(rules, name)) return *rule;
  throw InputError(fmt::format("unknown slip rule '{}'{}", name, allowed_names(name, slip_rule_names())));
}

std::vector<std::string> slip_rule_names() { return hd::names_of(rules); }
std::string slip_rule_name(SlipRule rule) { return hd::name_of(rules, rule); }

}  // namespace slipbench
