// The fast engine:
// - A word holds 64 entries, a vector register up to 512; a bundle is a tree of full adders over
//   bit-sliced counts.
// - Vertices and edges of a graph of four reduce to a count of vertices (kernel_body.h).
// - CIM * IM and P_k * CV are bound once, at construction.
// - The window slides: GST_t = rho(GST_{t-1}) * rho^N(GS_{t-N}) * GS_t. This is exact, from the
//   start if GS = +1 before the first frame. The published core's counts span the window, so its
//   frames are all bundled again.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "detectors/hd/engine.h"
#include "detectors/hd/kernel/kernel_passes.h"
#include "sim/core/error.h"

namespace slipbench::hd {
namespace {

using kernel::block_words;
using kernel::Word;

// Rows of words, aligned to cache lines.
class Rows {
 public:
  Rows(std::size_t rows, std::size_t words) : stride_((words + block_words - 1) / block_words), blocks_(rows * stride_) {}

  Word* operator[](std::size_t row) { return blocks_[row * stride_].words; }
  const Word* operator[](std::size_t row) const { return blocks_[row * stride_].words; }
  [[nodiscard]] std::size_t stride() const { return stride_ * block_words; }

 private:
  struct alignas(64) Block {
    Word words[block_words];
  };

  std::size_t stride_;
  std::vector<Block> blocks_;
};

// Number of copies of a vector that fill a word. Passes treat the copies alike; distances grow by
// the same factor.
std::size_t copies_of(std::size_t dimension) { return (63 + dimension) / dimension; }

std::size_t padded_words(std::size_t bits) { return (bits + 64 * block_words - 1) / (64 * block_words) * block_words; }

const kernel::Passes& passes_of(KernelPath path) {
  const std::vector<KernelPath> paths = kernel_paths();
  if (std::ranges::find(paths, path) == paths.end()) {
    throw InputError(std::string("hd kernel: this machine cannot run ") + (path == KernelPath::avx512 ? "AVX-512" : "AVX2"));
  }
#ifdef SLIPBENCH_HD_X86
  if (path == KernelPath::avx512) return kernel::avx512_passes;
  if (path == KernelPath::avx2) return kernel::avx2_passes;
#endif
  return kernel::portable_passes;
}

class Kernel : public Engine, public Encoder {
 public:
  Kernel(const Model& model, const Memories& memories, KernelPath path)
      : model_(model),
        passes_(passes_of(path)),
        copies_(copies_of(model.dimension)),
        bits_(model.dimension * copies_),
        words_(padded_words(bits_)),
        frames_(model.frames()),
        shift_(frames_ % bits_),
        bound_(pillar_count * level_count, words_),
        level_(level_count, words_),
        centre_(level_count, words_),
        graph_(2, words_),
        prototype_(context_count * class_count, words_),
        ones_(1, words_),
        // A rotation reads beyond the last bit, at most as far as it turns.
        history_(frames_ + 1, words_ + std::min(frames_, bits_ - 1) / 64 + 1),
        gst_(1, words_ + 1),
        query_(model.dimension) {
    for (std::size_t level = 0; level < level_count; ++level) {
      copy(memories.level[level], level_[level]);
      for (std::size_t p = 0; p < pillar_count; ++p) {
        copy(bind(memories.level[level], memories.item[p]), bound_[p * level_count + level]);
      }
      copy(bind(memories.level[level], memories.item[pillar_count + 2]), centre_[level]);
    }
    copy(memories.item[pillar_count], graph_[0]);
    copy(memories.item[pillar_count + 1], graph_[1]);
    for (std::size_t k = 0; k < memories.associative.size(); ++k) {
      const Hypervector& prototype = memories.associative[k];
      for (std::size_t c = 0; c < context_count; ++c) {
        copy(model.context_driven ? bind(prototype, memories.context[c]) : prototype, prototype_[c * class_count + k]);
      }
    }
    for (std::size_t i = 0; i < bits_; ++i) ones_[0][i / 64] |= Word{1} << (i % 64);
    if (model.compat == Compat::published_core) window_.resize(frames_);
    Kernel::reset();
  }

  Decision update(const Frame& frame) override {
    const bool full = take(frame);
    const Word* prototypes[class_count];
    for (std::size_t k = 0; k < class_count; ++k) prototypes[k] = prototype_[frame.context * class_count + k];
    std::size_t distance[class_count];
    passes_.distances(gst_[0], ones_[0], prototypes, words_, distance);
    prepare_rotations();
    if (!full) return {};
    // Minimum of distance and class packed into one number: without branches, which would be
    // unpredictable. Of two equally near classes the higher one has the lower number.
    Decision decision;
    std::size_t nearest = ~std::size_t{0};
    for (std::size_t k = 0; k < class_count; ++k) {
      decision.distance[k] = static_cast<std::uint16_t>(copies_ == 1 ? distance[k] : distance[k] / copies_);
      nearest = std::min(nearest, distance[k] * 4 + (class_count - 1 - k));
    }
    decision.state = static_cast<PadState>(class_count - nearest % 4);
    return decision;
  }

  const Hypervector* encode(const Frame& frame) override {
    const bool full = take(frame);
    for (std::size_t i = 0; i < query_.words().size(); ++i) query_.words()[i] = gst_[0][i];
    if (const std::size_t used = model_.dimension % 64; used != 0) query_.words().back() &= (Word{1} << used) - 1;
    prepare_rotations();
    return full ? &query_ : nullptr;
  }

