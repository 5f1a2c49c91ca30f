#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/json.h"
#include "capture/calibration/calibrate.h"
#include "cli/commands.h"
#include "cli/image_directory.h"
#include "cli/progress_bar.h"

namespace drupe {
namespace {

/// What the user wrote after `drupe calibrate`.
struct CalibrateArguments {
  std::string images;
  std::string pattern;
  std::string out = "calibration.json";
  std::string report;
  std::string coverage;
  int threads = 0;
};

Result<std::vector<PatternPicture>> ListPictures(const std::string& directory, const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> paths, ListImages(directory, limits));
  std::vector<PatternPicture> pictures;
  for (const std::filesystem::path& path : paths) {
    const std::size_t max_bytes = limits.max_image_bytes;
    pictures.push_back({path.filename().string(), [path, max_bytes] { return ReadFile(path, max_bytes); }});
  }
  return pictures;
}

Result<Checkerboard> LoadPattern(const std::string& path) {
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, JsonLimits{}.max_bytes));
  DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(text));
  return ParseCheckerboard(json);
}

void Print(const CalibrationResult& result) {
  for (const PictureReport& picture : result.pictures) {
    if (picture.used) {
      std::printf("%-20s %4d corners  %.3f px  tilt %2.0f deg\n", picture.name.c_str(), picture.corners, picture.rms_px,
                  picture.tilt_deg);
    } else {
      std::printf("%-20s left out: %s\n", picture.name.c_str(), picture.reason.c_str());
    }
  }
  const PinholeCamera& camera = result.calibration.camera;
  std::printf("focal length     %.2f +- %.2f, %.2f +- %.2f px\n", camera.fx, result.sigma.fx, camera.fy,
              result.sigma.fy);
  std::printf("principal point  %.2f +- %.2f, %.2f +- %.2f px\n", camera.cx, result.sigma.cx, camera.cy,
              result.sigma.cy);
  std::printf("verdict          %s\n", result.verdict.c_str());
}

Status Calibrate(const CalibrateArguments& arguments) {
  const CalibrationOptions options;
  DRUPE_ASSIGN_OR_RETURN(const Checkerboard pattern, LoadPattern(arguments.pattern));
  DRUPE_ASSIGN_OR_RETURN(const std::vector<PatternPicture> pictures, ListPictures(arguments.images, options.limits));
  ProgressBar bar(std::cerr);
  RunContext context;
  context.threads = arguments.threads;
  context.progress = [&bar](std::string_view stage, double fraction) { bar.Update(stage, fraction); };
  DRUPE_ASSIGN_OR_RETURN(const CalibrationResult result, RunCalibration(pictures, pattern, options, context));
  bar.Finish();
  Print(result);
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(arguments.out, DumpJson(ToJson(result.calibration), 1) + "\n"));
  if (!arguments.coverage.empty()) {
    DRUPE_ASSIGN_OR_RETURN(const std::string png, DrawCoverage(result.coverage));
    DRUPE_RETURN_IF_ERROR(WriteFileAtomically(arguments.coverage, png));
  }
  if (arguments.report.empty()) return Status::Ok();
  return WriteFileAtomically(arguments.report, DumpJson(ToJson(result), 1) + "\n");
}

}  // namespace

void AddCalibrateCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      app.add_subcommand("calibrate", "From pictures of a checkerboard or ChArUco board to calibration.json");
  command->add_option("IMAGES_DIR", arguments->images, "10 to 20 sharp pictures of the pattern, tilted every way")
      ->required();
  command
      ->add_option(
          "--pattern", arguments->pattern,
          "pattern.json: {\"pattern\": \"checkerboard\", \"inner_corners\": [11, 8], \"square_mm\": 6.0}; of a "
          "ChArUco board {\"pattern\": \"charuco\", ..., \"marker_mm\": 4.5, \"dictionary\": \"DICT_5X5_250\"}")
      ->required();
  command->add_option("--out", arguments->out, "Where the calibration is written")->capture_default_str();
  command->add_option("--report", arguments->report, "Where the full report is written (JSON); not by default");
  command->add_option("--coverage", arguments->coverage,
                      "Where a picture of the sensor with all corners is written (PNG); not by default");
  command->add_option("--threads", arguments->threads, "Worker threads; 0: one per core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command->callback([arguments, &exit_code] {
    const Status status = Calibrate(*arguments);
    if (status.ok()) return;
    std::fprintf(stderr, "drupe calibrate: %s\n", status.ToString().c_str());
    exit_code = status.kind() == StatusKind::kInvalidArgument ? 2 : 1;
  });
}

}  // namespace drupe
