#include "service/remote_object_store.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "base/digest.h"
#include "base/log.h"
#include "store/object_roots.h"

namespace drupe {

namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kLongestPause{2'000};
constexpr const char* kBytesType = "application/octet-stream";

std::string PathOf(std::string_view sha256) {
  return "/objects/" + std::string(sha256);
}

Status CheckDigestName(std::string_view sha256) {
  if (IsSha256Hex(sha256)) return Status::Ok();
  return InvalidArgument("invalid_digest", "an object is named by 64 lower-case hexadecimal digits");
}

/// Whether the same transfer may go on at another time: the machine is away or busy, or, as it sees it, still receives
/// from the connection that broke.
bool MayGoOn(const Status& status) {
  return status.kind() == StatusKind::kUnavailable || status.kind() == StatusKind::kTooManyRequests ||
         status.code() == "upload_in_progress";
}

struct UploadState {
  std::uint64_t received = 0;
  bool complete = false;
};

Result<UploadState> ReadUploadState(const Result<Client::Reply>& reply) {
  if (!reply.ok()) return reply.status();
  try {
    return UploadState{reply->json.at("received").get<std::uint64_t>(), reply->json.at("complete").get<bool>()};
  } catch (const Json::exception& error) {
    return Internal("bad_reply", std::string("the reply to an upload: ") + error.what());
  }
}

std::string RangeText(std::uint64_t first, std::uint64_t count, std::uint64_t total) {
  return "bytes " + std::to_string(first) + "-" + std::to_string(first + count - 1) + "/" + std::to_string(total);
}

}  // namespace

Result<std::unique_ptr<RemoteObjectStore>> RemoteObjectStore::Open(const std::string& url,
                                                                   const std::filesystem::path& cache,
                                                                   const RemoteStoreOptions& options) {
  DRUPE_ASSIGN_OR_RETURN(Client client, Client::Create(url, options.client));
  DRUPE_ASSIGN_OR_RETURN(auto opened, ObjectCache::Open(cache, options.cache_bytes, options.min_free_bytes));
  return std::unique_ptr<RemoteObjectStore>(new RemoteObjectStore(std::move(client), std::move(opened), options));
}

Status RemoteObjectStore::Insist(const std::function<Status()>& step, const std::uint64_t& progress) const {
  milliseconds pause = options_.first_pause;
  SteadyClock::time_point last_progress = SteadyClock::now();
  for (std::uint64_t seen = progress;;) {
    const Status status = step();
    if (!MayGoOn(status)) return status;
    const SteadyClock::time_point now = SteadyClock::now();
    if (progress != seen) {
      seen = progress;
      last_progress = now;
      pause = options_.first_pause;
    }
    if (now - last_progress + pause > options_.patience) return status;
    Log(LogLevel::kDebug, "a transfer goes on", {{"after", status.ToString()}, {"bytes", progress}});
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, kLongestPause);
  }
}

// Every attempt begins with the question how much has arrived, except that an object of one piece is sent at once.
Status RemoteObjectStore::Upload(const std::string& sha256, std::string_view bytes) const {
  const std::string path = PathOf(sha256);
  std::uint64_t received = 0;
  bool ask = bytes.size() > options_.piece_bytes;
  const auto send = [&]() -> Status {
    UploadState state;
    if (std::exchange(ask, true)) {
      DRUPE_ASSIGN_OR_RETURN(
          state, ReadUploadState(client_.Put(path, "", kBytesType, "bytes */" + std::to_string(bytes.size()))));
    }
    while (!state.complete) {
      received = std::min<std::uint64_t>(state.received, bytes.size());
      const std::string_view piece = bytes.substr(received, options_.piece_bytes);
      const std::string range = piece.empty() ? "" : RangeText(received, piece.size(), bytes.size());
      DRUPE_ASSIGN_OR_RETURN(state, ReadUploadState(client_.Put(path, piece, kBytesType, range)));
    }
    received = bytes.size();
    return Status::Ok();
  };
  // Other than the expected bytes are kept, or they were damaged on the way and dropped: once more, after asking.
  int starts_left = 3;
  return Insist(
      [&] {
        Status sent = send();
        while ((sent.code() == "upload_offset" || sent.code() == "digest_mismatch") && --starts_left > 0) sent = send();
        return sent;
      },
      received);
}

