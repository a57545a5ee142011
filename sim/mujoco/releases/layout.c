/* The layout of the release of MuJoCo whose headers it is compiled with. Fails to compile if the
 * pads cannot work in this release. tools/plugin/update_layouts.py compiles it for the releases of
 * layouts.h; for another release the plugin prints the command. */
#include <stddef.h>

#include <mujoco/mjplugin.h>
#include <mujoco/mujoco.h>

#include "members.h"

/* Types and functions that the pads rely on. */
#define FUNCTION(result, name, parameters) \
  _Static_assert(__builtin_types_compatible_p(__typeof__(&name), __typeof__(result(*) parameters)), #name " has another type");
SLIPBENCH_MUJOCO_FUNCTIONS(FUNCTION)
#define CONSTANT(name, symbol, value) _Static_assert(symbol == value, #symbol " has another value");
SLIPBENCH_MUJOCO_CONSTANTS(CONSTANT)
#define SAME(ours, theirs, member) \
  _Static_assert(offsetof(struct ours, member) == offsetof(theirs, member), #theirs "." #member " is elsewhere");
SAME(SlipbenchPlugin, mjpPlugin, name)
SAME(SlipbenchPlugin, mjpPlugin, nattribute)
SAME(SlipbenchPlugin, mjpPlugin, attributes)
SAME(SlipbenchPlugin, mjpPlugin, capabilityflags)
SAME(SlipbenchPlugin, mjpPlugin, needstage)
SAME(SlipbenchPlugin, mjpPlugin, nstate)
SAME(SlipbenchPlugin, mjpPlugin, nsensordata)
SAME(SlipbenchPlugin, mjpPlugin, init)
SAME(SlipbenchPlugin, mjpPlugin, destroy)
SAME(SlipbenchPlugin, mjpPlugin, copy)
SAME(SlipbenchPlugin, mjpPlugin, reset)
SAME(SlipbenchPlugin, mjpPlugin, compute)
SAME(SlipbenchPlugin, mjpPlugin, advance)
SAME(SlipbenchPlugin, mjpPlugin, visualize)
_Static_assert(sizeof(struct SlipbenchPlugin) == sizeof(mjpPlugin), "mjpPlugin has another size");
SAME(SlipbenchScene, mjvScene, maxgeom)
SAME(SlipbenchScene, mjvScene, ngeom)
SAME(SlipbenchScene, mjvScene, geoms)
SAME(SlipbenchGeom, mjvGeom, category)

/* Offsets; a member of another type does not compile. */
#define MODEL_COUNT(name) .name = _Generic(((mjModel*)0)->name, int : offsetof(mjModel, name), mjtLong : offsetof(mjModel, name)),
#define MODEL_VALUE(type, name, member) .name = _Generic(((mjModel*)0)->member, type : offsetof(mjModel, member)),
#define MODEL_ARRAY(type, name) .name = _Generic(((mjModel*)0)->name, type * : offsetof(mjModel, name)),
#define DATA_VALUE(type, name, member) .name = _Generic(((mjData*)0)->member, type : offsetof(mjData, member)),
#define DATA_ARRAY(type, name) .name = _Generic(((mjData*)0)->name, type * : offsetof(mjData, name)),
#define mjtLong __INT64_TYPE__

const struct SlipbenchLayout slipbench_mujoco_layout = {
    .version = mjVERSION_HEADER,
    .mjvGeom_size = sizeof(mjvGeom),
#if mjVERSION_HEADER < 340
    .sleep_flag = 0,
#else
    .sleep_flag = mjENBL_SLEEP,
#endif
#if mjVERSION_HEADER < 3011000
    .qM = offsetof(mjData, qM),
#else
    .qM = -1,
#endif
    SLIPBENCH_MODEL_MEMBERS(MODEL_COUNT, MODEL_VALUE, MODEL_ARRAY) SLIPBENCH_DATA_MEMBERS(DATA_VALUE, DATA_ARRAY)
#if mjVERSION_HEADER < 3014000
#define ABSENT_COUNT(name) .name = -1,
#define ABSENT_VALUE(type, name, member) .name = -1,
#define ABSENT_ARRAY(type, name) .name = -1,
        SLIPBENCH_METRIC_MODEL_MEMBERS(ABSENT_COUNT) SLIPBENCH_METRIC_DATA_MEMBERS(ABSENT_VALUE, ABSENT_ARRAY)
            .discrete = -1,
#else
        SLIPBENCH_METRIC_MODEL_MEMBERS(MODEL_COUNT) SLIPBENCH_METRIC_DATA_MEMBERS(DATA_VALUE, DATA_ARRAY)
            .discrete = mjINT_DISCRETE,
#endif
};

/* The names of the lists, so that a library compiled from other lists is recognised. */
#define NAME(name) #name " "
#define NAME_OF_VALUE(type, name, member) #name " "
#define NAME_OF_ARRAY(type, name) #name " "
const char slipbench_mujoco_members[] =
    SLIPBENCH_MODEL_MEMBERS(NAME, NAME_OF_VALUE, NAME_OF_ARRAY) SLIPBENCH_DATA_MEMBERS(NAME_OF_VALUE, NAME_OF_ARRAY)
        SLIPBENCH_METRIC_MODEL_MEMBERS(NAME) SLIPBENCH_METRIC_DATA_MEMBERS(NAME_OF_VALUE, NAME_OF_ARRAY);
