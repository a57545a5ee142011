# Finds FFTW 3 in double precision, whose Debian 12 package has no CMake configuration, and defines FFTW3::fftw3.
include(${CMAKE_CURRENT_LIST_DIR}/FindByName.cmake)
find_by_name(FFTW3 HEADER fftw3.h LIBRARY fftw3 TARGET FFTW3::fftw3)
