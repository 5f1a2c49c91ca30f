#include "http/multipart.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

#include "http/text.h"

namespace drupe {

namespace {

constexpr std::size_t kReadBytes = 64 << 10;

Status MalformedMultipart(std::string_view why) {
  return InvalidArgument("invalid_multipart", "the multipart body is malformed: " + std::string(why));
}

/// Takes one parameter value, quoted or not, from the front of `rest`; nothing when a quote is not closed. A backslash
/// escapes only a quote or itself: browsers send other backslashes as they are.
std::optional<std::string> TakeValue(std::string_view& rest) {
  std::string value;
  if (!rest.starts_with('"')) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    value = Trim(rest.substr(0, end));
    rest.remove_prefix(end);
    return value;
  }
  std::size_t i = 1;
  for (; i < rest.size() && rest[i] != '"'; ++i) {
    if (rest[i] == '\\' && i + 1 < rest.size() && (rest[i + 1] == '"' || rest[i + 1] == '\\')) ++i;
    value.push_back(rest[i]);
  }
  if (i >= rest.size()) return std::nullopt;
  rest.remove_prefix(i + 1);
  return value;
}

/// The parameter `wanted` of a header value such as `form-data; name="images"; filename="00.jpg"`; nothing when it is
/// absent or the value is malformed.
std::optional<std::string> Parameter(std::string_view header, std::string_view wanted) {
  std::size_t semicolon = header.find(';');
  while (semicolon != std::string_view::npos) {
    std::string_view rest = Trim(header.substr(semicolon + 1));
    const std::size_t equals = rest.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const std::string name = Lower(Trim(rest.substr(0, equals)));
    rest = Trim(rest.substr(equals + 1));
    const std::optional<std::string> value = TakeValue(rest);
    if (!value || name == wanted) return value;
    header = rest;
    semicolon = header.find(';');
  }
  return std::nullopt;
}

/// Reads the header lines of a part; the text has no final empty line.
Result<PartHead> ParsePartHead(std::string_view text, const MultipartLimits& limits) {
  PartHead head;
  bool is_form_data = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 2, text.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return MalformedMultipart("a part has a header line without a colon");
    const std::string name = Lower(Trim(line.substr(0, colon)));
    const std::string_view value = Trim(line.substr(colon + 1));
    if (name == "content-type") head.content_type = value;
    if (name != "content-disposition") continue;
    is_form_data = Lower(value).starts_with("form-data");
    head.name = Parameter(value, "name").value_or("");
    head.filename = Parameter(value, "filename").value_or("");
  }
  if (!is_form_data || head.name.empty()) return MalformedMultipart("a part has no name");
  if (head.name.size() > limits.max_name_bytes || head.filename.size() > limits.max_name_bytes) {
    return MalformedMultipart("a part's name is longer than " + std::to_string(limits.max_name_bytes) + " bytes");
  }
  return head;
}

bool IsBoundaryChar(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("'()+_,-./:=? ").find(c) != std::string_view::npos;
}

}  // namespace

MultipartParser::MultipartParser(std::string_view boundary, const MultipartLimits& limits, PartSink& sink)
    : delimiter_("\r\n--" + std::string(boundary)), limits_(limits), sink_(sink) {
  pending_ = "\r\n";  // so that a boundary at the very start is found like any other
}

Status MultipartParser::Feed(std::string_view bytes) {
  pending_.append(bytes);
  for (bool progressed = true; progressed;) DRUPE_RETURN_IF_ERROR(Step(progressed));
  return Status::Ok();
}

Status MultipartParser::Finish() const {
  if (state_ != State::kEpilogue) return MalformedMultipart("the closing boundary is missing");
  return parts_ > 0 ? Status::Ok() : MalformedMultipart("it has no parts");
}

Status MultipartParser::Step(bool& progressed) {
  progressed = false;
  switch (state_) {
    case State::kPreamble:
      return SkipPreamble(progressed);
    case State::kAfterBoundary:
      return EndBoundaryLine(progressed);
    case State::kHeaders:
      return TakeHeaders(progressed);
    case State::kBody:
      return TakeBody(progressed);
    case State::kEpilogue:
      pending_.clear();
      return Status::Ok();
  }
  return Status::Ok();
}

Status MultipartParser::SkipPreamble(bool& progressed) {
  const std::size_t found = pending_.find(delimiter_);
  if (found == std::string::npos) {
    if (pending_.size() >= delimiter_.size()) pending_.erase(0, pending_.size() - delimiter_.size() + 1);
    return Status::Ok();
  }
  pending_.erase(0, found + delimiter_.size());
  state_ = State::kAfterBoundary;
  progressed = true;
  return Status::Ok();
}

