#pragma once

#include <optional>
#include <string>

#include "base/json.h"
#include "base/option_reader.h"
#include "base/status.h"
#include "scene/class_model.h"

namespace drupe {

/// Adaptive segmentation of the skin's colour (paper 4.2, "improved adaptive segmentation").
struct SegmentationOptions {
  int min_clusters = 2;             ///< fewest colour classes tried; 2..16
  int max_clusters = 8;             ///< most colour classes tried; the Davies-Bouldin index chooses; 2..16
  int max_iterations = 30;          ///< of K-means
  double lightness_weight = 0.5;    ///< of L against a and b, since shading changes L most; 0..1
  double significance_delta_e = 9;  ///< weighted colour difference from the healthy skin that a defect must reach
  double significance_sigma = 5;    ///< the same in robust standard deviations of the healthy skin
  double faint_share = 0.6;         ///< of that difference, enough where the rim is as sharp as a stain's; 1: nowhere
  double faintest_share = 0.45;     ///< the same where the whole rim is sharp, as a faint scar's; 1: nowhere
  double local_sigma = 3;           ///< the same in those of single points of the skin beside the defect

  Status Check() const;
};

/// Grouping of defect points into defects (paper 4.2, Figure 12 c).
struct ClusterOptions {
  double min_area_mm2 = 0.35;      ///< smaller patches (lenticels, noise) are no defects
  double bridge_mm = 2.5;          ///< gaps in the cloud up to this wide are bridged with the colours at their edges
  double merge_distance_mm = 0.3;  ///< patches closer than this are one defect
  int max_defects = 500;           ///< reported for one fruit at most, largest first

  Status Check() const;
};

/// RANSAC plane of a defect (paper 4.2 (1)).
struct PlaneOptions {
  int iterations = 8;       ///< of RANSAC; 1..10000
  double distance = 0.007;  ///< inlier distance as a share of the defect's diameter (its largest extent)
  double distance_mm = 0;   ///< inlier distance in mm, in place of that share; 0: the share; 0..10

  Status Check() const;
};

/// Contour of a defect (paper 4.2 (2), Figure 13 and Table 5).
struct ContourOptions {
  int control_points = 10;    ///< of the closed B-spline; 4..200
  int degree = 3;             ///< of the B-spline; 1..5
  int sampling_density = 80;  ///< samples a span between neighbouring knots; 1..1000
  double level = 0.5;         ///< of the colour transition from skin (0) to defect (1) at which the boundary lies

  Status Check() const;
};

/// Classes by shape, size and colour: by a model, or by rules with the thresholds below.
struct ClassOptions {
  /// Trained from labelled reports; none: the rules. In JSON "model" is "rules" or the content of a model file.
  std::optional<ClassModel> model;
  double decay_min_area_mm2 = 20.0;  ///< a compact defect larger than this is decay
  double elongated_min = 2.5;        ///< length / width from which a defect is a scar or a crack
  double crack_max_width_mm = 0.9;   ///< an elongated defect narrower than this, and dark, is a crack
  double decay_min_depth_mm = 0.15;  ///< a compact defect half as large and sunk deeper than this is decay
  /// An elongated, narrow defect sunk deeper than this is a crack, dark or not; one 8 times as long as wide, than half.
  double crack_min_depth_mm = 0.12;
  /// L of the defect minus L of the skin about it, from which it counts as dark; less by as much as the skin's L is
  /// less than 60.
  double crack_max_lightness = -12.0;

  Status Check() const;
};

struct DefectOptions {
  SegmentationOptions segmentation;
  ClusterOptions cluster;
  PlaneOptions plane;
  ContourOptions contour;
  ClassOptions classes;

  Status Check() const;
};

/// Reads the keys "segmentation", "cluster", "plane", "contour" and "class" of `reader`, each an object with the names
/// above. Errors as OptionReader::Finish; ranges are checked by DefectOptions::Check.
Status ReadDefectOptions(OptionReader& reader, DefectOptions& options);
Json ToJson(const DefectOptions& options);

}  // namespace drupe
