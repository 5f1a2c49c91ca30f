#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/fruit/background_options.h"
#include "defect_analysis/fruit/fruit_options.h"
#include "scene/board.h"
#include "scene/colour_model.h"
#include "scene/point_cloud.h"
#include "scene/report.h"
#include "scene/sparse_model.h"

namespace drupe {

/// What the analysis needs of a reconstruction.
struct AnalysisInput {
  PointCloud cloud;  ///< positions and colours are required, normals used where present
  ScaleSource scale_source = ScaleSource::kNone;
  double scale_relative_sigma = 0;              ///< standard uncertainty of the scale, relative; 0 when unknown
  std::vector<Eigen::Vector3d> camera_centres;  ///< of the registered views, world frame; may be empty
  std::optional<Board> board;  ///< the world frame is the board's when it is there and the scale metric
  /// The model that options.background.model names; not needed for "none", nor for "default", the one built in.
  std::optional<ColourModel> background_model;
};

struct AnalysisOptions {
  BackgroundOptions background;  ///< key "background"
  FruitOptions fruit;            ///< key "fruit"
  DefectOptions defects;         ///< keys "segmentation", "cluster", "plane", "contour", "class"

  /// 400 `invalid_option` with the field and its range.
  Status Check() const;
};

/// Reads {"background": {...}, "fruit": {...}, "segmentation": {...}, "cluster": {...}, "plane": {...}, "contour":
/// {...}, "class": {...}}; null or absent keys keep their defaults. Errors: 400 `unknown_option` naming the key, 400
/// `invalid_option`.
Result<AnalysisOptions> ParseAnalysisOptions(const Json& json);
Json ToJson(const AnalysisOptions& options);

/// From the dense cloud to the defect report (paper section 4): background removal, traits, segmentation, clusters,
/// planes, contours, classes. Fills everything but id, created_at, quality and the images' provenance, which the caller
/// knows; timings_s holds the wall seconds of "fruit" and "defects".
/// A cloud without any fruit gives a report with none. Progress stages: "fruit", "defects". Errors: 422 `empty_cloud`,
/// 400 `invalid_cloud` (lengths differ, non-finite positions only, no colours), `unknown_model`, `cancelled`.
Result<Report> RunAnalysis(const AnalysisInput& input, const AnalysisOptions& options, const RunContext& context);

}  // namespace drupe
