#include "capture/session_grab.h"

#include <algorithm>

#include "capture/camera/raw_frame.h"
#include "capture/scan/picture_name.h"
#include "capture/scan/small_picture.h"

namespace drupe {
namespace {

constexpr int kMaxSessionPictures = 100;
constexpr int kJpegQuality = 97, kMarkedQuality = 80, kMarkedWidth = 800;
constexpr std::size_t kMinCorners = 12;
constexpr int kTries = 5;

Status CheckSame(const CalibrationSession& session, const std::string& serial, const RawFrame& frame) {
  const bool is_first = session.width == 0;
  if (is_first ||
      (session.binding.serial == serial && session.width == frame.width && session.height == frame.height)) {
    return Status::Ok();
  }
  return {StatusKind::kConflict, "camera_changed",
          "this session's pictures are of camera " + session.binding.serial + ", " + std::to_string(session.width) +
              " x " + std::to_string(session.height) + "; begin another for " + serial + ", " +
              std::to_string(frame.width) + " x " + std::to_string(frame.height)};
}

void MarkCorners(const PatternCorners& corners, double scale, RgbImage& small) {
  constexpr int kHalf = 2;
  for (const Eigen::Vector2d& pixel : corners.pixels) {
    const int x = static_cast<int>(pixel.x() * scale), y = static_cast<int>(pixel.y() * scale);
    for (int v = std::max(0, y - kHalf); v <= std::min(small.height() - 1, y + kHalf); ++v) {
      for (int u = std::max(0, x - kHalf); u <= std::min(small.width() - 1, x + kHalf); ++u) {
        small.At(u, v, 0) = 255, small.At(u, v, 1) = 40, small.At(u, v, 2) = 40;
      }
    }
  }
}

Result<std::string> PreviewOf(const RgbImage& image, const PatternCorners& corners) {
  RgbImage small = ShrinkTo(image, kMarkedWidth);
  MarkCorners(corners, static_cast<double>(small.width()) / image.width(), small);
  return EncodeJpeg(small, kMarkedQuality);
}

/// Why the picture, whose pose the last of `poses` is, is not worth keeping; empty when it is.
std::string ReasonAgainst(const CalibrationSession& session, std::vector<PatternPose> poses) {
  const PatternPose pose = poses.back();
  poses.pop_back();
  const int same = SimilarPose(pose, poses);
  if (same < 0) return "";
  return "it shows nearly the same as " + session.pictures[static_cast<std::size_t>(same)].name + "; move the pattern";
}

}  // namespace

Json ToJson(const Grab& grab) {
  return {{"kept", grab.kept},
          {"reason", grab.reason.empty() ? Json() : Json(grab.reason)},
          {"corners", grab.corners},
          {"pose", grab.pose ? ToJson(*grab.pose) : Json()}};
}

Result<Grab> TakeSessionPicture(CalibrationSession& session, ObjectStore& objects, const SteadyCameraOptions& steady) {
  if (session.pictures.size() >= kMaxSessionPictures) {
    return Status(StatusKind::kConflict, "session_full", "the session has 100 pictures; finish it");
  }
  SteadyCamera camera(session.camera.id, session.camera.options, steady, nullptr);
  DRUPE_RETURN_IF_ERROR(camera.Ensure());
  DRUPE_ASSIGN_OR_RETURN(const RawFrame frame, camera.ShootPatiently(kTries));
  DRUPE_RETURN_IF_ERROR(CheckSame(session, camera.identity().serial, frame));
  DRUPE_ASSIGN_OR_RETURN(const RgbImage image, DevelopFrame(frame));
  DRUPE_ASSIGN_OR_RETURN(const PatternCorners corners, FindCorners(GrayOf(image), session.pattern));
  session.binding.serial = camera.identity().serial;
  session.width = frame.width, session.height = frame.height;
  Grab grab;
  grab.corners = static_cast<int>(corners.size());
  DRUPE_ASSIGN_OR_RETURN(grab.preview, PreviewOf(image, corners));
  if (corners.size() < kMinCorners) {
    grab.reason = session.pattern.markers ? "too little of the pattern was found; is it in the picture, and sharp?"
                                          : "the whole pattern was not found; is all of it in the picture, and sharp?";
    return grab;
  }
  CalibrationSession with = session;
  with.pictures.push_back({PictureName(static_cast<int>(session.pictures.size())), "", corners});
  const std::vector<PatternPose> poses = with.Guide().poses;
  grab.pose = poses.back();
  grab.reason = ReasonAgainst(session, poses);
  grab.kept = grab.reason.empty();
  if (!grab.kept) return grab;
  DRUPE_ASSIGN_OR_RETURN(const std::string jpeg, EncodeJpeg(image, kJpegQuality));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects.Put(jpeg));
  with.pictures.back().sha256 = object.sha256;
  session = std::move(with);
  return grab;
}

}  // namespace drupe
