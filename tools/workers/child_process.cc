#include "tools/workers/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = ChildEnd::Kind;

// Polling period of the interrupt and the time limit.
constexpr std::chrono::milliseconds between_looks{50};

// Status of a child that another part of this process waited for, or with SIGCHLD ignored.
constexpr int no_status = -1;

// A child's message is a Header and a text that begins with one of these marks.
constexpr char result_mark = 'r', bad_input_mark = 'i', failure_mark = 'f';

// User code in a child may write to any descriptor, also to the pipe.
struct Header {
  std::uint64_t size, checksum;  // of the text
};

// FNV-1a over words of 8 bytes.
std::uint64_t checksum_of(std::string_view text) {
  std::uint64_t sum = 14695981039346656037ULL;
  for (std::size_t at = 0; at < text.size(); at += sizeof sum) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data() + at, std::min(sizeof word, text.size() - at));
    sum = (sum ^ word) * 1099511628211ULL;
  }
  return sum;
}

std::string framed(const std::string& text) {
  const Header header{text.size(), checksum_of(text)};
  std::string message(sizeof header, '\0');
  std::memcpy(message.data(), &header, sizeof header);
  return message + text;
}

// Returns the text of a whole message; nothing if it lacks bytes or contains others.
std::optional<std::string_view> unframed(std::string_view message) {
  Header header{};
  if (message.size() <= sizeof header) return std::nullopt;
  std::memcpy(&header, message.data(), sizeof header);
  const std::string_view text = message.substr(sizeof header);
  if (text.size() != header.size || checksum_of(text) != header.checksum) return std::nullopt;
  return text;
}

std::string message_of(const std::function<std::string()>& action) {
  try {
    return result_mark + action();
  } catch (const InputError& error) {
    return bad_input_mark + std::string(error.what());
  } catch (const std::bad_alloc&) {
    return failure_mark + std::string("out of memory");
  } catch (const std::exception& error) {
    return failure_mark + std::string(error.what());
  }
}

[[noreturn]] void be_the_child(int channel, const std::function<std::string()>& action) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The child is in a background process group, where reading from or configuring the terminal
  // would stop it.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGTTIN, SIGTTOU}) std::signal(signal, SIG_IGN);
  const pid_t self = ::getpid();
  const std::string message = framed(message_of(action));
  if (::getpid() != self) ::_exit(0);  // the action forked; this is the copy
  std::fflush(nullptr);                // output of libraries
  for (std::size_t sent = 0; sent < message.size();) {
    const ssize_t count = ::write(channel, message.data() + sent, message.size() - sent);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  ::_exit(0);  // skips the parent's clean-up and second flush
}

void end_group(pid_t process) {
  ::kill(-process, SIGKILL);
  ::kill(process, SIGKILL);  // the child may not have created its group yet
}

}  // namespace

std::string ChildEnd::loss(double limit) const {
  if (late) return fmt::format("was still running at the limit of {:g} s", limit);
  if (corrupt) return "returned an invalid result: its code wrote to a file descriptor that it had not opened";
  if (status == no_status) return "ended before its work was done";
  if (!WIFSIGNALED(status)) return fmt::format("ended with status {} before its work was done", WEXITSTATUS(status));
  const char* const name = ::sigabbrev_np(WTERMSIG(status));
  return fmt::format("was killed by SIG{} ({})", name == nullptr ? "?" : name, ::strsignal(WTERMSIG(status)));
}

std::string ChildEnd::result(const std::string& subject, double limit) && {
  if (kind == Kind::bad_input) throw InputError(text);
  if (kind == Kind::failure) throw std::runtime_error(text);
  if (kind == Kind::lost) reject("{}: its process {}", subject, loss(limit));
  return std::move(text);
}

ChildProcesses::ChildProcesses(double limit, Fork fork) : limit_(limit), fork_(fork ? std::move(fork) : Fork(&::fork)) {}

ChildProcesses::~ChildProcesses() {
  for (Child& child : running_) {
    end_group(child.process);
    static_cast<void>(end_of(child));
  }
}

