#pragma once

#include "base/limits.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/reconstruct_request.h"
#include "store/object_store.h"

namespace drupe {

/// The request as the pipeline takes it: pictures are read from `objects` when they are needed, and what is known of
/// them is in `cache`, which may be null. Both must outlive the result.
ReconstructionInput MakeInput(const ReconstructRequest& request, ObjectStore& objects, DerivedCache* cache,
                              const Limits& limits);

}  // namespace drupe
