#include "cli/labelled_clouds.h"

#include "base/files.h"

namespace drupe {

Result<LabelledColours> LoadLabelledCloud(const std::string& cloud, const std::string& labels) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(cloud));
  if (labels == "property") return ReadLabelledPly(bytes);
  DRUPE_ASSIGN_OR_RETURN(const PointCloud points, ReadPly(bytes));
  if (points.colours.empty()) return Unprocessable("no_labels", cloud + " has no colours");
  DRUPE_ASSIGN_OR_RETURN(const std::string surface_bytes, ReadFile(labels));
  DRUPE_ASSIGN_OR_RETURN(const PointCloud surface, ReadPly(surface_bytes));
  return LabelBySurface(points, surface.positions);
}

}  // namespace drupe
