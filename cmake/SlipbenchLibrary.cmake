# Headers that most sources include, precompiled once: they would take 2 to 4 s of every source
# (GCC 12). nlohmann/json.hpp is none: GCC instantiates its templates in each source that is compiled
# with the precompiled header, 0.8 s, and one source in ten includes it. Sources still include the headers that they use, and clang-tidy reads them without
# precompiled headers.
set(SLIPBENCH_COMMON_HEADERS
  <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <ranges> <span> <sstream> <stdexcept> <string>
  <string_view> <utility> <variant> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h>)

# slipbench_precompile(KIND hot TARGET slipbench_core HEADERS <gtest/gtest.h>)
# The first target of a kind compiles the common headers and HEADERS; the others use them. All targets
# of a kind must have the same options, because GCC takes the optimisation options from the precompiled
# header instead of the command line, without a warning.
function(slipbench_precompile)
  cmake_parse_arguments(ARG "" "KIND;TARGET" "HEADERS" ${ARGN})
  get_property(first GLOBAL PROPERTY SLIPBENCH_FIRST_${ARG_KIND})
  if(first)
    target_precompile_headers(${ARG_TARGET} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY SLIPBENCH_FIRST_${ARG_KIND} ${ARG_TARGET})
    target_precompile_headers(${ARG_TARGET} PRIVATE ${SLIPBENCH_COMMON_HEADERS} ${ARG_HEADERS})
  endif()
endfunction()

# Where a library or a test names no SOURCES they are its folder's.
macro(slipbench_sources)
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cc)
  endif()
endmacro()

# slipbench_library(NAME core SOURCES a.cc b.cc DEPENDS Eigen3::Eigen PRIVATE fmt::fmt)
# One target a folder: slipbench_<NAME>, alias slipbench::<NAME>, installed and exported with its headers.
# COLD: runs once a command and not once a step, so that the time to compile it counts and its own speed does not (-O1, stack
# protector, containers that check their indices).
# GUARDED: reads the files of others (stack protector; the precompiled headers are of libraries without it).
function(slipbench_library)
  cmake_parse_arguments(ARG "COLD;GUARDED" "NAME" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  set(target slipbench_${ARG_NAME})
  slipbench_sources()
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(slipbench::${ARG_NAME} ALIAS ${target})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/slipbench>)
  target_compile_features(${target} PUBLIC cxx_std_20)  # for those who use an installed copy
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:slipbench_flags>)
  if(ARG_COLD)
    target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1;-fstack-protector-strong;-D_GLIBCXX_ASSERTIONS>" $<$<CONFIG:Debug>:-O0>)
    slipbench_precompile(KIND cold TARGET ${target})
  elseif(ARG_GUARDED)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-fstack-protector-strong>)
  else()
    slipbench_precompile(KIND hot TARGET ${target})
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${ARG_NAME} UNITY_BUILD_BATCH_SIZE 24)  # by 8 the whole takes a tenth longer
  set_property(GLOBAL APPEND PROPERTY SLIPBENCH_TARGETS ${target})
endfunction()

# slipbench_bundled_sensor(gel_markers)
# The library of a sensor whose one source, NAME.cc, is written as that of a library of one's own: SensorKind NAME_sensor() makes it one of the program's.
function(slipbench_bundled_sensor name)
  slipbench_library(NAME ${name} SOURCES ${name}.cc ${PROJECT_SOURCE_DIR}/sensors/plugins/bundled_kind.cc DEPENDS slipbench::sensor_plugins)
  target_compile_definitions(slipbench_${name} PRIVATE SLIPBENCH_BUNDLED_TYPE="${name}" SLIPBENCH_BUNDLED_KIND=${name}_sensor)
  foreach(exported make_sensor sensor_abi sensor_parameters sensor_about)
    target_compile_definitions(slipbench_${name} PRIVATE slipbench_${exported}=${name}_${exported})
  endforeach()
endfunction()

# slipbench_test_plugin(TEST controllers NAME echo SOURCE plugins/echo.cc DEFINES VERSION=3)
# A shared library as a user would build one, plugins/echo.so in the build folder of the test that loads it, which knows that folder as
# SLIPBENCH_TEST_PLUGINS.
function(slipbench_test_plugin)
  cmake_parse_arguments(ARG "" "TEST;NAME;SOURCE" "DEFINES" ${ARGN})
  set(target ${ARG_TEST}_${ARG_NAME})
  add_library(${target} MODULE ${ARG_SOURCE})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${target} PRIVATE ${ARG_DEFINES})
  target_link_libraries(${target} PRIVATE slipbench_flags)
  set_target_properties(${target} PROPERTIES
    PREFIX "" SUFFIX .so OUTPUT_NAME ${ARG_NAME} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/plugins)
  add_dependencies(${ARG_TEST}_test ${target})
  target_compile_definitions(${ARG_TEST}_test PRIVATE SLIPBENCH_TEST_PLUGINS="${CMAKE_CURRENT_BINARY_DIR}/plugins")
endfunction()

# slipbench_extra(rtl_bench ...): programs that only the target `extra_tests` builds, for `./slipbench test --all`.
function(slipbench_extra)
  set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL TRUE)
  set_property(GLOBAL APPEND PROPERTY SLIPBENCH_EXTRA_PROGRAMS ${ARGN})
endfunction()

# slipbench_test(NAME units SOURCES quantity_test.cc DEPENDS slipbench::core)
# A GoogleTest program whose tests ctest lists one by one. What only `./slipbench test --all` runs,
# except under the sanitizers, which run all:
# SLOW: tests or suites such as "Board.*", each one test of ctest with the label `all`.
# ONLY_ALL: the whole program, one test of ctest; only the target `extra_tests` builds it.
function(slipbench_test)
  cmake_parse_arguments(ARG "ONLY_ALL" "NAME" "SOURCES;DEPENDS;SLOW" ${ARGN})
  if(SLIPBENCH_SANITIZE)
    set(ARG_ONLY_ALL FALSE)
    set(ARG_SLOW "")
  endif()
  set(target ${ARG_NAME}_test)
  slipbench_sources()
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest_main slipbench_flags)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og> $<$<CONFIG:Debug>:-O0>)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${target} PRIVATE SLIPBENCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SLIPBENCH_PROGRAM="$<TARGET_FILE:slipbench>")
  slipbench_precompile(KIND test TARGET ${target} HEADERS <gmock/gmock.h> <gtest/gtest.h>)
  add_dependencies(${target} slipbench-reader)  # beside them, for files of others
  if(ARG_ONLY_ALL)
    slipbench_extra(${target})
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES LABELS all)
    return()
  endif()
  set(filter "")
  if(ARG_SLOW)
    list(JOIN ARG_SLOW ":" filter)
    set(filter TEST_FILTER "-${filter}")
  endif()
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 ${filter})
  foreach(slow ${ARG_SLOW})
    string(REGEX REPLACE "[./]\\*$" "" name ${slow})
    add_test(NAME ${name} COMMAND ${target} --gtest_filter=${slow})
    set_tests_properties(${name} PROPERTIES LABELS all FAIL_REGULAR_EXPRESSION "Running 0 tests")
  endforeach()
  set_property(GLOBAL APPEND PROPERTY SLIPBENCH_TEST_PROGRAMS ${target})
endfunction()
