// Slow random processes of a hand that moves a finger: its load, its rocking and its drive.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "sim/api/motion.h"
#include "sim/core/random.h"

namespace slipbench {

// The value of a process, and its rate [1/s].
struct ProcessPoint {
  double value = 0.0, rate = 0.0;
};

// Gaussian process of mean 0 and variance 1: white noise behind two equal low passes, as a Markov
// chain. With s the time over the time constant and u = x'/a, (x, u) is normal with unit covariance
// P, and over s it becomes A (x, u) + L w with A = e^-s [1+s, s; -s, 1-s] and L L^T = P - A A^T.
class LowPassedNoise {
 public:
  void begin(RandomStream& random);
  void advance(double s, RandomStream& random);
  // Returns x, and its rate over a, bounded by HandProcesses::limit.
  [[nodiscard]] ProcessPoint bounded() const;

 private:
  double x_ = 0.0, u_ = 0.0;
};

// The processes of one trial at any time, drawn at knots of 10 ms. Between knots they are cubic with
// a continuous rate. A chain only runs forwards; for a time before the last one it is restarted.
class HandProcesses {
 public:
  enum Which { load, along, around, drive, count };

  static constexpr double knot = 0.01;  // s
  // Bound of processes and of their rates over a, which makes top_speed() of a motion finite. A rate
  // beyond it is drawn again (one in 16,000). A value cannot jump back, so it saturates from 3 on.
  static constexpr double limit = 4.0;

  struct Settings {
    double corner, warp_corner;  // Hz
    double warp, drive;
    double begin, rise;  // s, start and duration of the rise of q
    double rest;         // factor on all other processes until then
  };

  // `stream`: name of the random numbers.
  HandProcesses(const Settings& settings, const MotionKey& key, std::string stream);

  [[nodiscard]] ProcessPoint at(Which which, double t) const;
  // Returns the integral of q = max(0, drive + p), and q.
  [[nodiscard]] ProcessPoint way(double t) const;

  // Upper bounds of the rate of the processes [1/s] and of q.
  [[nodiscard]] double top_rate() const;
  [[nodiscard]] double top_way_rate() const;

 private:
  struct Knot {
    std::array<ProcessPoint, count> points;
    double pace, q, way;  // 1/s, 1, s
  };
  struct Chain {
    RandomStream random;
    LowPassedNoise time;
    std::array<LowPassedNoise, count> processes;
    std::size_t knots;  // number drawn; `after` is number knots - 1
    Knot before, after;
  };

  [[nodiscard]] Chain start() const;
  [[nodiscard]] Knot read(const Chain& chain, double t) const;
  void step(Chain& chain) const;
  // Moves the chain to time t; returns the fraction between `before` and `after`.
  [[nodiscard]] double go_to(double t) const;

  Settings settings_;
  MotionKey key_;
  std::string stream_;
  double pole_;  // 1/s
  mutable Chain chain_;
};

}  // namespace slipbench
