#include "defect_analysis/models/train_options.h"

#include "base/ids.h"
#include "base/option_check.h"
#include "base/option_reader.h"

namespace drupe {
Status TrainOptions::Check() const {
  if (!CheckImageName(name).ok())
    return RefuseOption("name", "1 to 128 characters of [A-Za-z0-9._-], not starting with a dot");
  if (!(c >= 1e-3 && c <= 1e5)) return RefuseOption("c", "0.001 to 100000");
  if (!(gamma >= 1e-3 && gamma <= 1e3)) return RefuseOption("gamma", "0.001 to 1000");
  if (max_points < 50 || max_points > 50000) return RefuseOption("max_points", "50 to 50000");
  if (!(test_share >= 0 && test_share <= 0.9)) return RefuseOption("test_share", "0 to 0.9");
  if (recoloured < 0 || recoloured > 24) return RefuseOption("recoloured", "0 to 24");
  return Status::Ok();
}

Result<TrainOptions> ParseTrainOptions(const Json& json) {
  TrainOptions options;
  if (json.is_null()) return options;
  OptionReader reader(json, "options");
  std::string space = ColourSpaceName(options.space);
  reader.Read("name", options.name);
  reader.Read("colour_space", space);
  reader.Read("c", options.c);
  reader.Read("gamma", options.gamma);
  reader.Read("max_points", options.max_points);
  reader.Read("test_share", options.test_share);
  reader.Read("recoloured", options.recoloured);
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  if (space != "lab" && space != "rgb") return RefuseOption("colour_space", "lab or rgb");
  options.space = space == "lab" ? ColourSpace::kLab : ColourSpace::kRgb;
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const TrainOptions& options) {
  return {{"name", options.name},
          {"colour_space", ColourSpaceName(options.space)},
          {"c", options.c},
          {"gamma", options.gamma},
          {"max_points", options.max_points},
          {"test_share", options.test_share},
          {"recoloured", options.recoloured}};
}

}  // namespace drupe
