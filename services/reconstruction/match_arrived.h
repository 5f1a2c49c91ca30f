#pragma once

#include <span>
#include <string>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"

namespace drupe {

/// Whether it is time to match a picture that has arrived with those that came before: `set` has the pictures that have
/// come so far, in the order of the set, and `arrived` is one of them (not one that has been replaced).
///
/// Which features stand still can be told once the first kComparedForStatic pictures are there. So that pictures which
/// come in another order are not matched in vain again and again, it is too early for one inside that front. It never
/// is time without a calibration, since the camera that would be guessed follows from all pictures.
bool IsTimeToMatch(const SourceImage& arrived, const ReconstructionInput& set);

/// Matches a picture for which IsTimeToMatch() with pictures that came before: those next to it in the order of the set
/// (clusters.sequence_window of them) and those named in `alike`. The reconstruction then takes these pairs from the
/// cache, which `set` has. The first call also matches the first pictures, for which it was too early when they came.
/// Gives the number of pairs of `arrived`, 0 for a picture for which it is not time. Errors: those of reading and
/// RunFeatures; `cancelled`.
Result<int> MatchArrived(const SourceImage& arrived, std::span<const std::string> alike, const ReconstructionInput& set,
                         const ReconstructionOptions& options, const RunContext& context);

}  // namespace drupe
