#include "defect_analysis/fruit/background_options.h"

#include "base/ids.h"
#include "base/option_check.h"
#include "base/option_reader.h"

namespace drupe {
Status BackgroundOptions::Check() const {
  if (model != "default" && model != "none" && !IsId(model, "mdl")) {
    return RefuseOption("background.model", "default, none, or the id of a trained model (mdl_...)");
  }
  if (!(known_share >= 0.5 && known_share <= 1)) return RefuseOption("background.known_share", "0.5 to 1");
  if (!(doubt_mm >= 0 && doubt_mm <= 10)) return RefuseOption("background.doubt_mm", "0 to 10");
  if (!(doubt_sigma >= 0 && doubt_sigma <= 100)) return RefuseOption("background.doubt_sigma", "0 to 100");
  return Status::Ok();
}

Result<BackgroundOptions> ParseBackgroundOptions(const Json& json, const std::string& path) {
  BackgroundOptions options;
  OptionReader reader(json, path);
  reader.Read("model", options.model);
  reader.Read("known_share", options.known_share);
  reader.Read("doubt_mm", options.doubt_mm);
  reader.Read("doubt_sigma", options.doubt_sigma);
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const BackgroundOptions& options) {
  return {{"model", options.model},
          {"known_share", options.known_share},
          {"doubt_mm", options.doubt_mm},
          {"doubt_sigma", options.doubt_sigma}};
}

}  // namespace drupe
