// A library that takes signals when it is loaded, as UCX does with SIGHUP.
#include <csignal>
#include <initializer_list>

namespace {

[[gnu::constructor]] void take_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) {});
}

}  // namespace

extern "C" void nothing() {}
