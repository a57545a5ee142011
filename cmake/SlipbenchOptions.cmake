# How everything is compiled.
option(SLIPBENCH_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SLIPBENCH_BENCHMARKS "Build the benchmarks" ${PROJECT_IS_TOP_LEVEL})
option(SLIPBENCH_FUZZ "Build the fuzzers instrumented with libFuzzer, ASan and UBSan (clang only)" OFF)
option(SLIPBENCH_WERROR "Treat compiler warnings as errors" OFF)
set(SLIPBENCH_SANITIZE "" CACHE STRING "Sanitizers as -fsanitize= takes them, e.g. address,undefined")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug" FORCE)
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_OPTIMIZE_DEPENDENCIES ON)  # static libraries do not wait for the libraries that they link
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)

# Hardening that costs no instruction of a step: README.md has the table. Others are below and in SlipbenchLibrary.cmake.
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
add_link_options(-Wl,-z,relro,-z,now)

find_program(CCACHE ccache)
if(CCACHE AND SKBUILD)
  # The same settings as in the environment of the presets.
  set(CCACHE ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
endif()

if(SLIPBENCH_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "SLIPBENCH_FUZZ needs clang (libFuzzer): configure with --preset fuzz")
  endif()
  # Every library carries libFuzzer's coverage counters; only the fuzzers themselves link its main().
  add_compile_options(-fsanitize=fuzzer-no-link)
  set(SLIPBENCH_SANITIZE address,undefined)
endif()
if(SLIPBENCH_SANITIZE)
  add_compile_options(-fsanitize=${SLIPBENCH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(NOT SLIPBENCH_FUZZ)
    # Four checks stand before every access through a pointer and take a third of the compiler's time: of null and of an object's size the address
    # sanitizer reports what reads or writes; a misaligned number and a wrong dynamic type go unseen but by the fuzzers, which keep them all.
    add_compile_options(-fno-sanitize=null,object-size,alignment,vptr)
  endif()
  add_link_options(-fsanitize=${SLIPBENCH_SANITIZE})
endif()

# Warnings, without three that misfire inside std::string in GCC 12 (its bug 105329); and the floating-point contract: no fused multiply-add, so that
# every preset and every instruction set that the dispatched kernels use gives the same bytes. Loops become vector code only where a square root need not set errno and a
# select need not keep a trap, which changes no result.
# GCC collects garbage once it holds 1 GB, not at every few MB: a tenth of the time to compile.
add_library(slipbench_flags INTERFACE)
target_compile_options(slipbench_flags INTERFACE
  -Wall -Wextra -Wconversion -Wno-psabi -ffp-contract=off -fno-math-errno -fno-trapping-math
  $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},aarch64>:-U__ARM_FEATURE_FMA>  # by which Eigen decides to fuse
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>
  $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>  # else ccache keeps nothing that uses precompiled headers
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow> $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds> $<$<BOOL:${SLIPBENCH_WERROR}>:-Werror>)
# Binaries do not depend on the build's location: __FILE__ and the like begin at the source folder.
target_compile_options(slipbench_flags INTERFACE
  $<$<CONFIG:Release>:-ffile-prefix-map=${PROJECT_BINARY_DIR}=build> $<$<CONFIG:Release>:-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.>)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(slipbench_flags INTERFACE -D_FORTIFY_SOURCE=2)  # needs an optimiser, which knows the sizes
endif()
# All users of the precompiled headers must have the definitions that these were compiled with.
target_compile_definitions(slipbench_flags INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
