#include "http/content.h"

#include <gtest/gtest.h>

#include "http/status_map.h"

namespace drupe {
namespace {

std::string Describe(std::string_view header, std::uint64_t size) {
  const Result<std::optional<ByteRange>> range = ParseRange(header, size);
  if (!range.ok()) return range.status().code();
  if (!range->has_value()) return "whole";
  return std::to_string((*range)->offset) + "+" + std::to_string((*range)->length);
}

TEST(Range, Nominal) {
  EXPECT_EQ(Describe("bytes=0-0", 10), "0+1");
  EXPECT_EQ(Describe("bytes=2-5", 10), "2+4");
  EXPECT_EQ(Describe("bytes=2-", 10), "2+8");
  EXPECT_EQ(Describe("bytes=-3", 10), "7+3");
  EXPECT_EQ(Describe("bytes=-30", 10), "0+10");
  EXPECT_EQ(Describe("bytes=8-100", 10), "8+2");
  EXPECT_EQ(Describe("bytes=0-18446744073709551615", 10), "0+10");
}

TEST(Range, NotOneRangeInside) {
  EXPECT_EQ(Describe("bytes=10-", 10), "range_not_satisfiable");
  EXPECT_EQ(Describe("bytes=-0", 10), "range_not_satisfiable");
  EXPECT_EQ(Describe("bytes=0-0", 0), "range_not_satisfiable");
  EXPECT_EQ(Describe("bytes=0-1,3-4", 10), "range_not_satisfiable");
}

TEST(Range, InvalidMeansTheWhole) {
  for (const char* header : {"", "lines=1-2", "bytes=", "bytes=a-b", "bytes=5-2", "bytes=--1", "bytes=1", "bytes=-",
                             "bytes=99999999999999999999-", "bytes=0x1-2"}) {
    EXPECT_EQ(Describe(header, 10), "whole") << header;
  }
}

TEST(Etag, Matches) {
  EXPECT_TRUE(MatchesEtag("\"a\"", "\"a\""));
  EXPECT_TRUE(MatchesEtag("\"b\", W/\"a\"", "\"a\""));
  EXPECT_TRUE(MatchesEtag("*", "\"a\""));
  EXPECT_FALSE(MatchesEtag("", "\"a\""));
  EXPECT_FALSE(MatchesEtag("\"b\",,", "\"a\""));
}

Response Send(const HeaderMap& headers) {
  Request request;
  request.headers = headers;
  Response response;
  SendContent(request, MakeByteSource("0123456789"), "text/plain", "tag", response);
  return response;
}

TEST(SendContent, WholePartAndNothing) {
  EXPECT_EQ(Send({}).status, 200);
  EXPECT_EQ(Send({}).source_length, 10u);
  const Response part = Send({{"Range", "bytes=2-5"}});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.source_offset, 2u);
  EXPECT_EQ(part.source_length, 4u);
  EXPECT_EQ(Send({{"if-none-match", "\"tag\""}, {"Range", "bytes=50-"}}).status, 304);
  EXPECT_EQ(Send({{"Range", "bytes=50-"}}).status, 416);
}

TEST(SendContent, IfRangeOfOtherBytesGetsTheWhole) {
  EXPECT_EQ(Send({{"Range", "bytes=2-5"}, {"If-Range", "\"tag\""}}).status, 206);
  EXPECT_EQ(Send({{"Range", "bytes=2-5"}, {"If-Range", "\"other\""}}).status, 200);
}

TEST(StatusMap, KindsAndProtocolCodes) {
  EXPECT_EQ(HttpStatusOf(Status::Ok()), 200);
  EXPECT_EQ(HttpStatusOf(InvalidArgument("x", "y")), 400);
  EXPECT_EQ(HttpStatusOf(InvalidArgument("method_not_allowed", "y")), 405);
  EXPECT_EQ(HttpStatusOf(Status(StatusKind::kInsufficientStorage, "disk_full", "")), 507);
  for (int kind = 1; kind <= static_cast<int>(StatusKind::kInsufficientStorage); ++kind) {
    EXPECT_GE(HttpStatusOf(Status(static_cast<StatusKind>(kind), "x", "")), 400);
  }
  EXPECT_EQ(ErrorBody(InvalidArgument("c", "m", "f")).dump(), R"({"error":{"code":"c","message":"m","field":"f"}})");
}

}  // namespace
}  // namespace drupe
