#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "capture/camera/raw_frame.h"
#include "capture/scan/small_picture.h"
#include "cli/bench/bench.h"
#include "cli/bench/set_bench.h"
#include "cli/bench/text_table.h"
#include "image/decode.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench bayer`.
struct BayerArguments {
  SetArguments sets;
  int jpeg_quality = 97;
  int chance = 0;
};

/// Which colour filters lie before the sensor, and where red lies in their top left 2 x 2.
struct Sensor {
  const char* name;
  FrameLayout layout;
  int red_x, red_y;
};
constexpr Sensor kColour = {"coded again", FrameLayout::kRgb, 0, 0};
/// Which samples a mosaic keeps is chance, and so is a part of a pose's error: a single layout tells little.
constexpr std::array<Sensor, 4> kMosaics = {{{"Bayer RGGB", FrameLayout::kBayerRg, 0, 0},
                                             {"Bayer GRBG", FrameLayout::kBayerGr, 1, 0},
                                             {"Bayer GBRG", FrameLayout::kBayerGb, 0, 1},
                                             {"Bayer BGGR", FrameLayout::kBayerBg, 1, 1}}};

/// What the sensor sees of the picture.
RawFrame MosaicOf(const RgbImage& picture, const Sensor& sensor) {
  RawFrame frame;
  frame.width = picture.width(), frame.height = picture.height();
  frame.layout = sensor.layout;
  frame.bytes.reserve(static_cast<std::size_t>(frame.width) * frame.height);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const int colour = ((x & 1) ^ sensor.red_x) + ((y & 1) ^ sensor.red_y);
      frame.bytes.push_back(picture.At(x, y, colour));
    }
  }
  return frame;
}

/// One level more or less at every tenth pixel: no eye sees it, and the poses move all the same.
void Disturb(std::uint32_t seed, RgbImage& picture) {
  std::mt19937 random(seed);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const auto die = random() % 20;
      const int change = die == 0 ? 1 : die == 1 ? -1 : 0;
      for (int c = 0; c < 3; ++c) {
        picture.At(x, y, c) = static_cast<std::uint8_t>(std::clamp(picture.At(x, y, c) + change, 0, 255));
      }
    }
  }
}

Status Retake(const Sensor& sensor, RgbImage& picture) {
  if (sensor.layout == FrameLayout::kRgb) return Status::Ok();
  DRUPE_ASSIGN_OR_RETURN(picture, DevelopFrame(MosaicOf(picture, sensor)));
  return Status::Ok();
}

/// The source's file, coded again after change(picture).
template <typename Change>
Result<std::string> Recode(const SourceImage& source, const BayerArguments& arguments, const Limits& limits,
                           const Change& change) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, source.read());
  DRUPE_ASSIGN_OR_RETURN(RgbImage picture, DecodeRgb(bytes, limits));
  DRUPE_RETURN_IF_ERROR(change(picture));
  return EncodeJpeg(picture, arguments.jpeg_quality);
}

/// The set with each picture coded again after change(index, picture).
template <typename Change>
Result<ReconstructionInput> RecodeAll(const TruthSet& set, const BayerArguments& arguments, const Change& change) {
  ReconstructionInput input = set.input;
  std::vector<Result<std::string>> files(input.images.size(), std::string());
  DRUPE_RETURN_IF_ERROR(ParallelFor(arguments.sets.Context(), files.size(), [&](std::size_t i) {
    files[i] =
        Recode(set.input.images[i], arguments, input.limits, [&](RgbImage& picture) { return change(i, picture); });
  }));
  for (std::size_t i = 0; i < files.size(); ++i) {
    DRUPE_RETURN_IF_ERROR(files[i].status());
    input.images[i].read = [file = std::move(*files[i])]() -> Result<std::string> { return file; };
  }
  return input;
}

/// Poses of one run of the pipeline.
struct Poses {
  PoseErrors errors;
  std::map<std::string, Eigen::Vector3d> centres;  ///< of the cameras by picture, in the truth's frame, mm
  double moved_um = 0;                             ///< root mean square distance from those of the files
};

Result<Poses> MeasurePoses(const TruthSet& set, const ReconstructionInput& input, const BayerArguments& arguments) {
  ReconstructionOptions options;
  options.run_dense = false;
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOutput output,
                         RunReconstruction(input, options, arguments.sets.Context()));
  Poses poses;
  DRUPE_ASSIGN_OR_RETURN(poses.errors, ComparePoses(set, output.model.views));
  for (const View& view : output.model.views) {
    if (view.cam_from_world) {
      poses.centres[Stem(view.image)] = poses.errors.truth_from_model * view.cam_from_world->Centre();
    }
  }
  return poses;
}

double DistanceUm(const Poses& a, const Poses& b) {
  double sum = 0;
  int count = 0;
  for (const auto& [image, centre] : a.centres) {
    const auto other = b.centres.find(image);
    if (other == b.centres.end()) continue;
    sum += (centre - other->second).squaredNorm(), ++count;
  }
  return 1000 * std::sqrt(sum / std::max(count, 1));
}

