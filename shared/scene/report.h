#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "scene/sparse_model.h"

namespace drupe {

/// Classes of defects and grades of fruit, in ascending severity; a fruit's grade is its worst class (paper 2.1).
enum class DefectClass { kIntact, kRainSpot, kScar, kCrack, kDecay };
const char* DefectClassName(DefectClass defect_class);  ///< "intact", "rain_spot", "scar", "crack", "decay"

/// The plane fitted to a defect's points (paper 4.2 (1)).
struct DefectPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit length, away from the fruit
  double offset_mm = 0;                               ///< normal . x = offset
  double rms_mm = 0;                                  ///< of the inliers
  double mean_abs_z_mm = 0;                           ///< mean |z| after rotation into XOY (the paper: 0.0152)
};

/// One surface defect. Lengths in mm when the scale is metric, else in the model's own unit.
struct Defect {
  int id = 0;  ///< 1, 2, ... within the fruit
  DefectClass defect_class = DefectClass::kRainSpot;
  double confidence = 0;  ///< 0..1
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double area_mm2 = 0;              ///< on the curved surface
  double area_uncertainty_mm2 = 0;  ///< standard uncertainty, as all named so
  double planar_area_mm2 = 0;       ///< of the contour in the fitted plane (Heron's triangles, paper 4.2 (2))
  double perimeter_mm = 0;
  double perimeter_uncertainty_mm = 0;
  double roundness = 0;    ///< 4 pi A / P^2
  double diameter_mm = 0;  ///< of the disc of its area
  double diameter_uncertainty_mm = 0;
  double length_mm = 0;  ///< long axis of the ellipse with the contour's second moments
  double width_mm = 0;   ///< area over length, of an ellipse
  double depth_mm = 0;   ///< below the healthy skin about it; negative when it stands out
  double depth_uncertainty_mm = 0;
  Eigen::Vector3d lab_change = Eigen::Vector3d::Zero();  ///< Lab of its core minus that of the skin about it
  bool completed = false;  ///< part of it lies under another defect; that part of the contour is completed
  DefectPlane plane;
  std::vector<Eigen::Vector3d> contour_mm;  ///< closed B-spline, sampled; the first point is not repeated
  Eigen::Vector3d mean_lab = Eigen::Vector3d::Zero();
  double area_share_pct = 0;  ///< of the fruit's surface
  int points = 0;             ///< of the cloud inside the contour
};

/// One fruit. Lengths in mm when the scale is metric, else in the model's own unit.
struct Fruit {
  int id = 0;  ///< 1, 2, ...
  DefectClass grade = DefectClass::kIntact;
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  double volume_mm3 = 0;
  double volume_uncertainty_mm3 = 0;
  double surface_area_mm2 = 0;
  double surface_area_uncertainty_mm2 = 0;
  double equatorial_diameter_mm = 0;
  double equatorial_uncertainty_mm = 0;
  double polar_diameter_mm = 0;
  double polar_uncertainty_mm = 0;
  double sphericity = 0;  ///< area of the sphere of equal volume over the fruit's area; 1 for a sphere
  Eigen::Vector3d mean_lab = Eigen::Vector3d::Zero();
  Eigen::Vector3d lab_spread = Eigen::Vector3d::Zero();  ///< standard deviation over the seen skin
  double observed_surface_pct = 0;
  double defect_area_pct = 0;
  std::vector<Defect> defects;  ///< descending by area
};

/// Where the numbers come from.
struct Provenance {
  std::string image_set;
  std::vector<std::string> image_sha256;
  Json calibration;
  Json options;
  std::string build;
};

/// The content of report.json.
struct Report {
  std::string id;          ///< of the reconstruction
  std::string created_at;  ///< UTC, ISO 8601
  ScaleSource scale_source = ScaleSource::kNone;
  Json quality;  ///< registered, of, mean_reprojection_error_px, dense_points, ...
  std::vector<Fruit> fruits;
  Json timings_s;
  Provenance provenance;
};

/// JSON after api/schemas/report.schema.json. Without a metric scale `unit` and everything measured in mm are null, and
/// shares, ratios and colours (defect_area_pct, area_share_pct, roundness, sphericity, mean_lab) remain.
Json ToJson(const Report& report);

/// One line a defect, RFC 4180, with a header; a fruit without defects has one line with empty defect columns.
std::string ToCsv(const Report& report);

}  // namespace drupe
