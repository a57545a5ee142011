// The one part of a file whose damage HDF5 does not notice.
#pragma once

#include <string>

namespace slipbench {

// Walks every global heap of a finished file: the blocks "GCOL" that hold the texts of attributes. They have no checksum, and where
// their sizes or indices are damaged HDF5 1.10 runs on for ever or ends the process. Throws InputError when one is damaged.
// Not for the file of a killed run, which may end in half a heap that nothing refers to.
void check_heaps(const std::string& path);

}  // namespace slipbench
