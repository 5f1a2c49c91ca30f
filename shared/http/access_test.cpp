#include "http/access.h"

#include <gtest/gtest.h>

#include "base/digest.h"
#include "base/files.h"
#include "base/ids.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

class AccessTest : public testing::Test {
 protected:
  ~AccessTest() override { std::filesystem::remove(file_); }

  Result<std::vector<AccessToken>> Read(const std::string& text) {
    EXPECT_TRUE(WriteFileAtomically(file_, text).ok());
    return ReadTokens(file_);
  }
  static AccessToken Token(const std::string& secret) {
    return {.name = "rig", .sha256 = Sha256Hex(secret), .read = true, .requests_per_s = 2, .max_concurrent = 2};
  }

  const std::filesystem::path file_ = std::filesystem::temp_directory_path() / NewId("tokens");
  const AccessControl::Clock::time_point now_ = AccessControl::Clock::now();
};

TEST_F(AccessTest, ReadsTheFile) {
  const auto tokens =
      Read(R"({"tokens": [{"name": "rig", "sha256": ")" + Sha256Hex("s") + R"(", "scopes": ["read", "submit"]}]})");
  ASSERT_TRUE(tokens.ok()) << tokens.status().ToString();
  EXPECT_EQ(tokens->at(0).name, "rig");
  EXPECT_TRUE(tokens->at(0).submit);
  EXPECT_FALSE(tokens->at(0).admin);
}

TEST_F(AccessTest, RefusesBadFiles) {
  const std::string digest = Sha256Hex("s");
  for (const std::string& text : {std::string("{}"), std::string(R"({"tokens": []})"),
                                  R"({"tokens": [{"name": "a", "sha256": "plain", "scopes": []}]})" + std::string(),
                                  R"({"tokens": [{"name": "a", "sha256": ")" + digest + R"(", "scopes": ["all"]}]})",
                                  R"({"tokens": [{"sha256": ")" + digest + R"(", "scopes": []}]})"}) {
    EXPECT_EQ(Read(text).status().code(), "invalid_tokens") << text;
  }
}

TEST_F(AccessTest, LetsInKnownTokensWithTheScope) {
  AccessControl access({Token("secret")});
  EXPECT_EQ(access.Admit("Bearer secret", Scope::kRead, now_)->name(), "rig");
  EXPECT_EQ(access.Admit("Bearer secret", Scope::kSubmit, now_).status().code(), "scope_missing");
  EXPECT_EQ(access.Admit("Bearer secret", Scope::kAdmin, now_).status().kind(), StatusKind::kForbidden);
  EXPECT_EQ(access.Admit("Bearer other", Scope::kRead, now_).status().code(), "token_unknown");
  EXPECT_EQ(access.Admit("Basic c2VjcmV0", Scope::kRead, now_).status().code(), "token_missing");
  EXPECT_EQ(access.Admit("", Scope::kRead, now_).status().kind(), StatusKind::kUnauthorized);
}

TEST_F(AccessTest, AdminMayDoEverything) {
  AccessToken token = Token("secret");
  token.read = false;
  token.admin = true;
  for (const Scope scope : {Scope::kRead, Scope::kSubmit, Scope::kAdmin}) EXPECT_TRUE(token.Allows(scope));
}

TEST_F(AccessTest, LimitsTheRate) {
  AccessControl access({Token("secret")});
  for (int i = 0; i < 4; ++i)
    EXPECT_TRUE(access.Admit("Bearer secret", Scope::kRead, now_).ok()) << "two seconds' worth";
  EXPECT_EQ(access.Admit("Bearer secret", Scope::kRead, now_).status().code(), "rate_limited");
  EXPECT_TRUE(access.Admit("Bearer secret", Scope::kRead, now_ + milliseconds(600)).ok());
}

TEST_F(AccessTest, LimitsRequestsUnderWay) {
  AccessControl access({Token("secret")});
  auto first = access.Admit("Bearer secret", Scope::kRead, now_);
  {
    const auto second = access.Admit("Bearer secret", Scope::kRead, now_);
    EXPECT_EQ(access.Admit("Bearer secret", Scope::kRead, now_).status().code(), "too_many_requests_at_once");
  }
  EXPECT_TRUE(access.Admit("Bearer secret", Scope::kRead, now_).ok()) << "a place was given back";
}

}  // namespace
}  // namespace drupe
