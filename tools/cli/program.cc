#include "tools/cli/program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/cli/commands.h"
#include "tools/cli/options.h"
#include "tools/cli/terminal.h"
#include "tools/doctor/doctor.h"

namespace slipbench {
namespace {

using Command = std::function<int(const Options&)>;

const std::map<std::string, Command>& commands() {
  static const std::map<std::string, Command> table{
      {"run", run_command},
      {"sweep", sweep_command},
      {"report", report_command},
      {"export", export_command},
      {"list", list_command},
      {"describe", describe_command},
      {"doctor", [](const Options& options) { return doctor_main(options.json); }},
      {"--version", version_command},
  };
  return table;
}

int dispatch(const std::vector<std::string>& arguments) {
  const Options options = parse_options(arguments);
  if (!options.help.empty()) {
    fmt::print("{}", options.help);
    return exit_good;
  }
  return commands().at(options.command)(options);
}

void print_error(const char* message) { fmt::print(stderr, "{} {}\n", style_for(stderr).error("slipbench:"), message); }

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  try {
    const int status = dispatch(arguments);
    // A full disk behind stdout shows only here.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw InputError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
    }
    return status;
  } catch (const InputError& error) {
    print_error(error.what());
    return exit_bad_input;
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
    return exit_bad_input;
  } catch (const std::exception& error) {
    // Not the user's fault, but the user is the only one who can report it.
    print_error(fmt::format("internal error, please report it: {}", error.what()).c_str());
    return exit_bad_input;
  }
}

}  // namespace slipbench
