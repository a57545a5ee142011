# Every package that any folder uses, found once, here. The Debian and PyPI names are in tools/setup.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)        # Eigen3::Eigen
find_package(yaml-cpp 0.7 REQUIRED)                # yaml-cpp
find_package(fmt REQUIRED)                         # fmt::fmt
find_package(nlohmann_json REQUIRED)               # nlohmann_json::nlohmann_json
find_package(CLI11 REQUIRED)                       # CLI11::CLI11
find_package(HDF5 REQUIRED COMPONENTS C)           # hdf5::hdf5
# Its interface of 1.10, Debian 12's, which 1.14 has too.
set_property(TARGET hdf5::hdf5 APPEND PROPERTY INTERFACE_COMPILE_DEFINITIONS H5_USE_110_API)
find_package(libdeflate REQUIRED)                  # libdeflate::libdeflate
find_package(LibArchive REQUIRED)                  # LibArchive::LibArchive
find_package(FFTW3 REQUIRED)                       # FFTW3::fftw3
find_package(NLopt REQUIRED)                       # NLopt::nlopt_cxx
find_package(Random123 REQUIRED)                   # Random123::Random123
find_package(OpenSSL REQUIRED COMPONENTS Crypto)   # OpenSSL::Crypto
find_package(ZLIB REQUIRED)                        # ZLIB::ZLIB
find_package(Threads REQUIRED)                     # Threads::Threads
find_package(SLEEF REQUIRED)                       # SLEEF::sleef
find_package(verilator 5.006 REQUIRED HINTS /usr/share/verilator $ENV{VERILATOR_ROOT})  # verilate()
if(SLIPBENCH_TESTS)
  find_package(GTest REQUIRED)                     # GTest::gtest_main, GTest::gmock
  if(EXISTS ${PROJECT_SOURCE_DIR}/build/venv/bin/python3)
    set(Python3_EXECUTABLE ${PROJECT_SOURCE_DIR}/build/venv/bin/python3)  # has numpy and h5py
  endif()
  find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)  # Python3_EXECUTABLE
endif()
if(SLIPBENCH_BENCHMARKS)
  find_package(benchmark REQUIRED)                 # benchmark::benchmark_main
endif()

# MuJoCo comes from the mujoco-core wheel. Without it everything but sim/mujoco is built; a wheel of another version is an error.
set(SLIPBENCH_MUJOCO_VERSION 4.0.1)
find_package(MuJoCo ${SLIPBENCH_MUJOCO_VERSION} EXACT)  # mujoco::mujoco
set(SLIPBENCH_WITH_MUJOCO ${MuJoCo_FOUND})
if(NOT SLIPBENCH_WITH_MUJOCO)
  if(MuJoCo_VERSION)
    message(FATAL_ERROR "MuJoCo ${MuJoCo_VERSION} in ${MuJoCo_ROOT_DIR} is not the pinned ${SLIPBENCH_MUJOCO_VERSION}. "
      "Get it with: tools/setup/setup.sh python")
  endif()
  message(STATUS "MuJoCo ${SLIPBENCH_MUJOCO_VERSION} not found: sim/mujoco is left out. Get it with: tools/setup/setup.sh python")
endif()

# An earlier release of MuJoCo, for which the plugin is built, too (tools/setup/setup.sh mujoco). Without its wheel that build is left out.
set(SLIPBENCH_EARLIER_MUJOCO_VERSION 3.3.7)
set(SLIPBENCH_EARLIER_MUJOCO_ROOT ${PROJECT_SOURCE_DIR}/build/mujoco/${SLIPBENCH_EARLIER_MUJOCO_VERSION}/mujoco CACHE PATH
  "The `mujoco` folder of an unpacked wheel of MuJoCo ${SLIPBENCH_EARLIER_MUJOCO_VERSION}")
set(SLIPBENCH_WITH_EARLIER_MUJOCO FALSE)
set(SLIPBENCH_PLUGIN_RELEASES ${SLIPBENCH_MUJOCO_VERSION})  # oldest first
set(earlier_library ${SLIPBENCH_EARLIER_MUJOCO_ROOT}/libmujoco.so.${SLIPBENCH_EARLIER_MUJOCO_VERSION})
if(SLIPBENCH_WITH_MUJOCO AND EXISTS ${earlier_library})
  set(SLIPBENCH_WITH_EARLIER_MUJOCO TRUE)
  list(PREPEND SLIPBENCH_PLUGIN_RELEASES ${SLIPBENCH_EARLIER_MUJOCO_VERSION})
  add_library(mujoco::earlier SHARED IMPORTED)
  set_target_properties(mujoco::earlier PROPERTIES
    IMPORTED_LOCATION ${earlier_library}
    IMPORTED_SONAME libmujoco.so.${SLIPBENCH_EARLIER_MUJOCO_VERSION}
    INTERFACE_INCLUDE_DIRECTORIES ${SLIPBENCH_EARLIER_MUJOCO_ROOT}/include)
elseif(SLIPBENCH_WITH_MUJOCO)
  message(STATUS "MuJoCo ${SLIPBENCH_EARLIER_MUJOCO_VERSION} not found: its build of the plugin is left out. Get it with: tools/setup/setup.sh mujoco")
endif()
list(JOIN SLIPBENCH_PLUGIN_RELEASES ", " SLIPBENCH_PLUGIN_VERSIONS)

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
  message(STATUS "No OpenVINO ${SLIPBENCH_OPENVINO_VERSION}, no libonnx-dev, or a sanitizer: detectors that are networks are left out. "
    "Get them with: tools/setup/setup.sh build python")
endif()
