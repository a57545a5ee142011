#include "tools/base/workers/isolated_worker.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "sim/core/process/plugin_library.h"
#include "tools/base/files/reject.h"

namespace slipbench {
namespace {

using Kind = ChildEnd::Kind;

constexpr int no_memory = 12;  // status of a process that had none to begin its work with

constexpr double idle = std::numeric_limits<double>::infinity();

// On the clock that all processes share [s].
double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

[[noreturn]] void throw_system(const char* what) { reject("{}: {}", what, std::strerror(errno)); }

// A process ends with the one that made it, and leaves signals of the terminal or of a batch system to the first.
void depend_on(pid_t maker) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != maker) ::_exit(1);
  // Of the last two: what reads from the terminal or sets it fails, and does not wait for ever.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGTTIN, SIGTTOU}) std::signal(signal, SIG_IGN);
}

sigset_t end_of_child() {
  sigset_t set{};
  sigemptyset(&set);
  sigaddset(&set, SIGCHLD);
  return set;
}

}  // namespace

struct IsolatedWorker::Page {
  std::atomic<std::uint64_t> taken{0};  // the last request that a worker has begun
  std::atomic<double> begun{idle};      // s, when
  std::atomic<pid_t> worker{0};         // that there is, and what it has started: its group
  NotedCall call;                       // that is under way
  NotedCall lost;                       // that was when the latest worker was lost
  static_assert(std::atomic<double>::is_always_lock_free, "processes share it");
};

// A request, or an answer of the worker or, where it was lost, of its keeper.
struct IsolatedWorker::Message {
  std::uint64_t number = 0;  // of the request; of a loss, of the last one that was begun
  std::size_t value = 0;     // of a request the work's number, of an answer its size in bytes
  Kind kind = Kind::broken;
  bool late = false;  // it was ended for the limit
  int status = 0;     // waitpid's
};

IsolatedWorker::IsolatedWorker(const std::function<std::string(std::size_t)>& work, const WorkLimits& limits) : limits_(limits) {
  std::error_code gone;
  folder_ = std::filesystem::current_path(gone).string();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) throw_system("cannot make a socket");
  channel_ = ends[0];
  bytes_ = ::memfd_create("slipbench", MFD_CLOEXEC);
  void* const page = ::mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (bytes_ < 0 || page == MAP_FAILED) throw_system("cannot share memory");
  page_ = new (page) Page;
  std::fflush(nullptr);  // what waits would be written by each process that a library ends
  const pid_t self = ::getpid();
  keeper_ = ::fork();
  if (keeper_ == 0) {
    depend_on(self);
    try {
      keep_a_worker(ends[1], work);
    } catch (const std::bad_alloc&) {
      ::_exit(no_memory);  // unwinding would end the caller's other workers
    }
  }
  ::close(ends[1]);
  if (keeper_ < 0) throw_system("cannot start a process");
}

IsolatedWorker::~IsolatedWorker() {
  ::kill(keeper_, SIGKILL);
  while (::waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) continue;
  if (page_->worker > 0) ::kill(-page_->worker, SIGKILL);
  ::close(channel_);
  ::close(bytes_);
  ::munmap(page_, sizeof(Page));
  map(0);
}

void IsolatedWorker::keep_working(int channel, const std::function<std::string(std::size_t)>& work) {
  PluginLibrary::note_calls(page_->call);
  const pid_t self = ::getpid();
  const std::uint64_t memory = 1'000'000 * limits_.memory, full = memory > 0 ? own_bytes() + memory / 2 : 0;
  if (memory > 0) limit_memory(memory);
  Message message;
  while (::recv(channel, &message, sizeof message, 0) == sizeof message) {
    page_->begun = now();
    page_->taken = message.number;
    const ChildEnd end = ChildEnd::of([&] { return work(message.value); });
    if (::getpid() != self) ::_exit(0);  // a copy that the work has made of this process
    page_->begun = idle;
    message = {.number = message.number, .value = end.text.size(), .kind = end.kind};
    for (std::size_t done = 0; done < end.text.size();) {
      const ssize_t count = ::pwrite(bytes_, end.text.data() + done, end.text.size() - done, static_cast<off_t>(done));
      if (count < 0 && errno != EINTR) ::_exit(1);
      if (count > 0) done += static_cast<std::size_t>(count);
    }
    std::fflush(nullptr);  // what a library has printed
    if (::send(channel, &message, sizeof message, MSG_NOSIGNAL) < 0) break;
    if (!folder_.empty() && ::chdir(folder_.c_str()) != 0) break;
    if (memory > 0 && own_bytes() > full) break;  // what work has kept would be missed by the next
  }
  ::_exit(1);
}

