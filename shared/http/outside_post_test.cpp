#include "http/outside_post.h"

#include <gtest/gtest.h>

#include <thread>

#include "http/server.h"

namespace drupe {
namespace {

TEST(ParseOutsideUrl, TakesApartWhatIsWellFormed) {
  const OutsideUrl plain = ParseOutsideUrl("http://example.org").value();
  EXPECT_EQ(plain.host, "example.org");
  EXPECT_EQ(plain.port, 80);
  EXPECT_EQ(plain.path, "/");
  const OutsideUrl full = ParseOutsideUrl("https://hooks.example.org:8443/a/b?c=d").value();
  EXPECT_TRUE(full.tls);
  EXPECT_EQ(full.port, 8443);
  EXPECT_EQ(full.path, "/a/b?c=d");
  EXPECT_EQ(ParseOutsideUrl("http://[2001:4860::1]:81/x").value().host, "2001:4860::1");
}

TEST(ParseOutsideUrl, RefusesTheRest) {
  for (const std::string& url :
       {std::string("ftp://host/"), std::string("http://"), std::string("http://user@host/"), std::string("//host"),
        std::string("http://host:0/"), std::string("http://host:99999/"), std::string("http://ho st/"),
        std::string("http://host/\r\nX: y"), std::string("http://host/#x"), std::string("http://[::1"),
        "http://host/" + std::string(3000, 'a')}) {
    EXPECT_EQ(ParseOutsideUrl(url).status().code(), "invalid_webhook") << url;
  }
}

TEST(IsPublicAddress, KnowsTheSpecialOnes) {
  for (const char* address : {"8.8.8.8", "93.184.216.34", "172.32.0.1", "2606:2800:220:1::1"}) {
    EXPECT_TRUE(IsPublicAddress(address)) << address;
  }
  for (const char* address : {"127.0.0.1",
                              "127.9.9.9",
                              "0.0.0.0",
                              "10.1.2.3",
                              "172.16.0.1",
                              "172.31.255.255",
                              "192.168.1.1",
                              "169.254.169.254",
                              "100.64.0.1",
                              "224.0.0.1",
                              "255.255.255.255",
                              "::1",
                              "::",
                              "fe80::1",
                              "fc00::1",
                              "fd12::1",
                              "ff02::1",
                              "::ffff:127.0.0.1",
                              "::ffff:10.0.0.1",
                              "64:ff9b::7f00:1",
                              "2002:7f00:1::",
                              "2001:db8::1",
                              "localhost",
                              ""}) {
    EXPECT_FALSE(IsPublicAddress(address)) << address;
  }
}

TEST(ResolveOutside, LooksAtTheAddressBehindTheName) {
  const OutsideUrl local = ParseOutsideUrl("http://localhost/").value();
  EXPECT_EQ(ResolveOutside(local, {}).status().code(), "webhook_refused");
  EXPECT_EQ(ResolveOutside(ParseOutsideUrl("http://2130706433/").value(), {}).status().kind() == StatusKind::kOk, false)
      << "127.0.0.1 as one number";
  EXPECT_TRUE(ResolveOutside(local, {"localhost"}).ok());
}

TEST(PostOutside, SendsToAHostThatIsAllowedAndTellsHowItAnswered) {
  Server server({}, nullptr);
  std::string received, header;
  server.router().Add("POST", "/taken", {}, [&](const Request& request, Response&) {
    received = ReadBody(request, 1000).value();
    header = request.Header("X-Test");
  });
  server.router().Add("POST", "/moved", {}, [](const Request&, Response& response) {
    response.status = 302;
    response.SetHeader("Location", "/taken");
  });
  ASSERT_TRUE(server.Bind().ok());
  std::thread listener([&] { (void)server.Serve(); });
  const auto post = [&](const std::string& path, const std::set<std::string>& allowed) {
    const std::string url = "http://localhost:" + std::to_string(server.port()) + path;
    return PostOutside(ParseOutsideUrl(url).value(), "{}", {{"X-Test", "yes"}}, {.allowed_hosts = allowed});
  };
  EXPECT_TRUE(post("/taken", {"localhost"}).ok());
  EXPECT_EQ(received + header, "{}yes");
  EXPECT_EQ(post("/moved", {"localhost"}).code(), "webhook_not_taken");
  EXPECT_EQ(post("/taken", {"other"}).code(), "webhook_refused");
  server.Stop();
  listener.join();
}

}  // namespace
}  // namespace drupe
