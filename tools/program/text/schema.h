// The JSON Schema of scenes, for editors and for programs that write scenes.
#pragma once

#include "sim/scene/catalogues.h"
#include "tools/base/record/json.h"

namespace slipbench {

// The JSON Schema (draft 2020-12) of scenes that draw from `catalogues`, made from the declarations that the scene parser
// reads. It describes a scene as written, before its sweep: what only a whole scene can tell, such as a kinetic
// coefficient above the static one, is left to `slipbench check`. Throws std::logic_error where a key of the scene has
// no schema.
Json scene_schema(const Catalogues& catalogues);

}  // namespace slipbench
