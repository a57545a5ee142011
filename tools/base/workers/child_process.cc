#include "tools/base/workers/child_process.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <new>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

using Kind = ChildEnd::Kind;

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

[[noreturn]] void be_the_child(int channel, const std::function<std::string()>& action) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);
  const ChildEnd end = ChildEnd::of(action);
  const std::string text = static_cast<char>(end.kind) + end.text;  // as ChildProcess::end() reads it
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = ::write(channel, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  ::_exit(0);  // nothing of the parent's is torn down or flushed twice
}

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

std::string announcement;                            // whole before the handler is set
constexpr std::string_view clear_line = "\r\033[K";  // on a terminal a progress bar may stand in it
volatile std::sig_atomic_t on_terminal = 0;

// Nothing can be done where stderr cannot be written.
void say(std::string_view text) { [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size()); }

void note_interrupt(int signal) {
  if (interrupted.exchange(true)) {
    std::raise(signal);  // the other signal came first; this one's action is the default again
    return;
  }
  const int before = errno;
  if (on_terminal != 0) say(clear_line);
  say(announcement);
  errno = before;
}

void catch_unless_ignored(int signal, const struct sigaction& action, struct sigaction& previous) {
  sigaction(signal, nullptr, &previous);
  if (previous.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

ChildEnd ChildEnd::of(const std::function<std::string()>& action) {
  try {
    return {.kind = Kind::result, .text = action()};
  } catch (const InputError& error) {
    return {.kind = Kind::bad_input, .text = error.what()};
  } catch (const std::bad_alloc&) {
    return {.kind = Kind::no_memory, .text = {}};
  } catch (const std::exception& error) {
    return {.kind = Kind::failure, .text = error.what()};
  }
}

std::string ChildEnd::result() && {
  switch (kind) {
    case Kind::result: break;
    case Kind::bad_input: throw InputError(text);
    case Kind::no_memory: throw std::runtime_error("a process had no memory left");
    case Kind::failure: throw std::runtime_error(text);
    case Kind::broken:
      throw std::runtime_error(
          fmt::format("a process ended without a result{}",
                      WIFSIGNALED(status) ? fmt::format(" ({})", ::strsignal(WTERMSIG(status))) : std::string()));
  }
  return std::move(text);
}

std::uint64_t own_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit_memory(std::uint64_t more) {
  if (sanitized) return;
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, own_bytes() + more);
  ::setrlimit(RLIMIT_AS, &limit);
}

ChildProcess::ChildProcess(const std::function<std::string()>& action) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  process_ = ::fork();
  if (process_ == 0) {
    ::close(ends[0]);
    be_the_child(ends[1], action);
  }
  const int error = errno;
  ::close(ends[1]);
  channel_ = ends[0];
  if (process_ > 0) return;
  ::close(channel_);
  throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(error)));
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : channel_(std::exchange(other.channel_, -1)), process_(std::exchange(other.process_, -1)), sent_(std::move(other.sent_)) {}

ChildProcess::~ChildProcess() {
  if (channel_ >= 0) ::close(channel_);
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
}

bool ChildProcess::read() {
  std::array<char, 65536> buffer{};
  while (true) {
    const ssize_t count = ::read(channel_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error(fmt::format("cannot read from a process: {}", std::strerror(errno)));
    sent_.append(buffer.data(), static_cast<std::size_t>(count));
    return count > 0;
  }
}

ChildEnd ChildProcess::end() {
  ChildEnd end;
  while (::waitpid(process_, &end.status, 0) < 0 && errno == EINTR) continue;
  process_ = -1;
  if (!WIFEXITED(end.status) || WEXITSTATUS(end.status) != 0 || sent_.empty()) return end;
  end.kind = static_cast<Kind>(sent_.front());
  end.text = sent_.substr(1);
  return end;
}

std::vector<std::string> run_in_processes(std::size_t count, std::size_t jobs,
                                          const std::function<std::string(std::size_t)>& work,
                                          const std::function<void(std::size_t)>& begun, const std::atomic<bool>& interrupt,
                                          const std::function<void(std::size_t, const std::string&)>& done) {
  struct Running {
    std::size_t index;
    ChildProcess child;
  };
  std::vector<Running> running;
  std::vector<std::string> results(count);
  for (std::size_t next = 0; next < count || !running.empty();) {
    if (interrupt) throw Interrupted();
    if (next < count && running.size() < std::max<std::size_t>(jobs, 1)) {
      begun(next);
      running.push_back({next, ChildProcess([&] { return work(next); })});
      ++next;
      continue;
    }
    std::vector<pollfd> channels;
    for (const Running& one : running) channels.push_back({one.child.channel(), POLLIN, 0});
    constexpr int a_second = 1000;  // ms, after which a set `interrupt` is seen
    if (::poll(channels.data(), channels.size(), a_second) <= 0) continue;
    std::vector<Running> left;
    for (std::size_t i = 0; i < running.size(); ++i) {
      if (channels[i].revents == 0 || running[i].child.read()) {
        left.push_back(std::move(running[i]));
      } else {
        const std::size_t index = running[i].index;
        results[index] = running[i].child.end().result();
        if (done) done(index, results[index]);
      }
    }
    running = std::move(left);
  }
  return results;
}

InterruptGuard::InterruptGuard(std::string_view notice) {
  interrupted.store(false);
  announcement = fmt::format("slipbench: {}; once more to stop at once\n", notice);
  on_terminal = isatty(STDERR_FILENO);
  struct sigaction action {};
  action.sa_handler = &note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&action.sa_mask);
  catch_unless_ignored(SIGINT, action, previous_int_);
  catch_unless_ignored(SIGTERM, action, previous_term_);
  catch_unless_ignored(SIGHUP, action, previous_hang_up_);
  action.sa_handler = SIG_IGN;
  action.sa_flags = 0;
  sigaction(SIGXFSZ, &action, &previous_file_size_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &previous_int_, nullptr);
  sigaction(SIGTERM, &previous_term_, nullptr);
  sigaction(SIGHUP, &previous_hang_up_, nullptr);
  sigaction(SIGXFSZ, &previous_file_size_, nullptr);
}

const std::atomic<bool>& InterruptGuard::flag() { return interrupted; }

}  // namespace slipbench
