#include "reconstruction/reconstruct_input.h"

#include "reconstruction/similarity/vocabulary.h"

namespace drupe {

ReconstructionInput MakeInput(const ReconstructRequest& request, ObjectStore& objects, DerivedCache* cache,
                              const Limits& limits) {
  ReconstructionInput input;
  for (const StoredImage& image : request.images) {
    const auto read = [&objects, sha256 = image.sha256, max_bytes = limits.max_image_bytes] {
      return objects.Get(sha256, max_bytes);
    };
    input.images.push_back({image.name, read, image.sha256});
  }
  input.calibration = request.calibration;
  input.board = request.board;
  input.limits = limits;
  input.read_vocabulary = [&objects](const std::string& sha256) { return objects.Get(sha256, MaxVocabularyBytes()); };
  input.cache = cache;
  return input;
}

}  // namespace drupe
