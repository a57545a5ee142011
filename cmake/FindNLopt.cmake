# Finds NLopt with its C++ header and defines NLopt::nlopt_cxx. Debian 12 has two CMake configurations of this name, for two libraries.
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_by_name(NLopt HEADER nlopt.hpp LIBRARY nlopt_cxx TARGET NLopt::nlopt_cxx)
