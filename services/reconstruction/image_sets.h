#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A picture that was verified and stored; `sha256` names the object with the file's bytes.
struct StoredImage {
  std::string name;
  std::string sha256;
  std::int64_t bytes = 0;
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels

  bool operator==(const StoredImage&) const = default;
};

struct ImageSet {
  std::string id;
  std::int64_t created_ms = 0;
  std::vector<StoredImage> images;  ///< ascending by name, which is the order of the turn
  /// {"calibration", "board", "options"}, each as in a request or absent: what will be asked of the set, so that work
  /// can begin while its images arrive. Checked by whoever creates the set.
  Json announced = Json::object();
};

enum class PutOutcome { kAdded, kReplaced, kUnchanged };

/// The image sets of a service, in tables of its database. A set lists objects; jobs take a copy of the list, so
/// changing a set later never changes what a job works on. Thread-safe.
class ImageSetStore {
 public:
  /// `database` and `clock` must outlive the store.
  static Result<std::unique_ptr<ImageSetStore>> Open(Database& database, const Limits& limits, const Clock& clock);
  static Result<std::unique_ptr<ImageSetStore>> Open(Database& database, const Limits& limits) {
    return Open(database, limits, database.clock());
  }

  /// A new set without images; for `announced` see ImageSet.
  Result<ImageSet> Create(const Json& announced = Json::object());
  /// The set of exactly these images (ascending by name). Its id follows from names and digests, so a repeated upload
  /// gives the same set.
  Result<ImageSet> CreateFrom(const std::vector<StoredImage>& images);
  /// Forgets the sets made before `before_ms` that no job is about.
  Status ForgetUnused(std::int64_t before_ms);
  /// Errors: 404 `image_set_not_found`.
  Result<ImageSet> Get(std::string_view id);
  /// Adds an image, or replaces the one of that name: sending a picture again corrects it, and sending the same bytes
  /// again changes nothing. Errors: 404 `image_set_not_found`, 413 `too_many_images`, 422 `image_size_mismatch` when it
  /// is not as large as the set's other images.
  Result<PutOutcome> PutImage(std::string_view id, const StoredImage& image);

 private:
  ImageSetStore(Database& database, const Limits& limits, const Clock& clock)
      : database_(database), limits_(limits), clock_(clock) {}

  Status InsertSet(const ImageSet& set);
  Status InsertImage(std::string_view id, const StoredImage& image);
  /// `lock`: put after the SELECT of the set, to keep others from changing it.
  Status Load(std::string_view id, std::string_view lock, ImageSet& set);
  Status CheckFits(const ImageSet& set, const StoredImage& image) const;

  Database& database_;
  const Limits limits_;
  const Clock& clock_;
};

/// [{"name", "sha256", "bytes", "width", "height"}]
Json ToJson(const std::vector<StoredImage>& images);
/// Reads what ToJson wrote. Errors: 500 `internal`, since only this program writes it.
Result<std::vector<StoredImage>> ParseStoredImages(const Json& json);

}  // namespace drupe
