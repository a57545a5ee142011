# Configures, builds and tests one preset of the tree SOURCE.
cmake_host_system_information(RESULT jobs QUERY NUMBER_OF_LOGICAL_CORES)
foreach(step "${CMAKE_COMMAND};--preset;${PRESET}" "${CMAKE_COMMAND};--build;--preset;${PRESET};--parallel;${jobs}"
             "${CMAKE_CTEST_COMMAND};--preset;${PRESET};--parallel;${jobs};--no-tests=error")
  execute_process(COMMAND ${step} WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN step " " command)
    message(FATAL_ERROR "${command}\nended with ${status}:\n${output}")
  endif()
endforeach()
