#include "capture/calibration/calibrate.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "base/parallel.h"
#include "capture/calibration/corner_refiner.h"
#include "capture/calibration/verdict.h"
#include "image/decode.h"

namespace drupe {
namespace {

constexpr int kMinViews = 3;
constexpr std::size_t kMinCorners = 12;

Result<GrayImage> Load(const PatternPicture& picture, const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, picture.read());
  return DecodeGray(bytes, limits);
}

/// One calibration under way. Pictures keep their index in `pictures_` throughout; `views_` holds those still in use.
class Calibrator {
 public:
  Calibrator(const std::vector<PatternPicture>& pictures, const Checkerboard& pattern,
             const CalibrationOptions& options, const RunContext& context)
      : pictures_(pictures), pattern_(pattern), options_(options), context_(context), states_(pictures.size()) {}

  Result<CalibrationResult> Run() {
    DRUPE_RETURN_IF_ERROR(FindAllCorners());
    DropOddSizes();
    DRUPE_RETURN_IF_ERROR(SolveWithoutOutliers());
    for (int i = 0; i < options_.refinements; ++i) {
      DRUPE_RETURN_IF_ERROR(RefineAllCorners());
      DRUPE_RETURN_IF_ERROR(SolveWithoutOutliers());
      context_.Report("calibration", (i + 1.0) / options_.refinements);
    }
    return Finish();
  }

 private:
  struct PictureState {
    int width = 0, height = 0;
    PatternCorners corners;
    std::string reason;  ///< why it is out of use; empty while it is in
  };

  Status FindAllCorners() {
    std::atomic<std::size_t> done = 0;
    DRUPE_RETURN_IF_ERROR(ParallelFor(context_, pictures_.size(), [&](std::size_t i) {
      FindCornersIn(i);
      context_.Report("corners", static_cast<double>(++done) / static_cast<double>(pictures_.size()));
    }));
    return context_.CheckCancelled();
  }

  void FindCornersIn(std::size_t i) {
    PictureState& state = states_[i];
    const auto image = Load(pictures_[i], options_.limits);
    if (!image.ok()) {
      state.reason = image.status().message();
      return;
    }
    state.width = image->width(), state.height = image->height();
    auto corners = FindCorners(*image, pattern_, options_.finder);
    if (!corners.ok()) {
      state.reason = corners.status().message();
    } else if (corners->size() < kMinCorners) {
      state.reason = pattern_.markers ? "too little of the pattern was found; its markers must be visible and sharp"
                                      : "the whole pattern was not found; all inner corners must be visible and sharp";
    } else {
      state.corners = std::move(corners).value();
    }
  }

