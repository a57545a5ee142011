// A loaded MuJoCo of any supported release: its functions, and its models and data by the offsets of
// that release. The pads use MuJoCo only through this header, so they are compiled once for all
// releases.
#pragma once

#include <cstddef>

#include "sim/mujoco/releases/members.h"

namespace slipbench {

// MuJoCo's constants that the pads use, the same in all releases: mj::geom is mjOBJ_GEOM.
namespace mj {
#define SLIPBENCH_CONSTANT(name, symbol, value) inline constexpr int name = value;
SLIPBENCH_MUJOCO_CONSTANTS(SLIPBENCH_CONSTANT)
#undef SLIPBENCH_CONSTANT
}  // namespace mj

// The functions have the names and the parameters of MuJoCo's.
struct MujocoLibrary {
  SlipbenchLayout layout{};
#define SLIPBENCH_FUNCTION(result, name, parameters) result(*name) parameters = nullptr;
  SLIPBENCH_MUJOCO_FUNCTIONS(SLIPBENCH_FUNCTION)
#undef SLIPBENCH_FUNCTION
  void (*mj_fullM)() = nullptr;  // its type depends on the release: full_inertia()
  // No header declares these two. implicit_self_test() verifies their types on the actual model.
  // Null in releases without a usable metric.
  void* (*mj_arenaAllocByte)(mjData_* d, std::size_t bytes, std::size_t alignment) = nullptr;
  void (*mj_effShift)(const mjModel_* m, mjData_* d) = nullptr;

  // True if the integrator `discrete` has a metric to which pads can add rows.
  [[nodiscard]] bool has_metric() const { return mj_arenaAllocByte != nullptr && mj_effShift != nullptr; }
};

// The MuJoCo that the program links. Only programs that simulate scenes contain it; the plugin's
// library does not.
const MujocoLibrary& own_mujoco();

// An mjModel or an mjData by the layout of its release. The accessors have the names of MuJoCo's
// members, with an underscore for a dot, and allow writing, since MuJoCo passes a const model even
// to callbacks that own it.
#define SLIPBENCH_COUNT(name) \
  [[nodiscard]] int& name() const { return at<int>(mujoco_->layout.name); }
#define SLIPBENCH_VALUE(type, name, member) \
  [[nodiscard]] type& name() const { return at<type>(mujoco_->layout.name); }
#define SLIPBENCH_ARRAY(type, name) \
  [[nodiscard]] type*& name() const { return at<type*>(mujoco_->layout.name); }

class ModelView {
 public:
  ModelView(const mjModel_* model, const MujocoLibrary& mujoco = own_mujoco()) : model_(model), mujoco_(&mujoco) {}

  [[nodiscard]] const mjModel_* get() const { return model_; }
  [[nodiscard]] const MujocoLibrary& mujoco() const { return *mujoco_; }

  // Returns the name of an object, or null. `type`: mj::geom and others.
  [[nodiscard]] const char* name_of(int type, int id) const { return mujoco_->mj_id2name(model_, type, id); }

  // COUNT reads the lower half of a 64-bit integer, which is the first in little-endian memory.
  SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_COUNT, SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
  SLIPBENCH_METRIC_MODEL_MEMBERS(SLIPBENCH_COUNT)

 private:
  template <class T>
  [[nodiscard]] T& at(int offset) const {
    return *reinterpret_cast<T*>(reinterpret_cast<char*>(const_cast<mjModel_*>(model_)) + offset);
  }

  const mjModel_* model_;
  const MujocoLibrary* mujoco_;
};

class DataView {
 public:
  DataView(const mjData_* data, const MujocoLibrary& mujoco = own_mujoco())
      : data_(const_cast<mjData_*>(data)), mujoco_(&mujoco) {}

  [[nodiscard]] mjData_* get() const { return data_; }
  [[nodiscard]] const MujocoLibrary& mujoco() const { return *mujoco_; }

  SLIPBENCH_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
  SLIPBENCH_METRIC_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
  [[nodiscard]] double* qM() const { return at<double*>(mujoco_->layout.qM); }

 private:
  template <class T>
  [[nodiscard]] T& at(int offset) const {
    return *reinterpret_cast<T*>(reinterpret_cast<char*>(data_) + offset);
  }

  mjData_* data_;
  const MujocoLibrary* mujoco_;
};

#undef SLIPBENCH_COUNT
#undef SLIPBENCH_VALUE
#undef SLIPBENCH_ARRAY

// True if the flag `sleep` is on. Releases before 3.4.0 do not have it.
inline bool sleep_enabled(ModelView m) { return (m.opt_enableflags() & m.mujoco().layout.sleep_flag) != 0; }

// Writes the joint-space inertia [nv, nv]; `d` must have been through mj_fwdPosition.
inline void full_inertia(ModelView m, DataView d, double* to) {
  constexpr int since = 3'010'000;
  if (m.mujoco().layout.version >= since) {
    reinterpret_cast<void (*)(const mjModel_*, const mjData_*, double*)>(m.mujoco().mj_fullM)(m.get(), d.get(), to);
  } else {
    reinterpret_cast<void (*)(const mjModel_*, double*, const double*)>(m.mujoco().mj_fullM)(m.get(), to, d.qM());
  }
}

}  // namespace slipbench
