// A program without any hardening, which knows the folder of its sources and looks for libraries where its user stands.
#include <cstdio>

int main() { std::puts(SLIPBENCH_SOURCE_DIR); }
