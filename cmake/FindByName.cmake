# How the project's Find modules find what has no CMake configuration that serves.
#
# find_by_name(FFTW3 HEADER fftw3.h LIBRARY fftw3 TARGET FFTW3::fftw3)
# For a module Find<NAME>.cmake whose library has no CMake configuration: finds header and library by their names and defines TARGET.
#
# find_in_wheel(MuJoCo SLIPBENCH_MUJOCO_ROOT mujoco)
# Sets MuJoCo_ROOT_DIR to the folder `mujoco` of an installed wheel: that of the cache variable, else, for `pip install`, the one in the environment
# of the build, else the one in build/venv of the source tree.
include(FindPackageHandleStandardArgs)

macro(find_by_name name)
  cmake_parse_arguments(_find "" "HEADER;LIBRARY;TARGET" "" ${ARGN})
  find_path(${name}_INCLUDE_DIR ${_find_HEADER})
  find_library(${name}_LIBRARY ${_find_LIBRARY})
  mark_as_advanced(${name}_INCLUDE_DIR ${name}_LIBRARY)
  find_package_handle_standard_args(${name} REQUIRED_VARS ${name}_LIBRARY ${name}_INCLUDE_DIR)
  if(${name}_FOUND AND NOT TARGET ${_find_TARGET})
    add_library(${_find_TARGET} UNKNOWN IMPORTED)
    set_target_properties(${_find_TARGET} PROPERTIES
      IMPORTED_LOCATION ${${name}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${${name}_INCLUDE_DIR})
  endif()
endmacro()

macro(find_in_wheel name variable folder)
  set(${variable} "" CACHE PATH "The `${folder}` folder of an installed wheel")
  if(${variable})
    set(${name}_ROOT_DIR ${${variable}})
  elseif(SKBUILD)
    execute_process(
      COMMAND ${Python_EXECUTABLE} -c "import importlib.util as util; print(*(util.find_spec('${folder}') or util.find_spec('sys')).submodule_search_locations or ())"
      OUTPUT_VARIABLE ${name}_ROOT_DIR OUTPUT_STRIP_TRAILING_WHITESPACE)
  else()
    file(GLOB ${name}_ROOT_DIR ${PROJECT_SOURCE_DIR}/build/venv/lib/python3*/site-packages/${folder})
  endif()
  unset(${name}_VERSION)
  unset(${name}_LIBRARY)
endmacro()
