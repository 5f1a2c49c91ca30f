#pragma once

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/skin_chart.h"
#include "defect_analysis/defects/skin_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// How deep a defect lies below the healthy skin about it, mm; negative when it stands out.
struct DefectDepth {
  double mm = 0;
  double uncertainty_mm = 0;  ///< standard uncertainty; 0 with mm = 0 when the skin about it is not seen
};

/// Depth against the skin about the defect, not against the fruit's closed surface, which follows a large hollow: a
/// quadratic of the place on the chart is fitted, re-weighted against outliers, to the heights of the points 0.4 to 2.2
/// mm outside the outline (on Lambert's map the height of a sphere is exactly quadratic), and the median height of the
/// points well inside is compared with it. The uncertainty is how far the means of twelve sectors about the defect
/// scatter about the fit, which holds the errors that neighbouring points share, and the points' own noise.
DefectDepth MeasureDepth(const FruitCloud& fruit, const SkinMap& map, const SkinChart& chart, const Polygon& outline);

}  // namespace drupe
