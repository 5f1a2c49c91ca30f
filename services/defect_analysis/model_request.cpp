#include "defect_analysis/model_request.h"

#include "base/ids.h"
#include "defect_analysis/models/labelled_colours.h"
#include "http/buffered_form.h"
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

/// Collects the parts of a form.
class ModelForm : public BufferedForm {
 public:
  ModelForm(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

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
  Result<std::size_t> LimitOf(const PartHead& head) override {
    if (head.name == "cloud") return LimitOfOne(head, kMaxCloudBytes, request_.cloud_sha256.size(), kMaxClouds);
    if (head.name == "image") return LimitOfOne(head, limits_.max_image_bytes, images_.size(), kMaxPictures);
    if (head.name == "mask") return LimitOfOne(head, limits_.max_image_bytes, masks_.size(), kMaxPictures);
    if (head.name == "options") return OnlyOnce(head, kMaxOptionBytes);
    return UnknownPart(head, "cloud, image, mask, options");
  }

  Status TakePart(const PartHead& head, std::string bytes) override {
    if (head.name == "cloud") return TakeCloud(bytes);
    if (head.name == "options") return TakeOptions(bytes);
    return TakeImage(head, bytes, head.name == "image" ? images_ : masks_);
  }

  static Result<std::size_t> LimitOfOne(const PartHead& head, std::size_t limit, std::size_t already,
                                        std::size_t most) {
    if (already < most) return limit;
    return TooMany(head.name, most);
  }

  Status TakeCloud(const std::string& bytes) {
    if (bytes.size() > kMaxCloudBytes) {
      return {StatusKind::kTooLarge, "cloud_too_large",
              "a cloud has at most " + std::to_string(kMaxCloudBytes >> 20) + " MB", "cloud"};
    }
    DRUPE_RETURN_IF_ERROR(ReadLabelledPly(bytes).status());
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes));
    request_.cloud_sha256.push_back(object.sha256);
    return Status::Ok();
  }

  Status TakeImage(const PartHead& head, const std::string& bytes, std::vector<StoredImage>& images) {
    DRUPE_RETURN_IF_ERROR(CheckImageName(head.filename));
    DRUPE_ASSIGN_OR_RETURN(const ImageInfo info, VerifyImage(bytes, limits_));
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes));
    images.push_back({head.filename, object.sha256, info.width, info.height});
    return Status::Ok();
  }

  Status TakeOptions(const std::string& bytes) {
    DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(bytes, {.max_bytes = kMaxOptionBytes}));
    DRUPE_ASSIGN_OR_RETURN(request_.options, ParseTrainOptions(json));
    return Status::Ok();
  }

  ObjectStore& objects_;
  const Limits& limits_;
  ModelRequest request_;
  std::vector<StoredImage> images_, masks_;
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
  ModelForm form(objects, limits);
  DRUPE_RETURN_IF_ERROR(ReadMultipart(http, form, {.max_parts = static_cast<int>(kMaxClouds + 2 * kMaxPictures) + 4}));
  return form.Finish();
}

}  // namespace drupe
