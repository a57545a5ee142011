# Installs BUILD, made from SOURCE, into an empty prefix below WORK, builds the project CONSUMER
# against it and runs it, then runs the installed program. All steps run in folders outside the
# source tree.
function(run)
  cmake_parse_arguments(ARG "" "IN" "COMMAND" ${ARGN})
  execute_process(COMMAND ${ARG_COMMAND} WORKING_DIRECTORY ${ARG_IN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARG_COMMAND " " command)
    message(FATAL_ERROR "${command}\nended with ${status}:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/elsewhere)
run(IN ${WORK}/elsewhere COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
# The prefix is relocatable: nothing in it may point to its original path.
file(RENAME ${WORK}/first ${WORK}/prefix)
# The program equals the built one and contains no path of the build; grep would find one.
run(IN ${WORK} COMMAND ${CMAKE_COMMAND} -E compare_files ${BUILD}/bin/slipbench prefix/bin/slipbench)
file(WRITE ${WORK}/prefix/planted "a file that holds ${SOURCE}.\n")
execute_process(COMMAND grep --recursive --files-with-matches --fixed-strings --regexp=${SOURCE} --regexp=${BUILD} prefix
  WORKING_DIRECTORY ${WORK} OUTPUT_VARIABLE found)
if(NOT found STREQUAL "prefix/planted\n")
  message(FATAL_ERROR "Beside prefix/planted, these hold ${SOURCE} or ${BUILD}:\n${found}")
endif()
file(REMOVE ${WORK}/prefix/planted)

run(IN ${WORK}/elsewhere COMMAND ${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/consumer -G ${GENERATOR}
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(IN ${WORK}/elsewhere COMMAND ${CMAKE_COMMAND} --build ${WORK}/consumer)
run(IN ${WORK}/elsewhere COMMAND ${WORK}/consumer/consumer)
file(GLOB_RECURSE plugin ${WORK}/prefix/*/libslipbench_mujoco.so)
if(plugin)
  run(IN ${WORK}/elsewhere COMMAND ${WORK}/consumer/attach ${plugin})
endif()

set(program ${WORK}/prefix/bin/slipbench)
run(IN ${WORK}/elsewhere COMMAND ${program} doctor)
run(IN ${WORK}/elsewhere COMMAND ${program} run ${WORK}/prefix/share/slipbench/scenes/papillarray/stage.yaml --seed 3 -o stage.h5)
run(IN ${WORK}/elsewhere COMMAND ${program} report stage.h5 -o stage.html)
# A custom detector needs only the installed headers.
run(IN ${WORK}/elsewhere COMMAND ${CXX} -shared -fPIC -I ${WORK}/prefix/include/slipbench
  ${CONSUMER}/../../../detectors/example/ratio_gate.cc -o ratio_gate.so)
run(IN ${WORK}/elsewhere COMMAND ${program} run ${WORK}/prefix/share/slipbench/scenes/papillarray/stage.yaml
  --set "detector={type: plugin, library: ${WORK}/elsewhere/ratio_gate.so}" -o plugin.h5)
# A network, with the installed OpenVINO libraries.
file(GLOB_RECURSE network ${WORK}/prefix/*/libslipbench_network.so)
if(network)
  run(IN ${WORK}/elsewhere COMMAND ${program} run ${WORK}/prefix/share/slipbench/scenes/papillarray/stage.yaml
    --set "detector={type: network, model: ${CONSUMER}/../../detectors/network/data/gru21.onnx}" -o network.h5)
endif()
foreach(file stage.h5 stage.html)
  file(SIZE ${WORK}/elsewhere/${file} size)
  if(size EQUAL 0)
    message(FATAL_ERROR "${file} is empty")
  endif()
endforeach()
