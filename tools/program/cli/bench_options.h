// What `slipbench bench` is asked for.
#pragma once

#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace slipbench {

struct BenchOptions {
  bool compare = false;
  std::string compare_with;  // a file; empty: the committed one of this build
};

extern const std::string_view bench_footer;

// Adds the command's own options to its parser, which writes into `options` while it parses.
void add_bench_options(CLI::App& command, BenchOptions& options);

}  // namespace slipbench
