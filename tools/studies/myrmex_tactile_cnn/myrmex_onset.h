// Slip of an object between two arrays: when it begins by the truth, and when by the rule of the Myrmex paper (section 2.2).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::reproduce {

// scenes/myrmex/dataset.yaml: the third sensor rests on the object, the arms begin to move [s].
inline constexpr double bench_settled = 2.0, bench_apart = 2.5;

// A sensor of that scene. Throws std::logic_error where the record has none of that name.
const SensorRecord& bench_sensor(const TrialRecord& record, std::string_view name);
// "cylinder", "remote" or "glass", by the shape.
std::string object_name(const BodyScene& body);
// Whether its centre of mass lies 5 mm or more to the side of the grip, so that it turns when it slips.
bool is_rotational(const BodyScene& body);

// The paper's rule: "the onset of slippage is the time when the sum of contacts on the third sensor started to decrease". What it
// leaves open:
struct OnsetRule {
  double window;     // s, over whose samples up to each the sum is averaged; 0: not at all
  double threshold;  // below its mean while nothing moves, in standard deviations of the averaged sum then
};

// The last sample's time at which the averaged `sum` falls to more than the threshold below its mean in [from, to) and stays
// there up to `end` [s]; empty: it does not stand below at the end, or there is none. `least`: in the unit of `sum`, by how much
// it must fall at least.
std::optional<double> decrease_onset(std::span<const double> time, std::span<const double> sum, const OnsetRule& rule,
                                     double from, double to, double end, double least = 0.0);

// Of each sample, the mean of `values` over the samples of the last `window` [s] up to it; 0: the values themselves.
std::vector<double> backward_mean(std::span<const double> time, std::span<const double> values, double window);

// Of each sample, the sum of 4095 - counts over all taxels of a myrmex.
std::vector<double> sum_of_contacts(const SensorRecord& sensor);

// Share of a pad's normal force, sample by sample, that slipping units carry; 0 where nothing touches.
std::vector<double> slipping_share(const SensorRecord& sensor);

// When the object begins to slip: the first sample's time from which on, as long as both pads touch, slipping taxels carry at
// least half of the normal force on both. At the limit of friction that is so of a translation and of a turn, whose centre
// sticks. Empty: it is not so at the end. `end`: the last sample at which both pads touch [s].
struct TrueSlip {
  std::optional<double> onset;
  double end = 0.0;
};
TrueSlip true_slip(const SensorRecord& left, const SensorRecord& right, double from);

// The end by the paper's rule, "no more contacts were detected on the sensors holding the object". What it leaves open is what a
// contact is:
struct ContactGate {
  bool of_sum;    // of an array: its sum of contacts; else its taxel that misses most counts
  double window;  // s, over whose samples up to each that is averaged; 0: not at all
  double counts;  // that must be missing; more is a contact
};
// An array's sum, mean of 20 ms, 5 sd above what its noise alone makes it, since in a trial it has some thousand independent means.
ContactGate sum_end();
inline constexpr double taxel_noise_sd = 9.0 / 1024.0 * 4095.0;  // counts, of a resting taxel (sensors/myrmex: 9 of 1,024)

// The last sample at which either array has a contact [s]; 0: there is none.
double contact_end(const SensorRecord& left, const SensorRecord& right, const ContactGate& gate);

// How far the body's centre of mass lies to the side of the grip, along Y [m]: what makes a trial one of rotation.
double side_of_mass(const BodyScene& body);

}  // namespace slipbench::reproduce
