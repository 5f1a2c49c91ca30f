#include "reconstruction/object_derived_cache.h"

#include <chrono>
#include <utility>
#include <vector>

#include "base/digest.h"
#include "base/log.h"

namespace drupe {
namespace {

const Migrations kDerivedSchema = {
    "CREATE TABLE derived (key TEXT PRIMARY KEY, sha256 TEXT NOT NULL, bytes INTEGER NOT NULL,"
    " used_ms INTEGER NOT NULL)"};

/// The least recently used that go at once.
constexpr int kEvictedTogether = 32;

/// Before the bytes, so that an object belongs to one key alone and says so.
std::string HeadOf(const std::string& key) {
  return "drupe-derived-1 " + key + "\n";
}

}  // namespace

/// A caller's right to look for a key or make it, alone; or not alone, when the other takes too long.
class ObjectDerivedCache::Turn {
 public:
  Turn(ObjectDerivedCache& cache, const std::string& key) : cache_(cache), key_(key) {}
  ~Turn() {
    if (!taken_) return;
    const std::lock_guard lock(cache_.mutex_);
    cache_.at_work_.erase(key_);
    cache_.ended_.notify_all();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  Status Take(const RunContext& context) {
    constexpr std::chrono::milliseconds kLook{100};
    const auto until = std::chrono::steady_clock::now() + cache_.patience_;
    std::unique_lock lock(cache_.mutex_);
    while (!cache_.at_work_.insert(key_).second) {
      DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
      if (std::chrono::steady_clock::now() >= until) return Status::Ok();
      cache_.ended_.wait_for(lock, kLook);
    }
    taken_ = true;
    return Status::Ok();
  }

 private:
  ObjectDerivedCache& cache_;
  const std::string& key_;
  bool taken_ = false;
};

Result<std::unique_ptr<ObjectDerivedCache>> ObjectDerivedCache::Open(Database& database, ObjectStore& objects,
                                                                     std::int64_t max_bytes,
                                                                     std::chrono::milliseconds patience) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("derived", kDerivedSchema));
  return std::unique_ptr<ObjectDerivedCache>(new ObjectDerivedCache(database, objects, max_bytes, patience));
}

Result<std::string> ObjectDerivedCache::FindOrMake(const std::string& key, const Make& make,
                                                   const RunContext& context) {
  Turn turn(*this, key);
  DRUPE_RETURN_IF_ERROR(turn.Take(context));
  if (std::optional<std::string> found = Find(key)) return *std::move(found);
  ++misses_;
  DRUPE_ASSIGN_OR_RETURN(std::string made, make());
  if (const Status kept = Keep(key, made); !kept.ok()) {
    Log(LogLevel::kWarning, "cannot keep what was computed of a picture", {{"error", kept.ToString()}});
  }
  return made;
}

std::optional<std::string> ObjectDerivedCache::Find(const std::string& key) {
  std::optional<std::string> found = Read(key);
  if (found) ++hits_;
  return found;
}

std::optional<std::string> ObjectDerivedCache::Read(const std::string& key) {
  std::string sha256;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto row,
                           database_.Prepare("UPDATE derived SET used_ms = ? WHERE key = ? RETURNING sha256"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, row->Bind(database_.clock().NowMs()).Bind(key).Step());
    if (found) sha256 = row->Text(0);
    return Status::Ok();
  });
  if (!status.ok() || sha256.empty()) return std::nullopt;
  Result<std::string> object = objects_.Get(sha256);
  const std::string head = HeadOf(key);
  if (!object.ok() || !object->starts_with(head)) return std::nullopt;
  return object->substr(head.size());
}

/// The row comes first: a crash between the two leaves a row whose object is missing, which counts as not there. What
/// two callers made of one key is the same, as a rule; where not, the later one's stays.
Status ObjectDerivedCache::Keep(const std::string& key, std::string_view bytes) {
  const std::string object = HeadOf(key).append(bytes);
  if (static_cast<std::int64_t>(object.size()) > max_bytes_) return Status::Ok();
  const std::string sha256 = Sha256Hex(object);
  std::string former;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto known, database_.Prepare("SELECT sha256 FROM derived WHERE key = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool is_known, known->Bind(key).Step());
    if (is_known) former = known->Text(0);
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO derived (key, sha256, bytes, used_ms) VALUES (?, ?, ?, ?)"
                                             " ON CONFLICT (key) DO UPDATE SET sha256 = excluded.sha256,"
                                             " bytes = excluded.bytes, used_ms = excluded.used_ms"));
    insert->Bind(key).Bind(sha256).Bind(static_cast<std::int64_t>(object.size()));
    return insert->Bind(database_.clock().NowMs()).Run();
  }));
  DRUPE_RETURN_IF_ERROR(objects_.Put(object).status());
  if (!former.empty() && former != sha256) DRUPE_RETURN_IF_ERROR(objects_.Remove(former));
  return MakeRoom();
}

/// Objects go before their rows, for the same reason.
Status ObjectDerivedCache::MakeRoom() {
  return database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto sum, database_.Prepare("SELECT SUM(bytes) FROM derived"));
    DRUPE_ASSIGN_OR_RETURN(const bool any, sum->Step());
    std::int64_t excess = (any ? sum->Int(0) : 0) - max_bytes_;
    if (excess <= 0) return Status::Ok();
    std::vector<std::string> gone;
    DRUPE_ASSIGN_OR_RETURN(const auto oldest,
                           database_.Prepare("SELECT key, sha256, bytes FROM derived ORDER BY used_ms, key LIMIT ?"));
    oldest->Bind(kEvictedTogether);
    while (excess > 0) {
      DRUPE_ASSIGN_OR_RETURN(const bool more, oldest->Step());
      if (!more) break;
      DRUPE_RETURN_IF_ERROR(objects_.Remove(oldest->Text(1)));
      gone.push_back(oldest->Text(0));
      excess -= oldest->Int(2);
    }
    for (const std::string& key : gone) {
      DRUPE_ASSIGN_OR_RETURN(const auto erase, database_.Prepare("DELETE FROM derived WHERE key = ?"));
      DRUPE_RETURN_IF_ERROR(erase->Bind(key).Run());
    }
    return Status::Ok();
  });
}

}  // namespace drupe
