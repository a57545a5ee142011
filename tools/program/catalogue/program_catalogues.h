// Everything that a scene may name in this program.
#pragma once

#include "sim/scene/catalogues.h"

namespace slipbench {

Catalogues program_catalogues();

}  // namespace slipbench
