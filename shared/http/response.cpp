#include "http/response.h"

#include <algorithm>
#include <cstring>

#include "http/status_map.h"

namespace drupe {

namespace {

/// What a client that met a full server should wait.
constexpr const char* kRetryAfterSeconds = "5";

class TextSource : public ByteSource {
 public:
  explicit TextSource(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<char> buffer) override {
    const std::size_t count = std::min<std::size_t>(buffer.size(), bytes_.size() - offset);
    std::memcpy(buffer.data(), bytes_.data() + offset, count);
    return count;
  }

 private:
  std::string bytes_;
};

}  // namespace

std::shared_ptr<ByteSource> MakeByteSource(std::string bytes) {
  return std::make_shared<TextSource>(std::move(bytes));
}

void Response::SetJson(const Json& json, int http_status) {
  SetText(DumpJson(json) + "\n", "application/json", http_status);
}

void Response::SetText(std::string text, std::string type, int http_status) {
  status = http_status;
  content_type = std::move(type);
  body = std::move(text);
}

void Response::SetError(const Status& error) {
  *this = Response();
  SetJson(ErrorBody(error), HttpStatusOf(error));
  if (status == 503 || status == 429) SetHeader("Retry-After", kRetryAfterSeconds);
}

}  // namespace drupe
