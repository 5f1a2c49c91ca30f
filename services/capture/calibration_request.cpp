#include "capture/calibration_request.h"

#include <algorithm>
#include <optional>
#include <set>

#include "base/ids.h"
#include "http/multipart.h"
#include "image/decode.h"

namespace drupe {
namespace {

constexpr int kMinPictures = 3;
constexpr int kMaxPictures = 100;
constexpr std::size_t kMaxPatternBytes = 4096;

/// Collects the parts of a form. One part at a time is in memory.
class FormSink : public PartSink {
 public:
  FormSink(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Status BeginPart(const PartHead& head) override {
    head_ = head;
    bytes_.clear();
    if (head.name == "images") return BeginPicture();
    if (head.name == "pattern") return BeginPattern();
    return InvalidArgument("unknown_part", "there is no part \"" + head.name + "\"; the parts are images and pattern",
                           head.name);
  }

  /// Keeps one byte more than the limit, which tells that the part is too large.
  Status WritePart(std::string_view bytes) override {
    bytes_.append(bytes.substr(0, max_bytes_ + 1 - bytes_.size()));
    return Status::Ok();
  }

  Status EndPart() override { return head_.name == "images" ? EndPicture() : EndPattern(); }

  Result<CalibrationRequest> Finish() {
    if (!has_pattern_) return InvalidArgument("missing_part", "the part pattern is missing", "pattern");
    if (request_.pictures.size() < kMinPictures) return TooFewPictures();
    std::sort(request_.pictures.begin(), request_.pictures.end(),
              [](const StoredPicture& a, const StoredPicture& b) { return a.name < b.name; });
    return std::move(request_);
  }

 private:
  Status BeginPicture() {
    max_bytes_ = limits_.max_image_bytes;
    DRUPE_RETURN_IF_ERROR(CheckImageName(head_.filename));
    if (!names_.insert(head_.filename).second) {
      return InvalidArgument("duplicate_name", "two images are called " + head_.filename, "images");
    }
    if (names_.size() <= kMaxPictures) return Status::Ok();
    return {StatusKind::kTooLarge, "too_many_images",
            "a calibration takes at most " + std::to_string(kMaxPictures) + " images", "images"};
  }

  Status BeginPattern() {
    max_bytes_ = kMaxPatternBytes;
    if (!has_pattern_) return Status::Ok();
    return InvalidArgument("duplicate_part", "the part pattern comes twice", "pattern");
  }

  Status EndPicture() {
    const Result<ImageInfo> info = VerifyImage(bytes_, limits_);
    if (!info.ok()) {
      if (!refusal_) refusal_ = info.status();
      request_.refused.push_back({head_.filename, info.status().code(), info.status().message()});
      return Status::Ok();
    }
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes_));
    request_.pictures.push_back({head_.filename, object.sha256});
    return Status::Ok();
  }

  Status EndPattern() {
    DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(bytes_, {.max_bytes = kMaxPatternBytes}));
    DRUPE_ASSIGN_OR_RETURN(request_.pattern, ParseCheckerboard(json));
    has_pattern_ = true;
    return Status::Ok();
  }

  Status TooFewPictures() const {
    const std::string counts = "at least 3 images are needed, " + std::to_string(names_.size()) + " came";
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
  std::set<std::string> names_;
  std::optional<Status> refusal_;  ///< the first one
  bool has_pattern_ = false;
  PartHead head_;
  std::string bytes_;
  std::size_t max_bytes_ = 0;
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
  return {
      {"pattern", ToJson(request.pattern)}, {"images", std::move(pictures)}, {"refused_images", std::move(refused)}};
}

Result<CalibrationRequest> ParseCalibrationPayload(const Json& payload) {
  CalibrationRequest request;
  DRUPE_ASSIGN_OR_RETURN(request.pattern, ParseCheckerboard(payload.value("pattern", Json())));
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
  FormSink sink(objects, limits);
  DRUPE_RETURN_IF_ERROR(ReadMultipart(http, sink, {.max_parts = kMaxPictures + 4}));
  return sink.Finish();
}

}  // namespace drupe
