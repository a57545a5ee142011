# slipbench_verilate(NAME models PREFIX VFastest TOP hd_sim SOURCES hd_sim.sv ARGS -GSliceWidth=1000)
# Translates rtl/hd, and SOURCES on top of it, with Verilator into the object library slipbench_<NAME>; several calls may share one.
# Verilator writes the names of sources into what it makes, so it is given them from the folder of the call, where verilate() runs it.
# Generated code is not ours to warn about or to sanitize. What runs once is not optimised and makes one compilation a model; the rest takes
# -O1, each file by itself: by -O3 a model takes three times as long to compile.
function(slipbench_verilate)
  cmake_parse_arguments(ARG "" "NAME;PREFIX;TOP" "SOURCES;ARGS" ${ARGN})
  set(target slipbench_${ARG_NAME})
  if(NOT TARGET ${target})
    add_library(${target} OBJECT)
    target_compile_options(${target} PRIVATE -w -fno-sanitize=all -O0 -ffile-prefix-map=${PROJECT_BINARY_DIR}=build)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
  file(STRINGS ${PROJECT_SOURCE_DIR}/rtl/hd/hd.f sources)
  list(TRANSFORM sources PREPEND ${PROJECT_SOURCE_DIR}/rtl/hd/)
  set(names "")
  foreach(source IN LISTS sources ARG_SOURCES)
    file(RELATIVE_PATH name ${CMAKE_CURRENT_SOURCE_DIR} ${source})
    list(APPEND names ${name})
  endforeach()
  verilate(${target} SOURCES ${names} TOP_MODULE ${ARG_TOP} PREFIX ${ARG_PREFIX} TRACE_FST
    OPT_FAST -O1 OPT_GLOBAL -O1 VERILATOR_ARGS -O3 --x-assign fast ${ARG_ARGS})
  get_target_property(generated ${target} SOURCES)
  list(FILTER generated INCLUDE REGEX "/${ARG_PREFIX}[^/]*\\.cpp$")
  set_source_files_properties(${generated} PROPERTIES UNITY_GROUP ${ARG_PREFIX})  # CMake leaves out what has flags of its own
endfunction()

# slipbench_use_models(slipbench_rtl models): the target holds the objects of slipbench_models and sees their headers.
function(slipbench_use_models TARGET NAME)
  set(models slipbench_${NAME})
  target_sources(${TARGET} PRIVATE $<TARGET_OBJECTS:${models}>)
  target_include_directories(${TARGET} SYSTEM PRIVATE $<TARGET_PROPERTY:${models},INCLUDE_DIRECTORIES>)
  target_compile_definitions(${TARGET} PRIVATE $<TARGET_PROPERTY:${models},COMPILE_DEFINITIONS>)
endfunction()
