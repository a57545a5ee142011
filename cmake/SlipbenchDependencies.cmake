# Every package that any folder uses, found once, here. The Debian and PyPI names are in tools/setup.

# slipbench_need(Eigen3 3.4 NO_MODULE): find_package(), whose failures slipbench_report_missing() reports together.
set(missing_packages "")
macro(slipbench_need name)
  find_package(${name} ${ARGN} QUIET)
  if(NOT ${name}_FOUND)
    list(APPEND missing_packages ${name})
  endif()
endmacro()

# slipbench_report_missing(SETS): ends with the command that installs what is missing.
macro(slipbench_report_missing sets)
  if(missing_packages)
    list(JOIN missing_packages ", " missing_packages)
    message(FATAL_ERROR "These packages are missing, or are too old: ${missing_packages}. Install them on Debian 12 or 13, as root, with: "
      "tools/setup/setup.sh ${sets}. Their names are in tools/setup/packages.txt and tools/setup/requirements.in.")
  endif()
endmacro()

slipbench_need(Eigen3 3.4 NO_MODULE)        # Eigen3::Eigen
slipbench_need(yaml-cpp 0.7)                # yaml-cpp
slipbench_need(fmt)                         # fmt::fmt
slipbench_need(nlohmann_json)               # nlohmann_json::nlohmann_json
slipbench_need(CLI11)                       # CLI11::CLI11
slipbench_need(HDF5 COMPONENTS C)           # hdf5::hdf5
slipbench_need(libdeflate)                  # libdeflate::libdeflate
slipbench_need(LibArchive)                  # LibArchive::LibArchive
slipbench_need(FFTW3)                       # FFTW3::fftw3
slipbench_need(NLopt)                       # NLopt::nlopt_cxx
slipbench_need(Random123)                   # Random123::Random123
slipbench_need(OpenSSL COMPONENTS Crypto)   # OpenSSL::Crypto
slipbench_need(ZLIB)                        # ZLIB::ZLIB
slipbench_need(Threads)                     # Threads::Threads
slipbench_need(SLEEF)                       # SLEEF::sleef
slipbench_need(verilator 5.006 HINTS /usr/share/verilator $ENV{VERILATOR_ROOT})  # verilate()
slipbench_report_missing("build")
# The interface of HDF5 1.10, which Debian 12 has and 1.14 offers too.
set_property(TARGET hdf5::hdf5 APPEND PROPERTY INTERFACE_COMPILE_DEFINITIONS H5_USE_110_API)
if(SLIPBENCH_TESTS)
  slipbench_need(GTest)                     # GTest::gtest_main, GTest::gmock
  if(EXISTS ${PROJECT_SOURCE_DIR}/build/venv/bin/python3)
    set(Python3_EXECUTABLE ${PROJECT_SOURCE_DIR}/build/venv/bin/python3)  # has numpy and h5py
  endif()
  slipbench_need(Python3 3.11 COMPONENTS Interpreter)  # Python3_EXECUTABLE
endif()
if(SLIPBENCH_BENCHMARKS)
  slipbench_need(benchmark)                 # benchmark::benchmark_main
endif()
slipbench_report_missing("build test python test-python")

# MuJoCo comes from the mujoco-core wheel. Without it everything but sim/mujoco is built; a wheel of another version is an error. So is its absence for
# `pip install`, whose package would fail in use.
set(SLIPBENCH_MUJOCO_VERSION 4.0.1)
find_package(MuJoCo ${SLIPBENCH_MUJOCO_VERSION} EXACT)  # mujoco::mujoco
set(SLIPBENCH_WITH_MUJOCO ${MuJoCo_FOUND})
if(NOT SLIPBENCH_WITH_MUJOCO)
  if(MuJoCo_VERSION)
    message(FATAL_ERROR "MuJoCo ${MuJoCo_VERSION} in ${MuJoCo_ROOT_DIR} is not the pinned ${SLIPBENCH_MUJOCO_VERSION}. "
      "Get it with: tools/setup/setup.sh python")
  endif()
  if(SKBUILD)
    message(FATAL_ERROR "MuJoCo ${SLIPBENCH_MUJOCO_VERSION} not found, without which the package cannot run grasps. Without build isolation, "
      "get it with: pip install mujoco-core==${SLIPBENCH_MUJOCO_VERSION}")
  endif()
  message(STATUS "MuJoCo ${SLIPBENCH_MUJOCO_VERSION} not found: sim/mujoco is left out. Get it with: tools/setup/setup.sh python")
