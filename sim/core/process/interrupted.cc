#include "sim/core/process/interrupted.h"

#include <utility>

namespace slipbench {
namespace {

thread_local const std::atomic<bool>* interrupt_of_thread = nullptr;

}  // namespace

InterruptScope::InterruptScope(const std::atomic<bool>* interrupt) : previous_(std::exchange(interrupt_of_thread, interrupt)) {}
InterruptScope::~InterruptScope() { interrupt_of_thread = previous_; }

void end_if_interrupted() { end_if(interrupt_of_thread); }

}  // namespace slipbench
