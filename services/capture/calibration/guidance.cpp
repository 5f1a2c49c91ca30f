#include "capture/calibration/guidance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "capture/calibration/pattern_pose.h"

namespace drupe {
namespace {

constexpr int kPictures = 10;
constexpr double kTiltDeg = 20;         // towards each side
constexpr double kNearFill = 0.5;       // of the nearest picture
constexpr double kDistanceRatio = 1.2;  // of the farthest picture to the nearest
constexpr double kSameTilt = 0.12;      // difference of tilt vectors, in radians: about 7 degrees
constexpr double kSamePlace = 0.06;     // of the picture's size
constexpr double kSameDistance = 1.08;

struct Side {
  const char* name;
  double x, y;  ///< direction in the picture
};
constexpr Side kSides[] = {{"left", -1, 0}, {"right", 1, 0}, {"top", 0, -1}, {"bottom", 0, 1}};

std::string Text(const char* format, auto... values) {
  char text[200];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

/// The largest tilt whose nearer side is this one, within 45 degrees.
double LargestTilt(const std::vector<PatternPose>& poses, const Side& side) {
  double largest = 0;
  for (const PatternPose& pose : poses) {
    if (pose.nearer_x * side.x + pose.nearer_y * side.y > 0.7) largest = std::max(largest, pose.tilt_deg);
  }
  return largest;
}

void AddTilts(Guidance& guidance) {
  for (const Side& side : kSides) {
    const double have = LargestTilt(guidance.poses, side);
    if (have >= kTiltDeg) continue;
    guidance.missing.push_back(
        {"tilt", side.name, have, kTiltDeg,
         Text("tilt the pattern so that its %s edge comes nearer, by %.0f to 45 degrees; the most "
              "so far is %.0f",
              side.name, kTiltDeg + 5, have)});
  }
}

void AddDistances(Guidance& guidance) {
  double nearest = 1e9, farthest = 0, fill = 0;
  for (const PatternPose& pose : guidance.poses) {
    nearest = std::min(nearest, pose.distance), farthest = std::max(farthest, pose.distance);
    fill = std::max(fill, pose.fill);
  }
  if (fill < kNearFill) {
    guidance.missing.push_back(
        {"fill", "", fill, kNearFill,
         Text("come nearer: the pattern should fill %.0f %% of the picture's width or height once; "
              "the most so far is %.0f %%",
              100 * kNearFill, 100 * fill)});
  }
  const double ratio = farthest > 0 ? farthest / nearest : 0;
  if (ratio >= kDistanceRatio) return;
  guidance.missing.push_back(
      {"distance", "", ratio, kDistanceRatio,
       Text("change the distance: the farthest picture should be taken from %.1f times as far as the "
            "nearest; so far %.2f",
            kDistanceRatio, ratio)});
}

void AddCoverage(Guidance& guidance) {
  for (const std::string& part : guidance.coverage.WeakParts()) {
    guidance.missing.push_back(
        {"coverage", part, 0, 0.5,
         Text("show the pattern in the %s of the picture, which has hardly seen it", part.c_str())});
  }
}

}  // namespace

Json ToJson(const PatternPose& pose) {
  const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps; };
  return {
      {"tilt_deg", rounded(pose.tilt_deg, 10)},
      {"nearer_side", pose.tilt_deg < 3                                   ? Json()
                      : std::abs(pose.nearer_x) > std::abs(pose.nearer_y) ? Json(pose.nearer_x > 0 ? "right" : "left")
                                                                          : Json(pose.nearer_y > 0 ? "bottom" : "top")},
      {"distance", rounded(pose.distance, 1000)},
      {"fill", rounded(pose.fill, 1000)},
      {"centre", Json::array({rounded(pose.centre_x, 1000), rounded(pose.centre_y, 1000)})}};
}

Json ToJson(const Guidance& guidance) {
  Json missing = Json::array();
  for (const MissingPose& pose : guidance.missing) {
    missing.push_back({{"kind", pose.kind},
                       {"side", pose.side.empty() ? Json() : Json(pose.side)},
                       {"have", std::round(1000 * pose.have) / 1000},
                       {"need", pose.need},
                       {"advice", pose.advice}});
  }
  return {{"complete", guidance.missing.empty()},
          {"missing", std::move(missing)},
          {"coverage_pct", std::round(1000 * guidance.coverage.Share()) / 10},
          {"coverage", ToJson(guidance.coverage)}};
}

Guidance Guide(const std::vector<PatternCorners>& pictures, const Checkerboard& pattern, int width, int height) {
  Guidance guidance;
  guidance.coverage = CoverageMap(width, height);
  std::vector<PatternMap> maps;
  for (const PatternCorners& corners : pictures) {
    guidance.coverage.Add(corners.pixels);
    maps.push_back(MapOf(corners, pattern, width, height).value_or(PatternMap::Identity()));
  }
  const double focal = GuessFocal(maps);
  for (const PatternMap& map : maps) guidance.poses.push_back(PoseOf(map, focal, pattern, width, height));
  AddTilts(guidance);
  AddDistances(guidance);
  AddCoverage(guidance);
  const auto count = static_cast<double>(pictures.size());
  if (count < kPictures) {
    guidance.missing.push_back(
        {"pictures", "", count, kPictures, Text("take %.0f pictures more, each from another side", kPictures - count)});
  }
  return guidance;
}

int SimilarPose(const PatternPose& pose, const std::vector<PatternPose>& kept) {
  constexpr double kRadian = 57.29578;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const PatternPose& other = kept[i];
    const double tilt_x = (pose.tilt_deg * pose.nearer_x - other.tilt_deg * other.nearer_x) / kRadian;
    const double tilt_y = (pose.tilt_deg * pose.nearer_y - other.tilt_deg * other.nearer_y) / kRadian;
    const double ratio = std::max(pose.distance, other.distance) / std::min(pose.distance, other.distance);
    const double moved = std::hypot(pose.centre_x - other.centre_x, pose.centre_y - other.centre_y);
    if (std::hypot(tilt_x, tilt_y) < kSameTilt && moved < kSamePlace && ratio < kSameDistance)
      return static_cast<int>(i);
  }
  return -1;
}

}  // namespace drupe
