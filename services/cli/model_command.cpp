#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/files.h"
#include "cli/bench/text_table.h"
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/json_arguments.h"
#include "cli/labelled_clouds.h"
#include "defect_analysis/models/train_model.h"

namespace drupe {

namespace {

using Names = std::vector<std::string>;

/// What the user wrote after `drupe model train`.
struct ModelArguments {
  Names clouds, labels, images, masks, test_clouds, test_labels;
  std::string options;
  std::string out;
};

Result<LabelledColours> LoadClouds(const Names& clouds, const Names& labels) {
  if (clouds.size() != labels.size()) {
    return InvalidArgument("missing_labels",
                           "every cloud needs its labels: --labels property, or a surface's PLY file");
  }
  LabelledColours all;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    DRUPE_ASSIGN_OR_RETURN(const LabelledColours labelled, LoadLabelledCloud(clouds[k], labels[k]));
    all.Append(labelled);
  }
  return all;
}

Result<LabelledColours> LoadImages(const Names& images, const Names& masks) {
  if (images.size() != masks.size()) return InvalidArgument("missing_mask", "every --image needs its --mask");
  LabelledColours all;
  for (std::size_t k = 0; k < images.size(); ++k) {
    DRUPE_ASSIGN_OR_RETURN(const std::string image, ReadFile(images[k]));
    DRUPE_ASSIGN_OR_RETURN(const std::string mask, ReadFile(masks[k]));
    DRUPE_ASSIGN_OR_RETURN(const LabelledColours labelled, ReadMaskedImage(image, mask));
    all.Append(labelled);
  }
  return all;
}

void PrintModel(const ColourModel& model) {
  const auto row = [](const char* name, const ConfusionTable& table) {
    return Names{name, std::to_string(table.Points()), FixedText(100 * table.Accuracy(), 2) + " %",
                 FixedText(100 * table.BackgroundError(), 2) + " %", FixedText(100 * table.FruitError(), 2) + " %"};
  };
  std::printf("%s: %zu support vectors in %s\n", model.name.c_str(), model.vectors.size(),
              ColourSpaceName(model.space));
  const Names heading = {"points", "number", "accuracy", "background error", "fruit error"};
  std::fputs(FormatTextTable(heading, {row("training", model.training), row("test", model.test)}).c_str(), stdout);
}

Status Train(const ModelArguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(arguments.options));
  DRUPE_ASSIGN_OR_RETURN(const TrainOptions options, ParseTrainOptions(json));
  DRUPE_ASSIGN_OR_RETURN(LabelledColours training, LoadClouds(arguments.clouds, arguments.labels));
  DRUPE_ASSIGN_OR_RETURN(const LabelledColours pictures, LoadImages(arguments.images, arguments.masks));
  DRUPE_ASSIGN_OR_RETURN(LabelledColours test, LoadClouds(arguments.test_clouds, arguments.test_labels));
  training.Append(pictures);
  DRUPE_ASSIGN_OR_RETURN(const ColourModel model,
                         TrainColourModel(std::move(training), std::move(test), options, RunContext()));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(arguments.out, DumpJson(ToJson(model)) + "\n"));
  PrintModel(model);
  std::printf("Written to %s\n", arguments.out.c_str());
  return Status::Ok();
}

Status ShowModel(const std::string& file) {
  DRUPE_ASSIGN_OR_RETURN(const ColourModel model, LoadModelArgument(file));
  PrintModel(model);
  return Status::Ok();
}

void AddTrainModelCommand(CLI::App& model, int& exit_code) {
  auto arguments = std::make_shared<ModelArguments>();
  CLI::App* command = model.add_subcommand(
      "train",
      "Train a model that tells fruit from background by colour, from labelled clouds, or from pictures and masks.\n"
      "A cloud with board, needle and fruit comes from `drupe run ... --options '{\"dense\": {\"scene\": \"all\"}}'`");
  command->add_option("--cloud", arguments->clouds, "A coloured PLY cloud; may be repeated");
  command->add_option(
      "--labels", arguments->labels,
      "For each cloud: 'property' when its vertices have a property label (1 fruit, 0 background), or a "
      "PLY file with points of the fruit's surface in the same frame, mm");
  command->add_option("--image", arguments->images, "A picture; may be repeated");
  command->add_option("--mask", arguments->masks, "For each picture: a picture of the same size, fruit white");
  command->add_option("--test-cloud", arguments->test_clouds, "Clouds of other fruit to judge the model by");
  command->add_option("--test-labels", arguments->test_labels, "As --labels");
  command->add_option(
      "--options", arguments->options,
      "A JSON file, or JSON: name, colour_space (lab, rgb), c, gamma, max_points, test_share, recoloured");
  command->add_option("--out", arguments->out, "The model file to write (JSON)")->required();
  command->callback([arguments, &exit_code] { exit_code = CommandExitCode("drupe model train", Train(*arguments)); });
}

}  // namespace

void AddModelCommand(CLI::App& app, int& exit_code) {
  CLI::App* model = app.add_subcommand("model", "Train and show models of the background's colours");
  model->require_subcommand(1);
  AddTrainModelCommand(*model, exit_code);
  auto file = std::make_shared<std::string>();
  CLI::App* show = model->add_subcommand("show", "Print a model's size and its confusion tables");
  show->add_option("FILE", *file, "A model file, or 'default' for the one built in")->required();
  show->callback([file, &exit_code] { exit_code = CommandExitCode("drupe model show", ShowModel(*file)); });
}

}  // namespace drupe