  std::vector<std::size_t> InUse() const {
    std::vector<std::size_t> in_use;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i].reason.empty()) in_use.push_back(i);
    }
    return in_use;
  }

  /// The size that most pictures have is the camera's.
  void DropOddSizes() {
    std::map<std::pair<int, int>, int> counts;
    for (const std::size_t i : InUse()) ++counts[{states_[i].width, states_[i].height}];
    if (counts.empty()) return;
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    std::tie(width_, height_) = most->first;
    const std::string size = std::to_string(width_) + "x" + std::to_string(height_);
    for (const std::size_t i : InUse()) {
      if (std::pair(states_[i].width, states_[i].height) == most->first) continue;
      states_[i].reason = "its size differs from that of most pictures, " + size;
    }
  }

  Status TooFew() const {
    std::string message = "the pattern was found in " + std::to_string(InUse().size()) + " of " +
                          std::to_string(pictures_.size()) + " pictures; at least 3 are needed";
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i].reason.empty()) continue;
      message += ". " + pictures_[i].name + ": " + states_[i].reason;
      break;
    }
    return Unprocessable("too_few_pattern_pictures", std::move(message));
  }

  /// Solves, drops pictures that contradict the others, and solves again until none does.
  Status SolveWithoutOutliers() {
    for (;;) {
      DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
      const std::vector<std::size_t> in_use = InUse();
      if (static_cast<int>(in_use.size()) < kMinViews) return TooFew();
      std::vector<PatternCorners> views;
      for (const std::size_t i : in_use) views.push_back(states_[i].corners);
      DRUPE_ASSIGN_OR_RETURN(solution_, SolveZhang(views, pattern_, width_, height_));
      if (!DropWorstPicture(in_use)) return Status::Ok();
    }
  }

  /// True when a picture was dropped.
  bool DropWorstPicture(const std::vector<std::size_t>& in_use) {
    const std::vector<double>& rms = solution_.view_rms_px;
    std::vector<double> sorted = rms;
    std::sort(sorted.begin(), sorted.end());
    // A twentieth of a pixel is no sign of a bent pattern, however good the other pictures are.
    const double limit = options_.max_rms_ratio * std::max(sorted[sorted.size() / 2], 0.05);
    const auto worst = std::max_element(rms.begin(), rms.end());
    if (*worst <= limit || static_cast<int>(in_use.size()) == kMinViews) return false;
    states_[in_use[static_cast<std::size_t>(worst - rms.begin())]].reason =
        "its corners do not fit the other pictures; is the pattern bent or blurred in it?";
    return true;
  }

  Status RefineAllCorners() {
    const std::vector<std::size_t> in_use = InUse();
    DRUPE_RETURN_IF_ERROR(ParallelFor(context_, in_use.size(), [&](std::size_t view) {
      PictureState& state = states_[in_use[view]];
      const auto image = Load(pictures_[in_use[view]], options_.limits);
      if (!image.ok()) {
        state.reason = image.status().message();
        return;
      }
      PatternCorners refined =
          RefineCorners(*image, pattern_, state.corners, solution_.camera, solution_.cam_from_pattern[view]);
      if (2 * refined.size() > state.corners.size() && refined.size() >= kMinCorners)
        state.corners = std::move(refined);
    }));
    return context_.CheckCancelled();
  }

  double TiltDeg(const Rigid3& cam_from_pattern) const {
    const Eigen::Vector2d middle = pattern_.CornerMm(pattern_.CornerCount() - 1) / 2;
    const Eigen::Vector3d sight = (cam_from_pattern * Eigen::Vector3d(middle.x(), middle.y(), 0)).normalized();
    const double cosine = std::min(1.0, std::abs(cam_from_pattern.rotation.col(2).dot(sight)));
    return std::round(std::acos(cosine) * 180e3 / std::numbers::pi) * 1e-3;  // finer means nothing
  }

  CalibrationResult Finish() const {
    CalibrationResult result;
    result.calibration = {.camera = solution_.camera, .rms_px = solution_.rms_px};
    result.sigma = solution_.sigma;
    result.square_pixels = solution_.square_pixels;
    result.fixed_k3 = solution_.fixed_k3;
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      result.pictures.push_back({.name = pictures_[i].name,
                                 .reason = states_[i].reason,
                                 .corners = static_cast<int>(states_[i].corners.size())});
    }
    const std::vector<std::size_t> in_use = InUse();
    for (std::size_t view = 0; view < in_use.size(); ++view) {
      PictureReport& report = result.pictures[in_use[view]];
      report.used = true;
      report.rms_px = solution_.view_rms_px[view];
      report.tilt_deg = TiltDeg(solution_.cam_from_pattern[view]);
    }
    result.coverage = CoverageMap(width_, height_);
    for (const std::size_t i : in_use) result.coverage.Add(states_[i].corners.pixels);
    Judge(result);
    return result;
  }

  const std::vector<PatternPicture>& pictures_;
  const Checkerboard& pattern_;
  const CalibrationOptions& options_;
  const RunContext& context_;
  std::vector<PictureState> states_;
  int width_ = 0, height_ = 0;
  ZhangSolution solution_;
};

}  // namespace

Status CalibrationOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(finder.Check());
  if (refinements < 0 || refinements > 5) return InvalidArgument("invalid_option", "must be 0 to 5", "refinements");
  if (!(max_rms_ratio >= 1.5)) return InvalidArgument("invalid_option", "must be at least 1.5", "max_rms_ratio");
  return Status::Ok();
}

Result<CalibrationResult> RunCalibration(const std::vector<PatternPicture>& pictures, const Checkerboard& pattern,
                                         const CalibrationOptions& options, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  return Calibrator(pictures, pattern, options, context).Run();
}

}  // namespace drupe
