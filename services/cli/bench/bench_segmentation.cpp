#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/files.h"
#include "cli/bench/bench.h"
#include "cli/bench/colour_clusters.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_cloud.h"
#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/point_classes.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/skin_map.h"
#include "defect_analysis/fruit/extract_fruits.h"
#include "scene/ply.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench segmentation`.
struct SegmentationArguments {
  std::vector<std::string> inputs;
  std::string clouds;
  std::vector<int> classes = {4, 6};
};

/// A fruit's cloud, and what each point truly is where that is known.
struct TrueFruit {
  std::string name;
  FruitCloud cloud;
  std::vector<std::uint8_t> truth;  ///< 0 healthy; empty: not known
};

Result<std::vector<FruitCloud>> FruitsOf(const PointCloud& cloud) {
  FruitScene scene;
  scene.metric = true;
  return ExtractFruits(cloud, scene, {}, {}, RunContext());
}

std::vector<std::uint8_t> TrueLabels(const FruitCloud& cloud, const std::vector<DefectMap>& maps) {
  const auto nearest = std::min_element(maps.begin(), maps.end(), [&](const DefectMap& a, const DefectMap& b) {
    return (a.centre - cloud.surface.centre()).norm() < (b.centre - cloud.surface.centre()).norm();
  });
  std::vector<std::uint8_t> labels;
  for (const Eigen::Vector3f& offset : cloud.offsets) {
    labels.push_back(nearest->LabelAt(cloud.surface.centre() + offset.cast<double>()));
  }
  return labels;
}

Result<std::vector<TrueFruit>> LoadFruits(const std::string& input, const std::string& clouds) {
  PointCloud cloud;
  std::vector<DefectMap> maps;
  std::string name = std::filesystem::path(input).filename().string();
  if (std::filesystem::is_directory(input)) {
    DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(input));
    DRUPE_ASSIGN_OR_RETURN(cloud, CloudOfSet(set, clouds, DenseOptions::Scene::kFruit));
    DRUPE_ASSIGN_OR_RETURN(maps, LoadDefectMaps(set));
    name = set.name;
  } else {
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(input));
    DRUPE_ASSIGN_OR_RETURN(cloud, ReadPly(bytes));
  }
  DRUPE_ASSIGN_OR_RETURN(std::vector<FruitCloud> found, FruitsOf(cloud));
  std::vector<TrueFruit> fruits;
  for (FruitCloud& fruit : found) {
    TrueFruit next{name + (found.size() > 1 ? "-" + std::to_string(fruits.size() + 1) : ""), std::move(fruit), {}};
    if (!maps.empty()) next.truth = TrueLabels(next.cloud, maps);
    fruits.push_back(std::move(next));
  }
  return fruits;
}

/// Ours, shading off and search for K included.
struct OurClusters {
  ColourClusters colours;  ///< K-means' own classes: each point the nearest of the centres found
  ColourClusters spots;    ///< what is made of them: each point by half way between its spot and the skin about it
};

Result<OurClusters> ClusterByUs(const FruitCloud& cloud) {
  const SegmentationOptions options;
  const Stopwatch watch;
  const SkinMap map(cloud);
  DRUPE_ASSIGN_OR_RETURN(const SkinColours colours, MeasureDeviation(cloud, map, options));
  const Segmentation found = SegmentColours(colours.deviation, colours.seen, colours.sigma, options);
  const double both_s = watch.CpuSeconds();
  const Stopwatch spots_watch;
  OurClusters ours;
  ours.spots.class_of = ClassifyPoints(cloud, map, colours, found, options);
  ours.spots.cpu_s = both_s + spots_watch.CpuSeconds();
  const Stopwatch nearest_watch;
  ours.colours = ClusterByNearest(PointDeviations(cloud, map, colours, options), found.centres);
  ours.colours.cpu_s = both_s + nearest_watch.CpuSeconds();
  ours.spots.classes = ours.colours.classes;
  ours.spots.colours = ours.colours.colours;
  return ours;
}