endif()

# The releases of MuJoCo that the plugin supports, oldest first: SLIPBENCH_PLUGIN_RELEASES; those that the default test suite loads:
# SLIPBENCH_DEFAULT_RELEASES. tools/setup/setup.sh mujoco or mujoco-all installs them for the tests; the build needs none.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/setup/requirements-mujoco.in)
file(STRINGS ${PROJECT_SOURCE_DIR}/tools/setup/requirements-mujoco.in release_lines REGEX "^mujoco")
set(SLIPBENCH_PLUGIN_RELEASES "")
set(SLIPBENCH_DEFAULT_RELEASES "")
foreach(line IN LISTS release_lines)
  string(REGEX REPLACE ".*==([0-9.]+).*" "\\1" release ${line})
  list(APPEND SLIPBENCH_PLUGIN_RELEASES ${release})
  if(line MATCHES "# default")
    list(APPEND SLIPBENCH_DEFAULT_RELEASES ${release})
  endif()
endforeach()
list(APPEND SLIPBENCH_PLUGIN_RELEASES ${SLIPBENCH_MUJOCO_VERSION})
list(APPEND SLIPBENCH_DEFAULT_RELEASES ${SLIPBENCH_MUJOCO_VERSION})

# OpenVINO, from its wheel, runs networks (detectors/network); the protobuf classes of ONNX look into their files before. Without either everything
# else is built; a wheel of another version is an error.
set(SLIPBENCH_OPENVINO_VERSION 2026.4.1)
find_package(OpenVINO ${SLIPBENCH_OPENVINO_VERSION} EXACT QUIET)  # openvino::runtime
find_package(Protobuf QUIET)                       # protobuf::libprotobuf, which ONNX's own configuration names and does not find
if(Protobuf_FOUND)
  find_package(ONNX QUIET)                         # ONNX::onnx, ONNX::onnx_proto; Debian 12's has no namespace
  foreach(library onnx onnx_proto)
    if(TARGET ${library} AND NOT TARGET ONNX::${library})
      add_library(ONNX::${library} ALIAS ${library})
    endif()
  endforeach()
endif()
# OpenVINO loads a library of its own in a way (RTLD_DEEPBIND) for which sanitizers end a program.
if(OpenVINO_FOUND AND TARGET ONNX::onnx_proto AND NOT SLIPBENCH_SANITIZE)
  set(SLIPBENCH_WITH_OPENVINO TRUE)
else()
  set(SLIPBENCH_WITH_OPENVINO FALSE)
  if(NOT OpenVINO_FOUND AND OpenVINO_VERSION)
    message(FATAL_ERROR "OpenVINO ${OpenVINO_VERSION} in ${OpenVINO_ROOT_DIR} is not the pinned ${SLIPBENCH_OPENVINO_VERSION}. "
      "Get it with: tools/setup/setup.sh python")
  endif()
  if(SKBUILD)
    message(FATAL_ERROR "OpenVINO ${SLIPBENCH_OPENVINO_VERSION} or libonnx-dev not found, without which the package cannot run networks. "
      "Get them with: tools/setup/setup.sh build, and, without build isolation, pip install openvino==${SLIPBENCH_OPENVINO_VERSION}")
  endif()
  message(STATUS "No OpenVINO ${SLIPBENCH_OPENVINO_VERSION}, no libonnx-dev, or a sanitizer: detectors that are networks are left out. "
    "Get them with: tools/setup/setup.sh build python")
endif()
