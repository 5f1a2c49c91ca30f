#include "capture/scan_job.h"

namespace drupe {

Result<Json> ScanJob::operator()(const Job& job, const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const ScanRequest request, ParseScanRequest(job.payload));
  ScanRun run(*tools_, job.id, request, context);
  DRUPE_RETURN_IF_ERROR(run.Run());
  return Json{{"frames", request.views}};
}

}  // namespace drupe
