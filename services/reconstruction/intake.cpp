#include "reconstruction/intake.h"

#include <algorithm>
#include <map>
#include <utility>

#include "image/decode.h"

namespace drupe {

namespace {

using PixelSize = std::pair<int, int>;

std::string SizeText(const PixelSize& size) {
  return std::to_string(size.first) + "x" + std::to_string(size.second);
}

/// The size that most images have; of equally frequent ones that of the earliest name.
PixelSize CommonSize(const std::vector<StoredImage>& images) {
  std::map<PixelSize, int> counts;
  for (const StoredImage& image : images) ++counts[{image.width, image.height}];
  PixelSize common;
  int most = 0;
  for (const StoredImage& image : images) {
    const PixelSize size{image.width, image.height};
    if (counts[size] > most) {
      most = counts[size];
      common = size;
    }
  }
  return common;
}

std::string ListRefusals(const std::vector<RefusedImage>& refused) {
  constexpr std::size_t kMaxListed = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(refused.size(), kMaxListed); ++i) {
    text += (i == 0 ? "" : "; ") + refused[i].name + ": " + refused[i].status.message();
  }
  if (refused.size() > kMaxListed) text += "; and " + std::to_string(refused.size() - kMaxListed) + " more";
  return text;
}

}  // namespace

Result<StoredImage> StoreImage(ObjectStore& objects, const std::string& name, std::string_view bytes,
                               const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const ImageInfo info, VerifyImage(bytes, limits));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects.Put(bytes));
  return StoredImage{name, object.sha256, static_cast<std::int64_t>(object.bytes), info.width, info.height};
}

Status ImageIntake::Add(const std::string& name, std::string_view bytes) {
  const Result<ImageInfo> info = VerifyImage(bytes, limits_);
  if (!info.ok()) {
    Refuse(name, info.status());
    return Status::Ok();
  }
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects_.Put(bytes));
  images_.push_back({name, object.sha256, static_cast<std::int64_t>(object.bytes), info->width, info->height});
  return Status::Ok();
}

void ImageIntake::RefuseOddSizes() {
  const PixelSize common = CommonSize(images_);
  std::vector<StoredImage> kept;
  for (StoredImage& image : images_) {
    const PixelSize size{image.width, image.height};
    if (size == common) {
      kept.push_back(std::move(image));
    } else {
      Refuse(image.name, Unprocessable("image_size_mismatch", "the picture has " + SizeText(size) +
                                                                  " pixels, most others have " + SizeText(common)));
    }
  }
  images_ = std::move(kept);
}

Status ImageIntake::Finish() {
  std::sort(images_.begin(), images_.end(), [](const StoredImage& a, const StoredImage& b) { return a.name < b.name; });
  RefuseOddSizes();
  const int count = static_cast<int>(images_.size());
  if (count >= limits_.min_images) return Status::Ok();
  const std::string needed = "at least " + std::to_string(limits_.min_images) + " images are needed, ";
  if (refused_.empty()) {
    return InvalidArgument("too_few_images", needed + std::to_string(count) + " came", "images");
  }
  const Status& first = refused_.front().status;
  return Status(first.kind(), first.code(),
                needed + "only " + std::to_string(count) + " can be used; " + ListRefusals(refused_), "images");
}

Json ToJson(const std::vector<RefusedImage>& refused) {
  Json list = Json::array();
  for (const RefusedImage& image : refused) {
    list.push_back({{"name", image.name}, {"code", image.status.code()}, {"message", image.status.message()}});
  }
  return list;
}

}  // namespace drupe
