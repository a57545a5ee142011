// A trial as a sequence of observations and actions at one rate.
#pragma once

#include <string>
#include <vector>

#include "tools/base/dataset/reader.h"
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

}  // namespace slipbench
