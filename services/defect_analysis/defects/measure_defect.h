#pragma once

#include <optional>

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/transition_field.h"
#include "scene/fruit_cloud.h"
#include "scene/report.h"

namespace drupe {

/// Measures one boundary of a field: contour as a B-spline on the curved skin, perimeter, area on the skin and in the
/// fitted plane, roundness, plane, colour, class, uncertainty. Nothing when the contour is degenerate.
std::optional<Defect> MeasureDefect(const FruitCloud& fruit, const SkinMap& map, const TransitionField& field,
                                    const Polygon& boundary, const DefectOptions& options, std::uint64_t seed);

}  // namespace drupe
