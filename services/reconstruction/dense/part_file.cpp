#include "reconstruction/dense/part_file.h"

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <span>
#include <utility>

#include "base/json.h"
#include "reconstruction/dense/packed_cells.h"

namespace drupe::dense {

namespace {

constexpr int kContext = 2;  ///< cells about a wanted one that its guess may be blended from

template <typename Values>
Json ArrayOf(const Values& values) {
  Json array = Json::array();
  for (const auto& value : values) array.push_back(value);
  return array;
}

Json CameraJson(const PinholeCamera& camera) {
  Json json = {{"size", {camera.width, camera.height}}, {"pinhole", {camera.fx, camera.fy, camera.cx, camera.cy}}};
  json["dist"] = ArrayOf(camera.dist);
  return json;
}

Json BoxJson(const RegionOfInterest& region) {
  if (!region.box) return nullptr;
  const Eigen::Vector3d least = region.box->min(), most = region.box->max();
  return {least.x(), least.y(), least.z(), most.x(), most.y(), most.z()};
}

/// The part's views: those of `work`, then their neighbours.
std::vector<int> ViewsOf(const DenseScene& scene, const std::vector<ViewWork>& work) {
  std::vector<int> views;
  const auto add = [&](int view) {
    if (std::find(views.begin(), views.end(), view) == views.end()) views.push_back(view);
  };
  for (const ViewWork& one : work) add(one.view);
  for (const ViewWork& one : work) {
    for (const int neighbour : scene.neighbours[one.view]) add(neighbour);
  }
  return views;
}

Json ViewJson(const DenseScene& scene, int view) {
  const DenseView& dense = scene.views[view];
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = dense.cam_from_world.rotation;
  return {{"image", scene.model->views[dense.index].image},
          {"rotation", ArrayOf(std::span<const double>(rotation.data(), 9))},
          {"translation", ArrayOf(std::span<const double>(dense.cam_from_world.translation.data(), 3))}};
}

/// The flags, and those within kContext cells of one.
std::vector<std::uint8_t> WithContext(const std::vector<std::uint8_t>& flags, int cols, int rows) {
  std::vector<std::uint8_t> wider(flags.size(), 0);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      if (!flags[static_cast<std::size_t>(row) * cols + col]) continue;
      for (int y = std::max(0, row - kContext); y <= std::min(rows - 1, row + kContext); ++y) {
        const auto begin = wider.begin() + static_cast<std::ptrdiff_t>(y) * cols;
        std::fill(begin + std::max(0, col - kContext), begin + std::min(cols, col + kContext + 1), std::uint8_t{1});
      }
    }
  }
  return wider;
}

template <std::size_t kCount>
Result<std::array<double, kCount>> Numbers(const Json& json, const char* what) {
  std::array<double, kCount> numbers{};
  if (!ReadNumbers(json, numbers)) return BadPart(std::string(what) + " is no array of numbers");
  return numbers;
}

Status ReadCamera(const Json& json, PinholeCamera& camera) {
  DRUPE_ASSIGN_OR_RETURN(const auto size, Numbers<2>(json.at("size"), "size"));
  DRUPE_ASSIGN_OR_RETURN(const auto pinhole, Numbers<4>(json.at("pinhole"), "pinhole"));
  DRUPE_ASSIGN_OR_RETURN(camera.dist, Numbers<5>(json.at("dist"), "dist"));
  camera.width = static_cast<int>(size[0]), camera.height = static_cast<int>(size[1]);
  camera.fx = pinhole[0], camera.fy = pinhole[1], camera.cx = pinhole[2], camera.cy = pinhole[3];
  return Status::Ok();
}

Status ReadView(const Json& json, Part& part, std::string_view* bytes) {
  DRUPE_ASSIGN_OR_RETURN(const auto rotation, Numbers<9>(json.at("rotation"), "rotation"));
  DRUPE_ASSIGN_OR_RETURN(const auto translation, Numbers<3>(json.at("translation"), "translation"));
  DRUPE_ASSIGN_OR_RETURN(const auto silhouette, Numbers<3>(json.at("silhouette"), "silhouette"));
  DenseView view;
  view.index = static_cast<int>(part.scene.views.size());
  view.cam_from_world.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
  view.cam_from_world.translation = Eigen::Map<const Eigen::Vector3d>(translation.data());
  view.centre = view.cam_from_world.Centre();
  part.model.views.emplace_back();
  part.model.views.back().image = json.at("image").get<std::string>();
  part.scene.views.push_back(std::move(view));
  part.scene.neighbours.push_back(json.at("neighbours").get<std::vector<int>>());
  const auto cells = static_cast<std::size_t>(std::max(0.0, silhouette[1]) * std::max(0.0, silhouette[2]));
  if (cells > bytes->size()) return BadPart("a silhouette is cut off");
  part.scene.silhouettes.emplace_back(static_cast<int>(silhouette[0]), static_cast<int>(silhouette[1]),
                                      static_cast<int>(silhouette[2]),
                                      std::vector<std::uint8_t>(bytes->begin(), bytes->begin() + cells));
  bytes->remove_prefix(cells);
  return Status::Ok();
}

