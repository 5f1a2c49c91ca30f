#include "reconstruction/reconstruction_status.h"

#include <utility>

#include "base/version.h"
#include "service/artifacts.h"
#include "service/job_json.h"

namespace drupe {

namespace {

Json LinksJson(const Job& job, const LinkBase& base) {
  const std::string self = base.self + "/reconstructions/" + job.id;
  Json links = {{"self", self}, {"events", self + "/events"}};
  if (job.state == JobState::kSucceeded) links["artifacts"] = self + "/artifacts";
  if (job.payload.value("analyze", false)) links["report"] = base.analysis + "/reports/" + job.id;
  return links;
}

/// Those refused at intake and those that the pipeline left out.
Json RefusedJson(const Job& job) {
  Json refused = job.payload.value("refused_images", Json::array());
  if (job.result) {
    for (const Json& entry : job.result->value("refused_images", Json::array())) refused.push_back(entry);
  }
  return refused;
}

/// What the report needs to say where its numbers come from.
Json ProvenanceJson(const Job& job) {
  Json names = Json::array(), digests = Json::array();
  for (const Json& image : job.payload.value("images", Json::array())) {
    names.push_back(image.value("name", ""));
    digests.push_back(image.value("sha256", ""));
  }
  return {{"image_set", job.payload.value("image_set", "")},
          {"image_names", std::move(names)},
          {"image_sha256", std::move(digests)},
          {"calibration", job.payload.value("calibration", Json())},
          {"options", job.result ? job.result->value("options", Json()) : job.payload.value("options", Json())},
          {"build", kVersion}};
}

}  // namespace

Json SummaryJson(const Job& job, const LinkBase& base) {
  Json json = JobJson(job);
  json["attempt"] = job.attempt;
  json["image_set"] = job.payload.value("image_set", "");
  json["images"] = job.payload.value("images", Json::array()).size();
  json["refused_images"] = RefusedJson(job);
  json["links"] = LinksJson(job, base);
  return json;
}

Json StatusJson(const Job& job, const LinkBase& base) {
  Json status = SummaryJson(job, base);
  const Json result = job.result.value_or(Json::object());
  status["quality"] = result.value("quality", Json());
  status["timings"] = result.value("timings", Json());
  status["artifacts"] = ToJson(ParseArtifacts(result.value("artifacts", Json::array())));
  status["provenance"] = ProvenanceJson(job);
  return status;
}

}  // namespace drupe
