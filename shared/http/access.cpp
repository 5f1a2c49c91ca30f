#include "http/access.h"

#include <algorithm>
#include <utility>

#include "base/digest.h"
#include "base/files.h"
#include "base/json.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr std::size_t kMaxTokenBytes = 512;
constexpr std::string_view kBearer = "Bearer ";

Status BadTokens(const std::string& why) {
  return InvalidArgument("invalid_tokens", "the file of tokens: " + why, "tokens");
}

Status AddScope(const Json& scope, AccessToken& token) {
  if (scope == "read") {
    token.read = true;
  } else if (scope == "submit") {
    token.submit = true;
  } else if (scope == "store") {
    token.store = true;
  } else if (scope == "admin") {
    token.admin = true;
  } else {
    return BadTokens("a scope is \"read\", \"submit\", \"store\" or \"admin\"");
  }
  return Status::Ok();
}

Result<AccessToken> ParseToken(const Json& json) {
  AccessToken token;
  try {
    token.name = json.at("name");
    token.sha256 = json.at("sha256");
    token.requests_per_s = json.value("requests_per_s", token.requests_per_s);
    token.max_concurrent = json.value("max_concurrent", token.max_concurrent);
    for (const Json& scope : json.at("scopes")) DRUPE_RETURN_IF_ERROR(AddScope(scope, token));
  } catch (const Json::exception& error) {
    return BadTokens(error.what());
  }
  if (token.name.empty() || !IsSha256Hex(token.sha256)) {
    return BadTokens("a token has a name, and as sha256 the 64 hexadecimal digits of its digest");
  }
  if (token.requests_per_s <= 0 || token.max_concurrent < 1) return BadTokens("limits must be positive");
  return token;
}

/// Whether two digests are equal, in a time that tells nothing of where they differ.
bool SameDigest(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

}  // namespace

bool AccessToken::Allows(Scope scope) const {
  switch (scope) {
    case Scope::kNone:
      return true;
    case Scope::kRead:
      return read || admin;
    case Scope::kSubmit:
      return submit || admin;
    case Scope::kStore:
      return store || admin;
    default:
      return admin;
  }
}

Result<std::vector<AccessToken>> ReadTokens(const std::filesystem::path& file) {
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxFileBytes));
  DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(text));
  if (!json.is_object() || !json.contains("tokens") || !json["tokens"].is_array() || json["tokens"].empty()) {
    return BadTokens("it must be {\"tokens\": [...]} with at least one");
  }
  std::vector<AccessToken> tokens;
  for (const Json& entry : json["tokens"]) {
    DRUPE_ASSIGN_OR_RETURN(AccessToken token, ParseToken(entry));
    tokens.push_back(std::move(token));
  }
  return tokens;
}

/// What a token has used: a bucket that fills at its rate and holds two seconds' worth (a token bucket), and places.
struct AccessControl::Usage {
  double allowance = 0;
  Clock::time_point filled_at;
  int under_way = 0;
};

AccessControl::AccessControl(std::vector<AccessToken> tokens) : tokens_(std::move(tokens)) {
  for (const AccessToken& token : tokens_) usage_.push_back({2 * token.requests_per_s, Clock::now(), 0});
}

AccessControl::~AccessControl() = default;

AccessControl::Pass::Pass(Pass&& other) noexcept
    : access_(std::exchange(other.access_, nullptr)), number_(other.number_), name_(std::move(other.name_)) {}

AccessControl::Pass::~Pass() {
  if (access_ != nullptr) access_->Leave(number_);
}

void AccessControl::Leave(std::size_t number) {
  const std::lock_guard lock(mutex_);
  --usage_[number].under_way;
}

std::size_t AccessControl::Find(std::string_view token) const {
  const std::string digest = Sha256Hex(token);
  std::size_t found = tokens_.size();
  for (std::size_t i = 0; i < tokens_.size(); ++i) {
    if (SameDigest(tokens_[i].sha256, digest)) found = i;
  }
  return found;
}

Result<AccessControl::Pass> AccessControl::Admit(std::string_view authorization, Scope scope, Clock::time_point now) {
  if (!authorization.starts_with(kBearer) || authorization.size() > kMaxTokenBytes) {
    return Status(StatusKind::kUnauthorized, "token_missing", "this service asks for Authorization: Bearer TOKEN");
  }
  const std::size_t number = Find(authorization.substr(kBearer.size()));
  if (number == tokens_.size()) return Status(StatusKind::kUnauthorized, "token_unknown", "there is no such token");
  const AccessToken& token = tokens_[number];
  if (!token.Allows(scope)) {
    return Status(StatusKind::kForbidden, "scope_missing", "the token of " + token.name + " has no scope for this");
  }
  const std::lock_guard lock(mutex_);
  Usage& usage = usage_[number];
  const double elapsed_s = std::max(0.0, std::chrono::duration<double>(now - usage.filled_at).count());
  usage.allowance = std::min(2 * token.requests_per_s, usage.allowance + elapsed_s * token.requests_per_s);
  usage.filled_at = std::max(usage.filled_at, now);
  if (usage.allowance < 1) {
    return Status(StatusKind::kTooManyRequests, "rate_limited",
                  "the token of " + token.name + " has used up its requests; try again later");
  }
  if (usage.under_way >= token.max_concurrent) {
    return Status(
        StatusKind::kTooManyRequests, "too_many_requests_at_once",
        "the token of " + token.name + " may have " + std::to_string(token.max_concurrent) + " requests under way");
  }
  usage.allowance -= 1;
  ++usage.under_way;
  return Pass(*this, number, token.name);
}

}  // namespace drupe
