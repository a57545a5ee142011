// Formats of an export: a function, or an object that receives trials, for each.
#pragma once

#include "tools/dataset/record/trial_record.h"
#include "tools/formats/export/export.h"

namespace slipbench {

// The actions of an episode: a quantity is `offset` + `scale` * action, with every action in [-1,
// 1].
struct ActionSpace {
  std::vector<std::string> names;   // one per column: "pad_vx", "command_position"
  std::vector<std::string> bodies;  // bodies whose velocities are the actions; empty: the registers of a grasp
  std::vector<double> scale;        // m/s and rad/s, or counts
  std::vector<double> offset;
};

// One row per instant. Instants are 1/rate apart, from the first at which every signal has a
// value; each value is the latest at or before its instant, without a filter.
struct Episode {
  struct Column {
    std::string name;                    // "pad_force"
    std::size_t width = 1;               // values per row
    std::vector<float> values;           // [T+1, width] of an observation, else [T, width]
    LabelRule rule = LabelRule::strict;  // of a state column
  };
  std::size_t steps = 0;             // T
  std::vector<Column> observations;  // including the one after the last step
  std::vector<Column> states;        // pad states of each sensor by the three rules
  Column actions, bodies;            // [T, A]; pose and velocity of every body [T, 13 B]
  std::vector<float> rewards;        // [T]
};

// Action space of the trials of one dataset. For a grasp, the registers written last, 0 to
// 255; else the velocities of the bodies that carry sensors, scaled by the largest component, of
// translation and of rotation, in the trials. Throws InputError if no body carries a sensor.
ActionSpace action_space(const DatasetReader& reader, const std::vector<std::size_t>& trials);

// Rate of the slowest requested sensor [Hz] (chosen_sensors).
double slowest_rate(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked);

// Throws InputError as write_robomimic does.
Episode make_episode(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked, double rate,
                     const ActionSpace& space);

// A length [m] in mm, with the fewest digits from which `slipbench import` restores the same
// float32.
std::string millimetres(float metres);

// Text of a file in the vendor's layout, up to two sensors side by side. Throws InputError if their
// sample times differ.
std::string vendor_csv(const std::vector<PapillarraySamples>& sensors);
// True if a file that begins with `text` is such a log.
bool begins_as_vendor_csv(std::string_view text);

// Text of a file of 73 columns. Throws InputError if the rate is not 1000 Hz.
std::string training_csv(const PapillarraySamples& samples, double rate);
// True if a file that begins with `text` is such a file: its first line has 73 numbers.
bool begins_as_training_csv(std::string_view text);

// File name that the published training code expects: "translation/demo_3-v_4.0-slip.csv"
// (README.md). `time`: times of the pad's samples.
std::string training_file_name(std::size_t trial, const CommandedMotion& motion, const BodyRecord& pad,
                               const std::vector<double>& time);

// The layout of the public grasps with three BioTac SP (3dperceptionlab, bts3v2): one row per
// grasp. The columns object,slipped,ff_biotac_1..24,mf_biotac_1..24,th_biotac_1..24 hold the
// grasped object, whether it was lost (0 or 1), and the counts of the three fingers' electrodes in
// the last row of the log up to `hold.from`. Each of `trials` must have three sensors biotac_sp ff,
// mf and th at sites, a body `object` and an outcome that states whether it was held; otherwise
// throws InputError. The object's name is its shape and its size in mm.
std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials);

bool begins_as_grasp_csv(std::string_view text);

// The layout of the public slip recordings of a BioTac SP (yayaneath/BioTacSP-DoS): one folder per
// class, one file per recording.
struct SlipRecording {
  std::string name;  // "n/acrylic12.csv": class, object and trial
  std::string text;  // header ff_e1,...,ff_e24, then a row of counts every 10 ms
};

// The class is the motion that the scene commands, by the object's direction as seen from the
// finger: n towards its root (the pad moves along its X axis), s towards its tip, e to its right as
// seen from the root with the skin down (the pad moves along Y), w to its left; cw if the pad turns
// in the positive direction about the normal (then the object turns clockwise as seen from the
// finger), aw the other way, t without either.
// The object is the surface's material, and its shape unless it is a plane. The published
// recordings are cut within the motion: those of `rub` begin when it has reached its speed, all
// others with the trial.
// `sensor` names a biotac_sp of 100 Hz. Throws InputError for another sensor or another motion.
SlipRecording slip_csv(const DatasetReader& reader, std::size_t trial, const std::string& sensor);

bool begins_as_slip_csv(std::string_view text);

// One sensor's samples as a text table.
struct CsvTable {
  std::string channel;  // the channel with its own time stamps, which has its own table; empty: all others
  std::string text;
};

// The tables of a sensor, that of its own samples first (README.md defines the columns), with the
// state by `rule`, or by all three. Throws InputError if the channels do not match the names of
// their values, or a channel with a difference column does not have two values.
std::vector<CsvTable> table_csv(const SensorRecord& sensor, std::optional<LabelRule> rule = {});

// True if a file that begins with `text` is such a table.
bool begins_as_table_csv(std::string_view text);

// A trial for numpy.
// Returns the bytes of an .npz archive with every array of `record` under its path in a dataset,
// the attributes of its units as arrays next to their labels, and first `about`, a JSON object
// (README.md). Equal records give identical bytes. Throws std::runtime_error if libarchive fails.
std::string npz(const TrialRecord& record, const std::string& about);

// Path of an array in the archive: as in a dataset, except that a recording's labels are called
// state_recorded.
std::string archive_path(const TrialRecord& record, const std::string& path);

// True if a file that begins with `text` is such an archive: a zip archive whose first member is
// `about`.
bool begins_as_npz(std::string_view text);

// Header of an .npy file of version 1.0, 64-byte aligned. `descr`: type as numpy names it; `shape`
// is written as a Python tuple.
std::string npy_header(std::string_view descr, const std::vector<std::size_t>& shape);

// A dataset for robomimic.
struct RobomimicOptions {
  std::vector<std::string> sensors;  // observed sensors; empty: all
  std::optional<double> rate;        // Hz, of the demos; empty: that of the slowest sensor
  std::optional<LabelRule> rule;     // of the states next to the observations; empty: all three
  bool compress = false;             // every array by shuffle and deflate
  std::function<void(std::size_t done, std::uintmax_t bytes)> progress =
      {};  // called with the number of written demos and the file's size
};

// Writes the trials as one HDF5 file in robomimic's layout (README.md) under a temporary name,
// syncs and renames it. The same dataset gives identical bytes. Throws InputError if a trial does
// not fit: no such sensor, a rate above the fastest sensor's, fewer than two rows, a grasp without
// a loop, no moving body; if the file cannot be written, which is then removed; and if another run
// is writing it, which is then left alone. Every trial must have a recording.
void write_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, const std::string& path,
                     const RobomimicOptions& options);

// Throws InputError if a non-empty file of another kind exists at `path` or at its temporary name.
void check_robomimic_target(const std::string& path, const std::vector<std::string>& inputs);

}  // namespace slipbench
