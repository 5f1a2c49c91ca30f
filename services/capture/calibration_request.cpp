#include "capture/calibration_request.h"

#include <algorithm>
#include <optional>
#include <set>

#include "base/ids.h"
#include "http/buffered_form.h"
#include "image/decode.h"

namespace drupe {
namespace {

constexpr int kMinPictures = 3;
constexpr int kMaxPictures = 100;
constexpr std::size_t kMaxJsonBytes = 4096;

/// Collects the parts of a form.
class CalibrationForm : public BufferedForm {
 public:
  CalibrationForm(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Result<CalibrationRequest> Finish() {
    if (!Has("pattern")) return InvalidArgument("missing_part", "the part pattern is missing", "pattern");
    if (request_.pictures.size() < kMinPictures) return TooFewPictures();
    std::sort(request_.pictures.begin(), request_.pictures.end(),
              [](const StoredPicture& a, const StoredPicture& b) { return a.name < b.name; });
    return std::move(request_);
  }

 private:
  Result<std::size_t> LimitOf(const PartHead& head) override {
    if (head.name == "images") return LimitOfPicture(head.filename);
    if (head.name == "pattern" || head.name == "camera") return OnlyOnce(head, kMaxJsonBytes);
    return UnknownPart(head, "images, pattern, camera");
  }

  Result<std::size_t> LimitOfPicture(const std::string& name) {
    DRUPE_RETURN_IF_ERROR(CheckImageName(name));
    if (!picture_names_.insert(name).second) {
      return InvalidArgument("duplicate_name", "two images are called " + name, "images");
    }
    if (picture_names_.size() <= kMaxPictures) return limits_.max_image_bytes;
    return Status(StatusKind::kTooLarge, "too_many_images",
                  "a calibration takes at most " + std::to_string(kMaxPictures) + " images", "images");
  }

  Status TakePart(const PartHead& head, std::string bytes) override {
    if (head.name == "images") return TakePicture(head.filename, bytes);
    DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(bytes, {.max_bytes = kMaxJsonBytes}));
    if (head.name == "camera") {
      DRUPE_ASSIGN_OR_RETURN(request_.camera, ParseCameraBinding(json));
    } else {
      DRUPE_ASSIGN_OR_RETURN(request_.pattern, ParseCheckerboard(json));
    }
    return Status::Ok();
  }

  Status TakePicture(const std::string& name, const std::string& bytes) {
    const Result<ImageInfo> info = VerifyImage(bytes, limits_);
    if (!info.ok()) {
      if (!refusal_) refusal_ = info.status();
      request_.refused.push_back({name, info.status().code(), info.status().message()});
      return Status::Ok();
    }
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes));
    request_.pictures.push_back({name, object.sha256});
    return Status::Ok();
  }

  Status TooFewPictures() const {
    const std::string counts = "at least 3 images are needed, " + std::to_string(picture_names_.size()) + " came";
    if (!refusal_) return InvalidArgument("too_few_images", counts, "images");
    const RefusedPicture& first = request_.refused.front();
    return {refusal_->kind(), refusal_->code(),
            counts + " and " + std::to_string(request_.refused.size()) + " cannot be used; " + first.name + ": " +
                first.message,
            "images"};
  }

  ObjectStore& objects_;
  const Limits& limits_;
  CalibrationRequest request_;
  std::set<std::string> picture_names_;
  std::optional<Status> refusal_;  ///< the first one
};

}  // namespace

Json ToJson(const CalibrationRequest& request) {
  Json pictures = Json::array(), refused = Json::array();
  for (const StoredPicture& picture : request.pictures) {
    pictures.push_back({{"name", picture.name}, {"sha256", picture.sha256}});
  }
  for (const RefusedPicture& picture : request.refused) {
    refused.push_back({{"name", picture.name}, {"code", picture.code}, {"message", picture.message}});
  }
  return {{"pattern", ToJson(request.pattern)},
          {"camera", ToJson(request.camera)},
          {"images", std::move(pictures)},
          {"refused_images", std::move(refused)}};
}

Result<CalibrationRequest> ParseCalibrationPayload(const Json& payload) {
  CalibrationRequest request;
  DRUPE_ASSIGN_OR_RETURN(request.pattern, ParseCheckerboard(payload.value("pattern", Json())));
  DRUPE_ASSIGN_OR_RETURN(request.camera, ParseCameraBinding(payload.value("camera", Json::object())));
  try {
    for (const Json& picture : payload.at("images")) {
      request.pictures.push_back({picture.at("name").get<std::string>(), picture.at("sha256").get<std::string>()});
    }
    for (const Json& picture : payload.at("refused_images")) {
      request.refused.push_back({picture.at("name").get<std::string>(), picture.at("code").get<std::string>(),
                                 picture.at("message").get<std::string>()});
    }
  } catch (const Json::exception& error) {
    return Internal("bad_payload", error.what());
  }
  return request;
}

Result<CalibrationRequest> ReadCalibrationForm(const Request& http, ObjectStore& objects, const Limits& limits) {
  CalibrationForm form(objects, limits);
  DRUPE_RETURN_IF_ERROR(ReadMultipart(http, form, {.max_parts = kMaxPictures + 4}));
  return form.Finish();
}

}  // namespace drupe
