#include "defect_analysis/defects/measure_defect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "defect_analysis/defects/classify.h"
#include "defect_analysis/defects/depth.h"
#include "defect_analysis/defects/plane_fit.h"

namespace drupe {
namespace {

constexpr int kMaxReportedContour = 400;  // points of contour_mm
constexpr int kMostControlPoints = 160;
constexpr double kBoundaryOffset = 0.1;    // of the points' spacing: standard uncertainty of the boundary as a whole
constexpr double kSoftEdge = 0.12;         // of an edge's own width: where in it a grader would draw the line
constexpr double kDisputed = 0.7;          // of the area between two half-way lines
constexpr double kCrackWall = 0.03;        // mm: the shade of a crack's walls is as dark as the crack, and widens it
constexpr double kCompletion = 0.05;       // of the area, where a part of the outline was completed
constexpr double kSplineTolerance = 0.15;  // of the points' spacing: rms beyond which control points are doubled

// Area of skin inside a polygon of the chart: the triangles of a fan about its centroid, each with the area scale of
// its middle; signs make it right for polygons that are not star-shaped too.
double AreaOnSkin(const SkinChart& chart, const Polygon& polygon) {
  const Eigen::Vector2d centre = Centroid(polygon);
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - centre;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - centre;
    area += (a.x() * b.y() - a.y() * b.x()) / 2 * chart.AreaScale(centre + (a + b) / 3);
  }
  return area;
}

// Resampling with a Gauss kernel of variance s^2 moves the half-way level inwards by curvature * s^2 / 2 (motion by
// mean curvature), which takes pi s^2 off the area of any closed curve, since its curvature adds up to 2 pi. Given back
// by growing the polygon about its centroid.
Polygon UndoShrinkage(Polygon polygon, double blur) {
  const double area = SignedArea(polygon);
  const double growth = std::sqrt(1 + std::min(0.5, std::numbers::pi * blur * blur / area));
  const Eigen::Vector2d centre = Centroid(polygon);
  for (Eigen::Vector2d& p : polygon) p = centre + growth * (p - centre);
  return polygon;
}

// The paper's ten control points suit round spots; longer shapes get more until the spline follows their boundary.
Result<ClosedSpline> FitContour(const Polygon& polygon, const ContourOptions& options, double tolerance) {
  int count = options.control_points;
  Result<ClosedSpline> spline = ClosedSpline::Fit(polygon, count, options.degree);
  while (spline.ok() && spline->rms() > tolerance && 2 * count <= kMostControlPoints &&
         2 * count <= static_cast<int>(polygon.size()) / 2) {
    count *= 2;
    spline = ClosedSpline::Fit(polygon, count, options.degree);
  }
  return spline;
}

std::vector<Eigen::Vector3d> OnSkin(const SkinChart& chart, const Polygon& polygon) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(polygon.size());
  for (const Eigen::Vector2d& p : polygon) points.push_back(chart.PointFromFlat(p));
  return points;
}

