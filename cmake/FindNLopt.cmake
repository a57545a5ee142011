# Finds NLopt with its C++ header and defines NLopt::nlopt_cxx. Debian 12 has two CMake configurations of this name, for two libraries.
find_path(NLopt_INCLUDE_DIR nlopt.hpp)
find_library(NLopt_LIBRARY nlopt_cxx)
mark_as_advanced(NLopt_INCLUDE_DIR NLopt_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NLopt REQUIRED_VARS NLopt_LIBRARY NLopt_INCLUDE_DIR)

if(NLopt_FOUND AND NOT TARGET NLopt::nlopt_cxx)
  add_library(NLopt::nlopt_cxx UNKNOWN IMPORTED)
  set_target_properties(NLopt::nlopt_cxx PROPERTIES
    IMPORTED_LOCATION ${NLopt_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${NLopt_INCLUDE_DIR})
endif()
