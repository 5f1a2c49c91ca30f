#include "base/status.h"

namespace drupe {

std::string Status::ToString() const {
  if (ok()) return "ok";
  std::string text = code_ + ": " + message_;
  if (!field_.empty()) text += " (" + field_ + ")";
  return text;
}

Status InvalidArgument(std::string code, std::string message, std::string field) {
  return {StatusKind::kInvalidArgument, std::move(code), std::move(message), std::move(field)};
}

Status NotFound(std::string code, std::string message, std::string field) {
  return {StatusKind::kNotFound, std::move(code), std::move(message), std::move(field)};
}

Status Internal(std::string code, std::string message) {
  return {StatusKind::kInternal, std::move(code), std::move(message)};
}

Status Unprocessable(std::string code, std::string message) {
  return {StatusKind::kUnprocessable, std::move(code), std::move(message)};
}

Status Cancelled() { return {StatusKind::kCancelled, "cancelled", "cancelled by request"}; }

}  // namespace drupe
