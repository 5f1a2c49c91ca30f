#include "defect_analysis/defects/separate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "defect_analysis/defects/classify.h"
#include "defect_analysis/defects/colour_layers.h"
#include "defect_analysis/defects/local_halfway.h"
#include "defect_analysis/defects/outline_shape.h"
#include "defect_analysis/defects/round_outline.h"
#include "defect_analysis/defects/significance.h"

namespace drupe {
namespace {

constexpr double kOwnOutline = 0.35;     // of a layer's outline that must border on skin, not on the other layer
constexpr float kShared = 0.25f;         // share of the other layer from which an outline's point borders on it
constexpr double kRoundRms = 0.08;       // of a roundish outline about its smooth form, relative to its radius
constexpr double kMostCompletion = 1.7;  // completed area over what is seen
constexpr double kLongFrom = 2.5;        // length over width of a layer that is an object by being long
constexpr double kContrastShare = 0.25;  // of the significance threshold, between two layers with forms of their own
constexpr double kRepairDoubt = 0.3;     // of the area that a repair takes or gives
constexpr double kWidestGap = 1.2;       // mm between two pieces of one crack or scar
constexpr double kAligned = 0.9;         // cosine between a long piece's axis and the way to the next piece
constexpr double kAsWide = 0.6;          // width of the thinner of two pieces of one long defect, over the other's
constexpr double kApartAlong = 0.5;      // of the shorter piece's length: from middle to middle of such pieces
constexpr double kJunction = 0.15;       // mm of an outline beside its junction with another one that both bend
constexpr double kInOther = 0.5;    // of a defect's area inside one of another colour that makes it a part of that one
constexpr double kSmallPart = 0.3;  // of min_area: pieces of a layer that another one cuts

// Raises the level to 1 within `half_width` of the line between two points.
void DrawBridge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double half_width, TransitionField& field) {
  const Eigen::Vector2d way = to - from;
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector2d p = field.FlatOf(column, row) - from;
      const double along = std::clamp(p.dot(way) / std::max(1e-12, way.squaredNorm()), 0.0, 1.0);
      const double inside = half_width - (p - along * way).norm();
      const std::size_t node = static_cast<std::size_t>(row) * field.width + column;
      const auto level = static_cast<float>(std::clamp(0.5 + inside / (2 * field.blur), 0.0, 1.0));
      field.level[node] = std::max(field.level[node], level);
      field.full_level[node] = std::max(field.full_level[node], level);
    }
  }
}

// The nearest points of two outlines, one of each.
std::pair<Eigen::Vector2d, Eigen::Vector2d> NearestPoints(const Polygon& a, const Polygon& b) {
  std::pair<Eigen::Vector2d, Eigen::Vector2d> nearest = {a[0], b[0]};
  for (const Eigen::Vector2d& p : a) {
    for (const Eigen::Vector2d& q : b) {
      if ((p - q).squaredNorm() < (nearest.first - nearest.second).squaredNorm()) nearest = {p, q};
    }
  }
  return nearest;
}

// Draws a bridge of the defect's own level between two pieces of a long defect that a gap or a highlight cuts, when
// they lie in one line. Whether any was drawn.
bool BridgePieces(const std::vector<Polygon>& pieces, TransitionField& field) {
  bool drawn = false;
  for (std::size_t a = 0; a < pieces.size(); ++a) {
    const DefectShape shape = ShapeOf(pieces[a], SignedArea(pieces[a]), 0);
    if (shape.elongation < kLongFrom) continue;
    for (std::size_t b = 0; b < pieces.size(); ++b) {
      if (a == b || SignedArea(pieces[b]) > SignedArea(pieces[a])) continue;
      const auto [from, to] = NearestPoints(pieces[a], pieces[b]);
      const Eigen::Vector2d way = Centroid(pieces[b]) - Centroid(pieces[a]);
      if ((from - to).norm() > kWidestGap || std::abs(way.normalized().dot(shape.axis)) < kAligned) continue;
      DrawBridge(from, to, 0.5 * std::min(shape.width_mm, ShapeOf(pieces[b], SignedArea(pieces[b]), 0).width_mm),
                 field);
      drawn = true;
    }
  }
  return drawn;
}

struct TracedOutline {
  Polygon polygon;
  double disputed = 0;  // mm2 between the half-way line of the whole and the local one
};

// The half-way lines of a field, each about one defect; the field is completed where a long one is cut.
std::vector<TracedOutline> TraceWhole(TransitionField& field, double level, double min_area) {
  std::vector<Polygon> pieces = TraceBoundaries(field, level, kSmallPart * min_area);
  if (pieces.size() > 1 && BridgePieces(pieces, field)) pieces = TraceBoundaries(field, level, kSmallPart * min_area);
  std::vector<TracedOutline> outlines;
  for (const Polygon& piece : pieces) {
    Polygon moved = FollowLocalHalfway(field, piece, level);
    const double disputed = std::abs(SignedArea(moved) - SignedArea(piece));
    outlines.push_back({std::move(moved), disputed});
  }
  return outlines;
}

