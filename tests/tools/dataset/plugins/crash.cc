// Loaded before all others (LD_PRELOAD), it crashes the program before main().
#include <csignal>

namespace {

[[gnu::constructor]] void crash() { static_cast<void>(std::raise(SIGSEGV)); }

}  // namespace
