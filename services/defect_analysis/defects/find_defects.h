#pragma once

#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/defects/defect_options.h"
#include "scene/fruit_cloud.h"
#include "scene/report.h"

namespace drupe {

/// All defects of one fruit, largest first, numbered from 1 (paper 4.2 and 4.3): small gaps bridged, healthy colour
/// removed, colours segmented, significant cells grouped into patches, each patch that stands out from the skin beside
/// it traced at the half-way colour and measured; then the same at a lower contrast for roundish spots with a sharp
/// edge. Lengths in mm as in FruitCloud. An intact fruit gives none. Errors: `cancelled`, 422 `too_few_directions`.
Result<std::vector<Defect>> FindDefects(const FruitCloud& fruit, const DefectOptions& options,
                                        const RunContext& context);

}  // namespace drupe
