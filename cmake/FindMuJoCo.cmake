# Finds MuJoCo inside an unpacked mujoco-core wheel and defines mujoco::mujoco.
# Looked for in SLIPBENCH_MUJOCO_ROOT (the wheel's `mujoco` folder), else in build/venv of the source tree.
# Sets MuJoCo_FOUND, MuJoCo_VERSION, MuJoCo_ROOT_DIR, MuJoCo_LIBRARY, MuJoCo_LICENCES (files).
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_in_wheel(MuJoCo SLIPBENCH_MUJOCO_ROOT mujoco)

set(_mujoco_header ${MuJoCo_ROOT_DIR}/include/mujoco/mujoco.h)
if(MuJoCo_ROOT_DIR AND EXISTS ${_mujoco_header})
  # mjVERSION_HEADER is major * 1e6 + minor * 1e3 + patch.
  file(STRINGS ${_mujoco_header} _mujoco_line REGEX "#define mjVERSION_HEADER [0-9]+")
  string(REGEX REPLACE ".*mjVERSION_HEADER ([0-9]+).*" "\\1" _mujoco_number "${_mujoco_line}")
  math(EXPR _mujoco_major "${_mujoco_number} / 1000000")
  math(EXPR _mujoco_minor "${_mujoco_number} / 1000 % 1000")
  math(EXPR _mujoco_patch "${_mujoco_number} % 1000")
  set(MuJoCo_VERSION ${_mujoco_major}.${_mujoco_minor}.${_mujoco_patch})
  if(EXISTS ${MuJoCo_ROOT_DIR}/libmujoco.so.${MuJoCo_VERSION})
    set(MuJoCo_LIBRARY ${MuJoCo_ROOT_DIR}/libmujoco.so.${MuJoCo_VERSION})
  endif()
  # In the wheel as pip unpacks it; in an installed copy beside the library.
  file(GLOB MuJoCo_LICENCES ${MuJoCo_ROOT_DIR}/../mujoco_core-*.dist-info/licenses/LICENSE* ${MuJoCo_ROOT_DIR}/LICENSE*)
endif()

find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_ROOT_DIR VERSION_VAR MuJoCo_VERSION)

if(MuJoCo_FOUND AND NOT TARGET mujoco::mujoco)
  add_library(mujoco::mujoco SHARED IMPORTED)
  set_target_properties(mujoco::mujoco PROPERTIES
    IMPORTED_LOCATION ${MuJoCo_LIBRARY}
    IMPORTED_SONAME libmujoco.so.${MuJoCo_VERSION}
    INTERFACE_INCLUDE_DIRECTORIES ${MuJoCo_ROOT_DIR}/include)
endif()
