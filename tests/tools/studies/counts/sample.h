// A small profile, as callgrind writes one, and small results.
#pragma once

#include <string>

#include "tools/studies/counts/results.h"

namespace slipbench::counts {

// 40 steps. Own instructions: run_trial 10, StageSimulation::step 60, Field::step 25 + 5 in two levels of a recursion; together 100.
inline const std::string sample_profile = R"(# callgrind format
version: 1
creator: callgrind-3.19.0
pid: 1234
cmd:  slipbench run stage.yaml
part: 1


desc: I1 cache: 
desc: Trigger: Program termination

positions: line
events: Ir
summary: 100


ob=(1) /usr/bin/slipbench
fl=(1) ???
fn=(10) slipbench::run_trial(slipbench::Scene const&, unsigned long)
0 8
+3 2
cob=(1)
cfi=(1)
cfn=(11) slipbench::StageSimulation::step()
calls=40 0 
* 90

fl=(1)
fn=(11)
16 50
fi=(2) vector.h
-6 10
fe=(1)
cfn=(12) slipbench::Field::step(double) [clone .cold]
calls=40 16 
16 30

fn=(12)
0 25
cfn=(13) slipbench::Field::step(double) [clone .cold]'2
calls=5 0 
0 5

fn=(13)
* 5

totals: 100
)";

// `text` with `from` replaced by `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the sample has no '" + from + "'");
  return text.replace(at, from.size(), to);
}

// Results of one scene that cost 1,000, 600 and 300 of them in two functions.
inline Results sample_results() {
  return {.build = {{"compiler", "GNU 12.2.0"}, {"instruction set", "x86_64 with AVX2"}},
          .context = {{"commit", "0123456789ab"}, {"processor", "A <fast> one & two"}},
          .scenes = {{.scene = "scenes/papillarray/stage.yaml",
                      .simulated = 4.0,
                      .steps = 50,
                      .instructions = 1000,
                      .cpu_time = 0.5,
                      .functions = {{"a::step", 600}, {"b::step", 300}}}}};
}

}  // namespace slipbench::counts
