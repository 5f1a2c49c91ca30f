#include "cli/bench/truth_cloud.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "base/files.h"
#include "image/decode.h"
#include "scene/ply.h"

namespace drupe {

namespace {

Result<DefectMap> LoadDefectMap(const std::string& path, const Json& fruit) {
  DefectMap map;
  const Json centre = fruit.value("centre_mm", Json());
  if (!centre.is_array() || centre.size() != 3)
    return InvalidArgument("bad_truth", "truth.json: a fruit has no centre");
  for (int axis = 0; axis < 3; ++axis) {
    if (!centre[axis].is_number()) return InvalidArgument("bad_truth", "truth.json: a centre is not three numbers");
    map.centre[axis] = centre[axis].get<double>();
  }
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path));
  DRUPE_ASSIGN_OR_RETURN(map.labels, DecodeGray(bytes));
  return map;
}

}  // namespace

Result<PointCloud> CloudOfSet(const TruthSet& set, const std::string& clouds, DenseOptions::Scene scene) {
  if (!clouds.empty()) {
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(clouds + "/" + set.name + "/dense.ply"));
    return ReadPly(bytes);
  }
  ReconstructionOptions options;
  options.dense.scene = scene;
  DRUPE_ASSIGN_OR_RETURN(ReconstructionOutput output, RunReconstruction(set.input, options, RunContext()));
  return std::move(output.cloud);
}

std::uint8_t DefectMap::LabelAt(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d d = (point - centre).normalized();
  const double azimuth = std::atan2(d.y(), d.x()) / (2 * std::numbers::pi);
  const double polar = std::acos(std::clamp(d.z(), -1.0, 1.0)) / std::numbers::pi;
  const int column = static_cast<int>((azimuth < 0 ? azimuth + 1 : azimuth) * labels.width());
  const int row = static_cast<int>(polar * labels.height());
  return labels.At(std::min(column, labels.width() - 1), std::min(row, labels.height() - 1));
}

Result<std::vector<DefectMap>> LoadDefectMaps(const TruthSet& set) {
  std::vector<DefectMap> maps;
  if (!set.truth.contains("fruits")) {
    const std::string path = set.directory + "/labels.png";
    if (!std::filesystem::exists(path)) return maps;
    DRUPE_ASSIGN_OR_RETURN(DefectMap map, LoadDefectMap(path, set.truth));
    maps.push_back(std::move(map));
    return maps;
  }
  for (const Json& fruit : set.truth["fruits"]) {
    const std::string name = "/labels-" + std::to_string(maps.size()) + ".png";
    DRUPE_ASSIGN_OR_RETURN(DefectMap map, LoadDefectMap(set.directory + name, fruit));
    maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace drupe
