#include "tools/studies/counts/callgrind.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <system_error>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench::counts {
namespace {

// Takes `ending` off where the name has it.
bool take_off(std::string_view& name, std::string_view ending) {
  if (!name.ends_with(ending)) return false;
  name.remove_suffix(ending.size());
  return true;
}

// "f'2": the second level of a recursion.
void take_off_level(std::string_view& name) {
  const std::size_t quote = name.rfind('\'');
  if (quote == std::string_view::npos || quote == 0 || quote + 1 == name.size()) return;
  if (name.find_first_not_of("0123456789", quote + 1) == std::string_view::npos) name = name.substr(0, quote);
}

// "f [clone .constprop.0]"
void take_off_clones(std::string_view& name) {
  while (name.ends_with(']')) {
    const std::size_t clone = name.rfind(" [clone ");
    if (clone == std::string_view::npos) return;
    name = name.substr(0, clone);
  }
}

// "f(int, g(*)(char))": what stands in the last pair of parentheses of the outermost level.
void take_off_arguments(std::string_view& name) {
  if (!name.ends_with(')')) return;
  std::size_t depth = 0;
  for (std::size_t i = name.size(); i-- > 0;) {
    if (name[i] == ')') ++depth;
    if (name[i] == '(' && --depth == 0) {
      const std::string_view rest = name.substr(0, i);
      // "(below main)" is callgrind's own, and the parentheses of "operator()" belong to its name.
      if (!rest.empty() && !rest.ends_with("operator")) name = rest;
      return;
    }
  }
}

bool is_simulation_step(std::string_view name) { return name.starts_with("slipbench::") && name.ends_with("Simulation::step"); }

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  InstructionProfile read() {
    while (next()) {
      if (!line_.empty()) read_line();
    }
    if (!total_) refuse("the total is missing: the text ends early");
    std::uint64_t sum = 0;
    for (const auto& [function, instructions] : profile_.self) sum += instructions;
    if (sum != *total_) refuse(fmt::format("the functions add up to {} instructions, the total is {}", sum, *total_));
    profile_.instructions = *total_;
    return std::move(profile_);
  }

 private:
  using Function = const std::string*;  // of names_, whose elements stay where they are

  bool next() {
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    return true;
  }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(fmt::format("{}:{}: not what callgrind writes: {}", name_, number_, reason));
  }

  bool take(std::string_view key) {
    if (!line_.starts_with(key)) return false;
    line_.remove_prefix(key.size());
    return true;
  }

  void read_line() {
    if (take("fn=")) {
      caller_ = function();
    } else if (take("cfn=")) {
      callee_ = function();
    } else if (take("calls=")) {
      read_call();
    } else if (line_.find_first_of("+-*0123456789") == 0) {
      if (caller_ == nullptr) refuse("a cost that belongs to no function");
      profile_.self[*caller_] += cost();
    } else if (take("positions: ")) {
      if (line_ != "line") refuse(fmt::format("positions are '{}'; allowed: line", line_));
    } else if (take("events: ")) {
      if (line_ != "Ir") refuse(fmt::format("events are '{}'; allowed: Ir", line_));
    } else if (take("totals: ")) {
      total_ = number(line_);
    } else if (!is_known()) {
      refuse(fmt::format("found '{}'", line_.substr(0, 60)));
    }
  }

  // Lines that say nothing that is wanted here: files, objects and the head.
  [[nodiscard]] bool is_known() const {
    for (const std::string_view key : {"#", "ob=", "fl=", "fi=", "fe=", "cob=", "cfi=", "cfl=", "version: ", "creator: ", "pid: ",
                                       "cmd: ", "part: ", "thread: ", "desc: ", "summary: "}) {
      if (line_.starts_with(key)) return true;
    }
    return false;
  }

  // "calls=COUNT POSITION", then a line with what the calls cost altogether, which the callee's own lines count.
  void read_call() {
    const std::uint64_t count = number(line_.substr(0, line_.find(' ')));
    if (caller_ == nullptr || callee_ == nullptr) refuse("a call without its two functions");
    if (is_simulation_step(*callee_) && !is_simulation_step(*caller_)) profile_.steps += count;
    if (!next()) refuse("a call without its cost");
    static_cast<void>(cost());
  }

  // "(ID) NAME" where a name comes first, "(ID)" from then on.
  Function function() {
    const std::size_t close = line_.find(')');
    if (!line_.starts_with('(') || close == std::string_view::npos) refuse("a function without its number");
    const std::uint64_t id = number(line_.substr(1, close - 1));
    if (close + 2 < line_.size()) return &(names_[id] = function_name(line_.substr(close + 2)));
    const auto known = names_.find(id);
    if (known == names_.end()) refuse(fmt::format("function ({}) has no name", id));
    return &known->second;
  }

  // "POSITION COST", where a cost of 0 may be left out.
  [[nodiscard]] std::uint64_t cost() const {
    const std::size_t space = line_.find(' ');
    if (space == std::string_view::npos || space + 1 == line_.size()) return 0;
    return number(line_.substr(space + 1));
  }

  [[nodiscard]] std::uint64_t number(std::string_view text) const {
    std::uint64_t value = 0;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{} || stop != text.data() + text.size()) refuse(fmt::format("'{}' is no count", text));
    return value;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  std::string_view line_;
  Function caller_ = nullptr;
  Function callee_ = nullptr;
  std::optional<std::uint64_t> total_;
  std::unordered_map<std::uint64_t, std::string> names_;
  InstructionProfile profile_;
};

}  // namespace

InstructionProfile parse_callgrind(std::string_view text, const std::string& name) { return Reader(text, name).read(); }

std::string function_name(std::string_view demangled) {
  std::string_view name = demangled;
  take_off_level(name);
  take_off_clones(name);
  while (take_off(name, " const") || take_off(name, " volatile") || take_off(name, " &") || take_off(name, " &&")) continue;
  take_off_arguments(name);
  return std::string(name);
}

}  // namespace slipbench::counts