double OtherAt(const ColourLayer& layer, const Eigen::Vector2d& flat) {
  const TransitionField& field = layer.field;
  const Eigen::Vector2d place = (flat - field.origin) / field.step;
  const int column = std::clamp(static_cast<int>(std::lround(place.x())), 0, field.width - 1);
  const int row = std::clamp(static_cast<int>(std::lround(place.y())), 0, field.height - 1);
  return layer.other[static_cast<std::size_t>(row) * field.width + column];
}

// A layer's outlines, and what of them borders on skin.
struct LayerOutlines {
  std::vector<Polygon> polygons;
  double disputed = 0;
  std::vector<Eigen::Vector2d> own;  // points that border on skin, clear of junctions
  std::size_t points = 0, bordering_skin = 0;
  double area = 0;
  std::optional<CompletedOutline> round;

  double OwnShare() const {
    return static_cast<double>(bordering_skin) / static_cast<double>(std::max<std::size_t>(1, points));
  }
  bool IsRound() const {
    return round && round->rms < kRoundRms && SignedArea(round->polygon) < kMostCompletion * area &&
           SignedArea(round->polygon) > 0.9 * area;
  }
  bool IsLong() const { return !polygons.empty() && ShapeOf(polygons[0], area, 0).elongation > kLongFrom; }
};

// The points of an outline that border on skin, those beside a junction with the other layer's outline left out.
void AddOwnPoints(const ColourLayer& layer, const Polygon& polygon, LayerOutlines& traced) {
  std::vector<const Eigen::Vector2d*> shared;
  for (const Eigen::Vector2d& p : polygon) {
    if (OtherAt(layer, p) >= kShared) shared.push_back(&p);
  }
  traced.points += polygon.size();
  traced.bordering_skin += polygon.size() - shared.size();
  for (const Eigen::Vector2d& p : polygon) {
    const bool clear = std::all_of(shared.begin(), shared.end(),
                                   [&](const Eigen::Vector2d* q) { return (p - *q).norm() > kJunction; });
    if (clear) traced.own.push_back(p);
  }
}

LayerOutlines Gather(const ColourLayer& layer, const std::vector<TracedOutline>& outlines, double min_area) {
  LayerOutlines traced;
  for (const TracedOutline& outline : outlines) {
    traced.area += SignedArea(outline.polygon);
    traced.disputed += outline.disputed;
    AddOwnPoints(layer, outline.polygon, traced);
    traced.polygons.push_back(outline.polygon);
  }
  if (traced.area < min_area) traced.polygons.clear();
  traced.round = CompleteOutline(traced.own);
  return traced;
}

// Whether two layers are the parts of one long defect whose hue changes on its way, as where it leaves a shadow: as
// wide, one behind the other in one line.
bool ContinueEachOther(const LayerOutlines& a, const LayerOutlines& b) {
  if (!a.IsLong() || !b.IsLong()) return false;
  const Polygon &first = a.polygons[0], &second = b.polygons[0];
  const DefectShape one = ShapeOf(first, SignedArea(first), 0), other = ShapeOf(second, SignedArea(second), 0);
  const Eigen::Vector2d way = Centroid(second) - Centroid(first);
  if (way.norm() < kApartAlong * std::min(one.length_mm, other.length_mm)) return false;
  if (std::min(one.width_mm, other.width_mm) < kAsWide * std::max(one.width_mm, other.width_mm)) return false;
  const auto [from, to] = NearestPoints(first, second);
  return (from - to).norm() <= kWidestGap && std::abs(way.normalized().dot(one.axis)) >= kAligned &&
         std::abs(way.normalized().dot(other.axis)) >= kAligned;
}

// Both draw an outline of their own, and at least the smaller one has a form of its own, so that it is no lighter or
// darker part of the other.
bool AreTwoDefects(const LayerOutlines& a, const LayerOutlines& b) {
  if (a.polygons.empty() || b.polygons.empty()) return false;
  if (a.OwnShare() < kOwnOutline || b.OwnShare() < kOwnOutline || ContinueEachOther(a, b)) return false;
  const LayerOutlines& smaller = a.area < b.area ? a : b;
  return smaller.IsRound() || smaller.IsLong() || (a.IsRound() && b.IsRound());
}

