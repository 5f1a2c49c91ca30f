#include "base/trace.h"

#include <algorithm>
#include <utility>

namespace drupe {

namespace {

constexpr std::size_t kMaxTraceBytes = 64;

thread_local std::string current_trace;

bool IsAllowed(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

}  // namespace

const std::string& CurrentTrace() {
  return current_trace;
}

TraceScope::TraceScope(std::string trace) : former_(std::exchange(current_trace, std::move(trace))) {}

TraceScope::~TraceScope() {
  current_trace = std::move(former_);
}

bool IsTrace(const std::string& text) {
  return !text.empty() && text.size() <= kMaxTraceBytes && std::all_of(text.begin(), text.end(), IsAllowed);
}

}  // namespace drupe
