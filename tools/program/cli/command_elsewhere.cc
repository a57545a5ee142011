#include "tools/program/cli/command_elsewhere.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "tools/program/cli/arguments.h"

namespace slipbench {

void CommandElsewhere::declare(Arguments& arguments) {
  arguments.about(name_, summary_, "\n");
  arguments.pass_on(words_);
}

int CommandElsewhere::run() {
  const std::string program = own_path(program_);
  std::vector<std::string> words{program, name_};
  if (json) words.emplace_back("--json");
  words.insert(words.end(), words_.begin(), words_.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  throw InputError(fmt::format("{}: cannot start {}: {}; it belongs beside slipbench, and its CMake target is {}", name_, program,
                               std::strerror(errno), program_));
}

}  // namespace slipbench
