// `slipbench doctor`: what is installed, in which versions, what is missing and how to get it.
#pragma once

#include <string>
#include <vector>

namespace slipbench {

// Whether something is in order.
enum class CheckStatus {
  ok,
  missing,  // not there
  wrong,    // there, but not as it has to be
};

// The outcome of one look.
struct Check {
  std::string group;  // "program", "machine", "libraries", "set-up"
  std::string name;
  CheckStatus status = CheckStatus::ok;
  bool required = true;     // false: only a part of the bench needs it
  std::string found = {};   // version or description, "" where missing
  std::string remedy = {};  // command or sentence that mends it, "" where in order
};

// Looks at everything. Never throws for what it finds.
std::vector<Check> run_checks();

// Runs the checks and prints them on stdout, as text or as one JSON object. Returns 0 when all that is required is in order, else 1.
int doctor_main(bool json);

}  // namespace slipbench
