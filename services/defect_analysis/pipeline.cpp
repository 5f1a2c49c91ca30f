#include "defect_analysis/pipeline.h"

#include <algorithm>

#include "base/clock.h"
#include "base/option_reader.h"
#include "base/version.h"
#include "defect_analysis/defects/find_defects.h"
#include "defect_analysis/fruit/extract_fruits.h"
#include "defect_analysis/fruit/traits.h"
#include "defect_analysis/models/default_model.h"
#include "defect_analysis/report/assemble.h"
#include "defect_analysis/report/trait_uncertainty.h"

namespace drupe {
namespace {

Status CheckInput(const AnalysisInput& input) {
  if (input.cloud.empty()) return Unprocessable("empty_cloud", "the dense cloud has no points");
  if (input.cloud.colours.size() != input.cloud.positions.size()) {
    return InvalidArgument("invalid_cloud", "the dense cloud must have one colour for every point", "cloud");
  }
  const auto& positions = input.cloud.positions;
  if (std::none_of(positions.begin(), positions.end(), [](const auto& x) { return x.allFinite(); })) {
    return InvalidArgument("invalid_cloud", "the dense cloud has no finite position", "cloud");
  }
  return Status::Ok();
}

Result<std::vector<Fruit>> MeasureFruits(const std::vector<FruitCloud>& clouds, double scale_sigma,
                                         const DefectOptions& options, const RunContext& context) {
  std::vector<Fruit> fruits;
  for (const FruitCloud& cloud : clouds) {
    context.Report("defects", static_cast<double>(fruits.size()) / static_cast<double>(clouds.size()));
    DRUPE_ASSIGN_OR_RETURN(std::vector<Defect> defects, FindDefects(cloud, options, context));
    Fruit traits = MeasureTraits(cloud);
    AddTraitUncertainties(cloud, scale_sigma, traits);
    fruits.push_back(AssembleFruit(std::move(traits), std::move(defects), cloud.mm_per_unit));
  }
  NumberFruits(fruits);
  context.Report("defects", 1);
  return fruits;
}

// The model that the options name; nothing for geometry alone.
Result<std::optional<ColourModel>> BackgroundModel(const AnalysisInput& input, const BackgroundOptions& options) {
  if (options.model == "none") return std::optional<ColourModel>();
  if (input.background_model) return input.background_model;
  if (options.model != "default") {
    return InvalidArgument("unknown_model", "there is no model " + options.model, "background.model");
  }
  DRUPE_ASSIGN_OR_RETURN(ColourModel model, DefaultBackgroundModel());
  return std::optional<ColourModel>(std::move(model));
}

}  // namespace

Status AnalysisOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(background.Check());
  DRUPE_RETURN_IF_ERROR(fruit.Check());
  return defects.Check();
}

Result<AnalysisOptions> ParseAnalysisOptions(const Json& json) {
  AnalysisOptions options;
  if (json.is_null()) return options;
  OptionReader reader(json, "options");
  if (const Json* background = reader.Nested("background")) {
    DRUPE_ASSIGN_OR_RETURN(options.background, ParseBackgroundOptions(*background, reader.PathOf("background")));
  }
  if (const Json* fruit = reader.Nested("fruit")) {
    DRUPE_ASSIGN_OR_RETURN(options.fruit, ParseFruitOptions(*fruit, reader.PathOf("fruit")));
  }
  DRUPE_RETURN_IF_ERROR(ReadDefectOptions(reader, options.defects));
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const AnalysisOptions& options) {
  Json json = {{"background", ToJson(options.background)}, {"fruit", ToJson(options.fruit)}};
  json.update(ToJson(options.defects));
  return json;
}

Result<Report> RunAnalysis(const AnalysisInput& input, const AnalysisOptions& options, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckInput(input));
  context.Report("fruit", 0);
  DRUPE_ASSIGN_OR_RETURN(const std::optional<ColourModel> model, BackgroundModel(input, options.background));
  const FruitScene scene{input.scale_source == ScaleSource::kBoard, input.camera_centres, model ? &*model : nullptr};
  const Stopwatch fruit_watch;
  DRUPE_ASSIGN_OR_RETURN(const std::vector<FruitCloud> clouds,
                         ExtractFruits(input.cloud, scene, options.fruit, options.background, context));
  const double fruit_s = fruit_watch.WallSeconds();
  context.Report("fruit", 1);
  const Stopwatch defects_watch;
  Report report;
  DRUPE_ASSIGN_OR_RETURN(report.fruits, MeasureFruits(clouds, input.scale_relative_sigma, options.defects, context));
  report.scale_source = input.scale_source;
  report.timings_s = {{"fruit", fruit_s}, {"defects", defects_watch.WallSeconds()}};
  report.provenance.options = ToJson(options);
  report.provenance.build = kVersion;
  return report;
}

}  // namespace drupe
