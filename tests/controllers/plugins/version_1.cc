// A library of the interface's first version, which exported only its version.
#include <cstddef>

extern "C" {
extern const unsigned slipbench_controller_abi;
const unsigned slipbench_controller_abi = 1;
int slipbench_make_controller(const void* channels, size_t count);
int slipbench_make_controller(const void* /*channels*/, size_t /*count*/) { return 0; }
}
