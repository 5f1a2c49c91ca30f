#pragma once

#include <cstddef>
#include <functional>

#include "base/run_context.h"

namespace drupe {

/// Calls `body(i)` once for every i in [0, count) on context.ThreadCount() threads; i are handed out one by one in
/// ascending order, so unequal items balance. Stops handing out when the context is cancelled. The caller's thread
/// takes part. `body` must write only to places that belong to i: that is what keeps results independent of the
/// number of threads. An exception in `body` ends the work and comes back as an `internal` Status.
Status ParallelFor(const RunContext& context, std::size_t count, const std::function<void(std::size_t)>& body);

/// As ParallelFor, with the number of the calling worker, 0 <= worker < context.ThreadCount(), for scratch memory.
Status ParallelForWorkers(const RunContext& context, std::size_t count,
                          const std::function<void(std::size_t index, int worker)>& body);

}  // namespace drupe
