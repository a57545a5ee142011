#include "tools/program/run/recorded_scene.h"

#include <string>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/base/record/json.h"

namespace slipbench {

Scene recorded_scene(const DatasetReader& reader, const TrialRecord& record, const Catalogues& catalogues) {
  SceneFile file = SceneFile::from_text(reader.header().scene, "attribute scene");
  const auto apply = [&file](const std::string& text, const std::string& attribute) {
    const auto values = Json::parse(text, nullptr, false);
    if (!values.is_object()) throw InputError("attribute " + attribute + " is not a JSON object");
    for (const auto& [path, value] : values.items()) {
      if (path != "sweep" && !path.starts_with("sweep.") && !value.is_null()) {
        file.apply({path, value.is_string() ? value.get<std::string>() : value.dump()});
      }
    }
  };
  apply(reader.header().overrides, "overrides");
  file.apply({"sweep", "{}"});
  apply(record.params, "params");
  return parse_scene(file, catalogues);
}

}  // namespace slipbench
