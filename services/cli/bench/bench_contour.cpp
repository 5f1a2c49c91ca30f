#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "cli/bench/bench.h"
#include "cli/bench/defect_scores.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_cloud.h"
#include "defect_analysis/pipeline.h"
#include "geometry/robust.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench contour`.
struct ContourArguments {
  std::vector<std::string> sets;
  std::string clouds;
  int control_points = ContourOptions().control_points;
  int degree = ContourOptions().degree;
};

constexpr std::array<int, 8> kDensities = {1, 5, 10, 20, 40, 80, 100, 120};
constexpr double kNearMm = 0.8;  // a spot that lies so near a true one is that one

/// Means over the spots that were found, for one sampling density.
struct Line {
  int spots = 0;
  double circumference = 0, area = 0, roundness = 0, true_area = 0, mean_abs_z = 0;
  std::vector<double> flat_errors, skin_errors;  // relative

  void Add(const Defect& defect, double true_area_mm2) {
    ++spots;
    circumference += defect.perimeter_mm;
    area += defect.planar_area_mm2;
    roundness += 4 * std::numbers::pi * defect.planar_area_mm2 / (defect.perimeter_mm * defect.perimeter_mm);
    true_area += true_area_mm2;
    mean_abs_z += defect.plane.mean_abs_z_mm;
    flat_errors.push_back(std::abs(defect.planar_area_mm2 / true_area_mm2 - 1));
    skin_errors.push_back(std::abs(defect.area_mm2 / true_area_mm2 - 1));
  }

  std::vector<std::string> Row(int density) const {
    const double n = std::max(1, spots);
    return {std::to_string(density),           FixedText(circumference / n, 4), FixedText(area / n, 4),
            FixedText(roundness / n, 4),       FixedText(true_area / n, 4),     FixedText(Median(flat_errors), 4),
            FixedText(Median(skin_errors), 4), FixedText(mean_abs_z / n, 4)};
  }
};

Result<std::vector<TrueDefect>> SpotsOf(const TruthSet& set) {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<FruitTruth> fruits, ParseFruitTruths(set.truth));
  std::vector<TrueDefect> spots;
  for (const FruitTruth& fruit : fruits) {
    for (const TrueDefect& defect : fruit.defects) {
      if (defect.defect_class == DefectClass::kRainSpot) spots.push_back(defect);
    }
  }
  return spots;
}

void Compare(const Report& report, const std::vector<TrueDefect>& truth, Line& line) {
  for (const TrueDefect& spot : truth) {
    const Defect* nearest = nullptr;
    for (const Fruit& fruit : report.fruits) {
      for (const Defect& defect : fruit.defects) {
        const double away = (defect.centre_mm - spot.centre_mm).norm();
        if (away < (nearest == nullptr ? kNearMm : (nearest->centre_mm - spot.centre_mm).norm())) nearest = &defect;
      }
    }
    if (nearest != nullptr) line.Add(*nearest, spot.area_mm2);
  }
}

Status Run(const ContourArguments& arguments) {
  std::array<Line, kDensities.size()> lines;
  std::size_t of = 0;
  for (const std::string& directory : arguments.sets) {
    DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(directory));
    DRUPE_ASSIGN_OR_RETURN(const std::vector<TrueDefect> spots, SpotsOf(set));
    AnalysisInput input;
    DRUPE_ASSIGN_OR_RETURN(input.cloud, CloudOfSet(set, arguments.clouds, DenseOptions::Scene::kFruit));
    input.scale_source = ScaleSource::kBoard;
    of += spots.size();
    for (std::size_t k = 0; k < kDensities.size(); ++k) {
      AnalysisOptions options;
      options.defects.contour.control_points = arguments.control_points;
      options.defects.contour.degree = arguments.degree;
      options.defects.contour.sampling_density = kDensities[k];
      DRUPE_ASSIGN_OR_RETURN(const Report report, RunAnalysis(input, options, RunContext()));
      Compare(report, spots, lines[k]);
    }
  }
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < kDensities.size(); ++k) rows.push_back(lines[k].Row(kDensities[k]));
  std::printf(
      "Means over %d of %zu rain spots; relative errors are medians. Closed B-spline of degree %d, %d control points\n",
      lines.back().spots, of, arguments.degree, arguments.control_points);
  const std::vector<std::string> heading = {"density",  "circumference mm", "flat area mm2", "roundness",
                                            "true mm2", "flat error",       "error on skin", "mean |z| mm"};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

}  // namespace

void AddContourBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<ContourArguments>();
  CLI::App* command = bench.add_subcommand(
      "contour",
      "Table 5 of the paper: rain spots measured with 1 to 120 samples a span of the contour's B-spline, by Heron's\n"
      "triangles in the fitted plane and on the curved skin, against the true area");
  command->add_option("SET_DIR", arguments->sets, "Sets with truth.json")->required();
  command->add_option("--clouds", arguments->clouds, "Take CLOUDS/SET/dense.ply, and do not reconstruct");
  command->add_option("--control-points", arguments->control_points, "Of the B-spline")->check(CLI::Range(4, 200));
  command->add_option("--degree", arguments->degree, "Of the B-spline")->check(CLI::Range(1, 5));
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