void IsolatedWorker::keep_a_worker(int channel, const std::function<std::string(std::size_t)>& work) {
  constexpr rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const sigset_t ended = end_of_child();
  const pid_t self = ::getpid();
  while (true) {
    page_->begun = idle;
    page_->call.function.front() = '\0';
    ::sigprocmask(SIG_BLOCK, &ended, nullptr);
    const pid_t worker = ::fork();
    if (worker < 0) ::_exit(1);
    if (worker == 0) {
      ::setpgid(0, 0);  // with all that it starts
      ::sigprocmask(SIG_UNBLOCK, &ended, nullptr);
      depend_on(self);
      keep_working(channel, work);
    }
    page_->worker = worker;
    Message message;
    while (::waitpid(worker, &message.status, WNOHANG) == 0) {
      constexpr timespec a_while{.tv_sec = 0, .tv_nsec = 50'000'000};
      ::sigtimedwait(&ended, nullptr, &a_while);
      message.late = message.late || now() - page_->begun > limits_.time;
      if (message.late) ::kill(worker, SIGKILL);
    }
    ::kill(-worker, SIGKILL);
    page_->worker = 0;
    page_->lost = page_->call;
    message.number = page_->taken;
    if (::send(channel, &message, sizeof message, MSG_NOSIGNAL) < 0) ::_exit(1);
  }
}

std::string_view IsolatedWorker::run(std::size_t index, const std::atomic<bool>* interrupt) {
  while (true) {
    ask(index);
    const Message message = answer(index, interrupt);
    const bool lost = message.kind == Kind::broken;
    const bool alone = std::exchange(fresh_, lost);
    if (lost && !message.late && !alone) continue;
    if (lost) tell_loss(message);
    if (message.kind == Kind::no_memory) throw std::bad_alloc();
    if (message.value > mapped_size_) map(message.value + message.value / 4);
    const std::string_view text(mapped_, message.value);
    if (message.kind == Kind::bad_input) throw InputError(std::string(text));
    if (message.kind == Kind::failure) throw std::runtime_error(std::string(text));
    return text;
  }
}

void IsolatedWorker::ask(std::size_t index) {
  const Message request{.number = ++sent_, .value = index};
  if (::send(channel_, &request, sizeof request, MSG_NOSIGNAL) < 0) throw_system("a process has gone");
}

IsolatedWorker::Message IsolatedWorker::answer(std::size_t index, const std::atomic<bool>* interrupt) {
  constexpr int a_while = 100;  // ms, after which a set `interrupt` is seen
  constexpr int most = 3;       // workers lost, one after the other, before they had begun anything
  std::uint64_t begun = sent_;  // the last request of which a loss is known to have begun it
  for (int unbegun = 0; true;) {
    end_if(interrupt);
    pollfd ready{channel_, POLLIN, 0};
    if (::poll(&ready, 1, a_while) <= 0) continue;
    Message message;
    if (::recv(channel_, &message, sizeof message, 0) != sizeof message) throw std::runtime_error("a process has gone");
    if (message.number == sent_) return message;
    if (message.kind != Kind::broken) continue;  // of a request that was given up
    unbegun = message.number == std::exchange(begun, message.number) ? unbegun + 1 : 1;
    if (unbegun > most && WIFEXITED(message.status) && WEXITSTATUS(message.status) == no_memory) throw std::bad_alloc();
    if (unbegun > most) return message;
    // A worker was lost that had not begun this request. It may have taken it from the channel, or not: then it is done twice, and heard once.
    fresh_ = true;
    ask(index);
  }
}

void IsolatedWorker::tell_loss(const Message& message) const {
  const auto text = [](const auto& place) { return std::string(place.data(), ::strnlen(place.data(), place.size())); };
  const std::string key = text(page_->lost.key), function = text(page_->lost.function);
  const std::string subject = function.empty() ? "its process" : fmt::format("{}: {}", key, text(page_->lost.library));
  const std::string in = function.empty() ? "" : " in " + function;
  const std::string path = function.empty() ? "" : key;
  if (message.late)
    throw LostWork(path, fmt::format("{} was still at work{} after {:g} s, the limit", subject, in, limits_.time));
  if (!WIFSIGNALED(message.status))
    throw LostWork(path, fmt::format("{} ended{}{}", subject, function.empty() ? "" : " its process", in));
  throw LostWork(path, fmt::format("{} crashed{}: {}", subject, in, signal_text(WTERMSIG(message.status))));
}

void IsolatedWorker::map(std::size_t size) {
  if (mapped_ != nullptr) ::munmap(const_cast<char*>(mapped_), mapped_size_);
  mapped_ = nullptr;
  mapped_size_ = size;
  if (size == 0) return;
  void* const at = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, bytes_, 0);
  if (at == MAP_FAILED) throw_system("cannot share memory");
  mapped_ = static_cast<const char*>(at);
}

}  // namespace slipbench
