#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"

namespace drupe {

/// What a request needs leave for. kByMethod: kRead for GET, kSubmit for everything else.
enum class Scope { kNone, kByMethod, kRead, kSubmit, kStore, kAdmin };

/// One token as the secrets file has it: never the token itself, only its digest.
struct AccessToken {
  std::string name;    ///< of who holds it, for the log
  std::string sha256;  ///< of the token
  bool read = false, submit = false, admin = false;
  bool store = false;          ///< reads, writes and removes objects by their digests: a compute machine
  double requests_per_s = 50;  ///< sustained; twice as many at once
  int max_concurrent = 16;     ///< requests being answered

  /// admin includes everything.
  bool Allows(Scope scope) const;
};

/// {"tokens": [{"name", "sha256", "scopes": ["read", "submit", "store", "admin"], "requests_per_s"?,
/// "max_concurrent"?}]}. Errors: those of reading and parsing, 400 `invalid_tokens`.
Result<std::vector<AccessToken>> ReadTokens(const std::filesystem::path& file);

/// Who may do what, and how often. Thread-safe.
class AccessControl {
 public:
  using Clock = std::chrono::steady_clock;

  explicit AccessControl(std::vector<AccessToken> tokens);
  ~AccessControl();

  /// A request under way; it takes one of its token's places for as long as it lives.
  class Pass {
   public:
    Pass() = default;
    ~Pass();
    Pass(Pass&& other) noexcept;
    Pass& operator=(Pass&&) = delete;
    /// The token's name.
    const std::string& name() const { return name_; }

   private:
    friend class AccessControl;
    Pass(AccessControl& access, std::size_t number, std::string name)
        : access_(&access), number_(number), name_(std::move(name)) {}

    AccessControl* access_ = nullptr;
    std::size_t number_ = 0;
    std::string name_;
  };

  /// Lets in a request whose header Authorization is `authorization` ("Bearer TOKEN"). Errors: 401 `token_missing`,
  /// `token_unknown`, 403 `scope_missing`, 429 `rate_limited`, `too_many_requests_at_once`.
  Result<Pass> Admit(std::string_view authorization, Scope scope, Clock::time_point now = Clock::now());

 private:
  struct Usage;

  /// The number of the token; every known digest is compared, in constant time. tokens_.size() for none.
  std::size_t Find(std::string_view token) const;
  void Leave(std::size_t number);

  const std::vector<AccessToken> tokens_;
  std::mutex mutex_;
  std::vector<Usage> usage_;
};

}  // namespace drupe
