# slipbench_install(): installs what slipbench_library() declared, the program, the scenes and the package that
# find_package(slipbench) reads. Call it last, when every target exists.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Programs, libraries and data stand below the build folder as below a prefix, and are found from the program's own place. So what is installed is
# what was built, byte for byte, and neither holds a path of the machine that built it.
set(SLIPBENCH_PLUGIN_DIR ${CMAKE_INSTALL_LIBDIR}/slipbench)
set(SLIPBENCH_DATA_DIR ${CMAKE_INSTALL_DATADIR}/slipbench)
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/${SLIPBENCH_PLUGIN_DIR} ${PROJECT_BINARY_DIR}/${SLIPBENCH_DATA_DIR})
if(SLIPBENCH_WITH_MUJOCO)
  set(SLIPBENCH_MUJOCO_DIR ${SLIPBENCH_PLUGIN_DIR}/mujoco)
  file(CREATE_LINK ${MuJoCo_ROOT_DIR} ${PROJECT_BINARY_DIR}/${SLIPBENCH_MUJOCO_DIR} SYMBOLIC)
  set(CMAKE_INSTALL_RPATH "$ORIGIN/../${SLIPBENCH_MUJOCO_DIR}")
endif()
if(SLIPBENCH_WITH_OPENVINO)
  set(SLIPBENCH_OPENVINO_DIR ${SLIPBENCH_PLUGIN_DIR}/openvino)
  file(CREATE_LINK ${OpenVINO_ROOT_DIR}/libs ${PROJECT_BINARY_DIR}/${SLIPBENCH_OPENVINO_DIR} SYMBOLIC)
endif()
# A build reads files of its source tree through this link: tools/files/project.
file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/${SLIPBENCH_DATA_DIR}/source SYMBOLIC)

# slipbench_module(slipbench_cores): a library that is loaded while the program runs, and that finds its own libraries where the system has them.
function(slipbench_module TARGET)
  set_target_properties(${TARGET} PROPERTIES
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${SLIPBENCH_PLUGIN_DIR}
    INSTALL_RPATH "")
  target_link_options(${TARGET} PRIVATE -Wl,--exclude-libs,ALL)
endfunction()

function(slipbench_install)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/slipbench)
  get_property(targets GLOBAL PROPERTY SLIPBENCH_TARGETS)
  set(headers sensors/plugin_abi.h)  # of a folder that has no target
  install(TARGETS ${targets} EXPORT slipbenchTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  foreach(target IN LISTS targets)
    get_target_property(folder ${target} SOURCE_DIR)
    file(GLOB_RECURSE found RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${folder}/*.h)  # a subfolder may have no target of its own
    list(APPEND headers ${found})
  endforeach()
  list(REMOVE_DUPLICATES headers)
  foreach(header IN LISTS headers)
    cmake_path(GET header PARENT_PATH path)
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/slipbench/${path})
  endforeach()

  install(DIRECTORY scenes DESTINATION ${SLIPBENCH_DATA_DIR} PATTERN "gallery.*" EXCLUDE PATTERN GALLERY.md EXCLUDE)
  install(DIRECTORY tools/benchmark/ DESTINATION ${SLIPBENCH_DATA_DIR}/tools/benchmark FILES_MATCHING PATTERN "slip-*.yaml")
  install(FILES LICENSE NOTICE.md DESTINATION ${SLIPBENCH_DATA_DIR})
  install(TARGETS slipbench slipbench-reader RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(SLIPBENCH_WITH_MUJOCO)
    install(FILES ${MuJoCo_LIBRARY} ${MuJoCo_LICENCES} DESTINATION ${SLIPBENCH_MUJOCO_DIR})
    install(DIRECTORY ${MuJoCo_ROOT_DIR}/include DESTINATION ${SLIPBENCH_MUJOCO_DIR})
    install(TARGETS slipbench_plugin LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
    install(FILES sim/mujoco/releases/layout.c sim/mujoco/releases/members.h DESTINATION ${SLIPBENCH_PLUGIN_DIR}/mujoco_layout)
  endif()
  install(TARGETS slipbench_cores LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
  if(SLIPBENCH_WITH_OPENVINO)
    install(TARGETS slipbench_network_engine LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
    install(FILES ${OpenVINO_LIBRARIES_AT_RUN} DESTINATION ${SLIPBENCH_OPENVINO_DIR})
    install(DIRECTORY ${OpenVINO_LICENCES}/ DESTINATION ${SLIPBENCH_OPENVINO_DIR})
  endif()

  install(EXPORT slipbenchTargets NAMESPACE slipbench:: DESTINATION ${package_dir})
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/cmake/slipbenchConfig.cmake.in ${PROJECT_BINARY_DIR}/slipbenchConfig.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_DATADIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/slipbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES
    ${PROJECT_BINARY_DIR}/slipbenchConfig.cmake
    ${PROJECT_BINARY_DIR}/slipbenchConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindByName.cmake
    ${PROJECT_SOURCE_DIR}/cmake/Findlibdeflate.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindFFTW3.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindNLopt.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindSLEEF.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindMuJoCo.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindRandom123.cmake
    DESTINATION ${package_dir})
endfunction()
