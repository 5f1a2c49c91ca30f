#include "defect_analysis/report/defect_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "base/log.h"
#include "defect_analysis/report/defects_ply.h"
#include "defect_analysis/report/drawing.h"
#include "image/decode.h"
#include "image/encode.h"

namespace drupe {
namespace {

constexpr int kTile = 240;    // pixels a side of a defect's picture
constexpr int kCaption = 22;  // height of the caption below it
constexpr int kColumns = 5;   // of the contact sheet
constexpr int kMargin = 8;
constexpr double kSurroundings = 1.8;  // side of the cutout over the contour's extent
constexpr double kLeastSide = 40;      // pixels of the photograph
const Rgb8 kPaper(245, 245, 245), kInk(30, 30, 30);

// The contour in a view's pixels; nothing when a part of it lies outside the picture.
std::optional<std::vector<Eigen::Vector2d>> Project(const Defect& defect, const View& view,
                                                    const PinholeCamera& camera) {
  std::vector<Eigen::Vector2d> line;
  for (const Eigen::Vector3d& x : defect.contour_mm) {
    const auto pixel = camera.Project(*view.cam_from_world * x);
    if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width - 1 || pixel->y() > camera.height - 1) {
      return std::nullopt;
    }
    line.push_back(*pixel);
  }
  return line;
}

// Whether another fruit, taken for a ball, lies between a place and the camera.
bool IsHidden(const Eigen::Vector3d& from, const Eigen::Vector3d& camera, std::size_t own,
              const std::vector<Fruit>& fruits) {
  const Eigen::Vector3d way = (camera - from).normalized();
  for (std::size_t k = 0; k < fruits.size(); ++k) {
    const Eigen::Vector3d to = fruits[k].centre_mm - from;
    const double along = to.dot(way);
    if (k != own && along > 0 && (to - along * way).norm() < fruits[k].equatorial_diameter_mm / 2) return true;
  }
  return false;
}

std::string Caption(const Fruit& fruit, const Defect& defect) {
  char text[96];
  std::snprintf(text, sizeof text, "%d.%d %s %.2f mm2", fruit.id, defect.id, DefectClassName(defect.defect_class),
                defect.area_mm2);
  return text;
}

RgbImage DrawTile(const RgbImage& photograph, const std::vector<Eigen::Vector2d>& line, const Fruit& fruit,
                  const Defect& defect) {
  Eigen::Vector2d low = line.front(), high = low;
  for (const Eigen::Vector2d& p : line) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector2d centre = (low + high) / 2;
  const double side = std::max(kLeastSide, kSurroundings * (high - low).maxCoeff());
  RgbImage cut = CutOut(photograph, centre, side, kTile);
  std::vector<Eigen::Vector2d> drawn;
  for (const Eigen::Vector2d& p : line) {
    drawn.push_back(((p - centre) / side + Eigen::Vector2d::Constant(0.5)) * kTile - Eigen::Vector2d::Constant(0.5));
  }
  DrawClosedLine(drawn, 1.6, ClassColour(defect.defect_class), cut);
  RgbImage tile = Canvas(kTile, kTile + kCaption, kPaper);
  Paste(cut, 0, 0, tile);
  DrawText(Caption(fruit, defect), 4, kTile + 7, 1, kInk, tile);
  return tile;
}

RgbImage Sheet(const std::vector<RgbImage>& tiles, bool intact) {
  const int count = static_cast<int>(tiles.size());
  const int columns = std::clamp(count, 1, kColumns), rows = std::max(1, (count + kColumns - 1) / kColumns);
  const int across = kTile + kMargin, down = kTile + kCaption + kMargin;
  RgbImage sheet = Canvas(columns * across + kMargin, rows * down + kMargin, kPaper);
  for (int k = 0; k < count; ++k) {
    Paste(tiles[static_cast<std::size_t>(k)], kMargin + k % kColumns * across, kMargin + k / kColumns * down, sheet);
  }
  if (count == 0) DrawText(intact ? "no defects" : "no pictures", kMargin, kMargin, 2, kInk, sheet);
  return sheet;
}

struct Job {
  std::size_t fruit, defect;
  int view;
};

// Defects and their views, at most `most`.
std::vector<Job> JobsOf(const std::vector<Fruit>& fruits, const SparseModel& model, int most) {
  std::vector<Job> jobs;
  for (std::size_t f = 0; f < fruits.size(); ++f) {
    for (std::size_t d = 0; d < fruits[f].defects.size() && static_cast<int>(jobs.size()) < most; ++d) {
      const int view = BestView(fruits[f].defects[d], f, fruits, model);
      if (view >= 0) jobs.push_back({f, d, view});
    }
  }
  return jobs;
}

}  // namespace

int BestView(const Defect& defect, std::size_t fruit, const std::vector<Fruit>& fruits, const SparseModel& model) {
  int best = -1;
  double straightest = 0.1;  // cosine: more aslant than that shows nothing
  for (std::size_t k = 0; k < model.views.size(); ++k) {
    const View& view = model.views[k];
    if (!view.cam_from_world || defect.contour_mm.empty()) continue;
    const Eigen::Vector3d camera = view.cam_from_world->Centre();
    const double straight = defect.normal.dot((camera - defect.centre_mm).normalized());
    if (straight <= straightest || IsHidden(defect.centre_mm, camera, fruit, fruits)) continue;
    if (!Project(defect, view, model.camera)) continue;
    straightest = straight;
    best = static_cast<int>(k);
  }
  return best;
}

Result<DefectPictures> DrawDefects(const std::vector<Fruit>& fruits, const SparseModel& model,
                                   const PhotographSource& photographs, int most) {
  const std::vector<Job> jobs = JobsOf(fruits, model, most);
  std::vector<RgbImage> tiles(jobs.size());
  // Photograph by photograph, so that each is decoded once and one at a time is in memory.
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    std::optional<RgbImage> photograph;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      if (jobs[k].view != static_cast<int>(view)) continue;
      if (!photograph) {
        const Result<std::string> bytes = photographs(view);
        Result<RgbImage> decoded = bytes.ok() ? DecodeRgb(*bytes) : Result<RgbImage>(bytes.status());
        if (!decoded.ok()) {
          Log(LogLevel::kWarning, "no photograph for a defect's picture", {{"why", decoded.status().message()}});
          break;
        }
        photograph = std::move(*decoded);
      }
      const Fruit& fruit = fruits[jobs[k].fruit];
      const Defect& defect = fruit.defects[jobs[k].defect];
      const auto line = Project(defect, model.views[view], model.camera);
      if (line) tiles[k] = DrawTile(*photograph, *line, fruit, defect);
    }
  }
  DefectPictures pictures;
  std::vector<RgbImage> drawn;
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    if (tiles[k].empty()) continue;
    const Fruit& fruit = fruits[jobs[k].fruit];
    const std::string name =
        "defect_" + std::to_string(fruit.id) + "_" + std::to_string(fruit.defects[jobs[k].defect].id) + ".png";
    DRUPE_ASSIGN_OR_RETURN(pictures.files[name], EncodePng(tiles[k]));
    drawn.push_back(std::move(tiles[k]));
  }
  const bool intact = std::ranges::all_of(fruits, [](const Fruit& fruit) { return fruit.defects.empty(); });
  DRUPE_ASSIGN_OR_RETURN(pictures.files["contact_sheet.png"], EncodePng(Sheet(drawn, intact)));
  return pictures;
}

}  // namespace drupe
