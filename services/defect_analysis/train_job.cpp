#include "defect_analysis/train_job.h"

#include <utility>

#include "defect_analysis/model_request.h"
#include "defect_analysis/models/train_model.h"

namespace drupe {
namespace {

Result<LabelledColours> ReadPoints(const ModelRequest& request, ObjectStore& objects, const Limits& limits,
                                   const RunContext& context) {
  LabelledColours points;
  for (const std::string& sha256 : request.cloud_sha256) {
    DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, objects.Get(sha256));
    DRUPE_ASSIGN_OR_RETURN(const LabelledColours cloud, ReadLabelledPly(bytes));
    points.Append(cloud);
  }
  for (const MaskedPicture& picture : request.pictures) {
    DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    DRUPE_ASSIGN_OR_RETURN(const std::string image, objects.Get(picture.image_sha256));
    DRUPE_ASSIGN_OR_RETURN(const std::string mask, objects.Get(picture.mask_sha256));
    DRUPE_ASSIGN_OR_RETURN(const LabelledColours pixels, ReadMaskedImage(image, mask, limits));
    points.Append(pixels);
  }
  return points;
}

}  // namespace

std::vector<StageShare> TrainStages() {
  return {{"points", 0.3}, {"training", 0.7}};
}

Result<Json> TrainJob::operator()(const Job& job, const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const ModelRequest request, ParseModelPayload(job.payload));
  context.Report("points", 0);
  DRUPE_ASSIGN_OR_RETURN(LabelledColours points, ReadPoints(request, objects_, limits_, context));
  DRUPE_ASSIGN_OR_RETURN(const ColourModel model, TrainColourModel(std::move(points), {}, request.options, context));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo file, objects_.Put(DumpJson(ToJson(model)) + "\n"));
  return Json{{"model_sha256", file.sha256},
              {"support_vectors", model.vectors.size()},
              {"confusion", {{"training", ToJson(model.training)}, {"test", ToJson(model.test)}}}};
}

}  // namespace drupe
