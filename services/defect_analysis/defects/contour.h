#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"
#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// A closed polygon on a flat map, counter-clockwise in (column, row); the first point is not repeated.
using Polygon = std::vector<Eigen::Vector2d>;

/// The outer boundaries of the defects in a field: the lines where it crosses `level`, interpolated between the nodes,
/// around each connected region that overlaps the patch. Holes are filled. Coordinates in mm on the field's chart.
/// Largest region first; regions of less than `min_area_mm2` on the map are left out.
std::vector<Polygon> TraceBoundaries(const TransitionField& field, double level, double min_area_mm2);

/// Signed area, positive for counter-clockwise.
double SignedArea(const Polygon& polygon);
Eigen::Vector2d Centroid(const Polygon& polygon);
bool Contains(const Polygon& polygon, const Eigen::Vector2d& p);
/// Area that two polygons have in common, from samples about a hundredth of the smaller one's extent apart.
double CommonArea(const Polygon& a, const Polygon& b);

/// A closed uniform B-spline in any dimension; control point i acts on spans i - degree .. i.
class ClosedSpline {
 public:
  /// Least-squares fit to a closed polygon, parametrised by its length. `control_points` is at least degree + 1; it is
  /// lowered where the polygon has fewer points. Errors: 422 `degenerate_contour`.
  static Result<ClosedSpline> Fit(const Polygon& polygon, int control_points, int degree);

  /// The curve at `samples_per_span` points in each of its spans.
  Polygon Sample(int samples_per_span) const;
  int ControlPointCount() const { return static_cast<int>(control_.rows()); }
  /// Root mean square distance of the fitted polygon from the curve at the same parameter.
  double rms() const { return rms_; }

 private:
  Eigen::MatrixX2d control_;
  int degree_ = 3;
  double rms_ = 0;
};

/// Length of a closed line in space.
double ClosedLength(const std::vector<Eigen::Vector3d>& points);

/// Area of a nearly plane closed line: Heron's formula over the triangles between its mean and its edges (paper 4.2
/// (2)), each with the sign of its turn about `normal`.
double HeronArea(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& normal);

}  // namespace drupe
