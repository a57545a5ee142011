#include "tools/base/dataset/guarded.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/dataset/header.h"

namespace slipbench {
namespace {

// A sanitizer takes the whole address space for itself.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
#else
constexpr bool sanitized = false;
#endif

// First byte of what the child sends.
enum class Outcome : char { result = 'r', bad_input = 'i', no_memory = 'm', failure = 'f' };

std::string message(Outcome outcome, std::string_view text) { return static_cast<char>(outcome) + std::string(text); }

std::string outcome_of(const std::function<std::string()>& action) {
  try {
    return message(Outcome::result, action());
  } catch (const InputError& error) {
    return message(Outcome::bad_input, error.what());
  } catch (const std::bad_alloc&) {
    return message(Outcome::no_memory, "");
  } catch (const std::exception& error) {
    return message(Outcome::failure, error.what());
  }
}

// Pages of the address space that the program has.
std::uint64_t own_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void set_limits(const ReadingLimits& limits) {
  constexpr rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto lower = [](__rlimit_resource kind, std::uint64_t value) {
    rlimit limit{};
    ::getrlimit(kind, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, value);
    ::setrlimit(kind, &limit);
  };
  lower(RLIMIT_CPU, limits.cpu);
  if (!sanitized) lower(RLIMIT_AS, own_bytes() + limits.memory);
}

[[noreturn]] void be_the_child(int channel, const ReadingLimits& limits, const std::function<std::string()>& action) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // a terminal sends it to both; what becomes of it is the parent's affair
  std::signal(SIGXCPU, SIG_DFL);
  set_limits(limits);
  const std::string text = outcome_of(action);
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = ::write(channel, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  ::_exit(0);  // nothing of the parent's is torn down or flushed twice
}

// What the child sends, until it ends; empty: it took longer than `seconds`. They are counted while this process runs, so that
// one that is stopped (Ctrl-Z) and goes on has them still.
std::optional<std::string> read_all(int channel, std::uint64_t seconds) {
  std::string text;
  std::array<char, 65536> buffer{};
  while (true) {
    pollfd ready{channel, POLLIN, 0};
    constexpr int one_second = 1000;
    const int count_ready = ::poll(&ready, 1, one_second);
    if (count_ready == 0 && seconds-- == 0) return std::nullopt;
    if (count_ready <= 0 && (count_ready == 0 || errno == EINTR)) continue;
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

ReadingLimits reading_limits(const std::string& path) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (std::size_t k = 0;; ++k) {
    const std::uintmax_t size = std::filesystem::file_size(sibling_path(path, k), error);
    if (error) break;
    bytes += size;
  }
  constexpr std::uint64_t megabyte = 1'000'000;
  return {8 + 2 * bytes / megabyte, 120 + 20 * bytes / megabyte, 8000 * megabyte + 16 * bytes};
}

std::string guarded(const std::string& subject, const std::function<std::string()>& action) {
  return guarded(subject, reading_limits(subject), action);
}

std::string guarded(const std::string& subject, const ReadingLimits& limits, const std::function<std::string()>& action) {
  std::array<int, 2> channel{};
  if (::pipe(channel.data()) != 0) throw std::runtime_error(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (child == 0) {
    ::close(channel[0]);
    be_the_child(channel[1], limits, action);
  }
  ::close(channel[1]);
  const std::optional<std::string> sent = read_all(channel[0], limits.wait);
  ::close(channel[0]);
  if (!sent) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const auto unreadable = [&subject](const std::string& why) {
    return InputError(fmt::format("{}: cannot be read: {}", subject, why));
  };
  if (!sent) throw unreadable(fmt::format("reading took longer than {} s", limits.wait));
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    throw unreadable(fmt::format("reading took longer than {} s of the processor", limits.cpu));
  }
  const std::string& text = *sent;
  if (WIFSIGNALED(status) && !is_crash(WTERMSIG(status))) {
    throw std::runtime_error(fmt::format("{}: reading it was ended: {}", subject, ::strsignal(WTERMSIG(status))));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.empty()) {
    throw InputError(fmt::format("{}: is damaged: HDF5 crashed on it{}", subject,
                                 WIFSIGNALED(status) ? fmt::format(" ({})", ::strsignal(WTERMSIG(status))) : ""));
  }
  switch (static_cast<Outcome>(text.front())) {
    case Outcome::bad_input: throw InputError(text.substr(1));
    case Outcome::no_memory:
      throw unreadable(fmt::format("reading needed more than {:.3g} GB", 1e-9 * static_cast<double>(limits.memory)));
    case Outcome::failure: throw std::runtime_error(text.substr(1));
    case Outcome::result: break;
  }
  return text.substr(1);
}

}  // namespace slipbench
