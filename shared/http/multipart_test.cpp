#include "http/multipart.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "http/buffered_form.h"

namespace drupe {
namespace {

struct Part {
  PartHead head;
  std::string bytes;
  bool ended = false;
};

class CollectingSink : public PartSink {
 public:
  Status BeginPart(const PartHead& head) override {
    parts.push_back({head, "", false});
    return Status::Ok();
  }
  Status WritePart(std::string_view bytes) override {
    parts.back().bytes.append(bytes);
    largest = std::max(largest, bytes.size());
    return Status::Ok();
  }
  Status EndPart() override {
    parts.back().ended = true;
    return Status::Ok();
  }

  std::vector<Part> parts;
  std::size_t largest = 0;
};

class NumberForm : public BufferedForm {
 public:
  std::vector<std::string> taken;

 private:
  Result<std::size_t> LimitOf(const PartHead& head) override {
    if (head.name == "number") return OnlyOnce(head, 3);
    return UnknownPart(head, "number");
  }
  Status TakePart(const PartHead& head, std::string bytes) override {
    taken.push_back(head.name + "=" + bytes);
    return Status::Ok();
  }
};

Status FeedPart(const std::string& name, const std::string& bytes, BufferedForm& form) {
  DRUPE_RETURN_IF_ERROR(form.BeginPart({.name = name, .filename = "", .content_type = ""}));
  for (const char byte : bytes) DRUPE_RETURN_IF_ERROR(form.WritePart({&byte, 1}));
  return form.EndPart();
}

TEST(BufferedFormTest, GathersEachPartUpToItsLimit) {
  NumberForm form;
  EXPECT_EQ(FeedPart("letter", "a", form).code(), "unknown_part");
  ASSERT_TRUE(FeedPart("number", "12345", form).ok());
  EXPECT_EQ(form.taken, std::vector<std::string>{"number=1234"});  // one byte more than the limit
  EXPECT_EQ(FeedPart("number", "1", form).code(), "duplicate_part");
}

/// Bytes that look like the delimiter "\r\n--B0" again and again, without being it.
constexpr std::string_view kTricky = "\r\n--B\r\n--\r\n-\r\n\r\r\n--B1\r\n--b0--B0\r";

std::string SampleBody() {
  return "preamble\r\n--B0\r\nContent-Disposition: form-data; name=\"images\"; filename=\"00.jpg\"\r\n"
         "Content-Type: image/jpeg\r\n\r\n" +
         std::string(kTricky) +
         "\r\n--B0 \t\r\ncontent-disposition: form-data; name=empty\r\n\r\n"
         "\r\n--B0\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{\"a\": 1}"
         "\r\n--B0--\r\nepilogue";
}

void ExpectSample(const std::vector<Part>& parts) {
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].head.name, "images");
  EXPECT_EQ(parts[0].head.filename, "00.jpg");
  EXPECT_EQ(parts[0].head.content_type, "image/jpeg");
  EXPECT_EQ(parts[0].bytes, kTricky);
  EXPECT_EQ(parts[1].head.name, "empty");
  EXPECT_EQ(parts[1].bytes, "");
  EXPECT_EQ(parts[2].bytes, "{\"a\": 1}");
  for (const Part& part : parts) EXPECT_TRUE(part.ended);
}

/// Feeds `body` in pieces of the given lengths, the rest at once.
Status FeedPieces(std::string_view body, const std::vector<std::size_t>& lengths, PartSink& sink,
                  const MultipartLimits& limits = {}) {
  MultipartParser parser("B0", limits, sink);
  for (const std::size_t length : lengths) {
    DRUPE_RETURN_IF_ERROR(parser.Feed(body.substr(0, length)));
    body.remove_prefix(std::min(length, body.size()));
  }
  DRUPE_RETURN_IF_ERROR(parser.Feed(body));
  return parser.Finish();
}

TEST(Multipart, SplitAtEveryOffset) {
  const std::string body = SampleBody();
  for (std::size_t split = 0; split <= body.size(); ++split) {
    SCOPED_TRACE(split);
    CollectingSink sink;
    ASSERT_TRUE(FeedPieces(body, {split}, sink).ok());
    ExpectSample(sink.parts);
  }
}

TEST(Multipart, PiecesOfEverySize) {
  const std::string body = SampleBody();
  for (std::size_t size = 1; size < 24; ++size) {
    SCOPED_TRACE(size);
    CollectingSink sink;
    ASSERT_TRUE(FeedPieces(body, std::vector<std::size_t>(body.size() / size, size), sink).ok());
    ExpectSample(sink.parts);
  }
}

