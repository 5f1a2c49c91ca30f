#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// A serial line that carries lines of text. Errors: 503 `table_unreachable`.
class SerialLine {
 public:
  /// Opens a terminal device raw, 8N1, at `baud` (9600, 19200, 38400, 57600, 115200, 230400), for this process alone.
  static Result<std::unique_ptr<SerialLine>> Open(const std::string& device, int baud = 115200);
  ~SerialLine();
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  /// From any thread; short texts are not torn apart.
  Status Write(std::string_view text);
  /// The next line without its end; nothing when none has come in time. Lines beyond 512 bytes are cut.
  Result<std::optional<std::string>> ReadLine(std::chrono::milliseconds timeout);
  /// Forgets what has arrived and was not read.
  void Discard();

 private:
  SerialLine(int fd, std::string device) : fd_(fd), device_(std::move(device)) {}
  Status Fail(std::string_view operation) const;
  std::optional<std::string> TakeLine();
  /// Reads what has arrived; false when nothing has until `deadline`.
  Result<bool> Receive(std::chrono::steady_clock::time_point deadline);

  const int fd_;
  const std::string device_;
  std::string received_;
};

}  // namespace drupe