// The cloud's points inside the boundary, through the cells under the field's nodes.
std::vector<std::uint32_t> PointsInside(const FruitCloud& fruit, const SkinMap& map, const TransitionField& field,
                                        const Polygon& polygon) {
  std::vector<std::int32_t> cells;
  const int stride = std::max(1, static_cast<int>(0.3 * map.CellSize() / field.step));
  for (int row = 0; row < field.height; row += stride) {
    for (int column = 0; column < field.width; column += stride) {
      const Eigen::Vector3d direction = field.chart.DirectionFromFlat(field.FlatOf(column, row));
      cells.push_back(map.map().CellOf(direction.cast<float>()));
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<std::uint32_t> inside;
  for (const std::int32_t cell : cells) {
    for (const std::uint32_t i : map.PointsOf(cell)) {
      if (i >= fruit.size()) continue;  // a bridged gap's
      if (Contains(polygon, field.chart.FlatFromDirection(fruit.offsets[i].cast<double>()))) inside.push_back(i);
    }
  }
  std::sort(inside.begin(), inside.end());
  return inside;
}

// Standard uncertainty of the area: the noise of the colours moves each independent piece of the boundary; the whole
// boundary may lie off by a tenth of the points' spacing, since that is how far the colours' own blur is known; and the
// curvature correction is trusted to a third. Where the local half-way line was not that of the whole, either may be
// right; where in a soft edge a defect ends is a matter of convention; and what is completed is guessed.
double AreaUncertainty(const Outline& outline, double perimeter) {
  const TransitionField& field = *outline.field;
  const Polygon& boundary = outline.polygon;
  double slope = 0;
  for (const Eigen::Vector2d& p : boundary) slope += field.SlopeAt(p) / static_cast<double>(boundary.size());
  const double piece =
      2 * std::sqrt(std::numbers::pi) * field.blur;  // length over which the kernel ties nodes together
  const double level_noise = field.noise * field.spacing / piece + 0.02;
  const double shift = level_noise / std::max(0.05, slope);
  const double random = perimeter * shift / std::sqrt(std::max(1.0, perimeter / piece));
  const double offset = kBoundaryOffset * field.spacing * perimeter;
  const double correction = std::numbers::pi * field.blur * field.blur / 3;
  const double shape = outline.completed ? kCompletion * std::abs(SignedArea(boundary)) : 0;
  // An edge that the kernel alone would make this steep has no width of its own.
  const double own_width = std::max(0.0, 1 / std::max(0.05, slope) - std::sqrt(2 * std::numbers::pi) * field.blur);
  const double soft = kSoftEdge * own_width * perimeter;
  return std::hypot(std::hypot(random, offset, correction), soft, std::hypot(kDisputed * outline.disputed_mm2, shape));
}

// Standard uncertainty of the perimeter: the boundary as a whole may lie off by as much as the area says, which a
// closed curve answers with 2 pi of that; a long one's ends are blurred away or drawn out by a width; and the spline,
// which follows the colours' noise a little, is trusted to half a percent.
double PerimeterUncertainty(const TransitionField& field, const Defect& defect) {
  const double offset = defect.area_uncertainty_mm2 / std::max(1e-9, defect.perimeter_mm);
  const double ends = 1 - std::min(1.0, defect.roundness);  // of a disc none
  return std::hypot(2 * std::numbers::pi * offset, ends * 4 * field.spacing, 0.005 * defect.perimeter_mm);
}

void MeasurePoints(const FruitCloud& fruit, const std::vector<std::uint32_t>& inside, const PlaneOptions& options,
                   std::uint64_t seed, Defect& defect) {
  std::vector<Eigen::Vector3d> points;
  for (const std::uint32_t i : inside) {
    points.push_back(fruit.surface.centre() + fruit.offsets[i].cast<double>());
    defect.mean_lab += fruit.lab[i].cast<double>() / static_cast<double>(inside.size());
  }
  defect.points = static_cast<int>(inside.size());
  const Result<DefectPlane> plane = FitDefectPlane(points, defect.normal, fruit.noise_mm, options, seed);
  // Too few points for a plane of their own: the skin's tangent plane.
  defect.plane =
      plane.ok() ? *plane : DefectPlane{.normal = defect.normal, .offset_mm = defect.normal.dot(defect.centre_mm)};
}

std::vector<Eigen::Vector3d> Thin(const std::vector<Eigen::Vector3d>& curve) {
  const std::size_t step = (curve.size() + kMaxReportedContour - 1) / kMaxReportedContour;
  std::vector<Eigen::Vector3d> thinned;
  for (std::size_t i = 0; i < curve.size(); i += step) thinned.push_back(curve[i]);
  return thinned;
}

}  // namespace

std::optional<Defect> MeasureDefect(const FruitCloud& fruit, const SkinMap& map, const Outline& outline,
                                    const DefectOptions& options, std::uint64_t seed) {
  const TransitionField& field = *outline.field;
  const Polygon& boundary = outline.polygon;
  const Polygon polygon = UndoShrinkage(boundary, field.blur);
  const Result<ClosedSpline> spline = FitContour(polygon, options.contour, kSplineTolerance * field.spacing);
  if (!spline.ok()) return std::nullopt;
  const std::vector<Eigen::Vector3d> curve = OnSkin(field.chart, spline->Sample(options.contour.sampling_density));
  const Eigen::Vector3d direction = field.chart.DirectionFromFlat(Centroid(polygon));
  Defect defect;
  defect.centre_mm = fruit.surface.PointAt(direction);
  defect.normal = fruit.surface.NormalAt(direction);
  defect.area_mm2 = AreaOnSkin(field.chart, polygon);
  defect.perimeter_mm = ClosedLength(curve);
  defect.area_uncertainty_mm2 = AreaUncertainty(outline, defect.perimeter_mm);
  defect.completed = outline.completed;
  MeasurePoints(fruit, PointsInside(fruit, map, field, polygon), options.plane, seed, defect);
  defect.planar_area_mm2 = HeronArea(curve, defect.plane.normal);
  defect.roundness = 4 * std::numbers::pi * defect.area_mm2 / (defect.perimeter_mm * defect.perimeter_mm);
  defect.contour_mm = Thin(curve);
  const DefectDepth depth = MeasureDepth(fruit, map, field.chart, polygon);
  defect.depth_mm = depth.mm;
  defect.depth_uncertainty_mm = depth.uncertainty_mm;
  defect.lab_change = field.defect_lab - field.healthy_lab;
  defect.diameter_mm = 2 * std::sqrt(defect.area_mm2 / std::numbers::pi);
  defect.perimeter_uncertainty_mm = PerimeterUncertainty(field, defect);
  DefectShape shape = ShapeOf(polygon, defect.area_mm2, defect.lab_change[0]);
  shape.skin_lightness = field.healthy_lab[0];
  shape.depth_mm = depth.mm;
  shape.depth_uncertainty_mm = depth.uncertainty_mm;
  defect.length_mm = shape.length_mm;
  defect.width_mm = shape.width_mm;
  const std::optional<ClassModel>& model = options.classes.model;
  const Classification found = model ? model->Classify(FeaturesOf(defect)) : Classify(shape, options.classes);
  defect.defect_class = found.defect_class;
  defect.confidence = found.confidence;
  if (defect.defect_class == DefectClass::kCrack) {
    defect.area_uncertainty_mm2 = std::hypot(defect.area_uncertainty_mm2, kCrackWall * defect.perimeter_mm);
  }
  defect.diameter_uncertainty_mm = defect.area_uncertainty_mm2 / (std::numbers::pi * defect.diameter_mm / 2);
  return defect;
}

bool IsEstablished(const Defect& defect) {
  constexpr double kLong = 2.5;              // length over width
  constexpr double kMostUncertain = 1. / 7;  // of the area
  if (defect.completed || defect.length_mm > kLong * defect.width_mm) return true;
  return defect.area_uncertainty_mm2 <= kMostUncertain * defect.area_mm2;
}

}  // namespace drupe
