# Finds libdeflate, whose Debian 12 package has no CMake configuration, and defines libdeflate::libdeflate.
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_by_name(libdeflate HEADER libdeflate.h LIBRARY deflate TARGET libdeflate::libdeflate)