void ChildProcesses::start(std::size_t index, const std::function<std::string()>& action) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) reject("cannot make a pipe: {}", std::strerror(errno));
  // A high number, which user code does not hit by chance.
  constexpr int least_descriptor = 500;
  if (const int high = ::fcntl(ends[1], F_DUPFD_CLOEXEC, least_descriptor); high >= 0) ::close(std::exchange(ends[1], high));
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::fflush(nullptr);  // otherwise the child would write the pending output too
  const pid_t process = fork_();
  if (process == 0) be_the_child(ends[1], action);
  const int end =
      process > 0 ? static_cast<int>(::syscall(SYS_pidfd_open, process, 0)) : -1;  // glibc 2.36 declares it for C only
  const int error = errno;
  ::close(ends[1]);
  running_.push_back({index, process, end, ends[0], Clock::now(), {}});
  // With SIGCHLD ignored a child disappears as soon as it ends; its message is in the pipe.
  if (end >= 0 || (process > 0 && error == ESRCH)) return;
  if (process > 0) end_group(process);
  static_cast<void>(end_of(running_.back()));
  running_.pop_back();
  reject("cannot start a process: {}", std::strerror(error));
}

// Reads the bytes that the pipe holds now.
void ChildProcesses::read(Child& child) {
  std::array<char, 65536> buffer{};
  while (child.channel >= 0) {
    const ssize_t count = ::read(child.channel, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;
    child.sent.append(buffer.data(), static_cast<std::size_t>(count));
    if (count == 0) ::close(std::exchange(child.channel, -1));
  }
}

// Call when the process has ended or was killed.
ChildEnd ChildProcesses::end_of(Child& child) {
  ChildEnd end;
  end.status = no_status;
  while (child.process > 0 && ::waitpid(child.process, &end.status, 0) < 0 && errno == EINTR) continue;
  read(child);
  if (child.channel >= 0) ::close(child.channel);  // a process started by the action may hold the other end open
  if (child.end >= 0) ::close(child.end);
  if (child.process > 0) ::kill(-child.process, SIGKILL);
  if (end.status != no_status && end.status != 0) return end;
  const std::optional<std::string_view> text = unframed(child.sent);
  end.corrupt = !text && !child.sent.empty() && end.status == 0;
  if (!text) return end;
  const char mark = text->front();
  end.kind = mark == result_mark ? Kind::result : mark == bad_input_mark ? Kind::bad_input : Kind::failure;
  end.text = text->substr(1);
  return end;
}

std::optional<std::pair<std::size_t, ChildEnd>> ChildProcesses::wait_until(Clock::time_point deadline) {
  while (true) {
    std::vector<pollfd> descriptors;
    for (const Child& child : running_) {
      descriptors.push_back({child.channel, POLLIN, 0});
      descriptors.push_back({child.end, POLLIN, 0});
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    const auto wait = std::clamp(left, std::chrono::milliseconds(0), between_looks);
    ::poll(descriptors.data(), descriptors.size(), static_cast<int>(wait.count()));
    for (std::size_t i = 0; i < running_.size(); ++i) {
      Child& child = running_[i];
      read(child);
      const bool late = std::chrono::duration<double>(Clock::now() - child.begun).count() > limit_;
      const bool ended = child.end < 0 || descriptors[2 * i + 1].revents != 0;
      if (!ended && !late) continue;
      if (!ended) end_group(child.process);
      std::pair<std::size_t, ChildEnd> found(child.index, end_of(child));
      found.second.late = !ended;
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      return found;
    }
    if (Clock::now() >= deadline) return std::nullopt;
  }
}

std::string run_in_child(const std::string& subject, const std::function<std::string()>& action,
                         const std::atomic<bool>* interrupt, double limit, const Fork& fork) {
  ChildProcesses children(limit, fork);
  children.start(0, action);
  while (true) {
    end_if(interrupt);
    if (auto ended = children.wait_until(Clock::now() + between_looks)) return std::move(ended->second).result(subject, limit);
  }
}

}  // namespace slipbench
