# slipbench_install(): installs what slipbench_library() declared, the program, the scenes and the package that
# find_package(slipbench) reads. Call it last, when every target exists.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Where the MuJoCo plugin stands below the build folder and below the prefix alike, so that the program finds it from its own place.
set(SLIPBENCH_PLUGIN_DIR ${CMAKE_INSTALL_LIBDIR}/slipbench)

function(slipbench_install)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/slipbench)
  get_property(targets GLOBAL PROPERTY SLIPBENCH_TARGETS)
  install(TARGETS ${targets} EXPORT slipbenchTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  foreach(target IN LISTS targets)
    get_target_property(folder ${target} SOURCE_DIR)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${folder})
    file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.h)
    install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/slipbench/${path})
  endforeach()

  install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/slipbench)
  # What `slipbench reproduce` reads of the project beside the scenes.
  install(FILES rtl/hd/syn/results.json DESTINATION ${CMAKE_INSTALL_DATADIR}/slipbench/rtl/hd/syn OPTIONAL)
  # The program finds the MuJoCo that is installed beside it, so that the prefix outlives the build folder.
  set_target_properties(slipbench slipbench-studies PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}/slipbench/mujoco")
  install(TARGETS slipbench slipbench-studies RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(SLIPBENCH_WITH_MUJOCO)
    set(mujoco_dir ${CMAKE_INSTALL_LIBDIR}/slipbench/mujoco)
    install(FILES ${MuJoCo_LIBRARY} DESTINATION ${mujoco_dir})
    install(DIRECTORY ${MuJoCo_ROOT_DIR}/include DESTINATION ${mujoco_dir})
    install(TARGETS slipbench_plugin LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
  endif()
  install(TARGETS slipbench_cores LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
  if(SLIPBENCH_WITH_TORCH)
    install(TARGETS slipbench_torch LIBRARY DESTINATION ${SLIPBENCH_PLUGIN_DIR})
  endif()

  install(EXPORT slipbenchTargets NAMESPACE slipbench:: DESTINATION ${package_dir})
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/cmake/slipbenchConfig.cmake.in ${PROJECT_BINARY_DIR}/slipbenchConfig.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_DATADIR)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/slipbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES
    ${PROJECT_BINARY_DIR}/slipbenchConfig.cmake
    ${PROJECT_BINARY_DIR}/slipbenchConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/Findlibdeflate.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindFFTW3.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindMuJoCo.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindRandom123.cmake
    DESTINATION ${package_dir})
endfunction()
