#include "tools/base/dataset/guarded.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// First byte of what the child sends.
enum class Outcome : char { result = 'r', bad_input = 'i', failure = 'f' };

std::string message(Outcome outcome, std::string_view text) { return static_cast<char>(outcome) + std::string(text); }

std::string outcome_of(const std::function<std::string()>& action) {
  try {
    return message(Outcome::result, action());
  } catch (const InputError& error) {
    return message(Outcome::bad_input, error.what());
  } catch (const std::exception& error) {
    return message(Outcome::failure, error.what());
  }
}

[[noreturn]] void be_the_child(int channel, const std::function<std::string()>& action) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // a terminal sends it to both; what becomes of it is the parent's affair
  constexpr rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const std::string text = outcome_of(action);
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = ::write(channel, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  ::_exit(0);  // nothing of the parent's is torn down or flushed twice
}

std::string read_all(int channel) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t count = ::read(channel, buffer.data(), buffer.size());
    if (count == 0) return text;
    if (count < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("cannot read from a process: {}", std::strerror(errno)));
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE || signal == SIGILL;
}

}  // namespace

std::string guarded(const std::string& subject, const std::function<std::string()>& action) {
  std::array<int, 2> channel{};
  if (::pipe(channel.data()) != 0) throw std::runtime_error(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (child == 0) {
    ::close(channel[0]);
    be_the_child(channel[1], action);
  }
  ::close(channel[1]);
  const std::string text = read_all(channel[0]);
  ::close(channel[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFSIGNALED(status) && !is_crash(WTERMSIG(status))) {
    throw std::runtime_error(fmt::format("{}: reading it was ended: {}", subject, ::strsignal(WTERMSIG(status))));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.empty()) {
    throw InputError(fmt::format("{}: is damaged: HDF5 crashed on it{}", subject,
                                 WIFSIGNALED(status) ? fmt::format(" ({})", ::strsignal(WTERMSIG(status))) : ""));
  }
  switch (static_cast<Outcome>(text.front())) {
    case Outcome::bad_input: throw InputError(text.substr(1));
    case Outcome::failure: throw std::runtime_error(text.substr(1));
    case Outcome::result: break;
  }
  return text.substr(1);
}

}  // namespace slipbench
