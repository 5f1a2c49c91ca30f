#pragma once

#include <optional>

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/separate.h"
#include "scene/fruit_cloud.h"
#include "scene/report.h"

namespace drupe {

/// Measures one outline: contour as a B-spline on the curved skin, perimeter, area on the skin and in the
/// fitted plane, roundness, plane, colour, class, uncertainty. Nothing when the contour is degenerate.
std::optional<Defect> MeasureDefect(const FruitCloud& fruit, const SkinMap& map, const Outline& outline,
                                    const DefectOptions& options, std::uint64_t seed);

}  // namespace drupe
