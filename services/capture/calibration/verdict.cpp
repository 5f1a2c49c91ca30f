#include "capture/calibration/verdict.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace drupe {
namespace {

/// One thing that limits a calibration: what it means for the grade, and what to do about it.
struct Finding {
  CalibrationGrade grade;
  std::string advice;
};

int UsedPictures(const CalibrationResult& result) {
  return static_cast<int>(std::count_if(result.pictures.begin(), result.pictures.end(),
                                        [](const PictureReport& picture) { return picture.used; }));
}

double LargestTilt(const CalibrationResult& result) {
  double largest = 0;
  for (const PictureReport& picture : result.pictures) largest = std::max(largest, picture.used ? picture.tilt_deg : 0);
  return largest;
}

std::vector<Finding> FindWeaknesses(const CalibrationResult& result) {
  using enum CalibrationGrade;
  std::vector<Finding> findings;
  const auto add = [&](bool poor, bool usable, std::string advice) {
    if (poor || usable) findings.push_back({poor ? kPoor : kUsable, std::move(advice)});
  };
  const double focal_sigma = result.sigma.fy / result.calibration.camera.fy;
  const double rms = result.calibration.rms_px;
  const int used = UsedPictures(result);
  const double tilt = LargestTilt(result);
  add(rms > 1.0, rms > 0.35, "the residuals are large: is the pattern flat and sharp, is its size right?");
  add(focal_sigma > 0.002, focal_sigma > 0.0005, "the focal length is uncertain: tilt the pattern more, come closer");
  add(used < 5, used < 8, "few pictures: take 10 to 20");
  add(tilt < 10, tilt < 20, "the pattern was hardly tilted: tilt it by 30 to 45 degrees in all directions");
  const double covered = result.coverage.Share();
  const std::string where = result.coverage.WeakParts().empty() ? "" : ": " + result.coverage.WeakText();
  add(covered < 0.3, covered < 0.6, "much of the picture hardly showed the pattern" + where);
  return findings;
}

}  // namespace

const char* CalibrationGradeName(CalibrationGrade grade) {
  switch (grade) {
    case CalibrationGrade::kGood:
      return "good";
    case CalibrationGrade::kUsable:
      return "usable";
    case CalibrationGrade::kPoor:
      break;
  }
  return "poor";
}

void Judge(CalibrationResult& result) {
  const std::vector<Finding> findings = FindWeaknesses(result);
  result.grade = CalibrationGrade::kGood;
  for (const Finding& finding : findings) result.grade = std::max(result.grade, finding.grade);
  const PinholeCamera& camera = result.calibration.camera;
  char numbers[160];
  std::snprintf(numbers, sizeof(numbers), "%s: focal length %.1f px to %.3f %%, residuals %.3f px, %d of %zu pictures",
                CalibrationGradeName(result.grade), camera.fy, 100 * result.sigma.fy / camera.fy,
                result.calibration.rms_px, UsedPictures(result), result.pictures.size());
  result.verdict = numbers;
  for (const Finding& finding : findings) result.verdict += "; " + finding.advice;
}

}  // namespace drupe
