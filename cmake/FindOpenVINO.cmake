# Finds OpenVINO inside an unpacked openvino wheel and defines openvino::runtime. The wheel's own configuration is not used: it adds definitions to
# every source of the project.
# Looked for in SLIPBENCH_OPENVINO_ROOT (the wheel's `openvino` folder), else in build/venv of the source tree.
# Sets OpenVINO_FOUND, OpenVINO_VERSION, OpenVINO_LIBRARY, OpenVINO_LIBRARIES_AT_RUN (those that a network needs beside the system's; they find each
# other in their folder), OpenVINO_LICENCES (folder).
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_in_wheel(OpenVINO SLIPBENCH_OPENVINO_ROOT openvino)

set(_openvino_header ${OpenVINO_ROOT_DIR}/include/openvino/core/version.hpp)
if(OpenVINO_ROOT_DIR AND EXISTS ${_openvino_header})
  file(READ ${_openvino_header} _openvino_text)
  foreach(_openvino_part MAJOR MINOR PATCH)
    string(REGEX MATCH "#define OPENVINO_VERSION_${_openvino_part} ([0-9]+)" _openvino_line "${_openvino_text}")
    list(APPEND OpenVINO_VERSION ${CMAKE_MATCH_1})
  endforeach()
  list(JOIN OpenVINO_VERSION "." OpenVINO_VERSION)
  file(GLOB OpenVINO_LIBRARY ${OpenVINO_ROOT_DIR}/libs/libopenvino.so.*)
  file(GLOB OpenVINO_LIBRARIES_AT_RUN ${OpenVINO_LIBRARY} ${OpenVINO_ROOT_DIR}/libs/libopenvino_onnx_frontend.so.*
    ${OpenVINO_ROOT_DIR}/libs/libopenvino_*_cpu_plugin.so ${OpenVINO_ROOT_DIR}/libs/libtbb.so.*)
  set(OpenVINO_LICENCES ${OpenVINO_ROOT_DIR}/../openvino-${OpenVINO_VERSION}.dist-info/licenses)
endif()

find_package_handle_standard_args(OpenVINO REQUIRED_VARS OpenVINO_LIBRARY OpenVINO_ROOT_DIR VERSION_VAR OpenVINO_VERSION)

if(OpenVINO_FOUND AND NOT TARGET openvino::runtime)
  get_filename_component(_openvino_name ${OpenVINO_LIBRARY} NAME)
  add_library(openvino::runtime SHARED IMPORTED)
  set_target_properties(openvino::runtime PROPERTIES
    IMPORTED_LOCATION ${OpenVINO_LIBRARY}
    IMPORTED_SONAME ${_openvino_name}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenVINO_ROOT_DIR}/include)
endif()
