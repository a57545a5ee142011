// The protocol slip-1: what is judged, what learns, and the constants of the score. Its scenes are scenes/benchmark/slip-1/*.yaml.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/program/train/network/operating_point.h"

namespace slipbench::benchmark {

inline constexpr std::string_view protocol_name = "slip-1";

// Constants of the score (score.h).
using train::alarm_limit;
using train::half_delay;
inline constexpr double worst_force_ratio =
    2.5;  // greatest grip force over the least that holds, from which on a grasp earns nothing

enum class Track { open, loop, transfer };
// "open recordings", "closed loop", "transfer"
std::string_view track_name(Track track);

// Held-out trials of one sensor.
struct Held {
  Track track = Track::open;
  std::string sensor;                // its type: "papillarray"
  std::string scene;                 // from the project's root
  std::vector<std::string> readers;  // the scene's names of the sensors that a detector may read; it gets the first that it can
  std::string mover;                 // the actuator that makes it slip; empty: the motion itself
  // What controls are told, which feel nothing: what scores best on these very trials, so that nothing of the kind scores better. NaN: never to say
  // slip scores better than any. The steps are those of the README.
  double clock;  // s after the start, from which the control `clock` says slip
  double
      time;  // s, for which the control `motion known, timed` waits after the motion begins; in a loop: for which it says slip from the lift on
};
const std::vector<Held>& held_out();

// A network that learns as a part of the protocol, from a scene that shares no seed with those held out. The memories of gst_hd that ship have
// learnt from learn_papillarray.yaml.
struct Lesson {
  std::string recipe;  // of train::recipes(), with its own number of steps
  std::string sensor;  // type
  std::string scene;   // from the project's root, with its own seed
  std::size_t trials;  // of each cell of its grid; 0: the scene's
};
const std::vector<Lesson>& lessons();

// SHA-256, 64 hexadecimal digits, over the name, the constants, both tables and the bytes of every scene and model that they name. Throws
// InputError where one cannot be read.
std::string protocol_sha256();

}  // namespace slipbench::benchmark
