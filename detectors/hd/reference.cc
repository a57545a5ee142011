#include <deque>
#include <stdexcept>
#include <string>

#include "detectors/hd/engine.h"

namespace slipbench::hd {
namespace {

// A vector of numbers: -1 and +1 if bipolar, otherwise sums of these. Entry i is bit i.
using Vector = std::vector<int>;

Vector bipolar(const Hypervector& bits) {
  Vector v(bits.dimension());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = bits.bit(i) ? 1 : -1;
  return v;
}

std::vector<Vector> bipolar(const std::vector<Hypervector>& memory) {
  std::vector<Vector> rows;
  for (const Hypervector& row : memory) rows.push_back(bipolar(row));
  return rows;
}

Vector operator*(Vector a, const Vector& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] *= b[i];
  return a;
}

Vector operator+(Vector a, const Vector& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

// [a]: reduces sums to -1 and +1.
Vector bipolarise(Vector a, Ties ties) {
  for (int& x : a) x = x > 0 || (x == 0 && ties == Ties::one) ? 1 : -1;
  return a;
}

// rho^k.
Vector rho(const Vector& a, std::size_t k) {
  Vector rotated(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) rotated[i] = a[(i + k) % a.size()];
  return rotated;
}

std::uint16_t hamming(const Vector& a, const Vector& b) {
  std::uint16_t distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance = static_cast<std::uint16_t>(distance + (a[i] != b[i]));
  return distance;
}

class Reference : public Engine, public Encoder {
 public:
  Reference(const Model& model, const Memories& memories)
      : model_(model),
        item_(bipolar(memories.item)),
        level_(bipolar(memories.level)),
        context_(bipolar(memories.context)),
        prototype_(bipolar(memories.associative)),
        query_(model.dimension) {}

  Decision update(const Frame& frame) override {
    if (!take(frame)) return {};
    const Vector gst = temporal();
    Decision decision;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < class_count; ++k) {
      decision.distance[k] = hamming(gst, model_.context_driven ? prototype_[k] * context_[frame.context] : prototype_[k]);
      if (decision.distance[k] <= decision.distance[nearest]) nearest = k;
    }
    decision.state = static_cast<PadState>(nearest + 1);
    return decision;
  }

  const Hypervector* encode(const Frame& frame) override {
    if (!take(frame)) return nullptr;
    const Vector gst = temporal();
    for (std::size_t i = 0; i < gst.size(); ++i) query_.set(i, gst[i] > 0);
    return &query_;
  }

  void reset() override { frames_.clear(); }

 private:
  // Adds a frame. Returns true if the window is full.
  bool take(const Frame& frame) {
    check(frame);
    frames_.push_back(frame);
    if (frames_.size() > model_.frames()) frames_.pop_front();
    return frames_.size() == model_.frames();
  }

  // Eq. 1: vertices and edges of a graph.
  template <class Pillars>
  Vector graph(const Frame& frame, const Pillars& pillars) const {
    Vector gamma(model_.dimension);
    for (std::size_t p = 0; p < pillars.size(); ++p) {
      const Vector& vertex = level_[frame.level[pillars[p]]];
      gamma = gamma + vertex;
      for (std::size_t q = p + 1; q < pillars.size(); ++q) gamma = gamma + vertex * level_[frame.level[pillars[q]]];
    }
    return gamma;
  }

  // Eq. 2: the graphs bound with their names; zero for an encoding without graphs.
  Vector graphs(const Frame& frame) const {
    if (model_.encoding != Encoding::graph_spatial_temporal) return Vector(model_.dimension);
    return graph(frame, corner_pillars) * item_[pillar_count] + graph(frame, edge_pillars) * item_[pillar_count + 1] +
           graph(frame, std::array{centre_pillar}) * item_[pillar_count + 2];
  }

  // The sum of eq. 3: levels bound with their pillars.
  Vector pillars(const Frame& frame) const {
    Vector sum(model_.dimension);
    for (std::size_t p = 0; p < pillar_count; ++p) sum = sum + level_[frame.level[p]] * item_[p];
    return sum;
  }

  // Eq. 4 over the window, with eq. 3 for each frame.
  Vector temporal() const {
    Vector gst(model_.dimension, 1);
    Vector counts(model_.dimension);
    for (std::size_t r = 0; r < frames_.size(); ++r) {
      counts = model_.compat == Compat::published_core ? counts + pillars(frames_[r]) : pillars(frames_[r]);
      const Vector gs = bipolarise(graphs(frames_[r]) + counts, model_.ties);
      gst = gst * rho(gs, frames_.size() - 1 - r);
    }
    return gst;
  }

  Model model_;
  std::vector<Vector> item_, level_, context_, prototype_;
  std::deque<Frame> frames_;
  Hypervector query_;
};

}  // namespace

void check(const Frame& frame) {
  for (const std::uint8_t level : frame.level) {
    if (level >= level_count) throw std::out_of_range("hd engine: level " + std::to_string(level) + " of 0 to 20");
  }
  if (frame.context >= context_count) {
    throw std::out_of_range("hd engine: context " + std::to_string(frame.context) + " of 0 to 3");
  }
}

std::unique_ptr<Engine> make_reference(const Model& model, const Memories& memories) {
  check(model, memories, true);
  return std::make_unique<Reference>(model, memories);
}

std::unique_ptr<Encoder> make_reference_encoder(const Model& model, const Memories& memories) {
  check(model, memories, false);
  return std::make_unique<Reference>(model, memories);
}

}  // namespace slipbench::hd
