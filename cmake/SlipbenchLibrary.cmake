# slipbench_library(NAME core SOURCES a.cc b.cc DEPENDS Eigen3::Eigen PRIVATE fmt::fmt)
# One target a folder: slipbench_<NAME>, alias slipbench::<NAME>, installed and exported with its headers.
# COLD: runs once a command and not once a step, so that the time to compile it counts and its own speed does not (-O1).
function(slipbench_library)
  cmake_parse_arguments(ARG "COLD" "NAME" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  set(target slipbench_${ARG_NAME})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(slipbench::${ARG_NAME} ALIAS ${target})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/slipbench>)
  target_compile_features(${target} PUBLIC cxx_std_20)  # for those who use an installed copy
  target_link_libraries(${target} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:slipbench_flags>)
  if(ARG_COLD)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${ARG_NAME})
  set_property(GLOBAL APPEND PROPERTY SLIPBENCH_TARGETS ${target})
endfunction()

# slipbench_test(NAME units SOURCES quantity_test.cc DEPENDS slipbench::core)
# A GoogleTest program whose tests ctest lists one by one.
function(slipbench_test)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;DEPENDS" ${ARGN})
  set(target ${ARG_NAME}_test)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_DEPENDS} GTest::gmock GTest::gtest_main slipbench_flags)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${target} PRIVATE SLIPBENCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60)
endfunction()
