#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "defect_analysis/models/train_options.h"
#include "http/request.h"
#include "store/object_store.h"

namespace drupe {

/// A picture and its mask in the object store.
struct MaskedPicture {
  std::string name;
  std::string image_sha256;
  std::string mask_sha256;
};

/// What a background model is asked to be trained from; the payload of its job.
struct ModelRequest {
  TrainOptions options;
  std::vector<std::string> cloud_sha256;  ///< of labelled PLY files
  std::vector<MaskedPicture> pictures;
};

Json ToJson(const ModelRequest& request);
/// Reads what ToJson wrote. Errors: 500 `bad_payload`.
Result<ModelRequest> ParseModelPayload(const Json& payload);

/// Reads a multipart form: `cloud`, up to 16 PLY files with colours and a property label; `image` and `mask`, up to 64
/// of each, the k-th mask being that of the k-th image; `options`, JSON. Each part is checked and stored as it comes.
/// Errors: 400 `unknown_part`, `duplicate_part`, `invalid_name`, `missing_part`, those of ParseTrainOptions; 413
/// `too_many_parts`, `cloud_too_large`; 422 `no_labels`, `mask_size`; those of ReadPly, VerifyImage and of the store.
Result<ModelRequest> ReadModelForm(const Request& http, ObjectStore& objects, const Limits& limits);

}  // namespace drupe
