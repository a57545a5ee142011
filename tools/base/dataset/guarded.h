// Reading files that may be damaged.
#pragma once

#include <functional>
#include <string>

namespace slipbench {

// Runs `action` in a child process and hands back what it returns. HDF5 checks few of the bytes that it reads, so that a damaged
// file can end the process that reads it; here that ends the child, and is an InputError "SUBJECT: is damaged: ...".
// An InputError in the child is thrown again as one, any other exception as std::runtime_error. Call it before any thread is made.
std::string guarded(const std::string& subject, const std::function<std::string()>& action);

}  // namespace slipbench
