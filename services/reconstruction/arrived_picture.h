#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"
#include "scene/features.h"

namespace drupe {

/// The place of a picture in the order of its set, by name and digest; images.size() when it is not in there, because
/// another has taken its name.
std::size_t PlaceOf(const SourceImage& arrived, std::span<const SourceImage> images);

/// Describes a picture as soon as its set allows it, for the similarity that the reconstruction will ask for, and tells
/// which pictures that came before look most like it: the pairs that are likely to be matched.
///
/// `set` has the pictures that have come so far, in the order of the set, and a cache; `arrived` is one of them
/// (nothing is done for one that has been replaced), with its `features`. The words are the vocabulary's that the
/// options name. Otherwise they are trained by the first call for a picture with which the TrainingFront of `set` is
/// complete, or for a later one; that call also describes the front's pictures. What was trained on a front that a
/// later picture changes is of no use any more, and does no harm: it stands in the cache under the digests of that
/// front. So that pictures which come in another order do not train words again and again, none are for a picture
/// inside the front.
///
/// Gives names, the most similar first, at most five; none as long as there are no words. Errors: those of reading,
/// RunFeatures, TrainWords and the vocabulary; `cancelled`.
Result<std::vector<std::string>> DescribeArrived(const SourceImage& arrived, const Features& features,
                                                 const ReconstructionInput& set, const ReconstructionOptions& options,
                                                 const RunContext& context);

}  // namespace drupe
