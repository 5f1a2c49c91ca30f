#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace drupe {

/// What kind of outcome an operation had. shared/http maps each kind to one HTTP status and nothing else does.
enum class StatusKind {
  kOk,
  kInvalidArgument,      ///< 400: the caller's input is wrong
  kUnauthorized,         ///< 401
  kForbidden,            ///< 403
  kNotFound,             ///< 404
  kConflict,             ///< 409: the state of the thing forbids the operation
  kLengthRequired,       ///< 411: a body without a declared length
  kPreconditionFailed,   ///< 412
  kTooLarge,             ///< 413: more bytes, images or pixels than the limit
  kUnsupportedMedia,     ///< 415: a format or encoding that is not accepted
  kRangeNotSatisfiable,  ///< 416
  kUnprocessable,        ///< 422: well formed, but nothing can be computed from it
  kTooManyRequests,      ///< 429: try again later, the caller asks too often
  kCancelled,            ///< 499 inside the process; never sent for a job, whose state says it
  kInternal,             ///< 500: a defect of ours
  kDataLoss,             ///< 500: stored bytes do not have their digest
  kUnavailable,          ///< 503: try again later, the service is full or stopping
  kInsufficientStorage,  ///< 507: the disk is full
};

/// The outcome of an operation that returns nothing else. An error carries a machine-readable `code` ("image_too_large"),
/// the `message` a user reads (what was wrong, and the limit), and optionally the input `field` it is about.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(StatusKind kind, std::string code, std::string message, std::string field = "")
      : kind_(kind), code_(std::move(code)), message_(std::move(message)), field_(std::move(field)) {}

  static Status Ok() { return Status(); }

  bool ok() const { return kind_ == StatusKind::kOk; }
  StatusKind kind() const { return kind_; }
  const std::string& code() const { return code_; }
  const std::string& message() const { return message_; }
  const std::string& field() const { return field_; }

  /// "code: message (field)" for logs.
  std::string ToString() const;

 private:
  StatusKind kind_ = StatusKind::kOk;
  std::string code_;
  std::string message_;
  std::string field_;
};

Status InvalidArgument(std::string code, std::string message, std::string field = "");
Status NotFound(std::string code, std::string message, std::string field = "");
Status Internal(std::string code, std::string message);
Status Unprocessable(std::string code, std::string message);
Status Cancelled();

/// A value or the Status that says why there is none. Reading the value of an error is a programming error.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}                                       // NOLINT: implicit by design
  Result(Status status) : status_(std::move(status)) { assert(!status_.ok()); }       // NOLINT: implicit by design

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }

  T& value() & { assert(ok()); return *value_; }
  const T& value() const& { assert(ok()); return *value_; }
  T&& value() && { assert(ok()); return std::move(*value_); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { assert(ok()); return &*value_; }
  const T* operator->() const { assert(ok()); return &*value_; }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace drupe

/// Returns the Status of `expression` from the calling function unless it is OK.
#define DRUPE_RETURN_IF_ERROR(expression)                      \
  do {                                                         \
    if (::drupe::Status drupe_status_ = (expression); !drupe_status_.ok()) return drupe_status_; \
  } while (false)

#define DRUPE_CONCAT_INNER(a, b) a##b
#define DRUPE_CONCAT(a, b) DRUPE_CONCAT_INNER(a, b)

/// DRUPE_ASSIGN_OR_RETURN(auto image, DecodeGray(bytes, limits)); returns the error from the calling function.
#define DRUPE_ASSIGN_OR_RETURN(declaration, expression) \
  DRUPE_ASSIGN_OR_RETURN_IMPL(DRUPE_CONCAT(drupe_result_, __LINE__), declaration, expression)
#define DRUPE_ASSIGN_OR_RETURN_IMPL(result, declaration, expression) \
  auto result = (expression);                                        \
  if (!result.ok()) return result.status();                          \
  declaration = std::move(result).value()