  void reset() override {
    seen_ = 0;
    slot_ = 0;
    std::fill_n(gst_[0], gst_.stride(), ~Word{0});
    for (std::size_t slot = 0; slot <= frames_; ++slot) std::fill_n(history_[slot], history_.stride(), ~Word{0});
  }

 private:
  void copy(const Hypervector& from, Word* to) const {
    for (std::size_t i = 0; i < bits_; ++i) to[i / 64] |= Word{from.bit(i % model_.dimension)} << (i % 64);
  }

  // Takes a frame. Returns true if gst_ belongs to a full window.
  bool take(const Frame& frame) {
    const kernel::FrameRows rows = pick(frame);
    model_.compat == Compat::paper ? slide(rows) : bundle_window(rows);
    return seen_ == frames_;
  }

  kernel::FrameRows pick(const Frame& frame) const {
    bool exists = frame.context < context_count;
    for (const std::uint8_t level : frame.level) exists &= level < level_count;
    if (!exists) throw std::out_of_range("hd engine: a level beyond 20 or a context beyond 3");
    kernel::FrameRows rows;
    for (std::size_t p = 0; p < pillar_count; ++p) rows.pillar[p] = bound_[p * level_count + frame.level[p]];
    for (std::size_t v = 0; v < 4; ++v) {
      rows.corner[v] = level_[frame.level[corner_pillars[v]]];
      rows.edge[v] = level_[frame.level[edge_pillars[v]]];
    }
    rows.centre = centre_[frame.level[centre_pillar]];
    return rows;
  }

  [[nodiscard]] kernel::GraphRows graphs() const { return {graph_[0], graph_[1]}; }

  void slide(const kernel::FrameRows& rows) {
    Word* const gs = history_[slot_];
    slot_ = slot_ == frames_ ? 0 : slot_ + 1;
    if (model_.encoding == Encoding::graph_spatial_temporal) {
      passes_.bundle_graphs(rows, graphs(), model_.ties == Ties::one, words_, gs);
    } else {
      passes_.bundle_pillars(rows, words_, gs);
    }
    passes_.slide(history_[slot_], shift_, gs, words_, gst_[0]);
    if (seen_ < frames_) ++seen_;
  }

  // Prepares the bits that the next slide() reads beyond the last ones. The write goes into a
  // vector that was just stored, which would stall a read of the whole vector; so this runs after
  // the query is read, not in slide().
  void prepare_rotations() {
    if (model_.compat == Compat::published_core) return;
    repeat(gst_[0], 1);
    repeat(history_[slot_ == 0 ? frames_ : slot_ - 1], shift_);
  }

  void bundle_window(const kernel::FrameRows& rows) {
    window_[slot_] = rows;
    slot_ = slot_ + 1 == frames_ ? 0 : slot_ + 1;
    if (seen_ < frames_ && ++seen_ < frames_) return;
    const bool with_graphs = model_.encoding == Encoding::graph_spatial_temporal;
    const kernel::GraphRows names = graphs();
    const auto planes = static_cast<unsigned>(std::bit_width(21 + pillar_count * frames_));
    passes_.bundle_core({window_.data(), frames_, slot_, planes}, with_graphs ? &names : nullptr, model_.ties == Ties::one,
                        words_, history_.stride(), history_[0]);
    std::fill_n(gst_[0], words_, ~Word{0});
    for (std::size_t r = 0; r < frames_; ++r) {
      const std::size_t shift = (frames_ - 1 - r) % bits_;
      repeat(history_[r], shift);
      passes_.bind_rotated(history_[r], shift, words_, gst_[0]);
    }
  }

  // Repeats the first bits of a row, at least `count`, after its last one.
  void repeat(Word* row, std::size_t count) const {
    const std::size_t used = bits_ % 64;
    std::size_t i = bits_ / 64;
    if (used != 0) {
      row[i] = (row[i] & ((Word{1} << used) - 1)) | row[0] << used;
      ++i;
    }
    for (; 64 * i < bits_ + count; ++i) {
      const std::size_t from = 64 * i - bits_;
      row[i] = row[from / 64] >> (from % 64) | row[from / 64 + 1] << 1 << (63 - from % 64);
    }
  }

  Model model_;
  const kernel::Passes& passes_;
  std::size_t copies_, bits_, words_;
  std::size_t frames_, shift_;  // N, and the rotation of the frame leaving the window
  Rows bound_, level_, centre_, graph_, prototype_, ones_;
  Rows history_;  // GS of the last N frames and of this one, in a ring; for the core its bundles, oldest first
  Rows gst_;
  std::vector<kernel::FrameRows> window_;  // published core: the last N frames, in a ring
  std::size_t seen_ = 0, slot_ = 0;
  Hypervector query_;
};

}  // namespace

std::vector<KernelPath> kernel_paths() {
  std::vector<KernelPath> paths{KernelPath::portable};
#ifdef SLIPBENCH_HD_X86
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("popcnt") != 0) paths.push_back(KernelPath::avx2);
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vpopcntdq") != 0)
    paths.push_back(KernelPath::avx512);
#endif
  return paths;
}

std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories) {
  return make_kernel(model, memories, kernel_paths().back());
}

std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories, KernelPath path) {
  check(model, memories, true);
  return std::make_unique<Kernel>(model, memories, path);
}

std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories) {
  return make_kernel_encoder(model, memories, kernel_paths().back());
}

std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories, KernelPath path) {
  check(model, memories, false);
  return std::make_unique<Kernel>(model, memories, path);
}

}  // namespace slipbench::hd
