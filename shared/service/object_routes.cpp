#include "service/object_routes.h"

#include <array>
#include <charconv>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "http/content.h"
#include "service/object_source.h"
#include "store/object_roots.h"

namespace drupe {

namespace {

constexpr std::size_t kReadBytes = std::size_t{256} << 10;
constexpr std::size_t kMaxRootsBytes = std::size_t{64} << 20;

/// What a PUT brings: bytes from `first` on, or, without `first`, the question how many are here.
struct PieceHead {
  std::optional<std::uint64_t> first;
  std::uint64_t total = 0;
};

Status BadPiece(const std::string& why) {
  return InvalidArgument("invalid_range", "Content-Range: " + why, "Content-Range");
}

std::optional<std::uint64_t> TakeNumber(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool TakeText(std::string_view& text, std::string_view expected) {
  if (!text.starts_with(expected)) return false;
  text.remove_prefix(expected.size());
  return true;
}

/// "bytes 0-99/300" for a body of 100 bytes, or "bytes */300" for none; without the header the body is the whole.
Result<PieceHead> ReadPieceHead(std::string_view range, std::uint64_t length) {
  if (range.empty()) return PieceHead{0, length};
  const Status malformed = BadPiece("it must be bytes FIRST-LAST/TOTAL, or bytes */TOTAL without a body");
  if (!TakeText(range, "bytes ")) return malformed;
  PieceHead head;
  if (!TakeText(range, "*")) {
    const std::optional<std::uint64_t> first = TakeNumber(range);
    if (!first || !TakeText(range, "-")) return malformed;
    const std::optional<std::uint64_t> last = TakeNumber(range);
    if (!last || *last < *first) return malformed;
    if (*last - *first + 1 != length) return BadPiece("the body has another length");
    head.first = first;
  } else if (length != 0) {
    return malformed;
  }
  const std::optional<std::uint64_t> total = TakeText(range, "/") ? TakeNumber(range) : std::nullopt;
  if (!total || !range.empty()) return malformed;
  head.total = *total;
  if (head.first && (*head.first > head.total || length > head.total - *head.first)) {
    return BadPiece("it goes beyond the total");
  }
  return head;
}

Status ReceivePiece(const Request& request, ObjectUpload& upload) {
  std::vector<char> buffer(kReadBytes);
  while (request.body->remaining() > 0) {
    DRUPE_ASSIGN_OR_RETURN(const std::size_t count, request.body->Read(buffer));
    DRUPE_RETURN_IF_ERROR(upload.Append(std::as_bytes(std::span(buffer.data(), count))));
  }
  return Status::Ok();
}

void AnswerUpload(std::uint64_t received, bool complete, int http_status, Response& response) {
  response.SetJson({{"received", received}, {"complete", complete}}, http_status);
}

Status TellReceived(DiskObjectStore& store, const std::string& sha256, std::uint64_t total, Response& response) {
  DRUPE_ASSIGN_OR_RETURN(const bool there, store.Renew(sha256));
  DRUPE_ASSIGN_OR_RETURN(const std::uint64_t uploaded, store.UploadedBytes(sha256));
  AnswerUpload(there ? total : uploaded, there, 200, response);
  return Status::Ok();
}

Status PutObject(DiskObjectStore& store, const Request& request, Response& response) {
  const std::string& sha256 = request.Capture("sha256");
  DRUPE_ASSIGN_OR_RETURN(const PieceHead head, ReadPieceHead(request.Header("Content-Range"), request.body->length()));
  if (!head.first) return TellReceived(store, sha256, head.total, response);
  DRUPE_ASSIGN_OR_RETURN(ObjectUpload upload, store.ResumeUpload(sha256, *head.first, head.total));
  DRUPE_RETURN_IF_ERROR(ReceivePiece(request, upload));
  const bool complete = upload.complete();
  if (complete) DRUPE_RETURN_IF_ERROR(upload.Commit().status());
  AnswerUpload(upload.bytes(), complete, complete ? 201 : 202, response);
  return Status::Ok();
}

Status GetObject(DiskObjectStore& store, const Request& request, Response& response) {
  const std::string& sha256 = request.Capture("sha256");
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<ObjectReader> reader, store.OpenObject(sha256));
  SendContent(request, std::make_shared<ObjectSource>(std::move(reader)), "application/octet-stream", sha256, response);
  return Status::Ok();
}

Status DeleteObject(DiskObjectStore& store, const Request& request, Response& response) {
  DRUPE_RETURN_IF_ERROR(store.Remove(request.Capture("sha256")));
  response.status = 204;
  return Status::Ok();
}

Status TellRoom(DiskObjectStore& store, const Request& request, Response& response) {
  constexpr std::int64_t kMost = std::int64_t{1} << 50;
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t bytes, request.QueryInt("bytes", 0, 0, kMost));
  DRUPE_RETURN_IF_ERROR(store.CheckWritable(static_cast<std::uint64_t>(bytes)));
  response.SetJson({{"writable", true}});
  return Status::Ok();
}

Status PutRoots(DiskObjectStore& store, const Request& request, Response& response) {
  DRUPE_ASSIGN_OR_RETURN(const std::string body, ReadBody(request, kMaxRootsBytes));
  DRUPE_ASSIGN_OR_RETURN(const std::set<std::string> digests, ParseRoots(body));
  DRUPE_RETURN_IF_ERROR(store.KeepRoots(request.Capture("name"), digests));
  response.status = 204;
  return Status::Ok();
}

using ObjectAnswer = Status (*)(DiskObjectStore&, const Request&, Response&);

Handler Reply(DiskObjectStore& store, ObjectAnswer answer) {
  return [&store, answer](const Request& request, Response& response) {
    if (const Status status = answer(store, request, response); !status.ok()) response.SetError(status);
  };
}

}  // namespace

void AddObjectRoutes(Router& router, DiskObjectStore& store) {
  const RouteOptions plain{.max_body_bytes = 0, .scope = Scope::kStore};
  const RouteOptions piece{.max_body_bytes = kMaxUploadPieceBytes, .upload = true, .scope = Scope::kStore};
  const RouteOptions roots{.max_body_bytes = kMaxRootsBytes, .upload = true, .scope = Scope::kStore};
  router.Add("GET", "/objects", plain, Reply(store, TellRoom));
  router.Add("GET", "/objects/{sha256}", plain, Reply(store, GetObject));
  router.Add("PUT", "/objects/{sha256}", piece, Reply(store, PutObject));
  router.Add("DELETE", "/objects/{sha256}", plain, Reply(store, DeleteObject));
  router.Add("PUT", "/object-roots/{name}", roots, Reply(store, PutRoots));
}

}  // namespace drupe
