#include "service/job_page.h"

#include <utility>

namespace drupe {

Result<Json> JobPageJson(const Request& request, JobStore& jobs, const std::string& kind, const std::string& name,
                         const std::function<Result<Json>(const Job&)>& describe) {
  JobFilter filter{.kind = kind};
  if (const auto state = request.Query("status")) {
    DRUPE_ASSIGN_OR_RETURN(filter.state, ParseJobState(*state));
  }
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t limit, request.QueryInt("limit", 50, 1, 200));
  const std::string cursor = request.Query("cursor").value_or("");
  DRUPE_ASSIGN_OR_RETURN(const JobPage page, jobs.List(filter, static_cast<int>(limit), cursor));
  Json list = Json::array();
  for (const Job& job : page.jobs) {
    DRUPE_ASSIGN_OR_RETURN(Json json, describe(job));
    list.push_back(std::move(json));
  }
  return Json{{name, std::move(list)}, {"next_cursor", page.next_cursor.empty() ? Json() : Json(page.next_cursor)}};
}

}  // namespace drupe
