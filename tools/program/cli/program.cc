#include "tools/program/cli/program.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/options.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/doctor/doctor.h"

namespace slipbench {
namespace {

using Command = std::function<int(const Options&)>;

const std::map<std::string, Command>& commands() {
  static const std::map<std::string, Command> table{
      {"run", run_command},
      {"sweep", sweep_command},
      {"check", check_command},
      {"report", report_command},
      {"export", export_command},
      {"hd replay", hd_replay_command},
      {"train", train_command},
      {"eval", eval_command},
      {"reproduce", reproduce_command},
      {"cost", cost_command},
      {"bench", bench_command},
      {"list", list_command},
      {"describe", describe_command},
      {"doctor", [](const Options& options) { return doctor_main(options.json); }},
      {"plugin-path", plugin_path_command},
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

// `message` and `detail` in one line on stderr. It is called where nothing catches any more, so it must not throw.
void print_error(const char* message, const char* detail = "") noexcept {
  try {
    say(stderr, fmt::format("{} {}{}\n", style_for(stderr).error("slipbench:"), message, detail));
  } catch (const std::bad_alloc&) {
    std::fputs("slipbench: out of memory\n", stderr);
  }
}

// A program may be started without standard streams (`>&-`). The next files that it opens would take their numbers, and what is
// meant for a person would end in a dataset. /dev/null stands in, opened the wrong way round, so that results still cannot be
// lost unnoticed: writing them fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) {
      throw InputError(
          fmt::format("standard stream {} is closed, and /dev/null cannot stand in: {}", stream, std::strerror(errno)));
    }
  }
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  try {
    occupy_standard_streams();
    const int status = dispatch(arguments);
    // A full disk behind stdout shows here, unless the output is longer than the buffer.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return status;
  } catch (const InputError& error) {
    print_error(error.what());
    return exit_bad_input;
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
    return exit_bad_input;
  } catch (const std::exception& error) {
    // What fmt throws, too.
    const auto* const system = dynamic_cast<const std::system_error*>(&error);
    if (system != nullptr && std::ferror(stdout) != 0) {
      print_error("cannot write to standard output: ", std::strerror(system->code().value()));
      return exit_bad_input;
    }
    // Not the user's fault, but the user is the only one who can report it.
    print_error("internal error, please report it: ", error.what());
    return exit_bad_input;
  }
}

}  // namespace slipbench
