// A program without hardening that contains its source folder and looks for libraries in the user's
// current folder.
#include <cstdio>

int main() { std::puts(SLIPBENCH_SOURCE_DIR); }