TEST(Multipart, LargePartArrivesInPieces) {
  CollectingSink sink;
  MultipartParser parser("B0", {}, sink);
  ASSERT_TRUE(parser.Feed("--B0\r\nContent-Disposition: form-data; name=\"x\"\r\n\r\n").ok());
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(parser.Feed(std::string(10'000, 'a')).ok());
  ASSERT_TRUE(parser.Feed("\r\n--B0--").ok());
  EXPECT_TRUE(parser.Finish().ok());
  EXPECT_EQ(sink.parts.at(0).bytes.size(), 1'000'000u);
  EXPECT_LT(sink.largest, 11'000u);
}

TEST(Multipart, EveryTruncationIsRefused) {
  const std::string body = SampleBody();
  const std::size_t end = body.rfind("--\r\nepilogue") + 2;
  for (std::size_t length = 0; length < end; ++length) {
    CollectingSink sink;
    EXPECT_EQ(FeedPieces(body.substr(0, length), {}, sink).code(), "invalid_multipart") << length;
  }
}

TEST(Multipart, LimitsAreKept) {
  CollectingSink sink;
  const std::string part = "--B0\r\nContent-Disposition: form-data; name=\"x\"\r\n\r\nv\r\n";
  EXPECT_EQ(FeedPieces(part + part + part + "--B0--", {}, sink, {.max_parts = 2}).code(), "too_many_parts");
  const std::string head = "--B0\r\nContent-Disposition: form-data; name=\"x\"\r\nX: " + std::string(200, 'a');
  EXPECT_EQ(FeedPieces(head, {}, sink, {.max_part_header_bytes = 100}).code(), "invalid_multipart");
  const std::string name = "--B0\r\nContent-Disposition: form-data; name=\"" + std::string(50, 'n') + "\"\r\n\r\n";
  EXPECT_EQ(FeedPieces(name, {}, sink, {.max_name_bytes = 49}).code(), "invalid_multipart");
}

TEST(Multipart, MalformedPartsAreRefused) {
  const std::vector<std::string> bodies = {
      "--B0\r\n\r\nno headers\r\n--B0--",
      "--B0\r\nContent-Type: text/plain\r\n\r\nno name\r\n--B0--",
      "--B0\r\nContent-Disposition: attachment; name=\"x\"\r\n\r\nv\r\n--B0--",
      "--B0\r\nContent-Disposition: form-data; name=\"x\r\n\r\nv\r\n--B0--",
      "--B0\r\nno colon\r\n\r\nv\r\n--B0--",
      "--B0garbage\r\nContent-Disposition: form-data; name=\"x\"\r\n\r\nv\r\n--B0--",
      "nothing at all",
      "--B0--\r\n",
  };
  for (const std::string& body : bodies) {
    CollectingSink sink;
    EXPECT_EQ(FeedPieces(body, {}, sink).code(), "invalid_multipart") << body;
  }
}

TEST(Multipart, QuotedNames) {
  CollectingSink sink;
  ASSERT_TRUE(
      FeedPieces(
          "--B0\r\nContent-Disposition: form-data; filename=\"a;\\\"b\\\\c\\d.jpg\"; name=\"i;j\"\r\n\r\n\r\n--B0--",
          {}, sink)
          .ok());
  EXPECT_EQ(sink.parts.at(0).head.filename, "a;\"b\\c\\d.jpg");
  EXPECT_EQ(sink.parts.at(0).head.name, "i;j");
}

TEST(Multipart, Boundary) {
  EXPECT_EQ(MultipartBoundary("multipart/form-data; boundary=abc").value(), "abc");
  EXPECT_EQ(MultipartBoundary("Multipart/Form-Data; charset=utf-8; Boundary=\"a b\"").value(), "a b");
  EXPECT_EQ(MultipartBoundary("application/json").status().code(), "unsupported_media_type");
  EXPECT_EQ(MultipartBoundary("multipart/form-data").status().code(), "invalid_multipart");
  EXPECT_EQ(MultipartBoundary("multipart/form-data; boundary=").status().code(), "invalid_multipart");
  EXPECT_EQ(MultipartBoundary("multipart/form-data; boundary=" + std::string(71, 'a')).status().code(),
            "invalid_multipart");
  EXPECT_EQ(MultipartBoundary("multipart/form-data; boundary=\"a\\\"b\"").status().code(), "invalid_multipart");
}

}  // namespace
}  // namespace drupe
