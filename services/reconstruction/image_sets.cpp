#include "reconstruction/image_sets.h"

#include <algorithm>

#include "base/digest.h"
#include "base/ids.h"

namespace drupe {

namespace {

const Migrations kImageSetSchema = {
    "CREATE TABLE image_sets (id TEXT PRIMARY KEY, created_ms INTEGER NOT NULL) WITHOUT ROWID;"
    "CREATE TABLE image_set_images (set_id TEXT NOT NULL REFERENCES image_sets(id), name TEXT NOT NULL,"
    " sha256 TEXT NOT NULL, bytes INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL,"
    " PRIMARY KEY (set_id, name)) WITHOUT ROWID;",
    "ALTER TABLE image_sets ADD COLUMN announced TEXT NOT NULL DEFAULT '{}'"};

constexpr std::size_t kContentIdDigits = 40;  ///< of the digest that names a set by its content

std::string SizeText(const StoredImage& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

std::string ContentId(const std::vector<StoredImage>& images) {
  Sha256 digest;
  for (const StoredImage& image : images) digest.Update(image.name + "/" + image.sha256 + "\n");
  return "set_" + digest.FinishHex().substr(0, kContentIdDigits);
}

}  // namespace

Result<std::unique_ptr<ImageSetStore>> ImageSetStore::Open(Database& database, const Limits& limits,
                                                           const Clock& clock) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("image_sets", kImageSetSchema));
  return std::unique_ptr<ImageSetStore>(new ImageSetStore(database, limits, clock));
}

Result<ImageSet> ImageSetStore::Create(const Json& announced) {
  ImageSet set{NewId("set"), clock_.NowMs(), {}, announced};
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kPowerCut, [&] { return InsertSet(set); }));
  return set;
}

Result<ImageSet> ImageSetStore::CreateFrom(const std::vector<StoredImage>& images) {
  ImageSet set{ContentId(images), clock_.NowMs(), images, Json::object()};
  const Status status = database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_RETURN_IF_ERROR(InsertSet(set));
    for (const StoredImage& image : images) DRUPE_RETURN_IF_ERROR(InsertImage(set.id, image));
    return Status::Ok();
  });
  DRUPE_RETURN_IF_ERROR(status);
  return set;
}

Result<ImageSet> ImageSetStore::Get(std::string_view id) {
  ImageSet set;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&] { return Load(id, "", set); }));
  return set;
}

Result<PutOutcome> ImageSetStore::PutImage(std::string_view id, const StoredImage& image) {
  PutOutcome outcome = PutOutcome::kAdded;
  const Status status = database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    ImageSet set;
    DRUPE_RETURN_IF_ERROR(Load(id, database_.WaitForRows(), set));
    DRUPE_RETURN_IF_ERROR(CheckFits(set, image));
    for (const StoredImage& present : set.images) {
      if (present.name == image.name) outcome = present == image ? PutOutcome::kUnchanged : PutOutcome::kReplaced;
    }
    return outcome == PutOutcome::kUnchanged ? Status::Ok() : InsertImage(id, image);
  });
  DRUPE_RETURN_IF_ERROR(status);
  return outcome;
}

Status ImageSetStore::ForgetUnused(std::int64_t before_ms) {
  const std::string unused =
      "(SELECT id FROM image_sets WHERE created_ms < ? AND NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.subject = "
      "image_sets.id))";
  return database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    for (const std::string& from : {"image_set_images WHERE set_id IN " + unused, "image_sets WHERE id IN " + unused}) {
      DRUPE_ASSIGN_OR_RETURN(const auto remove, database_.Prepare("DELETE FROM " + from));
      DRUPE_RETURN_IF_ERROR(remove->Bind(before_ms).Run());
    }
    return Status::Ok();
  });
}

Status ImageSetStore::InsertSet(const ImageSet& set) {
  DRUPE_ASSIGN_OR_RETURN(const auto insert,
                         database_.Prepare("INSERT INTO image_sets (id, created_ms, announced) VALUES (?, ?, ?)"
                                           " ON CONFLICT (id) DO NOTHING"));
  return insert->Bind(set.id).Bind(set.created_ms).Bind(DumpJson(set.announced)).Run();
}

Status ImageSetStore::InsertImage(std::string_view id, const StoredImage& image) {
  DRUPE_ASSIGN_OR_RETURN(const auto insert,
                         database_.Prepare("INSERT INTO image_set_images"
                                           " (set_id, name, sha256, bytes, width, height) VALUES (?, ?, ?, ?, ?, ?)"
                                           " ON CONFLICT (set_id, name) DO UPDATE SET sha256 = excluded.sha256,"
                                           " bytes = excluded.bytes, width = excluded.width,"
                                           " height = excluded.height"));
  insert->Bind(id).Bind(image.name).Bind(image.sha256).Bind(image.bytes).Bind(image.width).Bind(image.height);
  return insert->Run();
}

Status ImageSetStore::Load(std::string_view id, std::string_view lock, ImageSet& set) {
  const std::string select = "SELECT created_ms, announced FROM image_sets WHERE id = ?" + std::string(lock);
  DRUPE_ASSIGN_OR_RETURN(const auto head, database_.Prepare(select));
  DRUPE_ASSIGN_OR_RETURN(const bool found, head->Bind(id).Step());
  if (!found) return NotFound("image_set_not_found", "there is no image set " + std::string(id));
  set.id = id;
  set.created_ms = head->Int(0);
  DRUPE_ASSIGN_OR_RETURN(set.announced, ParseJson(head->Text(1)));
  DRUPE_ASSIGN_OR_RETURN(const auto rows,
                         database_.Prepare("SELECT name, sha256, bytes, width, height FROM image_set_images"
                                           " WHERE set_id = ? ORDER BY name"));
  rows->Bind(id);
  while (true) {
    DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
    if (!more) return Status::Ok();
    set.images.push_back(
        {rows->Text(0), rows->Text(1), rows->Int(2), static_cast<int>(rows->Int(3)), static_cast<int>(rows->Int(4))});
  }
}

Status ImageSetStore::CheckFits(const ImageSet& set, const StoredImage& image) const {
  const auto other = std::find_if(set.images.begin(), set.images.end(),
                                  [&](const StoredImage& present) { return present.name != image.name; });
  if (other != set.images.end() && SizeText(*other) != SizeText(image)) {
    return Unprocessable("image_size_mismatch",
                         image.name + " is " + SizeText(image) + " pixels, the set's others are " + SizeText(*other));
  }
  const auto others = std::count_if(set.images.begin(), set.images.end(),
                                    [&](const StoredImage& present) { return present.name != image.name; });
  if (others < limits_.max_images) return Status::Ok();
  return Status(StatusKind::kTooLarge, "too_many_images",
                "an image set has at most " + std::to_string(limits_.max_images) + " images");
}

Json ToJson(const std::vector<StoredImage>& images) {
  Json list = Json::array();
  for (const StoredImage& image : images) {
    list.push_back({{"name", image.name},
                    {"sha256", image.sha256},
                    {"bytes", image.bytes},
                    {"width", image.width},
                    {"height", image.height}});
  }
  return list;
}

Result<std::vector<StoredImage>> ParseStoredImages(const Json& json) {
  std::vector<StoredImage> images;
  try {
    for (const Json& entry : json) {
      images.push_back(
          {entry.at("name"), entry.at("sha256"), entry.at("bytes"), entry.at("width"), entry.at("height")});
    }
  } catch (const Json::exception& error) {
    return Internal("bad_payload", std::string("a stored image list is malformed: ") + error.what());
  }
  return images;
}

}  // namespace drupe