std::vector<Eigen::Vector3f> WeightedLab(const FruitCloud& cloud) {
  std::vector<Eigen::Vector3f> colours = cloud.lab;
  for (Eigen::Vector3f& colour : colours) colour[0] *= static_cast<float>(SegmentationOptions().lightness_weight);
  return colours;
}

std::string OrDash(const std::optional<double>& value, int decimals) {
  return value ? FixedText(*value, decimals) : "-";
}

std::vector<std::string> Row(const TrueFruit& fruit, const std::string& method, const ColourClusters& clusters,
                             bool ours) {
  const auto agreement = fruit.truth.empty() ? std::nullopt : DefectAgreement(clusters, fruit.truth, ours);
  return {fruit.name,
          std::to_string(fruit.cloud.size()),
          method,
          std::to_string(clusters.classes),
          FixedText(clusters.cpu_s, 3),
          OrDash(DaviesBouldinIndex(clusters), 3),
          OrDash(agreement, 3)};
}

Status AddRows(const TrueFruit& fruit, const std::vector<int>& classes, std::vector<std::vector<std::string>>& rows) {
  DRUPE_ASSIGN_OR_RETURN(const OurClusters both, ClusterByUs(fruit.cloud));
  const ColourClusters& ours = both.colours;
  rows.push_back(Row(fruit, "ours, nearest centre", ours, true));
  rows.push_back(Row(fruit, "ours, spot by spot", both.spots, true));
  const std::vector<Eigen::Vector3f> lab = WeightedLab(fruit.cloud);
  std::vector<int> counts = classes;
  if (ours.classes > 1) counts.insert(counts.begin(), ours.classes);
  for (const int count : counts) {
    rows.push_back(Row(fruit, "K-means", ClusterByOpenCv(lab, count, false), false));
    rows.push_back(Row(fruit, "K-means++", ClusterByOpenCv(lab, count, true), false));
  }
  const int most = std::max(2, ours.classes);
  rows.push_back(Row(fruit, "K-means++, our shading off", ClusterByOpenCv(ours.colours, most, true), false));
  return Status::Ok();
}

Status Run(const SegmentationArguments& arguments) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& input : arguments.inputs) {
    DRUPE_ASSIGN_OR_RETURN(const std::vector<TrueFruit> fruits, LoadFruits(input, arguments.clouds));
    for (const TrueFruit& fruit : fruits) DRUPE_RETURN_IF_ERROR(AddRows(fruit, arguments.classes, rows));
  }
  std::printf(
      "Ours finds K and says which classes are defects; OpenCV's are given K, and the classes that agree best.\n"
      "'nearest centre' are the clusters of the search: each point by the nearest of its centres. 'spot by spot' is "
      "what\n"
      "is made of them: each point by half way, in light, between its spot's core and the skin about that spot\n");
  const std::vector<std::string> heading = {"fruit", "points", "method", "K", "CPU s", "DBI", "agreement"};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

}  // namespace

void AddSegmentationBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<SegmentationArguments>();
  CLI::App* command = bench.add_subcommand(
      "segmentation",
      "Colour classes of the skin: ours beside OpenCV's K-means and K-means++ on the same points. Seconds of CPU, the\n"
      "Davies-Bouldin index (smaller is better) and the agreement of the defects' points with the truth (intersection\n"
      "over union, 1 is best; '-' where there is no defect or no truth)");
  command->add_option("INPUT", arguments->inputs, "Sets with truth.json and labels.png, or dense.ply clouds in mm")
      ->required();
  command->add_option("--clouds", arguments->clouds, "Take CLOUDS/SET/dense.ply of the sets, and do not reconstruct");
  command->add_option("--classes", arguments->classes, "K for OpenCV's, beside that which ours finds")
      ->check(CLI::Range(2, 16));
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
