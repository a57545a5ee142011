# Finds SLEEF, whose Debian 12 package has no CMake configuration, and defines SLEEF::sleef.
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_by_name(SLEEF HEADER sleef.h LIBRARY sleef TARGET SLEEF::sleef)
