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

/// Whether a measured defect is known well enough to be one. Where skin is seen badly, as between fruits that stand
/// close together, points of a wrong colour or slant lie scattered and give a ragged outline: one that is not long
/// (threads are known less exactly by nature) nor partly hidden, and whose area has a standard uncertainty above a
/// seventh, is none.
bool IsEstablished(const Defect& defect);

}  // namespace drupe
