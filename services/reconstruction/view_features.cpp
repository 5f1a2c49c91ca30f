#include "reconstruction/view_features.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "image/decode.h"
#include "reconstruction/picture_features.h"

namespace drupe {

namespace {

/// What one picture gave; `status` says why it gave nothing.
struct OneView {
  Status status;
  ImageInfo info;
  PictureFeatures found;
};

using Size = std::pair<int, int>;

std::string SizeText(const Size& size) {
  return std::to_string(size.first) + "x" + std::to_string(size.second);
}

/// Reads the headers alone, so that the size of the set is known before time is spent on pictures of another one.
Status ProbeAll(const ReconstructionInput& input, const RunContext& context, std::vector<OneView>& views) {
  return ParallelFor(context, views.size(), [&](std::size_t i) {
    const Result<std::string> bytes = input.images[i].read();
    if (!bytes.ok()) {
      views[i].status = bytes.status();
      return;
    }
    Result<ImageInfo> info = ProbeImage(*bytes, input.limits);
    if (info.ok()) {
      views[i].info = *info;
    } else {
      views[i].status = info.status();
    }
  });
}

/// The calibration's size when there is one, else the most frequent (the smaller of equals).
Result<Size> SetSize(const ReconstructionInput& input, const std::vector<OneView>& views) {
  std::map<Size, int> counts;
  for (const OneView& view : views) {
    if (view.status.ok()) ++counts[{view.info.width, view.info.height}];
  }
  if (counts.empty()) return Unprocessable("too_few_images", "none of the pictures can be read");
  const Size most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                      return a.second < b.second;
                    })->first;
  if (input.calibration) DRUPE_RETURN_IF_ERROR(CheckCalibrationSize(*input.calibration, most.first, most.second));
  return most;
}

void RefuseOtherSizes(const Size& size, std::vector<OneView>& views) {
  for (OneView& view : views) {
    if (!view.status.ok() || Size(view.info.width, view.info.height) == size) continue;
    view.status =
        Unprocessable("image_size_differs", "the picture has " + SizeText({view.info.width, view.info.height}) +
                                                " pixels, the others of the set have " + SizeText(size));
  }
}

Status Process(const SourceImage& source, const ReconstructionInput& input, const ReconstructionOptions& options,
               const RunContext& context, OneView& view) {
  DRUPE_ASSIGN_OR_RETURN(view.found, FindPictureFeatures(source, input, options, context));
  return Status::Ok();
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

ViewFeatures Collect(const ReconstructionInput& input, const Size& size, std::vector<OneView>& views) {
  ViewFeatures result;
  result.width = size.first;
  result.height = size.second;
  std::vector<double> focals;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i].status.ok()) {
      result.refused.push_back({input.images[i].name, views[i].status});
      continue;
    }
    result.sources.push_back(static_cast<int>(i));
    result.names.push_back(input.images[i].name);
    result.features.push_back(std::move(views[i].found.features));
    if (input.board) result.detections.push_back(std::move(views[i].found.detection));
    if (views[i].info.exif_focal_px > 0) focals.push_back(views[i].info.exif_focal_px);
  }
  result.exif_focal_px = Median(std::move(focals));
  return result;
}

}  // namespace

Result<ViewFeatures> FindViewFeatures(const ReconstructionInput& input, const ReconstructionOptions& options,
                                      const RunContext& context) {
  std::vector<OneView> views(input.images.size());
  DRUPE_RETURN_IF_ERROR(ProbeAll(input, context, views));
  DRUPE_ASSIGN_OR_RETURN(const Size size, SetSize(input, views));
  RefuseOtherSizes(size, views);

  RunContext one_thread = context;  // threads go over pictures, not into them
  one_thread.threads = 1;
  one_thread.progress = nullptr;
  std::atomic<int> done{0};
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, views.size(), [&](std::size_t i) {
    if (views[i].status.ok()) {
      views[i].status = Process(input.images[i], input, options, one_thread, views[i]);
    }
    context.Report("features", static_cast<double>(++done) / static_cast<double>(views.size()));
  }));

  ViewFeatures result = Collect(input, size, views);
  if (static_cast<int>(result.names.size()) >= input.limits.min_images) return result;
  std::string message = std::to_string(result.names.size()) + " of " + std::to_string(views.size()) +
                        " pictures can be used; at least " + std::to_string(input.limits.min_images) + " are needed";
  if (!result.refused.empty()) {
    message += " (" + result.refused.front().name + ": " + result.refused.front().status.message() + ")";
  }
  return Unprocessable("too_few_images", message);
}

}  // namespace drupe