Result<ObjectInfo> RemoteObjectStore::Put(std::string_view bytes) {
  const ObjectInfo object{Sha256Hex(bytes), bytes.size()};
  DRUPE_RETURN_IF_ERROR(Upload(object.sha256, bytes));
  Status kept = cache_->MakeRoom(bytes.size());
  if (kept.ok()) kept = cache_->store().Put(bytes).status();
  if (!kept.ok()) Log(LogLevel::kWarning, "no copy of an object kept", {{"error", kept.ToString()}});
  return object;
}

Status RemoteObjectStore::Fetch(const std::string& sha256) {
  DRUPE_ASSIGN_OR_RETURN(const std::uint64_t bytes, Size(sha256));
  DRUPE_RETURN_IF_ERROR(cache_->MakeRoom(bytes));
  DRUPE_ASSIGN_OR_RETURN(ObjectWriter writer, cache_->store().Begin(bytes));
  Status written;
  std::uint64_t received = 0;
  const Status fetched = Insist(
      [&] {
        if (received == bytes && bytes > 0) return Status::Ok();
        return client_.Download(
            PathOf(sha256), bytes - received,
            [&](std::string_view piece) {
              written = writer.Append(piece);
              received += piece.size();
              return written.ok();
            },
            received);
      },
      received);
  DRUPE_RETURN_IF_ERROR(written);
  DRUPE_RETURN_IF_ERROR(fetched);
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, writer.Commit());
  if (object.sha256 == sha256) return Status::Ok();
  (void)cache_->store().Remove(object.sha256);
  return {StatusKind::kDataLoss, "object_damaged", "other bytes than those of " + sha256 + " came"};
}

template <typename T>
Result<T> RemoteObjectStore::Read(std::string_view sha256, const std::function<Result<T>(DiskObjectStore&)>& read) {
  DRUPE_RETURN_IF_ERROR(CheckDigestName(sha256));
  constexpr int kLooks = 3;  // another thread's object may take the place of this one before it is read
  cache_->Used(sha256);
  for (int look = 0;; ++look) {
    Result<T> found = read(cache_->store());
    const StatusKind kind = found.status().kind();
    if ((kind != StatusKind::kNotFound && kind != StatusKind::kDataLoss) || look == kLooks) return found;
    const std::lock_guard lock(fetching_[std::hash<std::string_view>()(sha256) % fetching_.size()]);
    if (kind == StatusKind::kNotFound && cache_->store().Contains(sha256)) continue;
    DRUPE_RETURN_IF_ERROR(Fetch(std::string(sha256)));
  }
}

Result<std::string> RemoteObjectStore::Get(std::string_view sha256, std::uint64_t max_bytes) {
  return Read<std::string>(sha256, [&](DiskObjectStore& store) { return store.Get(sha256, max_bytes); });
}

Result<std::unique_ptr<ObjectReader>> RemoteObjectStore::OpenObject(std::string_view sha256) {
  return Read<std::unique_ptr<ObjectReader>>(sha256, [&](DiskObjectStore& store) { return store.OpenObject(sha256); });
}

Result<std::uint64_t> RemoteObjectStore::Size(std::string_view sha256) {
  DRUPE_RETURN_IF_ERROR(CheckDigestName(sha256));
  const Result<std::uint64_t> here = cache_->store().Size(sha256);
  if (here.ok()) return here;
  std::uint64_t bytes = 0;
  const Status asked = Insist(
      [&]() -> Status {
        DRUPE_ASSIGN_OR_RETURN(bytes, client_.Length(PathOf(sha256)));
        return Status::Ok();
      },
      bytes);
  if (asked.kind() == StatusKind::kNotFound) {
    return NotFound("object_not_found", "there is no object " + std::string(sha256));
  }
  DRUPE_RETURN_IF_ERROR(asked);
  return bytes;
}

Status RemoteObjectStore::Remove(std::string_view sha256) {
  DRUPE_RETURN_IF_ERROR(CheckDigestName(sha256));
  DRUPE_RETURN_IF_ERROR(cache_->store().Remove(sha256));
  return client_.Delete(PathOf(sha256)).status();
}

Status RemoteObjectStore::CheckWritable(std::uint64_t expected_bytes) {
  return client_.Get("/objects?bytes=" + std::to_string(expected_bytes)).status();
}

Status RemoteObjectStore::KeepRoots(const std::string& owner, const std::set<std::string>& digests) {
  return client_.Put("/object-roots/" + owner, RootsText(digests), "text/plain").status();
}

}  // namespace drupe
