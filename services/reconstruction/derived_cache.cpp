#include "reconstruction/derived_cache.h"

#include "base/digest.h"
#include "base/files.h"
#include "base/version.h"

namespace drupe {
namespace {

/// The version, and the digest of the program itself: what two builds of one version compute may differ.
const std::string& BuildId() {
  static const std::string id = [] {
    constexpr std::size_t kMaxProgramBytes = std::size_t{1} << 30;
    const Result<std::string> program = ReadFile("/proc/self/exe", kMaxProgramBytes);
    return std::string(kVersion) + (program.ok() ? "-" + Sha256Hex(*program) : "");
  }();
  return id;
}

}  // namespace

std::string DerivedKey(const std::string& kind, const Json& parameters) {
  return Sha256Hex(DumpJson({{"kind", kind}, {"build", BuildId()}, {"parameters", parameters}}));
}

}  // namespace drupe
