#pragma once

#include <vector>

#include "capture/camera/camera_directory.h"

namespace drupe {

/// Searches all networks and USB ports; takes about a second. One call at a time in a process.
std::vector<CameraInfo> SearchWithAravis();

}  // namespace drupe
