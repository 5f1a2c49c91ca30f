#include "capture/scan_request.h"

#include <utility>

#include "base/option_reader.h"
#include "scene/board.h"
#include "scene/calibration.h"

namespace drupe {
namespace {

Status Invalid(const std::string& field, const std::string& range) {
  return InvalidArgument("invalid_option", field + " must be " + range, field);
}

Status ReadTable(const Json& json, ScanRequest& request) {
  std::string driver = json.is_string() ? json.get<std::string>() : "grbl";
  if (json.is_object()) {
    OptionReader reader(json, "turntable");
    reader.Read("driver", driver);
    reader.Read("speed_deg_s", request.table.speed_deg_s);
    reader.Read("settle_ms", request.table.settle_ms);
    reader.Read("clockwise", request.table.clockwise);
    reader.Read("home", request.table.home);
    DRUPE_RETURN_IF_ERROR(reader.Finish());
  } else if (!json.is_string() && !json.is_null()) {
    return Invalid("turntable", "grbl, external or an object");
  }
  if (driver != "grbl" && driver != "external") return Invalid("turntable.driver", "grbl or external");
  request.table_turns_by_itself = driver == "external";
  return Status::Ok();
}

Status ReadChecks(const Json& json, FrameCheckOptions& checks) {
  OptionReader reader(json, "checks");
  reader.Read("min_sharpness_ratio", checks.min_sharpness_ratio);
  reader.Read("min_ratio", checks.min_ratio);
  reader.Read("max_saturated_pct", checks.max_saturated_pct);
  reader.Read("min_bright_level", checks.min_bright_level);
  reader.Read("max_motion_px", checks.max_motion_px);
  reader.Read("min_change", checks.min_change);
  reader.Read("min_markers", checks.min_markers);
  return reader.Finish();
}

/// The documents are checked here, so that a scan never fails at its end for something that was known at its start.
Status CheckDocuments(const ScanRequest& request) {
  if (!request.calibration.is_null()) DRUPE_RETURN_IF_ERROR(ParseCalibration(request.calibration).status());
  if (request.board.is_object()) return ParseBoard(request.board).status();
  if (request.board.is_null() || request.board == "default") return Status::Ok();
  return InvalidArgument("invalid_board", "board must be \"default\", a board.json or null", "board");
}

std::string DictionaryOf(const Json& board) {
  if (board.is_null()) return "";
  return board.is_object() ? board.value("dictionary", Board().dictionary) : Board().dictionary;
}

Status ReadMode(OptionReader& reader, ScanMode& mode) {
  std::string name = mode == ScanMode::kStep ? "step" : "continuous";
  reader.Read("mode", name);
  mode = name == "continuous" ? ScanMode::kContinuous : ScanMode::kStep;
  return name == "step" || name == "continuous" ? Status::Ok() : Invalid("mode", "step or continuous");
}

}  // namespace

Status ScanRequest::Check() const {
  if (lens.size() > 128) return Invalid("lens", "at most 128 characters");
  DRUPE_RETURN_IF_ERROR(camera.Check());
  DRUPE_RETURN_IF_ERROR(table.Check());
  DRUPE_RETURN_IF_ERROR(checks.Check());
  if (views < 3 || views > 400) return Invalid("views", "3 to 400");
  if (!(turn_s >= 5 && turn_s <= 3600)) return Invalid("turn_s", "5 to 3600");
  if (retakes < 0 || retakes > 10) return Invalid("retakes", "0 to 10");
  if (jpeg_quality < 50 || jpeg_quality > 100) return Invalid("jpeg_quality", "50 to 100");
  if (table_turns_by_itself && mode == ScanMode::kStep) {
    return Invalid("mode", "continuous with a table that turns by itself");
  }
  return Status::Ok();
}

Result<ScanRequest> ParseScanRequest(const Json& json) {
  if (!json.is_object()) return InvalidArgument("invalid_request", "the body must be a JSON object");
  ScanRequest request;
  Json rest = json;  // without what is not plain
  for (const char* key : {"camera", "turntable", "calibration", "calibrated_for", "board"}) rest.erase(key);
  OptionReader reader(rest, "");
  DRUPE_ASSIGN_OR_RETURN(CameraChoice camera, ParseCameraChoice(json.value("camera", Json())));
  request.camera_id = std::move(camera.id), request.camera = std::move(camera.options);
  DRUPE_RETURN_IF_ERROR(ReadTable(json.value("turntable", Json()), request));
  if (request.table_turns_by_itself) request.mode = ScanMode::kContinuous;
  DRUPE_RETURN_IF_ERROR(ReadMode(reader, request.mode));
  reader.Read("lens", request.lens);
  reader.Read("views", request.views);
  reader.Read("turn_s", request.turn_s);
  reader.Read("retakes", request.retakes);
  reader.Read("jpeg_quality", request.jpeg_quality);
  reader.Read("reconstruct", request.reconstruct);
  reader.Read("analyze", request.analyze);
  if (const Json* checks = reader.Nested("checks")) DRUPE_RETURN_IF_ERROR(ReadChecks(*checks, request.checks));
  if (const Json* options = reader.Nested("options")) request.options = *options;
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  request.calibration = json.value("calibration", Json());
  if (const Json made_with = json.value("calibrated_for", Json()); !made_with.is_null()) {
    DRUPE_ASSIGN_OR_RETURN(request.calibrated_for, ParseCameraBinding(made_with));
  }
  request.board = json.value("board", Json("default"));
  DRUPE_RETURN_IF_ERROR(CheckDocuments(request));
  request.checks.dictionary = DictionaryOf(request.board);
  request.camera.trigger = request.mode == ScanMode::kStep ? CameraTrigger::kSoftware : CameraTrigger::kLine;
  DRUPE_RETURN_IF_ERROR(request.Check());
  return request;
}

Json ToJson(const ScanRequest& request) {
  return {{"camera", ToJson(CameraChoice{request.camera_id, request.camera})},
          {"turntable",
           {{"driver", request.table_turns_by_itself ? "external" : "grbl"},
            {"speed_deg_s", request.table.speed_deg_s},
            {"settle_ms", request.table.settle_ms},
            {"clockwise", request.table.clockwise},
            {"home", request.table.home}}},
          {"views", request.views},
          {"mode", request.mode == ScanMode::kStep ? "step" : "continuous"},
          {"turn_s", request.turn_s},
          {"retakes", request.retakes},
          {"checks",
           {{"min_sharpness_ratio", request.checks.min_sharpness_ratio},
            {"min_ratio", request.checks.min_ratio},
            {"max_saturated_pct", request.checks.max_saturated_pct},
            {"min_bright_level", request.checks.min_bright_level},
            {"max_motion_px", request.checks.max_motion_px},
            {"min_change", request.checks.min_change},
            {"min_markers", request.checks.min_markers}}},
          {"jpeg_quality", request.jpeg_quality},
          {"calibration", request.calibration},
          {"calibrated_for", ToJson(request.calibrated_for)},
          {"lens", request.lens},
          {"board", request.board},
          {"options", request.options},
          {"reconstruct", request.reconstruct},
          {"analyze", request.analyze}};
}

}  // namespace drupe
