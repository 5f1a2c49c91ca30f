#include "http/router.h"

#include <gtest/gtest.h>

#include "http/request_head.h"

namespace drupe {
namespace {

class RouterTest : public testing::Test {
 protected:
  RouterTest() {
    const auto none = [](const Request&, Response&) {};
    router_.Add("GET", "/jobs", {}, none);
    router_.Add("GET", "/jobs/{id:rec}", {}, none);
    router_.Add("DELETE", "/jobs/{id:rec}", {}, none);
    router_.Add("GET", "/jobs/{id:rec}.csv", {}, none);
    router_.Add("GET", "/jobs/{id:rec}/artifacts/{name}", {}, none);
  }

  /// The pattern found, or the error's code.
  std::string Find(std::string_view method, std::string_view path) {
    const auto route = router_.Find(method, path, request_, allowed_);
    return route.ok() ? (*route)->pattern : route.status().code();
  }

  Router router_;
  Request request_;
  std::string allowed_;
};

TEST_F(RouterTest, Nominal) {
  EXPECT_EQ(Find("GET", "/jobs"), "/jobs");
  EXPECT_EQ(Find("HEAD", "/jobs"), "/jobs");
  EXPECT_EQ(Find("GET", "/jobs/rec_abc"), "/jobs/{id:rec}");
  EXPECT_EQ(request_.Capture("id"), "rec_abc");
  EXPECT_EQ(Find("GET", "/jobs/rec_abc.csv"), "/jobs/{id:rec}.csv");
  EXPECT_EQ(request_.Capture("id"), "rec_abc");
  EXPECT_EQ(Find("GET", "/jobs/rec_abc/artifacts/dense%2Eply"), "/jobs/{id:rec}/artifacts/{name}");
  EXPECT_EQ(request_.Capture("name"), "dense.ply");
}

TEST_F(RouterTest, OnlyValidCapturesReachAHandler) {
  for (const char* path :
       {"/jobs/img_abc", "/jobs/rec_", "/jobs/rec_A", "/jobs/rec_abc%2f..", "/jobs/rec_abc/artifacts/..",
        "/jobs/rec_abc/artifacts/%2e%2e", "/jobs/rec_abc/artifacts/..%2f..%2fetc%2fpasswd", "/jobs/rec_abc/artifacts/",
        "/jobs/rec_abc/artifacts/a/b", "/jobs/rec_abc/artifacts/.hidden", "/jobs//rec_abc", "//jobs", "/jobs/", "/"}) {
    EXPECT_EQ(Find("GET", path), "unknown_route") << path;
  }
}

TEST_F(RouterTest, BadPaths) {
  for (const char* path : {"jobs", "", "/jobs/%", "/jobs/%4", "/jobs/%zz", "/jobs/rec_a%00b", "/jobs/%0d%0a",
                           "/1/2/3/4/5/6/7/8/9/10/11/12/13/14/15/16/17"}) {
    EXPECT_EQ(Find("GET", path), "invalid_path") << path;
  }
}

TEST_F(RouterTest, OtherMethod) {
  EXPECT_EQ(Find("POST", "/jobs/rec_abc"), "method_not_allowed");
  EXPECT_EQ(allowed_, "GET, DELETE");
  EXPECT_EQ(Find("get", "/jobs"), "method_not_allowed");
}

std::string HeadCode(const std::string& text) {
  const Result<RequestHead> head = ParseRequestHead(text);
  return head.ok() ? "ok" : head.status().code();
}

TEST(RequestHead, Nominal) {
  const auto head = ParseRequestHead(
      "POST /a/b?x=1&y=%20 HTTP/1.1\r\nHost: h\r\ncontent-length: 12\r\n"
      "Expect: 100-Continue\r\nConnection: keep-alive, Close\r\n\r\n");
  ASSERT_TRUE(head.ok());
  EXPECT_EQ(head->method, "POST");
  EXPECT_EQ(head->path, "/a/b");
  EXPECT_EQ(head->query, "x=1&y=%20");
  EXPECT_EQ(head->content_length, 12u);
  EXPECT_TRUE(head->expects_continue);
  EXPECT_FALSE(head->keep_alive);
}

TEST(RequestHead, AmbiguousOrMalformed) {
  const std::string line = "POST / HTTP/1.1\r\n";
  const std::string host = "Host: h\r\n";
  for (const std::string& text :
       {std::string("GET /\r\n\r\n"), std::string("GET / HTTP/1.1\r\n\r\n"), line + host + host + "\r\n",
        line + host + "Content-Length: 1\r\nContent-Length: 1\r\n\r\n", line + host + "Content-Length: 1, 1\r\n\r\n",
        line + host + "Content-Length: +1\r\n\r\n", line + host + "Content-Length: -1\r\n\r\n",
        line + host + "Content-Length:\r\n\r\n", line + host + "Content-Length: 99999999999999999999\r\n\r\n",
        line + host + "X : y\r\n\r\n", line + host + " folded\r\n\r\n", line + host + "X: a\x01\r\n\r\n",
        line + host + "X: a\nY: b\r\n\r\n", line + host + "no colon\r\n\r\n",
        std::string("GET http://h/ HTTP/1.1\r\nHost: h\r\n\r\n"), std::string("GET * HTTP/1.1\r\nHost: h\r\n\r\n"),
        std::string("GET /a b HTTP/1.1\r\nHost: h\r\n\r\n"), std::string("G(T / HTTP/1.1\r\nHost: h\r\n\r\n")}) {
    EXPECT_EQ(HeadCode(text), "invalid_request") << text;
  }
}

TEST(RequestHead, RefusedFeatures) {
  const std::string start = "POST / HTTP/1.1\r\nHost: h\r\n";
  EXPECT_EQ(HeadCode(start + "Transfer-Encoding: chunked\r\n\r\n"), "length_required");
  EXPECT_EQ(HeadCode(start + "Transfer-Encoding: identity\r\nContent-Length: 3\r\n\r\n"), "length_required");
  EXPECT_EQ(HeadCode(start + "Content-Encoding: gzip\r\n\r\n"), "unsupported_encoding");
  EXPECT_EQ(HeadCode(start + "Content-Encoding: identity\r\n\r\n"), "ok");
  EXPECT_EQ(HeadCode(start + "Expect: tea\r\n\r\n"), "expectation_failed");
  EXPECT_EQ(HeadCode("GET / HTTP/2.0\r\nHost: h\r\n\r\n"), "unsupported_version");
  EXPECT_EQ(HeadCode("GET /" + std::string(2048, 'a') + " HTTP/1.1\r\nHost: h\r\n\r\n"), "target_too_long");
  std::string many = start;
  for (int i = 0; i < 64; ++i) many += "X: y\r\n";
  EXPECT_EQ(HeadCode(many + "\r\n"), "headers_too_large");
}

TEST(Query, DecodesAndRefuses) {
  const auto query = ParseQuery("a=1&b=x%26+y&a=2&c");
  ASSERT_TRUE(query.ok());
  EXPECT_EQ(query->at("a"), "2");
  EXPECT_EQ(query->at("b"), "x& y");
  EXPECT_EQ(query->at("c"), "");
  EXPECT_FALSE(ParseQuery("a=%").ok());
  EXPECT_FALSE(ParseQuery("a=%00").ok());
  std::string many;
  for (int i = 0; i < 33; ++i) many += "a" + std::to_string(i) + "=1&";
  EXPECT_FALSE(ParseQuery(many).ok());
}

}  // namespace
}  // namespace drupe
