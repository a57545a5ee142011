#include "tools/cli/program.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "sim/core/process/own_library.h"
#include "tools/cli/arguments.h"
#include "tools/cli/command.h"
#include "tools/cli/terminal.h"
#include "tools/doctor/doctor.h"
#include "tools/files/delayed_end.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

int print_version(bool json) {
  const BuildInfo& info = build_info();
  if (json)
    return print_json(
        Json{{"version", info.version}, {"commit", info.commit}, {"compiler", info.compiler}, {"build_type", info.build_type}});
  print_text("slipbench {} (commit {}, {}, {})\n", info.version, info.commit, info.compiler, info.build_type);
  return exit_good;
}

int dispatch(const Commands& commands, const std::vector<std::string>& words) {
  const Request request = parse_command_line(commands, words);
  if (Command* const command = request.command) {
    if (command->json || command->streams()) set_stdout_aside();
    const int status = command->run();
    command->send_stream();
    return status;
  }
  if (request.version) return print_version(request.json);
  fmt::print("{}", request.help);
  return exit_good;
}

// Prints `message` and `detail` in one line on stderr. No caller catches exceptions, so it must not
// throw.
void print_error(const char* message, const char* detail = "") noexcept {
  say(stderr, fmt::format("{} {}{}\n", style_for(stderr).error("slipbench:"), printable(message, true), printable(detail, true)));
}

// Opens /dev/null for standard streams that are closed (`>&-`). Otherwise the next opened files
// would take their numbers, and messages would end in a dataset. The streams are opened the wrong
// way round, so that writing results to them fails rather than losing them.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) {
      reject("standard stream {} is closed, and /dev/null cannot replace it: {}", stream, std::strerror(errno));
    }
  }
}

int run_to_status(const Commands& commands, const std::vector<std::string>& words) {
  try {
    occupy_standard_streams();
    const int status = dispatch(commands, words);
    // Reports a full disk behind stdout, unless the output exceeded the buffer before.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return status;
  } catch (const Interrupted& interrupted) {
    say(stderr, fmt::format("slipbench: {}\n", interrupted.what()));
    return exit_interrupted;
  } catch (const InputError& error) {
    print_error(error.what());
    return exit_bad_input;
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
    return exit_bad_input;
  } catch (const std::filesystem::filesystem_error& error) {
    // Such as a loop of links, a name that is too long, or a folder that was removed.
    const std::string path = error.path1().empty() ? "" : error.path1().string() + ": ";
    print_error(path.c_str(), error.code().message().c_str());
    return exit_bad_input;
  } catch (const std::exception& error) {
    // Includes exceptions of fmt.
    const auto* const system = dynamic_cast<const std::system_error*>(&error);
    if (system != nullptr && std::ferror(stdout) != 0) {
      print_error("cannot write to standard output: ", std::strerror(system->code().value()));
      return exit_bad_input;
    }
    // A bug: the user is the only one who can report it.
    print_error("internal error, please report it: ", error.what());
    return exit_bad_input;
  }
}

}  // namespace

int run_program(const Commands& commands, const std::vector<std::string>& words) {
  // Commands without an InterruptGuard exit at once, or when a file is complete, with the same status.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, [](int) { end_by_signal(exit_interrupted); }) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  std::signal(SIGCHLD, SIG_DFL);  // if inherited as ignored, children would have no status
  std::signal(SIGXFSZ, SIG_IGN);  // writing beyond the limit of a file's size then fails as on a full disk
  return run_to_status(commands, words);
}

}  // namespace slipbench
