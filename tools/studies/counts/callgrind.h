// Instruction counts of one run, read from what callgrind wrote.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace slipbench::counts {

struct InstructionProfile {
  std::uint64_t instructions = 0;  // all that were counted
  std::uint64_t steps = 0;         // calls of a simulation's step() by what is no simulation's step() itself
  // Instructions of each function without those it calls; all add up to `instructions`. What the compiler put in line counts
  // where it was put.
  std::map<std::string, std::uint64_t, std::less<>> self;
};

// Reads callgrind's output format, version 1, with one event, Ir, and positions by line. `name` stands for the text in messages.
// Throws InputError with name:line for what is none, and where the functions do not add up to the total that callgrind states.
// Format: valgrind manual, "Callgrind Format Specification".
InstructionProfile parse_callgrind(std::string_view text, const std::string& name);

// A demangled name without arguments, qualifiers, the compiler's clone and callgrind's recursion level, so that overloads,
// clones and levels of one function are counted as one: "a::f(int) const [clone .cold]'2" becomes "a::f".
std::string function_name(std::string_view demangled);

}  // namespace slipbench::counts
