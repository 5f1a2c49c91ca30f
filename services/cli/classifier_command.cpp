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
#include "defect_analysis/models/defect_labels.h"
#include "defect_analysis/models/train_class_model.h"

namespace drupe {

namespace {

using Names = std::vector<std::string>;

constexpr std::size_t kMaxReportBytes = 64 << 20;  // thousands of defects with their contours

/// What the user wrote after `drupe classifier train`.
struct ClassifierArguments {
  Names reports;
  std::string labels;
  ClassTrainOptions options;
  std::string out;
};

using Labels = std::vector<DefectLabel>;

/// The labels of a table, which must say of which report each is when there are several.
Result<std::optional<Labels>> LoadLabels(const ClassifierArguments& arguments) {
  if (arguments.labels.empty()) return std::optional<Labels>();
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(arguments.labels));
  DRUPE_ASSIGN_OR_RETURN(Labels labels, ParseDefectLabels(text));
  for (const DefectLabel& label : labels) {
    if (!label.report.empty() || arguments.reports.size() == 1) continue;
    return InvalidArgument("bad_labels",
                           "there are several reports, and line " + std::to_string(label.line) + " names none");
  }
  return std::optional<Labels>(std::move(labels));
}

Result<std::vector<LabelledDefect>> LoadReport(const std::string& file, const std::optional<Labels>& labels) {
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxReportBytes));
  DRUPE_ASSIGN_OR_RETURN(Json json, ParseJson(text, {.max_bytes = kMaxReportBytes}));
  if (labels) DRUPE_RETURN_IF_ERROR(LabelReport(*labels, json));
  return ReadLabelledReport(json);
}

Status InFile(const std::string& file, const Status& status) {
  return Status(status.kind(), status.code(), file + ": " + status.message(), status.field());
}

void PrintWeights(const ClassModel& model) {
  Names heading = {"feature", "mean", "scale"};
  for (const DefectClass one : model.classes) heading.push_back(DefectClassName(one));
  std::vector<Names> rows;
  for (int k = 0; k < kClassFeatures; ++k) {
    rows.push_back({kClassFeatureNames[k], FixedText(model.mean[k], 3), FixedText(model.scale[k], 3)});
    for (const double weight : model.weights.col(k)) rows.back().push_back(FixedText(weight, 2));
  }
  rows.push_back({"bias", "", ""});
  for (const double bias : model.bias) rows.back().push_back(FixedText(bias, 2));
  std::printf("%s: weights of the standardised features, from %lld defects of %lld reports, ridge %g\n",
              model.name.c_str(), static_cast<long long>(model.training.sum()), static_cast<long long>(model.reports),
              model.ridge);
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
}

void PrintConfusion(const char* title, const ClassModel& model, const ClassConfusion& table) {
  std::printf("\n%s: %lld of %lld right\n", title, static_cast<long long>(table.trace()),
              static_cast<long long>(table.sum()));
  Names heading = {"is \\ taken for"};
  for (const DefectClass one : model.classes) heading.push_back(DefectClassName(one));
  std::vector<Names> rows;
  for (Eigen::Index row = 0; row < table.rows(); ++row) {
    rows.push_back({heading[static_cast<std::size_t>(row) + 1]});
    for (const std::int64_t count : table.row(row)) rows.back().push_back(std::to_string(count));
  }
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
}

void PrintModel(const ClassModel& model) {
  PrintWeights(model);
  PrintConfusion("The defects it was trained from", model, model.training);
  PrintConfusion("Each report by a model of the others", model, model.left_out);
}

Status Train(const ClassifierArguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const std::optional<Labels> labels, LoadLabels(arguments));
  std::vector<std::vector<LabelledDefect>> reports;
  for (const std::string& file : arguments.reports) {
    Result<std::vector<LabelledDefect>> report = LoadReport(file, labels);
    if (!report.ok()) return InFile(file, report.status());
    reports.push_back(std::move(*report));
  }
  DRUPE_ASSIGN_OR_RETURN(const ClassModel model, TrainClassModel(reports, arguments.options));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(arguments.out, DumpJson(ToJson(model), 1) + "\n"));
  PrintModel(model);
  std::printf("Written to %s\n", arguments.out.c_str());
  return Status::Ok();
}

Status ShowClassifier(const std::string& file) {
  DRUPE_ASSIGN_OR_RETURN(const std::optional<ClassModel> model, LoadClassModelArgument(file));
  if (!model) return InvalidArgument("invalid_model", "name a model file", "FILE");
  PrintModel(*model);
  return Status::Ok();
}

void AddTrainClassifierCommand(CLI::App& classifier, int& exit_code) {
  auto arguments = std::make_shared<ClassifierArguments>();
  CLI::App* command = classifier.add_subcommand(
      "train",
      "Train a classifier of defects from reports in which a person has corrected the classes.\n"
      "Take report.json of `drupe run` or of the service, set each defect's \"class\" to rain_spot, scar, crack or "
      "decay, "
      "and delete what is no defect. Then: drupe classifier train a/report.json b/report.json --out classes.json, and "
      "drupe run ... --class-model classes.json");
  command->add_option("REPORT", arguments->reports, "Corrected report.json files, in mm; one fruit in one report only")
      ->required();
  command->add_option("--labels", arguments->labels,
                      "A table (CSV) of the true classes, so that no report need be edited: columns report (the "
                      "report's id), fruit, defect and class, one line a defect; class none for what is no defect. "
                      "A defect without a line is left out; report and fruit may be missing where there is only one");
  command->add_option("--name", arguments->options.name, "The model's name")->capture_default_str();
  command
      ->add_option("--ridge", arguments->options.ridge,
                   "Penalty on the weights, 0.001 to 1000: the more, the less sure and the less learnt by heart")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "The model file to write (JSON)")->required();
  command->callback(
      [arguments, &exit_code] { exit_code = CommandExitCode("drupe classifier train", Train(*arguments)); });
}

}  // namespace

void AddClassifierCommand(CLI::App& app, int& exit_code) {
  CLI::App* classifier =
      app.add_subcommand("classifier", "Train and show models that tell the classes of defects apart");
  classifier->require_subcommand(1);
  AddTrainClassifierCommand(*classifier, exit_code);
  auto file = std::make_shared<std::string>();
  CLI::App* show = classifier->add_subcommand("show", "Print a model's weights and its confusion tables");
  show->add_option("FILE", *file, "A model file")->required();
  show->callback([file, &exit_code] { exit_code = CommandExitCode("drupe classifier show", ShowClassifier(*file)); });
}

}  // namespace drupe
