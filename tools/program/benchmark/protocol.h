// The protocols slip-1 and slip-2: what is judged, what learns, and the constants of the score. Their scenes are scenes/benchmark/NAME/*.yaml.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tools/program/train/network/operating_point.h"

namespace slipbench::benchmark {

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
  std::string sensor{};                // its type: "papillarray"
  std::string scene{};                 // from the project's root
  std::vector<std::string> readers{};  // the scene's names of the sensors that a detector may read; it gets the first that it can
  std::string mover{};                 // the actuator that makes it slip; empty: the motion itself
  std::string domain{};                // "inside" or "outside" of what scenes/learn draws; empty: not told apart
  bool grace = false;                  // an alarm less than a sample period before the slip is no early one
  bool needless = false;               // a grasp's score is lowered by force that its box did not need (score.h)
  // What controls are told, which feel nothing: what scores best on these very trials, so that nothing of the kind scores better. NaN: never to say
  // slip scores better than any. The steps are those of the README.
  double clock = std::numeric_limits<double>::quiet_NaN();  // s after the start, from which the control `clock` says slip
  // s, for which the control `motion known, timed` waits after the motion begins; in a loop: for which it says slip from the lift on
  double time = std::numeric_limits<double>::quiet_NaN();
};

// A network that learns as a part of the protocol, from a scene that shares no seed with those held out. The memories of gst_hd that ship have
// learnt from learn_papillarray.yaml.
struct Lesson {
  std::string recipe;  // of train::recipes(), with its own number of steps
  std::string sensor;  // type
  std::string scene;   // from the project's root, with its own seed
  std::size_t trials;  // of each cell of its grid; 0: the scene's
};

struct Protocol {
  std::string name;  // "slip-2"
  std::vector<Held> held_out;
  std::vector<Lesson> lessons;
};
inline constexpr const char* default_protocol = "slip-2";
// In the order in which they were made.
const std::vector<Protocol>& protocols();
// Throws InputError where none has this name; `subject` is who names it, a command or a file.
const Protocol& find_protocol(const std::string& name, const std::string& subject);

// SHA-256, 64 hexadecimal digits, over the name, the constants, both tables and the bytes of every scene and model that they name. Throws
// InputError where one cannot be read.
std::string protocol_sha256(const Protocol& protocol);

}  // namespace slipbench::benchmark
