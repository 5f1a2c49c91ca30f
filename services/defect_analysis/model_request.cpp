#include "defect_analysis/model_request.h"

#include <optional>

#include "base/ids.h"
#include "defect_analysis/models/labelled_colours.h"
#include "http/multipart.h"
#include "image/decode.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxClouds = 16;
constexpr std::size_t kMaxPictures = 64;
constexpr std::size_t kMaxCloudBytes = 256 << 20;
constexpr std::size_t kMaxOptionBytes = 4096;

Status TooMany(const std::string& part, std::size_t most) {
  return {StatusKind::kTooLarge, "too_many_parts", "at most " + std::to_string(most) + " parts " + part + " are taken",
          part};
}

/// A picture of the form, checked and stored.
struct StoredImage {
  std::string name;
  std::string sha256;
  int width = 0;
  int height = 0;
};

/// Collects the parts of a form. One part at a time is in memory.
class FormSink : public PartSink {
 public:
  FormSink(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Status BeginPart(const PartHead& head) override {
    head_ = head;
    bytes_.clear();
    if (head.name == "cloud") return Begin(kMaxCloudBytes, request_.cloud_sha256.size(), kMaxClouds);
    if (head.name == "image") return Begin(limits_.max_image_bytes, images_.size(), kMaxPictures);
    if (head.name == "mask") return Begin(limits_.max_image_bytes, masks_.size(), kMaxPictures);
    if (head.name == "options") return BeginOptions();
    return InvalidArgument(
        "unknown_part", "there is no part \"" + head.name + "\"; the parts are cloud, image, mask, options", head.name);
  }

  /// Keeps one byte more than the limit, which tells that the part is too large.
  Status WritePart(std::string_view bytes) override {
    bytes_.append(bytes.substr(0, max_bytes_ + 1 - bytes_.size()));
    return Status::Ok();
  }

  Status EndPart() override {
    if (head_.name == "cloud") return EndCloud();
    if (head_.name == "options") return EndOptions();
    return EndImage(head_.name == "image" ? images_ : masks_);
  }

  Result<ModelRequest> Finish() {
    if (images_.size() != masks_.size()) {
      return InvalidArgument("missing_part", "every image needs a mask: as many parts mask as image", "mask");
    }
    for (std::size_t k = 0; k < images_.size(); ++k) {
      if (images_[k].width != masks_[k].width || images_[k].height != masks_[k].height) {
        return Unprocessable("mask_size", "the mask of " + images_[k].name + " must have as many pixels as it");
      }
      request_.pictures.push_back({images_[k].name, images_[k].sha256, masks_[k].sha256});
    }
    if (!request_.cloud_sha256.empty() || !request_.pictures.empty()) return std::move(request_);
    return InvalidArgument("missing_part", "send labelled clouds, or images with masks", "cloud");
  }

 private:
  Status Begin(std::size_t max_bytes, std::size_t already, std::size_t most) {
    max_bytes_ = max_bytes;
    return already < most ? Status::Ok() : TooMany(head_.name, most);
  }

  Status BeginOptions() {
    max_bytes_ = kMaxOptionBytes;
    if (!has_options_) return Status::Ok();
    return InvalidArgument("duplicate_part", "the part options comes twice", "options");
  }

  Status EndCloud() {
    if (bytes_.size() > kMaxCloudBytes) {
      return {StatusKind::kTooLarge, "cloud_too_large",
              "a cloud has at most " + std::to_string(kMaxCloudBytes >> 20) + " MB", "cloud"};
    }
    DRUPE_RETURN_IF_ERROR(ReadLabelledPly(bytes_).status());
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes_));
    request_.cloud_sha256.push_back(object.sha256);
    return Status::Ok();
  }

  Status EndImage(std::vector<StoredImage>& images) {
    DRUPE_RETURN_IF_ERROR(CheckImageName(head_.filename));
    DRUPE_ASSIGN_OR_RETURN(const ImageInfo info, VerifyImage(bytes_, limits_));
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes_));
    images.push_back({head_.filename, object.sha256, info.width, info.height});
    return Status::Ok();
  }

  Status EndOptions() {
    DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(bytes_, {.max_bytes = kMaxOptionBytes}));
    DRUPE_ASSIGN_OR_RETURN(request_.options, ParseTrainOptions(json));
    has_options_ = true;
    return Status::Ok();
  }

  ObjectStore& objects_;
  const Limits& limits_;
  ModelRequest request_;
  std::vector<StoredImage> images_, masks_;
  bool has_options_ = false;
  PartHead head_;
  std::string bytes_;
  std::size_t max_bytes_ = 0;
};

}  // namespace

Json ToJson(const ModelRequest& request) {
  Json pictures = Json::array();
  for (const MaskedPicture& picture : request.pictures) {
    pictures.push_back({{"name", picture.name}, {"image", picture.image_sha256}, {"mask", picture.mask_sha256}});
  }
  return {{"options", ToJson(request.options)}, {"clouds", request.cloud_sha256}, {"pictures", std::move(pictures)}};
}

Result<ModelRequest> ParseModelPayload(const Json& payload) {
  ModelRequest request;
  try {
    DRUPE_ASSIGN_OR_RETURN(request.options, ParseTrainOptions(payload.at("options")));
    request.cloud_sha256 = payload.at("clouds").get<std::vector<std::string>>();
    for (const Json& picture : payload.at("pictures")) {
      request.pictures.push_back({picture.at("name").get<std::string>(), picture.at("image").get<std::string>(),
                                  picture.at("mask").get<std::string>()});
    }
  } catch (const Json::exception& error) {
    return Internal("bad_payload", error.what());
  }
  return request;
}

Result<ModelRequest> ReadModelForm(const Request& http, ObjectStore& objects, const Limits& limits) {
  FormSink sink(objects, limits);
  DRUPE_RETURN_IF_ERROR(ReadMultipart(http, sink, {.max_parts = static_cast<int>(kMaxClouds + 2 * kMaxPictures) + 4}));
  return sink.Finish();
}

}  // namespace drupe
