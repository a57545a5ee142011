#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/implicit.h"

namespace slipbench {

void prepare_implicit(mjSpec* spec, std::span<const SitePair> pairs) {
  for (const SitePair& pair : pairs) {
    for (const std::string& site : {pair.pad_site, pair.object_site}) {
      if (mjs_findElement(spec, mjOBJ_SITE, site.c_str()) == nullptr) {
        throw std::invalid_argument("implicit fields: the model has no site '" + site + "'");
      }
    }
  }
  spec->option.integrator = mjINT_DISCRETE;
  spec->option.noslip_iterations = 0;
  if (spec->option.solver == mjSOL_PGS) spec->option.solver = mjSOL_NEWTON;
  for (const SitePair& pair : pairs) {
    mjsTendon* tendon = mjs_addTendon(spec, nullptr);
    tendon->damping[0] = 1e-9;  // N s/m, so small that it damps nothing, and not zero
    tendon->rgba[3] = 0.0F;
    mjs_wrapSite(tendon, pair.pad_site.c_str());
    mjs_wrapSite(tendon, pair.object_site.c_str());
  }
}

}  // namespace slipbench