// Whether one of two touching defects would stand out alone. One that is nearly as light as gloss is told by its edge,
// and a faint one beside a round one by its form: light and shade there are not long and of another hue, as a part of a
// scar may be.
bool LayerStandsOut(const ColourLayer& layer, const LayerOutlines& traced, const LayerOutlines& other, double threshold,
                    const DefectOptions& options) {
  const SegmentationOptions& segmentation = options.segmentation;
  if (ContrastBeyondLight(layer.field, segmentation.lightness_weight) >= threshold) return true;
  if (StandsOut(layer.field, threshold, options)) return true;
  // The second look's threshold is a faint one's already.
  const double faint = segmentation.faint_share * std::max(threshold, segmentation.significance_delta_e);
  return traced.IsLong() && other.IsRound() && HasColourOfItsOwn(layer.field, faint, options);
}

// Whether a defect of one colour lies mostly within one of the other: then it is a lighter or darker part of it. A
// defect that touches another one lies beside it, even when what is covered of it was completed.
bool LieWithinOneAnother(const std::vector<Outline>& outlines) {
  for (std::size_t a = 0; a < outlines.size(); ++a) {
    for (std::size_t b = a + 1; b < outlines.size(); ++b) {
      if (outlines[a].field == outlines[b].field) continue;
      const Polygon &first = outlines[a].polygon, &second = outlines[b].polygon;
      if (CommonArea(first, second) > kInOther * std::min(SignedArea(first), SignedArea(second))) return true;
    }
  }
  return false;
}

Outline OutlineOf(const Polygon& polygon, const TransitionField* field, double disputed, bool completed) {
  Outline outline{polygon, field, disputed, completed};
  const double area = SignedArea(polygon);
  if (ShapeOf(polygon, area, 0).elongation > kLongFrom) return outline;
  if (auto repaired = RepairRoundOutline(polygon)) {
    outline.disputed_mm2 += kRepairDoubt * std::abs(SignedArea(*repaired) - area);
    outline.polygon = std::move(*repaired);
  }
  return outline;
}

void Add(const LayerOutlines& traced, const TransitionField* field, double min_area, Outlines& result) {
  const bool covered = traced.OwnShare() < 0.99;
  if (covered && traced.IsRound() && !traced.IsLong()) {
    result.outlines.push_back({traced.round->polygon, field, traced.disputed, true});
    return;
  }
  for (const Polygon& polygon : traced.polygons) {
    if (SignedArea(polygon) < min_area) continue;
    result.outlines.push_back(OutlineOf(polygon, field, traced.disputed, false));
  }
}

}  // namespace

Outlines SeparateLayers(const TransitionField& field, double threshold, const DefectOptions& options) {
  const double level = options.contour.level, min_area = options.cluster.min_area_mm2;
  Outlines result;
  std::vector<ColourLayer> layers =
      SeparateColours(field, level, min_area, kContrastShare * threshold, options.segmentation.lightness_weight);
  if (layers.size() != 2) return result;
  std::vector<TracedOutline> pieces = TraceWhole(layers[1].field, level, min_area);
  const LayerOutlines first = Gather(layers[0], TraceWhole(layers[0].field, level, min_area), min_area);
  LayerOutlines second = Gather(layers[1], pieces, min_area);
  if (pieces.size() > 1 && !AreTwoDefects(first, second)) {
    pieces.resize(1);  // the largest; the others may be highlights on the first
    second = Gather(layers[1], pieces, min_area);
  }
  if (!AreTwoDefects(first, second) || !LayerStandsOut(layers[0], first, second, threshold, options) ||
      !LayerStandsOut(layers[1], second, first, threshold, options)) {
    return result;
  }
  result.fields.reserve(layers.size());  // the outlines point into it
  for (ColourLayer& layer : layers) result.fields.push_back(std::move(layer.field));
  Add(first, &result.fields[0], min_area, result);
  Add(second, &result.fields[1], min_area, result);
  return LieWithinOneAnother(result.outlines) ? Outlines{} : std::move(result);
}

Outlines SeparateDefects(TransitionField field, double threshold, const DefectOptions& options) {
  Outlines result = SeparateLayers(field, threshold, options);
  if (!result.outlines.empty()) return result;
  const double level = options.contour.level, min_area = options.cluster.min_area_mm2;
  result.fields.push_back(std::move(field));
  for (const TracedOutline& outline : TraceWhole(result.fields[0], level, min_area)) {
    if (SignedArea(outline.polygon) < min_area) continue;
    const std::vector<Polygon> parts = SplitAtNeck(outline.polygon, min_area);
    const bool cut = parts.size() > 1;
    for (const Polygon& part : parts) {
      result.outlines.push_back(OutlineOf(part, &result.fields[0], outline.disputed, cut));
    }
  }
  return result;
}

}  // namespace drupe
