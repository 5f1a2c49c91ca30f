#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "capture/turntable/turntable.h"

namespace drupe {

/// What goes on at the rig now, shared between the scan that runs and those who watch it. Thread-safe.
class RigState {
 public:
  /// The latest picture of a scan, reduced, as JPEG; kept or not, so that the user sees what the camera sees.
  void ShowPreview(std::string_view scan, std::string jpeg);

  struct Preview {
    std::string jpeg;
    std::int64_t number = 0;  ///< grows with every picture
  };
  /// Nothing for a scan that has not taken a picture in this process, or none since the one that is `seen`.
  std::optional<Preview> PreviewOf(std::string_view scan, std::int64_t seen = 0) const;

  /// The table that is driven now; nullptr when none is.
  void SetTable(Turntable* table);
  /// Stops the table whatever it costs; false when none is driven.
  bool EmergencyStop();

 private:
  mutable std::mutex mutex_;
  std::string scan_;
  Preview preview_;
  Turntable* table_ = nullptr;
};

}  // namespace drupe
