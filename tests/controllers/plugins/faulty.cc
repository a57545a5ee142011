// A library that lacks what its build does not define: VERSION, the version it claims to be built for, and MAKES, a controller.
#include "controllers/plugin_abi.h"

#ifdef VERSION
const unsigned slipbench_controller_abi = VERSION;
#endif

#ifdef MAKES
slipbench_controller slipbench_make_controller(const slipbench_channel* /*channels*/, size_t /*count*/) { return {}; }
#endif
