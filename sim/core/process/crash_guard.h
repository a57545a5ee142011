// A call into somebody else's code whose crash ends the call and not the program.
//
// What it promises: SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT that the calling thread itself raises during the call, an
// overflow of its stack among them, come back as a number. Every other thread, and this one outside of such a call, keeps what
// would have happened: the handlers that were there before are called, else the program ends as it would have.
//
// What it cannot promise:
// - What the code held when it crashed stays held: memory, files, a lock. A crash inside the allocator or inside stdio may leave
//   a lock of the whole process taken, at which the program hangs later.
// - Memory that the code overwrote before it crashed stays overwritten.
// - Threads that the code has started are not guarded, nor is a handler for these signals that it sets, a call of exit(), or what
//   runs when the program ends, such as destructors of static objects.
// - A loop without end is no crash.
// - Sanitizers: what a sanitizer finds by itself ends the program with its report, as it should; a signal that nothing has
//   foreseen comes back here. Under the sanitizer of threads, which holds signals back and follows jumps by itself, a crash may
//   end the program.
//
// Handlers belong to the process: the first guarded call sets them, they stay, and who sets others later takes their place. Which
// thread is inside of a guarded call is known by thread. A call costs tens of ns.
#pragma once

#include <memory>
#include <string>

namespace slipbench {

// Runs call(context). Returns 0, or the signal by which it crashed: no destructor of what the call had begun has run then. Lets
// exceptions pass. The first call of a thread throws std::bad_alloc where no stack for the handlers is to be had.
int run_guarded(void (*call)(void*), void* context);

// The same for anything that can be called.
template <class Call>
int run_guarded(Call& call) {
  return run_guarded([](void* context) { (*static_cast<Call*>(context))(); }, std::addressof(call));
}

// A signal for a message: "SIGSEGV (segmentation fault)".
std::string signal_text(int signal);

}  // namespace slipbench
