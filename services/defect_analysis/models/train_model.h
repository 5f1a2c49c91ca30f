#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/models/labelled_colours.h"
#include "defect_analysis/models/train_options.h"
#include "scene/colour_model.h"

namespace drupe {

/// Trains a background model (paper 4.1) and fills its confusion tables. `test`: points of other fruit; empty: a share
/// of `training` is kept for it. Both tables are over an even sample of all points, not over those that the training
/// chose. Progress stage: "training". Errors: 400 `invalid_option`, 422 `one_class`, `training_failed`, `cancelled`.
Result<ColourModel> TrainColourModel(LabelledColours training, LabelledColours test, const TrainOptions& options,
                                     const RunContext& context);

/// What a model takes an even sample of at most `max_points` of the colours for.
ConfusionTable JudgeColourModel(const ColourModel& model, const LabelledColours& colours, std::size_t max_points);

}  // namespace drupe
