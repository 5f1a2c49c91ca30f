#include "defect_analysis/models/train_model.h"

#include <algorithm>
#include <cmath>

#include "defect_analysis/models/colour_sample.h"
#include "defect_analysis/models/svm_solver.h"

namespace drupe {
namespace {

constexpr std::size_t kJudgedPoints = 100'000;
constexpr float kMinScale = 1;  // of a channel that hardly varies

void Normalise(const LabelledColours& sample, ColourModel& model, std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (const Rgb8& colour : sample.colours) {
    points.push_back(PlaceOf(colour, model.space));
    sum += points.back().cast<double>();
    squares += points.back().cast<double>().cwiseAbs2();
  }
  const auto count = static_cast<double>(sample.size());
  const Eigen::Vector3d variance = squares / count - (sum / count).cwiseAbs2();
  model.mean = (sum / count).cast<float>();
  model.scale = variance.cwiseMax(0).cwiseSqrt().cast<float>().cwiseMax(kMinScale);
  for (Eigen::Vector3f& point : points) point = (point - model.mean).cwiseQuotient(model.scale);
}

}  // namespace

ConfusionTable JudgeColourModel(const ColourModel& model, const LabelledColours& colours, std::size_t max_points) {
  const std::size_t step = std::max<std::size_t>(1, colours.size() / max_points);
  ConfusionTable table;
  for (std::size_t i = 0; i < colours.size(); i += step) {
    table.Count(colours.is_fruit[i] != 0, model.Decide(colours.colours[i]) > 0);
  }
  return table;
}

Result<ColourModel> TrainColourModel(LabelledColours training, LabelledColours test, const TrainOptions& options,
                                     const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  context.Report("training", 0);
  if (test.size() == 0) SplitOff(options.test_share, training, test);
  const LabelledColours sample = SampleColours(WithRecolouredFruit(training, options.recoloured), options.max_points);
  if (sample.size() == 0) return Unprocessable("one_class", "both fruit and background are needed for training");
  ColourModel model;
  model.name = options.name;
  model.space = options.space;
  model.gamma = static_cast<float>(options.gamma);
  model.c = options.c;
  std::vector<Eigen::Vector3f> points;
  Normalise(sample, model, points);
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  DRUPE_ASSIGN_OR_RETURN(SvmSolution solution, SolveSvm(points, sample.is_fruit, options.c, options.gamma));
  if (solution.vectors.size() > ColourModel::kMaxVectors) {
    return Unprocessable("training_failed", "the two classes overlap too much: too many support vectors");
  }
  model.vectors = std::move(solution.vectors);
  model.weights = std::move(solution.weights);
  model.bias = solution.bias;
  context.Report("training", 0.7);
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  model.training = JudgeColourModel(model, training, kJudgedPoints);
  model.test = JudgeColourModel(model, test, kJudgedPoints);
  model.source = {{"options", ToJson(options)}, {"training_points", training.size()}, {"test_points", test.size()}};
  context.Report("training", 1);
  return model;
}

}  // namespace drupe
