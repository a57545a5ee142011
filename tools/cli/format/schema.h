// The JSON Schema of scenes, for editors and for programs that generate scenes.
#pragma once

#include "sim/scene/catalogues.h"
#include "tools/dataset/record/json.h"

namespace slipbench {

// The JSON Schema (draft 2020-12) of scenes with `catalogues`, generated from the declarations that
// the scene parser reads. It describes a scene as written, before its sweep; conditions on the
// whole scene, such as a kinetic coefficient that must not exceed the static one, are left to
// `slipbench check`. Throws std::logic_error if a key of the scene has no schema.
Json scene_schema(const Catalogues& catalogues);

}  // namespace slipbench