Status ReadWork(const Json& json, Part& part, std::string_view* bytes) {
  DRUPE_ASSIGN_OR_RETURN(const auto map, Numbers<5>(json.at("map"), "map"));
  PatchMap coarse;
  coarse.level = static_cast<int>(map[0]), coarse.csize = static_cast<int>(map[1]);
  coarse.cols = static_cast<int>(map[2]), coarse.rows = static_cast<int>(map[3]);
  coarse.unit = static_cast<float>(map[4]);
  const double cells = map[2] * map[3];
  if (!(map[2] >= 0 && map[3] >= 0 && cells <= kMaxCells)) return BadPart("a map is too large");
  coarse.cells.resize(static_cast<std::size_t>(cells));
  std::vector<std::uint8_t> wanted(coarse.cells.size(), 0);
  DRUPE_RETURN_IF_ERROR(TakeCells(json.at("cells").get<std::size_t>(), bytes, &coarse));
  DRUPE_RETURN_IF_ERROR(TakeFlags(json.at("wanted").get<std::size_t>(), bytes, &wanted));
  part.coarse.push_back(std::move(coarse));
  part.wanted.push_back(std::move(wanted));
  return Status::Ok();
}

Status CheckNeighbours(const Part& part) {
  const auto count = static_cast<int>(part.scene.views.size());
  for (const std::vector<int>& neighbours : part.scene.neighbours) {
    const bool known = std::all_of(neighbours.begin(), neighbours.end(), [&](int k) { return k >= 0 && k < count; });
    if (!known || neighbours.size() > 32) return BadPart("a neighbour is not among the views");
  }
  return part.coarse.size() <= part.scene.views.size() ? Status::Ok() : BadPart("there is more work than views");
}

Status ReadHead(const Json& head, Part& part, std::string_view bytes) {
  part.finest = head.at("finest").get<int>(), part.csize = head.at("csize").get<int>();
  if (part.finest < 0 || part.finest > 6 || part.csize < 1) return BadPart("its level is out of range");
  part.scene.typical_depth = head.at("typical_depth").get<double>();
  DRUPE_RETURN_IF_ERROR(ReadCamera(head.at("camera"), part.model.camera));
  if (!head.at("box").is_null()) {
    DRUPE_ASSIGN_OR_RETURN(const auto box, Numbers<6>(head.at("box"), "box"));
    part.scene.region.box =
        Eigen::AlignedBox3d(Eigen::Vector3d(box[0], box[1], box[2]), Eigen::Vector3d(box[3], box[4], box[5]));
  }
  for (const Json& view : head.at("views")) DRUPE_RETURN_IF_ERROR(ReadView(view, part, &bytes));
  for (const Json& work : head.at("work")) DRUPE_RETURN_IF_ERROR(ReadWork(work, part, &bytes));
  return CheckNeighbours(part);
}

}  // namespace

std::string WritePart(const LevelContext& fine, const std::vector<ViewWork>& work) {
  const DenseScene& scene = *fine.scene;
  const std::vector<int> views = ViewsOf(scene, work);
  std::map<int, int> place;
  for (std::size_t k = 0; k < views.size(); ++k) place[views[k]] = static_cast<int>(k);
  Json head = {{"finest", fine.level},
               {"csize", fine.csize},
               {"typical_depth", scene.typical_depth},
               {"camera", CameraJson(scene.model->camera)},
               {"box", BoxJson(scene.region)},
               {"views", Json::array()},
               {"work", Json::array()}};
  std::string bytes;
  for (std::size_t k = 0; k < views.size(); ++k) {
    Json view = ViewJson(scene, views[k]);
    view["neighbours"] = Json::array();
    for (const int neighbour : scene.neighbours[views[k]]) {
      if (k < work.size()) view["neighbours"].push_back(place.at(neighbour));
    }
    const Silhouette& silhouette = scene.silhouettes[views[k]];
    view["silhouette"] = {silhouette.block(), silhouette.cols(), silhouette.rows()};
    bytes.append(silhouette.background().begin(), silhouette.background().end());
    head["views"].push_back(std::move(view));
  }
  for (const ViewWork& one : work) {
    const PatchMap& map = *one.coarse;
    const std::size_t cells = AppendCells(map, WithContext(*one.wanted, map.cols, map.rows), &bytes);
    const std::size_t wanted = AppendFlags(*one.wanted, &bytes);
    head["work"].push_back(
        {{"map", {map.level, map.csize, map.cols, map.rows, map.unit}}, {"cells", cells}, {"wanted", wanted}});
  }
  return DumpJson(head) + "\n" + bytes;
}

Result<Part> ReadPart(std::string_view bytes) {
  DRUPE_ASSIGN_OR_RETURN(const Json head, TakeHead(&bytes));
  Part part;
  try {
    DRUPE_RETURN_IF_ERROR(ReadHead(head, part, bytes));
  } catch (const std::exception& error) {
    return BadPart(error.what());
  }
  return part;
}

}  // namespace drupe::dense
