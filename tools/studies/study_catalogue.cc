#include "tools/studies/study_catalogue.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench::reproduce {

const std::vector<Reproduction>& reproductions() {
  static const std::vector<Reproduction> all{
      {"hd-papillarray/table1",
       "ablation of the encoders, by sequence and by frame, and what decides it",
       {"--data", "--seed", "--jobs"},
       &hd_table1},
      {"hd-papillarray/table2",
       "grasp and lift in the closed loop: drops, slip and grip force of every detector and controller",
       {"--trials", "--only", "--memories", "--seed", "--jobs"},
       &hd_table2},
      {"hd-papillarray/latency", "time from a frame to its class, in software and in the register-level core", {}, &hd_latency},
      {"hd-papillarray/resources",
       "what the core takes of the published FPGA, for each degree of unrolling",
       {"--synthesise"},
       &hd_resources},
      {"myrmex-tactile-cnn/onset_label",
       "the onset that a third sensor on the object labels, beside the true one: 64 trials, several readings of the rule",
       {"--trials", "--seed", "--jobs"},
       &myrmex_onset_label},
      {"nib-reconfigurable/table1",
       "calibration of the nib pad: force and moment out of 36 capacitances, uniform and partial loads, and what decides it",
       {"--seed", "--jobs"},
       &nib_table1},
      {"nib-reconfigurable/table2",
       "Algorithm 1 while the grasp is slowly let go, four surfaces; what decides its figures, and where 0 to 8 Hz comes from",
       {"--trials", "--seed", "--jobs"},
       &nib_table2},
      {"nib-reconfigurable/slip_kinds",
       "no slip, linear and rotational slip told apart by FL, FR and curl",
       {"--trials", "--seed", "--jobs"},
       &nib_slip_kinds},
      {"nib-reconfigurable/table3",
       "a box turned up by rotational slip and released: weights, centres of mass, surfaces, thresholds",
       {"--trials", "--only", "--seed", "--jobs"},
       &nib_table3},
      {"piezo-fft-gru/table4",
       "networks on the piezoelectric skin: a frame alone against the motors' vibration, with and without motor recordings",
       {"--data", "--trials", "--only", "--seed", "--jobs"},
       &piezo_table4},
      {"piezo-fft-gru/slip_against_hold",
       "slip and hold told apart by the power of one frame, against the motors' vibration, and which frames are mistaken",
       {"--trials", "--seed", "--jobs"},
       &piezo_slip_against_hold},
  };
  return all;
}

const Reproduction& find_reproduction(const std::string& name) {
  const std::vector<Reproduction>& all = reproductions();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Reproduction& candidate) { return candidate.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const Reproduction& candidate : all) names.push_back(candidate.name);
  throw InputError(fmt::format("unknown reproduction '{}'{}", name, allowed_names(name, names)));
}

}  // namespace slipbench::reproduce
