#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/pipeline.h"
#include "store/object_store.h"

namespace drupe {

/// Takes pictures from outside: each is decoded once to prove that it is whole, then stored. One that is not is refused
/// by name, and the others are kept.
class ImageIntake {
 public:
  /// `objects` must outlive the intake.
  ImageIntake(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  /// Errors: only of the store (507, 500). A bad picture is no error here: it is in refused().
  Status Add(const std::string& name, std::string_view bytes);
  void Refuse(std::string name, Status reason) { refused_.push_back({std::move(name), std::move(reason)}); }

  /// Leaves out pictures whose size is not that of most, and checks that enough remain. Errors: 400 `too_few_images`;
  /// or the first refusal's kind and code, with every refused name, when only the refusals make it too few.
  Status Finish();

  const std::vector<StoredImage>& images() const { return images_; }
  const std::vector<RefusedImage>& refused() const { return refused_; }

 private:
  void RefuseOddSizes();

  ObjectStore& objects_;
  const Limits limits_;
  std::vector<StoredImage> images_;  ///< after Finish ascending by name
  std::vector<RefusedImage> refused_;
};

/// Verifies and stores one picture. Errors: those of VerifyImage (the picture's fault) and of the store.
Result<StoredImage> StoreImage(ObjectStore& objects, const std::string& name, std::string_view bytes,
                               const Limits& limits);

/// [{"name", "code", "message"}]
Json ToJson(const std::vector<RefusedImage>& refused);

}  // namespace drupe
