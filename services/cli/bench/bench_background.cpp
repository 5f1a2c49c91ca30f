#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/files.h"
#include "cli/bench/bench.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_cloud.h"
#include "cli/labelled_clouds.h"
#include "defect_analysis/models/colour_sample.h"
#include "defect_analysis/models/train_model.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench background`.
struct BackgroundArguments {
  std::vector<std::string> sets;
  std::string clouds;
  int recoloured = 8;
};

/// One set's points; sets of the same fruit are trained and tested together.
struct LabelledSet {
  std::string name;
  std::string fruit;
  LabelledColours points;
};

std::string FruitOf(const TruthSet& set) {
  return set.truth.contains("plum") ? set.truth["plum"].get<std::string>() : set.name;
}

Result<LabelledSet> LoadSet(const std::string& directory, const std::string& clouds) {
  DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(directory));
  DRUPE_ASSIGN_OR_RETURN(const PointCloud cloud, CloudOfSet(set, clouds, DenseOptions::Scene::kAll));
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(directory + "/surface.ply"));
  DRUPE_ASSIGN_OR_RETURN(const PointCloud surface, ReadPly(bytes));
  return LabelledSet{set.name, FruitOf(set), LabelBySurface(cloud, surface.positions)};
}

struct Variant {
  const char* name;
  ColourSpace space;
  bool recoloured;
};
constexpr std::array<Variant, 4> kVariants = {{{"Lab", ColourSpace::kLab, false},
                                               {"RGB", ColourSpace::kRgb, false},
                                               {"Lab, recoloured", ColourSpace::kLab, true},
                                               {"RGB, recoloured", ColourSpace::kRgb, true}}};

struct Score {
  ConfusionTable training, test, other_hues;

  void Add(const Score& other) {
    Sum(other.training, training);
    Sum(other.test, test);
    Sum(other.other_hues, other_hues);
  }

 private:
  static void Sum(const ConfusionTable& from, ConfusionTable& to) {
    to.fruit_as_fruit += from.fruit_as_fruit;
    to.fruit_as_background += from.fruit_as_background;
    to.background_as_fruit += from.background_as_fruit;
    to.background_as_background += from.background_as_background;
  }
};

/// The fruit's points in hues and lightnesses that the recoloured copies of the training do not have.
LabelledColours OtherHues(const LabelledColours& points) {
  constexpr std::size_t kSample = 4000;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSample);
  LabelledColours others;
  for (std::size_t i = 0; i < points.size(); i += step) {
    if (points.is_fruit[i] == 0) continue;
    for (const double turn : {30.0, 90.0, 150.0, 210.0, 270.0, 330.0}) {
      for (const double gain : {1.0, 0.6}) others.Add(Recolour(points.colours[i], turn, gain), true);
    }
  }
  return others;
}

Result<Score> TestOn(const std::string& fruit, const std::vector<LabelledSet>& sets, const Variant& variant,
                     int recoloured) {
  LabelledColours training, test;
  for (const LabelledSet& set : sets) (set.fruit == fruit ? test : training).Append(set.points);
  TrainOptions options;
  options.space = variant.space;
  options.recoloured = variant.recoloured ? recoloured : 0;
  const LabelledColours other_hues = OtherHues(test);
  DRUPE_ASSIGN_OR_RETURN(const ColourModel model,
                         TrainColourModel(std::move(training), std::move(test), options, RunContext()));
  return Score{model.training, model.test, JudgeColourModel(model, other_hues, other_hues.size())};
}

std::vector<std::string> Row(const Variant& variant, const std::string& fruit, const Score& score) {
  std::vector<std::string> row = {variant.name, fruit};
  for (const ConfusionTable& table : {score.training, score.test}) {
    for (const double share : {table.Accuracy(), table.BackgroundError(), table.FruitError()}) {
      row.push_back(FixedText(100 * share, 2));
    }
  }
  row.push_back(FixedText(100 * score.other_hues.FruitError(), 2));
  return row;
}

Status Run(const BackgroundArguments& arguments) {
  std::vector<LabelledSet> sets;
  for (const std::string& directory : arguments.sets) {
    DRUPE_ASSIGN_OR_RETURN(LabelledSet set, LoadSet(directory, arguments.clouds));
    sets.push_back(std::move(set));
  }
  std::vector<std::string> fruits;
  for (const LabelledSet& set : sets) {
    if (std::find(fruits.begin(), fruits.end(), set.fruit) == fruits.end()) fruits.push_back(set.fruit);
  }
  if (fruits.size() < 2) return InvalidArgument("too_few_sets", "sets of at least two different fruits are needed");
  std::vector<std::vector<std::string>> rows;
  for (const Variant& variant : kVariants) {
    Score all;
    for (const std::string& fruit : fruits) {
      DRUPE_ASSIGN_OR_RETURN(const Score score, TestOn(fruit, sets, variant, arguments.recoloured));
      rows.push_back(Row(variant, fruit, score));
      all.Add(score);
    }
    rows.push_back(Row(variant, "all", all));
  }
  std::printf(
      "Support vector machines with a radial kernel, each tested on a fruit that it was not trained on; percent\n");
  const std::vector<std::string> heading = {"colour space",    "test fruit", "training accuracy",
                                            "background err.", "fruit err.", "test accuracy",
                                            "background err.", "fruit err.", "other hues' fruit err."};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

}  // namespace

void AddBackgroundBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<BackgroundArguments>();
  CLI::App* command = bench.add_subcommand(
      "background",
      "Table 4 of the paper: fruit against background by colour, Lab against RGB. Every fruit in turn is the test of "
      "a\n"
      "model trained on the others; 'recoloured' models are trained with copies of the fruit in other hues");
  command->add_option("SET_DIR", arguments->sets, "Sets with images, calibration, board, truth.json and surface.ply")
      ->required();
  command->add_option("--clouds", arguments->clouds,
                      "Take CLOUDS/SET/dense.ply, made with {\"dense\": {\"scene\": \"all\"}}, and do not reconstruct");
  command->add_option("--recoloured", arguments->recoloured, "Copies in other hues")->check(CLI::Range(1, 24));
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