/// Of several runs together: the means of their figures, and the fewest views registered.
Poses MeanOf(const std::vector<Poses>& each) {
  Poses mean;
  mean.errors.registered = mean.errors.of = each.front().errors.of;
  const auto count = static_cast<double>(each.size());
  for (const Poses& poses : each) {
    mean.errors.registered = std::min(mean.errors.registered, poses.errors.registered);
    mean.errors.mean_centre_mm += poses.errors.mean_centre_mm / count;
    mean.errors.mean_rotation_deg += poses.errors.mean_rotation_deg / count;
    mean.moved_um += poses.moved_um / count;
  }
  return mean;
}

/// One set's table.
class BayerTable {
 public:
  BayerTable(const TruthSet& set, const BayerArguments& arguments) : set_(set), arguments_(arguments) {}

  Status Measure() {
    DRUPE_ASSIGN_OR_RETURN(files_, MeasurePoses(set_, set_.input, arguments_));
    AddRow("the files", files_);
    DRUPE_RETURN_IF_ERROR(Add(kColour.name, Retaken(kColour)).status());
    std::vector<Poses> mosaics, disturbed;
    for (const Sensor& sensor : kMosaics) {
      DRUPE_ASSIGN_OR_RETURN(mosaics.emplace_back(), Add(sensor.name, Retaken(sensor)));
    }
    AddRow("Bayer, mean", MeanOf(mosaics));
    for (int round = 1; round <= arguments_.chance; ++round) {
      DRUPE_ASSIGN_OR_RETURN(disturbed.emplace_back(), Add("chance " + std::to_string(round), Disturbed(round)));
    }
    if (!disturbed.empty()) AddRow("chance, mean", MeanOf(disturbed));
    return Status::Ok();
  }

  void Print() const {
    std::printf("%s: %zu pictures\n", set_.name.c_str(), set_.views.size());
    const std::vector<std::string> header = {"pictures",     "registered", "centre mm",
                                             "rotation deg", "centre",     "moved um"};
    std::fputs(FormatTextTable(header, rows_).c_str(), stdout);
    std::fflush(stdout);
  }

 private:
  Result<ReconstructionInput> Retaken(const Sensor& sensor) const {
    return RecodeAll(set_, arguments_, [&](std::size_t, RgbImage& picture) { return Retake(sensor, picture); });
  }

  Result<ReconstructionInput> Disturbed(int round) const {
    return RecodeAll(set_, arguments_, [&](std::size_t i, RgbImage& picture) {
      Disturb(static_cast<std::uint32_t>(1000 * round + static_cast<int>(i)), picture);
      return Status::Ok();
    });
  }

  Result<Poses> Add(const std::string& name, const Result<ReconstructionInput>& input) {
    DRUPE_RETURN_IF_ERROR(input.status());
    DRUPE_ASSIGN_OR_RETURN(Poses poses, MeasurePoses(set_, *input, arguments_));
    poses.moved_um = DistanceUm(poses, files_);
    AddRow(name, poses);
    return poses;
  }

  void AddRow(const std::string& name, const Poses& poses) {
    const PoseErrors& errors = poses.errors;
    const double more_percent = 100 * (errors.mean_centre_mm / files_.errors.mean_centre_mm - 1);
    rows_.push_back({name, std::to_string(errors.registered) + "/" + std::to_string(errors.of),
                     FixedText(errors.mean_centre_mm, 5), FixedText(errors.mean_rotation_deg, 5),
                     (more_percent < 0 ? "" : "+") + FixedText(more_percent, 1) + " %", FixedText(poses.moved_um, 2)});
  }

  const TruthSet& set_;
  const BayerArguments& arguments_;
  Poses files_;
  std::vector<std::vector<std::string>> rows_;
};

Status MeasureSet(const TruthSet& set, const BayerArguments& arguments) {
  BayerTable table(set, arguments);
  DRUPE_RETURN_IF_ERROR(table.Measure());
  table.Print();
  return Status::Ok();
}

Status Run(const BayerArguments& arguments) {
  return MeasureSets(arguments.sets, [&](const TruthSet& set) { return MeasureSet(set, arguments); });
}

}  // namespace

void AddBayerBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<BayerArguments>();
  CLI::App* command = bench.add_subcommand(
      "bayer",
      "What the rig's Bayer frames cost in accuracy: poses from a set's files, from the same pictures coded again as\n"
      "the rig codes them, and from the pictures put through a Bayer mosaic (each of its four layouts), interpolated\n"
      "and coded as the rig does");
  AddSetArguments(*command, "Sets with images, calibration and truth.json", arguments->sets);
  command->add_option("--jpeg-quality", arguments->jpeg_quality, "Of the pictures that are coded")
      ->check(CLI::Range(50, 100))
      ->capture_default_str();
  command
      ->add_option("--chance", arguments->chance,
                   "So often also the pictures as files coded again, each time with one grey level more or less at\n"
                   "other tenths of the pixels: how far poses move by chance")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