/// After a boundary: "--" ends the body, optional blanks and CR LF begin a part.
Status MultipartParser::EndBoundaryLine(bool& progressed) {
  constexpr std::size_t kMaxPadding = 64;
  if (pending_.starts_with("--")) {
    state_ = State::kEpilogue;
    progressed = true;
    return Status::Ok();
  }
  const std::size_t text = std::min(pending_.find_first_not_of(" \t"), pending_.size());
  if (text > kMaxPadding) return MalformedMultipart("blanks follow a boundary");
  const std::string_view rest = std::string_view(pending_).substr(text);
  if (rest.empty() || (rest.size() == 1 && (rest == "\r" || (rest == "-" && text == 0)))) return Status::Ok();
  if (!rest.starts_with("\r\n")) return MalformedMultipart("a boundary is followed by other text");
  if (++parts_ > limits_.max_parts) {
    return Status(StatusKind::kTooLarge, "too_many_parts",
                  "the body has more than " + std::to_string(limits_.max_parts) + " parts");
  }
  pending_.erase(0, text);  // the CR LF stays: it starts the empty line of a part without headers
  state_ = State::kHeaders;
  progressed = true;
  return Status::Ok();
}

Status MultipartParser::TakeHeaders(bool& progressed) {
  const std::size_t end = pending_.find("\r\n\r\n");
  if (std::min(end, pending_.size()) > limits_.max_part_header_bytes) {
    return MalformedMultipart("a part's headers are longer than " + std::to_string(limits_.max_part_header_bytes) +
                              " bytes");
  }
  if (end == std::string::npos) return Status::Ok();
  const std::string_view text = end == 0 ? std::string_view() : std::string_view(pending_).substr(2, end - 2);
  DRUPE_ASSIGN_OR_RETURN(const PartHead head, ParsePartHead(text, limits_));
  pending_.erase(0, end + 2);  // the CR LF stays: with it an empty part's delimiter is found like any other
  DRUPE_RETURN_IF_ERROR(sink_.BeginPart(head));
  state_ = State::kBody;
  progressed = true;
  lead_bytes_ = 2;
  return Status::Ok();
}

Status MultipartParser::TakeBody(bool& progressed) {
  const std::size_t found = pending_.find(delimiter_);
  // Without a delimiter in sight, all but its possible beginning at the end is the part's.
  const std::size_t take =
      found != std::string::npos ? found : pending_.size() - std::min(pending_.size(), delimiter_.size() - 1);
  DRUPE_RETURN_IF_ERROR(PassOn(take));
  if (found == std::string::npos) return Status::Ok();
  pending_.erase(0, delimiter_.size());
  DRUPE_RETURN_IF_ERROR(sink_.EndPart());
  state_ = State::kAfterBoundary;
  progressed = true;
  return Status::Ok();
}

/// Hands the first `count` pending bytes to the sink, less the CR LF that ended the part's headers.
Status MultipartParser::PassOn(std::size_t count) {
  const std::size_t skip = std::min(count, lead_bytes_);
  lead_bytes_ -= skip;
  if (count > skip) DRUPE_RETURN_IF_ERROR(sink_.WritePart(std::string_view(pending_).substr(skip, count - skip)));
  pending_.erase(0, count);
  return Status::Ok();
}

Result<std::string> MultipartBoundary(std::string_view content_type) {
  const std::string type = Lower(Trim(content_type.substr(0, content_type.find(';'))));
  if (type != "multipart/form-data") {
    return Status(StatusKind::kUnsupportedMedia, "unsupported_media_type", "the body must be multipart/form-data",
                  "Content-Type");
  }
  const std::string boundary = Parameter(content_type, "boundary").value_or("");
  if (boundary.empty() || boundary.size() > 70 || boundary.back() == ' ' ||
      !std::all_of(boundary.begin(), boundary.end(), IsBoundaryChar)) {
    return InvalidArgument("invalid_multipart", "Content-Type has no valid boundary", "Content-Type");
  }
  return boundary;
}

Status ReadMultipart(const Request& request, PartSink& sink, const MultipartLimits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const std::string boundary, MultipartBoundary(request.Header("Content-Type")));
  MultipartParser parser(boundary, limits, sink);
  std::vector<char> buffer(kReadBytes);
  while (true) {
    DRUPE_ASSIGN_OR_RETURN(const std::size_t count, request.body->Read(buffer));
    if (count == 0) return parser.Finish();
    DRUPE_RETURN_IF_ERROR(parser.Feed(std::string_view(buffer.data(), count)));
  }
}

}  // namespace drupe
