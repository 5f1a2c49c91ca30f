#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/status.h"
#include "http/request.h"

namespace drupe {

/// What is accepted of a multipart/form-data body. The size of the whole is limited by the route.
struct MultipartLimits {
  int max_parts = 1024;
  std::size_t max_part_header_bytes = 4096;
  std::size_t max_name_bytes = 256;  ///< of a part's name, and of its file name
};

/// The head of a part.
struct PartHead {
  std::string name;      ///< never empty
  std::string filename;  ///< empty for a plain field; as sent, so check it before use
  std::string content_type;
};

/// Receives the parts of a body in order, each piece by piece, so that no part is ever whole in memory unless the sink
/// wants it. An error of the sink ends the reading and is what the reader returns.
class PartSink {
 public:
  virtual ~PartSink() = default;
  virtual Status BeginPart(const PartHead& head) = 0;
  virtual Status WritePart(std::string_view bytes) = 0;
  virtual Status EndPart() = 0;
};

/// Incremental parser of multipart/form-data (RFC 7578, RFC 2046 section 5.1): fed in pieces of any size, split
/// anywhere.
class MultipartParser {
 public:
  MultipartParser(std::string_view boundary, const MultipartLimits& limits, PartSink& sink);

  /// Takes the next bytes of the body. Errors: 400 `invalid_multipart`, 413 `too_many_parts`, those of the sink. After
  /// an error nothing more may be fed.
  Status Feed(std::string_view bytes);
  /// To be called at the end of the body. Errors: 400 `invalid_multipart` when the closing boundary has not come.
  Status Finish() const;

 private:
  enum class State { kPreamble, kAfterBoundary, kHeaders, kBody, kEpilogue };

  Status Step(bool& progressed);
  Status SkipPreamble(bool& progressed);
  Status EndBoundaryLine(bool& progressed);
  Status TakeHeaders(bool& progressed);
  Status TakeBody(bool& progressed);
  Status PassOn(std::size_t count);

  const std::string delimiter_;  ///< CR LF "--" boundary
  const MultipartLimits limits_;
  PartSink& sink_;
  State state_ = State::kPreamble;
  std::string pending_;         ///< bytes not consumed yet; bounded by the header limit and the delimiter
  std::size_t lead_bytes_ = 0;  ///< of the CR LF that ended the part's headers, how much is still pending
  int parts_ = 0;
};

/// The boundary parameter of a Content-Type. Errors: 415 `unsupported_media_type` when it is not multipart/form-data,
/// 400 `invalid_multipart` without a valid boundary (1 to 70 characters).
Result<std::string> MultipartBoundary(std::string_view content_type);

/// Reads the whole body of `request` into `sink`.
Status ReadMultipart(const Request& request, PartSink& sink, const MultipartLimits& limits = {});

}  // namespace drupe
