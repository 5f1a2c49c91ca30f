#include "reconstruction/dense/dense_part.h"

#include <exception>
#include <utility>

#include "base/json.h"
#include "base/parallel.h"
#include "reconstruction/dense/dense.h"
#include "reconstruction/dense/packed_cells.h"
#include "reconstruction/dense/part_file.h"
#include "reconstruction/dense/refine_view.h"

namespace drupe::dense {

namespace {

Status LoadPictures(const LoadNamedRgb& load_rgb, const RunContext& run, Part& part) {
  std::vector<Status> outcomes(part.scene.views.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, outcomes.size(), [&](std::size_t i) {
    const Result<RgbImage> picture = load_rgb(part.model.views[i].image);
    const PinholeCamera& camera = part.model.camera;
    if (!picture.ok()) {
      outcomes[i] = picture.status();
    } else if (picture->width() != camera.width || picture->height() != camera.height) {
      outcomes[i] = BadPart("a picture does not have the size of the camera");
    } else {
      DenseView& view = part.scene.views[i];
      BuildPyramid(*picture, camera, ProjectRegion(part.scene.region, camera, view.cam_from_world), part.finest + 1,
                   &view);
      DropLevelsBelow(part.finest, &view);
    }
  }));
  for (const Status& outcome : outcomes) DRUPE_RETURN_IF_ERROR(outcome);
  return Status::Ok();
}

}  // namespace

Result<std::string> RefineViews(const LevelContext& fine, const std::vector<ViewWork>& work, const RunContext& run) {
  std::vector<std::string> cells(work.size());
  std::vector<std::size_t> counts(cells.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, cells.size(), [&](std::size_t k) {
    counts[k] = AppendCells(RefineFinest(fine, work[k].view, *work[k].coarse, *work[k].wanted, run), {}, &cells[k]);
  }));
  std::string bytes = DumpJson(Json{{"cells", counts}}) + "\n";
  for (const std::string& one : cells) bytes += one;
  return bytes;
}

Result<PartResult> PartResult::Read(std::string bytes, std::size_t views) {
  std::string_view rest = bytes;
  DRUPE_ASSIGN_OR_RETURN(const Json head, TakeHead(&rest));
  const auto cells = head.is_object() ? head.find("cells") : head.end();
  if (cells == head.end() || !cells->is_array() || cells->size() != views) return BadPart("its views are wrong");
  PartResult result;
  std::size_t first = bytes.size() - rest.size();
  for (const Json& count : *cells) {
    if (!count.is_number_unsigned() || count.get<std::size_t>() > kMaxCells) return BadPart("a count is wrong");
    result.first_.push_back(first);
    result.count_.push_back(count.get<std::size_t>());
    first += result.count_.back() * kPlacedCellBytes;
  }
  if (first != bytes.size()) return BadPart("its length is wrong");
  result.bytes_ = std::move(bytes);
  return result;
}

Result<PatchMap> PartResult::MapOf(std::size_t k, PatchMap empty) const {
  std::string_view rest = std::string_view(bytes_).substr(first_[k]);
  DRUPE_RETURN_IF_ERROR(TakeCells(count_[k], &rest, &empty));
  return empty;
}

}  // namespace drupe::dense

namespace drupe {

Result<std::string> RunDensePart(std::string_view part, const DenseOptions& options, const LoadNamedRgb& load_rgb,
                                 const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  try {
    DRUPE_ASSIGN_OR_RETURN(dense::Part read, dense::ReadPart(part));
    read.scene.options = &options;
    read.scene.model = &read.model;
    DRUPE_RETURN_IF_ERROR(dense::LoadPictures(load_rgb, context, read));
    std::vector<dense::ViewWork> work;
    for (std::size_t k = 0; k < read.coarse.size(); ++k) {
      work.push_back({static_cast<int>(k), &read.coarse[k], &read.wanted[k]});
    }
    return dense::RefineViews(dense::MakeLevelContext(read.scene, read.finest, read.csize), work, context);
  } catch (const std::exception& error) {
    return Internal("internal", std::string("dense reconstruction: ") + error.what());
  }
}

}  // namespace drupe
