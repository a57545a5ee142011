// What a dataset can be exported as: a function, or an object that is fed trials, for each format.
#pragma once

#include "tools/base/record/trial_record.h"
#include "tools/program/export/export.h"

namespace slipbench {

// What an episode's actions are: `offset` + `scale` * action is the quantity itself, and every action is in [-1, 1].
struct ActionSpace {
  std::vector<std::string> names;   // one a column: "pad_vx", "command_position"
  std::vector<std::string> bodies;  // whose velocities they are; empty: they are the registers of a grasp
  std::vector<double> scale;        // m/s and rad/s, or counts
  std::vector<double> offset;
};

// A row an instant. Instants are 1/rate apart, from the first at which everything has been read once; each value is the latest at or before
// its instant, without a filter.
struct Episode {
  struct Column {
    std::string name;                  // "pad_force"
    std::size_t width = 1;             // values a row
    std::vector<float> values;         // [T+1, width] of an observation, [T, width] of all else
    SlipRule rule = SlipRule::strict;  // of a state
  };
  std::size_t steps = 0;             // T
  std::vector<Column> observations;  // with the one after the last step
  std::vector<Column> states;        // pad states of each sensor by the three rules
  Column actions, bodies;            // [T, A]; pose and velocity of every body [T, 13 B]
  std::vector<float> rewards;        // [T]
};

// Of the trials of one dataset. A grasp's are the registers written last, 0 to 255; else the velocities of the bodies that carry sensors,
// scaled by the greatest component, of translation and of rotation, that occurs in the trials. Throws InputError when there are none.
ActionSpace action_space(const DatasetReader& reader, const std::vector<std::size_t>& trials);

// Rate of the slowest sensor [Hz] of those asked for (chosen_sensors).
double slowest_rate(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked);

// Throws InputError as write_robomimic does.
Episode make_episode(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked, double rate,
                     const ActionSpace& space);

// A length [m] in mm, in the fewest digits from which `slipbench import` makes the same float32 again.
std::string millimetres(float metres);

// The file's text in the vendor's layout, up to two sensors side by side. Throws InputError when their samples differ in time.
std::string vendor_csv(const std::vector<PapillarraySamples>& sensors);
// Whether a file that begins so is one.
bool begins_as_vendor_csv(std::string_view text);

// The text of a file of 73 columns. Throws InputError when the rate is not 1000 Hz.
std::string training_csv(const PapillarraySamples& samples, double rate);
// Whether a file that begins so is one: its first line is 73 numbers.
bool begins_as_training_csv(std::string_view text);

// The name that the published training code expects: "translation/demo_3-v_4.0-slip.csv" (README.md). `time`: of the pad's samples.
std::string training_file_name(std::size_t trial, const CommandedMotion& motion, const BodyRecord& pad,
                               const std::vector<double>& time);

// The layout of the public grasps with three BioTac SP (3dperceptionlab, bts3v2): a row a grasp.
// object,slipped,ff_biotac_1..24,mf_biotac_1..24,th_biotac_1..24: what was grasped, whether it was lost (0 or 1), and the counts of the three
// fingers' electrodes in the last row of the log up to `hold.from`. `trials` must each have three sensors biotac_sp ff, mf and th at sites, a body
// `object` and an outcome that says whether it was held. The object's name is its shape and its size in mm. Throws InputError where one has not.
std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials);

bool begins_as_grasp_csv(std::string_view text);

// The layout of the public slip recordings of a BioTac SP (yayaneath/BioTacSP-DoS): a folder a class, a file a recording.
struct SlipRecording {
  std::string name;  // "n/acrylic12.csv": class, object and trial
  std::string text;  // header ff_e1,...,ff_e24, then a row of counts every 10 ms
};

// The class is the motion that the scene commands, by where the object goes as the finger sees it: n towards its root (the pad goes along its
// X axis), s towards its tip, e to its right as seen from the root with the skin down (the pad goes along Y), w to its left; cw where the pad
// turns the positive way about the normal (the object clockwise then, seen from the finger), aw the other way, t where it does neither.
// The object is the surface's material, and its shape where that is no plane. The published recordings are cut inside the motion: those of
// `rub` begin where it has come up to its speed, all others with the trial.
// `sensor` names a biotac_sp of 100 Hz. Throws InputError where it is none, or where the motion is none of these.
SlipRecording slip_csv(const DatasetReader& reader, std::size_t trial, const std::string& sensor);

bool begins_as_slip_csv(std::string_view text);

// One sensor's samples as a table of text.
struct CsvTable {
  std::string channel;  // the one that has a time of its own, and so a table; empty: all that have the sensor's
  std::string text;
};

// The tables of a sensor, that of its own samples first (README.md says which columns), with the state by `rule`, or by all three. Throws
// InputError when the channels do not fit the names of their values, or a channel with a column of its difference has not two values.
std::vector<CsvTable> table_csv(const SensorRecord& sensor, std::optional<SlipRule> rule = {});

// Whether a file that begins so is one.
bool begins_as_table_csv(std::string_view text);

// A trial as numpy reads it.
// The bytes of an .npz archive with every array of `record` under the path that it has in a dataset, the attributes of its units as arrays
// beside their labels, and first `about`, a JSON object (README.md). The same record gives the same bytes. Throws std::runtime_error when
// libarchive fails.
std::string npz(const TrialRecord& record, const std::string& about);

// The path of an array in the archive: that in a dataset, but the labels of a recording are called state_recorded.
std::string archive_path(const TrialRecord& record, const std::string& path);

// Whether a file that begins so is one: a zip archive whose first member is `about`.
bool begins_as_npz(std::string_view text);

// `shape` as Python writes a tuple, `descr` as numpy names a type: the header of an .npy file of version 1.0, 64-byte aligned.
std::string npy_header(std::string_view descr, const std::vector<std::size_t>& shape);

// A dataset as robomimic reads it.
struct RobomimicOptions {
  std::vector<std::string> sensors;  // to observe; empty: all
  std::optional<double> rate;        // Hz, of the demos; empty: that of the slowest sensor
  std::optional<SlipRule> rule;      // of the states beside the observations; empty: all three
  bool compress = false;             // every array by shuffle and deflate
  std::function<void(std::size_t done, std::uintmax_t bytes)> progress = {};  // told of the demos written, and of the file's size
};

// Writes the trials as one HDF5 file in robomimic's layout (README.md) under a temporary name, syncs and renames it. The same dataset gives
// the same bytes. Throws InputError when a trial does not fit: no such sensor, a rate beyond the fastest sensor's, fewer than two rows, a
// grasp without a loop, nothing that moves; or when the file cannot be written, of which nothing is left then, or another run is writing it,
// which is left to that run. Every trial has a recording.
void write_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, const std::string& path,
                     const RobomimicOptions& options);

// Throws InputError when something stands at `path`, or at its temporary name, that is neither empty nor such a file.
void check_robomimic_target(const std::string& path, const std::vector<std::string>& inputs);

}  // namespace slipbench
