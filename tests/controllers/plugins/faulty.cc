// A library without the parts that its build does not define: VERSION, the version it claims to be
// built for, and MAKES, a controller.
#include "controllers/plugin_abi.h"

#ifdef VERSION
const slipbench_abi slipbench_controller_abi = {VERSION, SLIPBENCH_SHARED_SIZES, sizeof(slipbench_controller),
                                                sizeof(slipbench_control_input), sizeof(slipbench_grip_command)};
#endif

#ifdef MAKES
void slipbench_make_controller(const slipbench_source* /*source*/, slipbench_controller* /*controller*/) {}
#endif
