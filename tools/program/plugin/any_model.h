// mjModel and mjData of whatever release is loaded, for libslipbench_mujoco-others.so: CMakeLists.txt puts this in place of both structures in
// MuJoCo's headers. A member is empty and stands where its structure begins; reading it reads the place that the loaded release has it at, so that
// sources which know nothing of this work in every release of mujoco_layouts.h.
#pragma once

#include <cstdint>

#include "tools/program/plugin/mujoco_layouts.h"

namespace slipbench::any_mujoco {

// Rows of the table: one a member, then the numbers.
enum Row : int {
#define SLIPBENCH_ROW(type, name, ...) row_##name,
  SLIPBENCH_COUNT_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_OPTION_MEMBERS(SLIPBENCH_ROW)
      SLIPBENCH_FORCE_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_DATA_MEMBERS(SLIPBENCH_ROW)
#undef SLIPBENCH_ROW
#define SLIPBENCH_ROW(name, ...) name##_number,
          SLIPBENCH_MUJOCO_NUMBERS(SLIPBENCH_ROW)
#undef SLIPBENCH_ROW
              row_count
};

// The loaded release's column of the table: any_mujoco.cc fills it before anything is registered.
extern int places[row_count];

inline int number(Row row) { return places[row]; }

template <class T, Row row>
class Member {
 public:
  Member() = delete;
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;
  operator T&() const {
    return *reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(this) + static_cast<std::uintptr_t>(places[row]));
  }
  T& operator=(T value) { return static_cast<T&>(*this) = value; }
  T& operator|=(T value) { return static_cast<T&>(*this) |= value; }
};

// How many of something: an int, since 3.5.0 an int64_t.
template <Row row>
class Count {
 public:
  Count() = delete;
  Count(const Count&) = delete;
  Count& operator=(const Count&) = delete;
  operator std::int64_t() const {
    const auto place = reinterpret_cast<std::uintptr_t>(this) + static_cast<std::uintptr_t>(places[row]);
    return places[count_bytes_number] == sizeof(int) ? *reinterpret_cast<const int*>(place)
                                                     : *reinterpret_cast<const std::int64_t*>(place);
  }
  std::int64_t operator=(int value) {
    const auto place = reinterpret_cast<std::uintptr_t>(this) + static_cast<std::uintptr_t>(places[row]);
    if (places[count_bytes_number] == sizeof(int)) return *reinterpret_cast<int*>(place) = value;
    return *reinterpret_cast<std::int64_t*>(place) = value;
  }
};

}  // namespace slipbench::any_mujoco

#define SLIPBENCH_COUNT(type, name, ...) \
  [[no_unique_address]] slipbench::any_mujoco::Count<slipbench::any_mujoco::row_##name> name;
#define SLIPBENCH_MEMBER(type, name, ...) \
  [[no_unique_address]] slipbench::any_mujoco::Member<type, slipbench::any_mujoco::row_##name> name;

struct mjModel_ {
  SLIPBENCH_COUNT_MEMBERS(SLIPBENCH_COUNT)
  SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_MEMBER)
  [[no_unique_address]] struct Option { SLIPBENCH_OPTION_MEMBERS(SLIPBENCH_MEMBER) } opt;
  [[no_unique_address]] struct Visual {
    [[no_unique_address]] struct Map { SLIPBENCH_FORCE_MEMBERS(SLIPBENCH_MEMBER) } map;
  } vis;
};
typedef struct mjModel_ mjModel;

struct mjData_ {
  SLIPBENCH_DATA_MEMBERS(SLIPBENCH_MEMBER)
};
typedef struct mjData_ mjData;

#undef SLIPBENCH_COUNT
#undef SLIPBENCH_MEMBER

// The structures of a release begin where these do.
static_assert(sizeof(mjModel_) == 1 && sizeof(mjData_) == 1);
