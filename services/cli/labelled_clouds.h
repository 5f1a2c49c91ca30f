#pragma once

#include <string>

#include "base/status.h"
#include "defect_analysis/models/labelled_colours.h"

namespace drupe {

/// Reads a cloud and labels its points. `labels`: "property", for a cloud whose vertices have a property label; or a
/// PLY file with points of the fruit's surface in the cloud's frame. Errors: those of ReadPly and ReadLabelledPly.
Result<LabelledColours> LoadLabelledCloud(const std::string& cloud, const std::string& labels);

}  // namespace drupe
