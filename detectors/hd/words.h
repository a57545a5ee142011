// Names of a model's choices in files, scenes and commands.
#pragma once

#include <array>

#include "detectors/hd/features.h"
#include "detectors/hd/model.h"
#include "sim/core/choice.h"

namespace slipbench::hd {

inline constexpr std::array encoding_words{Choice<Encoding>{"spatial", Encoding::spatial},
                                           Choice<Encoding>{"spatial_temporal", Encoding::spatial_temporal},
                                           Choice<Encoding>{"graph_spatial_temporal", Encoding::graph_spatial_temporal}};
inline constexpr std::array ties_words{Choice<Ties>{"one", Ties::one}, Choice<Ties>{"zero", Ties::zero}};
inline constexpr std::array compat_words{Choice<Compat>{"paper", Compat::paper},
                                         Choice<Compat>{"published_core", Compat::published_core}};
inline constexpr std::array quantiser_words{Choice<Quantiser>{"fixed_point", Quantiser::fixed_point},
                                            Choice<Quantiser>{"exact", Quantiser::exact},
                                            Choice<Quantiser>{"unrounded", Quantiser::unrounded}};

}  // namespace slipbench::hd
