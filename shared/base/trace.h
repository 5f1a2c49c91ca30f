#pragma once

#include <string>

namespace drupe {

/// The request on whose behalf this thread works, from the first service that heard it to the report; "" for none. Log
/// adds it to every line, a job keeps it, and calls to other services pass it on as X-Request-Id.
const std::string& CurrentTrace();

/// Sets CurrentTrace() of this thread for as long as it lives.
class TraceScope {
 public:
  explicit TraceScope(std::string trace);
  ~TraceScope();
  TraceScope(const TraceScope&) = delete;
  TraceScope& operator=(const TraceScope&) = delete;

 private:
  std::string former_;
};

/// Whether a trace that came from outside may be taken over: 1 to 64 characters of [A-Za-z0-9._-].
bool IsTrace(const std::string& text);

}  // namespace drupe
