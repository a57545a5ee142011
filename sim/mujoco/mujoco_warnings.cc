#include "sim/mujoco/mujoco_warnings.h"

#include <string>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

// Returns the body of the degree of freedom or coordinate that a warning names, or nothing.
std::string body_of(const mjModel* model, int warning, int info) {
  int body = -1;
  if (warning == mjWARN_INERTIA || warning == mjWARN_BADQVEL || warning == mjWARN_BADQACC) {
    if (info >= 0 && info < model->nv) body = model->dof_bodyid[info];
  } else if (warning == mjWARN_BADQPOS) {
    for (int j = 0; j < model->njnt; ++j) {
      if (model->jnt_qposadr[j] <= info) body = model->jnt_bodyid[j];
    }
  }
  const char* name = body < 0 ? nullptr : mj_id2name(model, mjOBJ_BODY, body);
  return name == nullptr ? "" : fmt::format(", body '{}'", name);
}

}  // namespace

void refuse_warnings(const mjModel* model, const mjData* data, double time) {
  for (int w = 0; w < mjNWARNING; ++w) {
    if (data->warning[w].number == 0) continue;
    const int info = data->warning[w].lastinfo;
    throw FailedRun(fmt::format("MuJoCo warns: {} (at {:.6g} s{})", mju_warningText(w, static_cast<std::size_t>(info)), time,
                                body_of(model, w, info)));
  }
}

}  // namespace slipbench
