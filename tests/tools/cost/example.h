// An exploration with made-up values.
#pragma once

#include <string>
#include <utility>

#include "tools/cost/explore.h"
#include "tools/cost/reading.h"

namespace slipbench::cost {

inline Errors onset_error(double worst, bool different = false) {
  Errors errors;
  at(errors, Measure::onset) = MeasureError{worst, worst, different};
  return errors;
}

inline Row timed(const std::string& series, const std::string& label, double cpu, Errors errors) {
  Row row{.setting = {series, label, {}}, .command = "slipbench run s.yaml"};
  row.cpu = CpuTime{cpu, cpu, cpu, 9};
  row.errors = std::move(errors);
  return row;
}

// A trial of 2 s.
inline Exploration example() {
  Exploration exploration;
  exploration.simulated = 2.0;
  exploration.reference.converged = true;
  exploration.rows = {timed("own", "1 ms", 0.02, onset_error(5e-4)),
                      timed("field", "10 ms", 0.002, onset_error(0.05)),
                      timed("field", "5 ms", 0.004, onset_error(5e-3)),
                      timed("field", "2 ms", 0.01, onset_error(6e-3)),
                      timed("contact", "impratio 100", 0.5, onset_error(0.03)),
                      timed("contact", "noslip 3", 1.6, onset_error(8e-3)),
                      timed("elements", "6 bristles", 0.001, onset_error(0.0))};
  Row failed{
      .setting = {"contact", "stiff", {}}, .command = "slipbench run s.yaml", .status = Status::warning, .why = "MuJoCo warned"};
  exploration.rows.push_back(failed);
  mark_fronts(exploration);
  return exploration;
}

}  // namespace slipbench::cost
