#include "capture/calibration/calibrate.h"

namespace drupe {
namespace {

Json SigmaJson(const IntrinsicsSigma& sigma) {
  return {{"fx", sigma.fx}, {"fy", sigma.fy}, {"cx", sigma.cx}, {"cy", sigma.cy}, {"dist", sigma.dist}};
}

Json PictureJson(const PictureReport& picture) {
  Json json = {{"image", picture.name}, {"used", picture.used}};
  if (!picture.used) json["reason"] = picture.reason;
  json["corners"] = picture.corners;
  if (picture.used) {
    json["rms_px"] = picture.rms_px;
    json["tilt_deg"] = picture.tilt_deg;
  }
  return json;
}

}  // namespace

Json ToJson(const CalibrationResult& result) {
  Json pictures = Json::array();
  for (const PictureReport& picture : result.pictures) pictures.push_back(PictureJson(picture));
  return {{"calibration", ToJson(result.calibration)},
          {"sigma", SigmaJson(result.sigma)},
          {"assumed", {{"square_pixels", result.square_pixels}, {"k3_zero", result.fixed_k3}}},
          {"pictures", std::move(pictures)},
          {"coverage_pct", 100 * result.coverage.Share()},
          {"coverage", ToJson(result.coverage)},
          {"grade", CalibrationGradeName(result.grade)},
          {"verdict", result.verdict}};
}

}  // namespace drupe
